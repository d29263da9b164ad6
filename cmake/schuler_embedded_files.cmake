# Files that are compiled into a room, so that the program needs nothing beside it: see embed_data.cmake.
function(schuler_embed room namespace header)
    get_target_property(imported schuler_${room} IMPORTED)
    if(imported)
        return()
    endif()
    set(source "${PROJECT_BINARY_DIR}/embedded/${room}.cpp")
    add_custom_command(
        OUTPUT "${source}"
        COMMAND "${CMAKE_COMMAND}" "-DNAME=${room}" "-DNAMESPACE=${namespace}" "-DHEADER=${header}" "-DFILES=${ARGN}" "-DSOURCE=${source}"
                -P "${PROJECT_SOURCE_DIR}/cmake/embed_data.cmake"
        DEPENDS ${ARGN} "${PROJECT_SOURCE_DIR}/cmake/embed_data.cmake"
        COMMENT "Embedding files of ${room}"
        VERBATIM)
    target_sources(schuler_${room} PRIVATE "${source}")
    set_source_files_properties("${source}" PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# Style sheet and script of reports.
file(GLOB page_files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/schuler/report/page/*")
schuler_embed(report schuler::report::detail schuler/report/detail/page_assets.h ${page_files})
# What `schuler paper` needs of data and examples.
file(GLOB paper_files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/data/papers.toml" "${PROJECT_SOURCE_DIR}/examples/paper-*.toml"
     "${PROJECT_SOURCE_DIR}/examples/presets.toml" "${PROJECT_SOURCE_DIR}/examples/gravity-*.toml")
schuler_embed(study schuler::study schuler/study/papers/printed.h ${paper_files})
# What `schuler demo` runs.
schuler_embed(settings schuler::settings::detail schuler/settings/scenario/built_in.h "${PROJECT_SOURCE_DIR}/examples/demo.toml")
