# `cpack -G DEB` in the build folder: one Debian package with the program, its man page and completions, library, headers, pkg-config and
# CMake files, and the Python package where it is built. Versions of the libraries that it needs are taken from the binaries
# (dpkg-shlibdeps). With SOURCE_DATE_EPOCH set, the same build gives the same bytes.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME schuler)
set(CPACK_PACKAGE_VENDOR "Schuler")
set(CPACK_PACKAGE_CONTACT "The Schuler authors <schuler@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "integrated inertial-satellite navigation")
set(CPACK_PACKAGE_DESCRIPTION "From IMU and GNSS logs to a trajectory with honest uncertainty: filters and smoothers of all couplings, attitude and
 heading, gravimetry, simulation, theory and studies. Program, C++ library and Python package.")
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL OFF)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE zstd)   # Debian 12 and later
# to build programs with the library, which is an archive; the program itself needs none of them
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "g++, libeigen3-dev, libfmt-dev, libgeographiclib-dev, libhdf5-dev, zlib1g-dev, libyaml-cpp-dev, libmatio-dev, \
libsqlite3-dev, libzstd-dev, liblz4-dev, libbz2-dev, octave, python3-pandas, python3-matplotlib")
if(TARGET schuler_python)
    set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-numpy")
endif()
include(CPack)
