// Errors of ranges assumed by the filter, and selection of the ranges used.
#include "schuler/settings/config/config.h"
#include "schuler/settings/config/sections.h"
#include "schuler/settings/range_error_options.h"

namespace schuler::settings {

void add_ranging_options(OptionTable<Config>& table) {
    add_range_error_options(table, [](auto& c) -> auto& { return c.filter.ranging.errors; });
    using fusion::ProtectionSettings;
    const auto protection = [](auto ProtectionSettings::*field) {
        return [=](auto& c) -> auto& { return c.filter.ranging.protection.*field; };
    };
    table
        .add(flag<Config>("filter.protection.use",
                          "monitor for slowly growing pseudorange faults, and write protection.csv; "
                          "default: on for data sets",
                          protection(&ProtectionSettings::use)))
        .add(number<Config>(
            "filter.protection.missed_detection", 1.0, 1e-9, 0.1,
            "maximum probability that a fault of one satellite moves the position beyond its protection level without an alarm",
            protection(&ProtectionSettings::missed_detection)))
        .add(number<Config>("filter.protection.false_alarm", 1.0, 1e-15, 0.1,
                            "probability that a healthy source exceeds the limit of one test",
                            protection(&ProtectionSettings::false_alarm)))
        .add(number<Config>("filter.protection.fault_free", 1.0, 1e-15, 0.1,
                            "maximum probability that the position is beyond its protection level without a fault",
                            protection(&ProtectionSettings::fault_free)))
        .add(number<Config>("ranges.receiver_acceleration_m_s_sqrt_s", 1.0, 1e-4, 1e3,
                            "intermediate coupling: white acceleration assumed by the receiver-only filter",
                            [](auto& c) -> auto& { return c.filter.ranging.receiver_acceleration; }))
        .add(flag<Config>("ranges.use_rates", "use range rates too", [](auto& c) -> auto& { return c.filter.ranging.use_rates; }))
        .add(flag<Config>(
            "ranges.slow_by_model",
            "sigma of a satellite's slowly varying error from the residual errors of the atmosphere models and the ephemeris, instead of ranges.correlated_m; default for raw measurements where that is not given",
            [](auto& c) -> auto& { return c.filter.ranging.slow_by_model; }))
        .add(flag<Config>("ranges.use_stations", "use the ranges of ground stations too",
                          [](auto& c) -> auto& { return c.filter.ranging.use_stations; }))
        .add(number<Config>("baro.bias_time_s", 1.0, 0, 1e7,
                            "correlation time of the barometer's bias, whose sigma is then stationary; 0 = random walk",
                            [](auto& c) -> auto& { return c.filter.baro.bias_time; }));
}

}  // namespace schuler::settings
