# What `schuler paper` needs of data and examples, compiled into the room study: the program runs it without its sources.
file(GLOB paper_files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/data/papers.toml" "${PROJECT_SOURCE_DIR}/examples/paper-*.toml"
     "${PROJECT_SOURCE_DIR}/examples/presets.toml" "${PROJECT_SOURCE_DIR}/examples/gravity-*.toml")
set(paper_source "${PROJECT_BINARY_DIR}/papers/embedded.cpp")
add_custom_command(
    OUTPUT "${paper_source}"
    COMMAND "${CMAKE_COMMAND}" "-DFILES=${paper_files}" "-DSOURCE=${paper_source}" -P "${PROJECT_SOURCE_DIR}/cmake/embed_data.cmake"
    DEPENDS ${paper_files} "${PROJECT_SOURCE_DIR}/cmake/embed_data.cmake"
    COMMENT "Embedding what the papers print"
    VERBATIM)
target_sources(schuler_study PRIVATE "${paper_source}")
