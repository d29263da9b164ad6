// Options of the errors of ranges and of the receiver's clock, the same for data sets (as assumed by the filter) and scenarios.
#pragma once

#include "schuler/sensor/range_errors.h"
#include "schuler/settings/option_builders.h"

#include <string>

namespace schuler::settings {

/// `errors`: access to the model in the target.
template <class Target, class Errors>
void add_range_error_options(OptionTable<Target>& table, Errors errors) {
    using M = sensor::RangingErrorModel;
    using R = sensor::RangeErrorModel;
    const struct {
        const char* name;
        const char* help;
        R M::*kind;
        double R::*field;
        double low, high;
    } rows[] = {
        {"ranges.white_m", "white error of a satellite's pseudorange", &M::satellite, &R::white, 1e-6, 1e4},
        {"ranges.correlated_m", "slowly varying error of a satellite's pseudorange, a state of each satellite; 0 = none",
         &M::satellite, &R::correlated, 0, 1e4},
        {"ranges.correlated_time_s", "correlation time of the slowly varying error of a satellite's pseudorange", &M::satellite,
         &R::correlation_time, 1e-3, 1e7},
        {"ranges.rate_m_s", "white error of a satellite's range rate", &M::satellite, &R::rate, 1e-6, 1e3},
        {"ranges.correlated_rate_m_s", "slowly varying error of a satellite's range rate, a state of each satellite; 0 = none",
         &M::satellite, &R::correlated_rate, 0, 1e3},
        {"ranges.correlated_rate_time_s", "correlation time of the slowly varying error of a satellite's range rate",
         &M::satellite, &R::correlated_rate_time, 1e-3, 1e7},
        {"ranges.station_white_m", "white error of a ground station's pseudorange", &M::station, &R::white, 1e-6, 1e4},
        {"ranges.station_correlated_m", "slowly varying error of a ground station's pseudorange; 0 = none", &M::station,
         &R::correlated, 0, 1e4},
        {"ranges.station_correlated_time_s", "correlation time of the slowly varying error of a ground station's pseudorange",
         &M::station, &R::correlation_time, 1e-3, 1e7}};
    for (const auto& r : rows)
        table.add(number<Target>(r.name, 1.0, r.low, r.high, r.help, [errors, kind = r.kind, field = r.field](auto& t) -> auto& {
            return (errors(t).*kind).*field;
        }));
    const struct {
        const char* name;
        const char* help;
        double M::*field;
        double low;
    } others[] = {
        {"ranges.network_m", "offset of the stations' common time from the satellites' time, one sigma", &M::network, 0},
        {"ranges.network_time_s", "correlation time of the offset of the stations' time", &M::network_time, 1e-3},
        {"ranges.rate_span_s",
         "interval over which a range rate is averaged, whose clock noise all ranges share; 0 = included in the sigmas",
         &M::rate_span, 0},
        {"ranges.intersystem_m", "constant offset of each further satellite system", &M::intersystem, 0}};
    for (const auto& r : others)
        table.add(number<Target>(r.name, 1.0, r.low, 1e7, r.help,
                                 [errors, field = r.field](auto& t) -> auto& { return errors(t).*field; }));
    const auto clock = [errors](double sensor::Oscillator::*field) {
        return [=](auto& t) -> auto& { return errors(t).clock.*field; };
    };
    OptionSpec spec =
        detail::spec("ranges.clock", Shape::Text, "the receiver's oscillator; the two coefficients below refine it");
    spec.choices = {"ocxo", "tcxo"};
    table
        .add(Option<Target>{std::move(spec),
                            [errors](Target& t, const Value& v) {
                                const sensor::Oscillator& known = *v.text() == "tcxo" ? sensor::tcxo : sensor::ocxo;
                                errors(t).clock.h0 = known.h0;
                                errors(t).clock.h_minus2 = known.h_minus2;
                            },
                            [](const Target&) { return std::optional<Value>(); }})
        .add(number<Target>("ranges.clock_h0_s", 1.0, 0, 1e-10, "white frequency noise of the clock",
                            clock(&sensor::Oscillator::h0)))
        .add(number<Target>("ranges.clock_h_minus2_hz", 1.0, 0, 1e-10, "random walk of the frequency of the clock",
                            clock(&sensor::Oscillator::h_minus2)))
        .add(number<Target>("ranges.clock_std_m", 1.0, 0, 1e9, "clock error at the start, one sigma",
                            clock(&sensor::Oscillator::bias)))
        .add(number<Target>("ranges.drift_std_m_s", 1.0, 0, 1e6, "clock drift at the start, one sigma",
                            clock(&sensor::Oscillator::drift)));
}

}  // namespace schuler::settings
