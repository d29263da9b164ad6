# The page of `schuler ui`: ui/ is built by npm and Vite, and what comes out is compiled into the program. Without npm, or where it
# reaches no registry, the program is built all the same and serves a page that says what is missing (docs/building.md).
#   SCHULER_UI_SOURCE    the source file with the page and the example scenarios in it
set(SCHULER_UI "AUTO" CACHE STRING "the page of `schuler ui`: AUTO (built where npm can), ON (an error where it cannot), OFF")
set(ui "${PROJECT_SOURCE_DIR}/ui")
set(ui_dist "${PROJECT_BINARY_DIR}/ui/dist")
file(GLOB_RECURSE ui_sources CONFIGURE_DEPENDS "${ui}/src/*" "${ui}/public/*")
list(APPEND ui_sources "${ui}/index.html" "${ui}/package.json" "${ui}/package-lock.json" "${ui}/vite.config.ts" "${ui}/tsconfig.json")
file(GLOB examples CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/examples/*.toml")

set(ui_mode "${SCHULER_UI}")
if(SCHULER_SANITIZE OR SCHULER_FUZZ)
    set(ui_mode OFF)   # the page is not what these builds look at
endif()
add_custom_command(
    OUTPUT "${PROJECT_BINARY_DIR}/ui/built"
    COMMAND "${PROJECT_SOURCE_DIR}/scripts/build_ui.sh" "${ui_mode}" "${PROJECT_BINARY_DIR}/ui"
    DEPENDS ${ui_sources} "${PROJECT_SOURCE_DIR}/scripts/build_ui.sh"
    COMMENT "Building the web page"
    VERBATIM)

set(SCHULER_UI_SOURCE "${PROJECT_BINARY_DIR}/ui/assets.cpp")
add_custom_command(
    OUTPUT "${SCHULER_UI_SOURCE}"
    COMMAND "${CMAKE_COMMAND}" "-DDIST=${ui_dist}" "-DEXAMPLES=${examples}" "-DSOURCE=${SCHULER_UI_SOURCE}"
            -P "${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake"
    DEPENDS "${PROJECT_BINARY_DIR}/ui/built" ${examples} "${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake"
    COMMENT "Embedding the web page"
    VERBATIM)
