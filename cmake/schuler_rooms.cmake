# A room is src/schuler/NAME with an archive schuler_NAME, so that a link finds what a room uses and should not. What users link
# is libschuler: the objects of all rooms in one archive, with the third-party libraries behind it.

# With SCHULER_PCH: what nearly every file includes, parsed once. Off by default, so that a forgotten include is found.
function(schuler_precompile target headers)
    if(SCHULER_PCH)
        target_precompile_headers(${target} PRIVATE ${headers})
    endif()
endfunction()
set(SCHULER_COMMON_HEADERS <Eigen/Core> <Eigen/Geometry> <Eigen/LU> <fmt/format.h> <algorithm> <array> <cmath> <filesystem> <functional>
    <map> <optional> <string> <vector>)

function(schuler_room name)
    cmake_parse_arguments(ROOM "" "" "DEPENDS;PRIVATE;HEADERS" ${ARGN})
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/schuler/${name}/*.cpp")
    set(target schuler_${name})
    if(sources)
        add_library(${target} STATIC ${sources})
        target_link_libraries(${target} PUBLIC ${ROOM_DEPENDS} PRIVATE schuler_flags ${ROOM_PRIVATE} ${ROOM_HEADERS})
        target_include_directories(${target} PUBLIC "${PROJECT_SOURCE_DIR}/src")
        target_compile_definitions(${target} PUBLIC ${SCHULER_ABI_DEFINITIONS})
        schuler_precompile(${target} "${SCHULER_COMMON_HEADERS}")
        set_property(GLOBAL APPEND PROPERTY SCHULER_OBJECTS $<TARGET_OBJECTS:${target}>)
    else()
        add_library(${target} INTERFACE)
        target_link_libraries(${target} INTERFACE ${ROOM_DEPENDS})
        target_include_directories(${target} INTERFACE "${PROJECT_SOURCE_DIR}/src")
    endif()
    set_property(GLOBAL APPEND PROPERTY SCHULER_ROOMS ${name})
    set_property(GLOBAL APPEND PROPERTY SCHULER_LINKED ${ROOM_PRIVATE})
endfunction()

function(schuler_library)
    get_property(objects GLOBAL PROPERTY SCHULER_OBJECTS)
    get_property(linked GLOBAL PROPERTY SCHULER_LINKED)
    add_library(schuler STATIC ${objects})
    add_library(schuler::schuler ALIAS schuler)
    set_target_properties(schuler PROPERTIES LINKER_LANGUAGE CXX)
    target_link_libraries(schuler PUBLIC Eigen3::Eigen fmt::fmt PRIVATE ${linked})
    target_compile_features(schuler PUBLIC cxx_std_20)
    target_compile_definitions(schuler PUBLIC ${SCHULER_ABI_DEFINITIONS})
    target_include_directories(schuler PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
                                              $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
endfunction()
