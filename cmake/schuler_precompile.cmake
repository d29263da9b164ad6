# With SCHULER_PCH: what nearly every file of a target includes, parsed once. ./run builds so, and ./test where it uses sanitizers; off
# by default, so that a forgotten include is found. Larger headers cost more to load than to parse: what few files include stays out.
set(SCHULER_COMMON_HEADERS <Eigen/Core> <Eigen/Geometry> <Eigen/LU> <Eigen/Cholesky> <fmt/format.h> <algorithm> <array> <cmath>
    <complex> <cstdint> <filesystem> <functional> <limits> <map> <memory> <numbers> <optional> <set> <span> <sstream> <string>
    <string_view> <utility> <variant> <vector>)
set(core schuler/core)
set(SCHULER_CORE_HEADERS ${SCHULER_COMMON_HEADERS} "<${core}/instrument_logs.h>" "<${core}/error.h>" "<${core}/fact.h>" "<${core}/log.h>"
    "<${core}/nav_state.h>" "<${core}/samples.h>" "<${core}/units.h>")

set(SCHULER_PRECOMPILED_core ${SCHULER_CORE_HEADERS})
set(SCHULER_PRECOMPILED_filter ${SCHULER_CORE_HEADERS} <schuler/math/rotation.h> <schuler/earth/earth.h> <schuler/gnss/ranges.h>
    <schuler/gnss/satellite_source.h> <schuler/filter/measurement/measurement.h> <schuler/filter/settings.h>
    <schuler/filter/states/inertial_filter.h> <schuler/filter/update/pass.h> <schuler/filter/result.h>)
set(SCHULER_PRECOMPILED_app ${SCHULER_CORE_HEADERS} <schuler/settings/config/config.h> <schuler/settings/option_table.h>
    <schuler/sim/simulate.h> <schuler/fusion/result.h>)
set(SCHULER_PRECOMPILED_serve ${SCHULER_CORE_HEADERS} <nlohmann/json.hpp>)
set(SCHULER_PRECOMPILED_cli ${SCHULER_COMMON_HEADERS} <CLI/CLI.hpp>)
set(SCHULER_PRECOMPILED_programs ${SCHULER_COMMON_HEADERS})
set(SCHULER_PRECOMPILED_tests ${SCHULER_COMMON_HEADERS} <gtest/gtest.h>)
set(SCHULER_PRECOMPILED_filter_tests ${SCHULER_PRECOMPILED_filter} <schuler/sim/simulate.h> <schuler/fusion/result.h>
    <gtest/gtest.h>)

# The first target of a name compiles its headers, the others use them. It must have no definition of its own that the others lack:
# GCC would parse all again there.
function(schuler_precompile target name)
    if(NOT SCHULER_PCH)
        return()
    endif()
    get_property(first GLOBAL PROPERTY SCHULER_PCH_${name})
    if(first)
        target_precompile_headers(${target} REUSE_FROM ${first})
    else()
        target_precompile_headers(${target} PRIVATE ${SCHULER_PRECOMPILED_${name}})
        set_property(GLOBAL PROPERTY SCHULER_PCH_${name} ${target})
    endif()
    # GCC collects garbage as soon as the heap has doubled, and would walk through all of the precompiled headers.
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
        target_compile_options(${target} PRIVATE --param=ggc-min-expand=1000 --param=ggc-min-heapsize=1000000)
    endif()
endfunction()
