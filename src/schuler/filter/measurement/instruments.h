// The instruments beside IMU and receiver whose measurements are valid at their stamps: the only list of them. Timelines, streams,
// reversed time, measurement updates and the health of sources follow from it.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/filter/measurement/kinds.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

namespace schuler::filter {

/// Everything that feeds a navigator.
enum class Source : std::uint8_t { Imu, Gnss, Baro, Mag, Odometer, Heading, Gauges, Log, Ranges };
inline constexpr std::size_t source_count = 9;

/// Highest sample rate of each instrument, for which memory is allocated. 0: there is no such instrument.
struct FeedRates {
    double gnss = 20.0, baro = 0.0, mag = 0.0, odometer = 0.0, heading = 0.0, gauges = 0.0, log = 0.0, ranges = 0.0;  ///< Hz
    int gauge_count = 0;              ///< number of values in GaugeSample::height, at most 3
    std::size_t range_sources = 128;  ///< largest number of satellites and stations in a run
};

template <class S>
struct Instrument {
    using Sample = S;

    MeasurementKind kind;
    Source source;
    std::uint8_t components;  ///< bits, as Event::components
    std::vector<S> Recording::*log;
    double FeedRates::*rate;
    void (*reverse)(S&);  ///< signs of a sample's values if time runs backward
};

namespace detail {

inline constexpr auto keep = [](auto&) {};

}  // namespace detail

/// In the order in which simultaneous measurements are used.
inline constexpr std::tuple instruments{
    Instrument<BaroSample>{MeasurementKind::Baro, Source::Baro, 4, &Recording::baro, &FeedRates::baro, detail::keep},
    Instrument<MagSample>{MeasurementKind::Mag, Source::Mag, 1, &Recording::mag, &FeedRates::mag, detail::keep},
    Instrument<OdometerSample>{MeasurementKind::Odometer, Source::Odometer, 1, &Recording::odometer, &FeedRates::odometer,
                               [](OdometerSample& s) { s.speed = -s.speed; }},
    Instrument<HeadingSample>{MeasurementKind::Heading, Source::Heading, 1, &Recording::heading, &FeedRates::heading,
                              detail::keep},
    Instrument<GaugeSample>{MeasurementKind::Gauges, Source::Gauges, 7, &Recording::gauges, &FeedRates::gauges, detail::keep},
    Instrument<BodyVelocitySample>{MeasurementKind::BodyVelocity, Source::Log, 7, &Recording::body_velocity, &FeedRates::log,
                                   [](BodyVelocitySample& s) { s.velocity_b = -s.velocity_b; }}};
static_assert(std::tuple_size_v<decltype(instruments)> == std::tuple_size_v<decltype(instrument_logs)>);

/// `visit(const Instrument<Sample>&)` for each of them, in order.
template <class Visit>
constexpr void for_each_instrument(Visit&& visit) {
    std::apply([&](const auto&... instrument) { (visit(instrument), ...); }, instruments);
}

/// Their kinds, in order.
inline constexpr auto instrument_kinds =
    std::apply([](const auto&... instrument) { return std::array{instrument.kind...}; }, instruments);

}  // namespace schuler::filter
