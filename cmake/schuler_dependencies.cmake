# Third-party libraries (Debian 12 packages; scripts/packages.sh lists and installs them). Read by this build and, installed, by
# schulerConfig.cmake: there SCHULER_LINKED_ONLY leaves out what is needed to compile the library but not to link it.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(ZLIB REQUIRED)
find_package(Threads REQUIRED)
find_package(yaml-cpp REQUIRED)

find_package(PkgConfig REQUIRED)
function(schuler_pkg_config alias prefix module)
    if(NOT TARGET ${alias})
        pkg_check_modules(${prefix} REQUIRED QUIET IMPORTED_TARGET GLOBAL ${module})
        add_library(${alias} ALIAS PkgConfig::${prefix})
    endif()
endfunction()
schuler_pkg_config(GeographicLib::GeographicLib GEOGRAPHICLIB geographiclib)
schuler_pkg_config(tomlplusplus::tomlplusplus TOMLPLUSPLUS tomlplusplus)
schuler_pkg_config(schuler_hdf5 HDF5 hdf5-serial)

if(NOT SCHULER_LINKED_ONLY)
    find_package(nlohmann_json REQUIRED)
    find_package(CLI11 REQUIRED)
    find_package(FastFloat REQUIRED)
    find_package(Boost 1.74 REQUIRED)  # Multiprecision, headers only
    schuler_pkg_config(schuler_httplib HTTPLIB cpp-httplib)
endif()
