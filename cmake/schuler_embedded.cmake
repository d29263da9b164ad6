# The embedded core: the streaming navigator and the attitude filter, and what they are made of, without exceptions and run-time types.
# A build of its own (SCHULER_EMBEDDED=ON), because its needs are few: Eigen and the headers of Boost.Math and fmt. docs/embed.md says what
# it can do; scripts/embedded.sh builds it for several processors and compares them.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)

# A cross compiler does not look into the headers of the machine it runs on, and must not, but for these two: they are headers only.
set(headers "${PROJECT_BINARY_DIR}/headers")
file(MAKE_DIRECTORY "${headers}")
foreach(library boost fmt)
    find_path(SCHULER_${library}_HEADERS ${library} PATHS /usr/include NO_CMAKE_FIND_ROOT_PATH REQUIRED)
    file(CREATE_LINK "${SCHULER_${library}_HEADERS}/${library}" "${headers}/${library}" SYMBOLIC)
endforeach()

# All of the filter; of the other rooms what it and the attitude filter call. A file that is missing here fails to link.
file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/schuler/filter/*.cpp" "${PROJECT_SOURCE_DIR}/src/embedded/*.cpp")
foreach(file core/error core/time math/chi_square math/rotation math/steep_attitude earth/atmosphere earth/earth earth/ellipsoid
        earth/gravity estim/scalar_update estim/transition estim/update sensor/grades gnss/atmosphere gnss/ranges gnss/ground_range
        gnss/satellite ins/align ins/error_e ins/error_n ins/increments ins/state_error ins/step_e ins/step_n
        ahrs/dcm_filter ahrs/field_watch ahrs/heading_channel ahrs/heading_model ahrs/mekf ahrs/quaternion_filter ahrs/settings
        ahrs/tilt_channel)
    list(APPEND sources "${PROJECT_SOURCE_DIR}/src/schuler/${file}.cpp")
endforeach()

add_library(schuler_embedded STATIC ${sources})
target_compile_features(schuler_embedded PUBLIC cxx_std_20)
target_compile_options(schuler_embedded PUBLIC -fno-exceptions -fno-rtti
                       PRIVATE -ffunction-sections -fdata-sections -fstack-usage $<$<CONFIG:Release>:-O2>)
target_compile_definitions(schuler_embedded PUBLIC ${SCHULER_ABI_DEFINITIONS} FMT_HEADER_ONLY)
if(SCHULER_FLOAT32_COVARIANCE)
    target_compile_definitions(schuler_embedded PUBLIC SCHULER_FLOAT32_COVARIANCE)
    # Variances are assigned and increased in many places: the rounding is what is asked for.
    target_compile_options(schuler_embedded PRIVATE -Wno-float-conversion)
endif()
target_include_directories(schuler_embedded PUBLIC "${PROJECT_SOURCE_DIR}/src")
target_include_directories(schuler_embedded SYSTEM PUBLIC "${headers}")
target_link_libraries(schuler_embedded PUBLIC Eigen3::Eigen PRIVATE schuler_flags)

# Its example, which is its test: linked without the loader, for an emulator has none of another processor.
add_executable(embedded_drive "${PROJECT_SOURCE_DIR}/examples/embedded/main.cpp")
target_link_libraries(embedded_drive PRIVATE schuler_embedded schuler_flags)
target_link_options(embedded_drive PRIVATE -static -Wl,--gc-sections -no-pie)
