# The page of `schuler ui`, compiled into the program: ui/bundle as it is kept in the repository, so that the program needs no Node.
# scripts/build_ui.sh renews it from ui/; the test e2e.ui_bundle compares.
#   SCHULER_UI_SOURCE    the source file with the page and the example scenarios in it
set(ui_bundle "${PROJECT_SOURCE_DIR}/ui/bundle")
file(GLOB_RECURSE ui_files CONFIGURE_DEPENDS "${ui_bundle}/*")
file(GLOB examples CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/examples/*.toml" "${PROJECT_SOURCE_DIR}/examples/*.csv")

set(SCHULER_UI_SOURCE "${PROJECT_BINARY_DIR}/ui/assets.cpp")
add_custom_command(
    OUTPUT "${SCHULER_UI_SOURCE}"
    COMMAND "${CMAKE_COMMAND}" "-DDIST=${ui_bundle}" "-DEXAMPLES=${examples}" "-DSOURCE=${SCHULER_UI_SOURCE}"
            -P "${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake"
    DEPENDS ${ui_files} ${examples} "${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake"
    COMMENT "Embedding the web page"
    VERBATIM)
