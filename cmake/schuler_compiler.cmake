# Language, warnings, processor and instrumentation, the same for every target of the project.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

# Decided once: a ccache that is installed later (./test does, ./run does not) would change every command, and everything be compiled again.
if(NOT DEFINED CACHE{SCHULER_CCACHE})
    find_program(SCHULER_CCACHE ccache)
endif()
if(SCHULER_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER "${SCHULER_CCACHE}")
endif()

# With several files in one, a name of one file hides a name of another, and GCC takes a .cpp for a header: not worth a warning.
set(SCHULER_SHADOW -Wshadow)
if(SCHULER_UNITY AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    set(SCHULER_SHADOW -Wshadow=local -Wno-subobject-linkage)
endif()

add_library(schuler_flags INTERFACE)
target_compile_options(schuler_flags INTERFACE
    -Wall -Wextra $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict> -Wpedantic $<$<BOOL:${SCHULER_WERROR}>:-Werror>
    ${SCHULER_SHADOW} -Wnon-virtual-dtor -Wcast-qual -Woverloaded-virtual -Wimplicit-fallthrough)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # False alarms of this compiler at -O3: on "text" + std::string (GCC bug 105651), on moved std::variant and Eigen expressions.
    target_compile_options(schuler_flags INTERFACE -Wno-restrict -Wno-maybe-uninitialized -Wno-array-bounds
        -Wno-stringop-overflow)
endif()

# Eigen takes the alignment of its fixed-size types from -march. Fixed here, the layout of every public struct is the same for the
# library and for users who compile for another processor.
set(SCHULER_ABI_DEFINITIONS EIGEN_MAX_ALIGN_BYTES=32 EIGEN_MAX_STATIC_ALIGN_BYTES=32)

set(SCHULER_MARCH "")
if(SCHULER_ARCH STREQUAL "auto")
    if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND EXISTS /proc/cpuinfo)
        file(STRINGS /proc/cpuinfo cpu_flags REGEX "^flags" LIMIT_COUNT 1)
        if(cpu_flags MATCHES " avx2( |$)" AND cpu_flags MATCHES " fma( |$)" AND cpu_flags MATCHES " bmi2( |$)")
            set(SCHULER_MARCH "x86-64-v3")
        endif()
    endif()
elseif(NOT SCHULER_ARCH STREQUAL "")
    set(SCHULER_MARCH "${SCHULER_ARCH}")
endif()
if(SCHULER_MARCH)
    target_compile_options(schuler_flags INTERFACE -march=${SCHULER_MARCH})
endif()

target_compile_options(schuler_flags INTERFACE $<$<CONFIG:Release>:-fno-math-errno>)

# Names of folders of the machine that builds are no part of a program: the same sources give the same bytes elsewhere
# (scripts/reproducible). The report of coverage needs the real names.
if(NOT SCHULER_COVERAGE)
    target_compile_options(schuler_flags INTERFACE "-ffile-prefix-map=${PROJECT_SOURCE_DIR}=." "-ffile-prefix-map=${PROJECT_BINARY_DIR}=./build")
endif()

if(SCHULER_SANITIZE)
    target_compile_options(schuler_flags INTERFACE -fsanitize=${SCHULER_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_link_options(schuler_flags INTERFACE -fsanitize=${SCHULER_SANITIZE})
    if(SCHULER_SANITIZE_NOT)
        target_compile_options(schuler_flags INTERFACE -fno-sanitize=${SCHULER_SANITIZE_NOT})
    endif()
endif()
if(SCHULER_COVERAGE)
    # Counters are set in before anything is inlined or made free of branches, so that they are those of the source; optimized after
    # that, because matrices without it are thirty times slower.
    target_compile_options(schuler_flags INTERFACE --coverage -O1 -g1 -fno-early-inlining -fno-ssa-phiopt)
    target_link_options(schuler_flags INTERFACE --coverage)
endif()
