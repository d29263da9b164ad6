# `cmake --install build --prefix X`: headers, libschuler, the find_package(schuler) and pkg-config files (component development), and the
# program with its data (component program).
include(CMakePackageConfigHelpers)
set(config_dir "${CMAKE_INSTALL_LIBDIR}/cmake/schuler")

install(TARGETS schuler EXPORT schulerTargets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/src/schuler" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT development
        FILES_MATCHING PATTERN "*.h" PATTERN "inner" EXCLUDE)
install(EXPORT schulerTargets NAMESPACE schuler:: DESTINATION "${config_dir}" COMPONENT development)
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/schulerConfig.cmake.in" "${PROJECT_BINARY_DIR}/schulerConfig.cmake"
                              INSTALL_DESTINATION "${config_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/schulerConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/schulerConfig.cmake" "${PROJECT_BINARY_DIR}/schulerConfigVersion.cmake"
              "${CMAKE_CURRENT_LIST_DIR}/schuler_dependencies.cmake"
        DESTINATION "${config_dir}" COMPONENT development)

set(pc_definitions "")
foreach(definition ${SCHULER_ABI_DEFINITIONS})
    string(APPEND pc_definitions "-D${definition} ")
endforeach()
set(pc_hdf5 "")
if(NOT HDF5_MODULE_NAME)   # found without pkg-config
    string(JOIN " " pc_hdf5 ${HDF5_C_LIBRARIES})
    string(APPEND pc_hdf5 " ")
endif()
file(RELATIVE_PATH pc_to_prefix "/prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/prefix")   # wherever it is unpacked
configure_file("${CMAKE_CURRENT_LIST_DIR}/schuler.pc.in" "${PROJECT_BINARY_DIR}/schuler.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/schuler.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT development)

if(TARGET schuler_cli)
    install(TARGETS schuler_cli RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT program)
    install(FILES "${PROJECT_BINARY_DIR}/shell/schuler.1" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT program OPTIONAL)
    install(FILES "${PROJECT_BINARY_DIR}/shell/schuler.bash" DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions"
            RENAME schuler COMPONENT program OPTIONAL)
    install(FILES "${PROJECT_BINARY_DIR}/shell/_schuler" DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/site-functions" COMPONENT program OPTIONAL)
endif()
# systemd looks for units of packages here, whatever the library folder is called
install(FILES "${PROJECT_SOURCE_DIR}/examples/live/schuler-live.service" DESTINATION lib/systemd/system COMPONENT program)
if(EXISTS "${PROJECT_SOURCE_DIR}/data")
    install(DIRECTORY "${PROJECT_SOURCE_DIR}/data/" DESTINATION "${CMAKE_INSTALL_DATADIR}/schuler" COMPONENT program)
endif()
install(DIRECTORY "${PROJECT_SOURCE_DIR}/octave" DESTINATION "${CMAKE_INSTALL_DATADIR}/schuler" COMPONENT program)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/examples" DESTINATION "${CMAKE_INSTALL_DATADIR}/schuler" COMPONENT program FILES_MATCHING PATTERN "*.toml")
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program)
include(schuler_package)
