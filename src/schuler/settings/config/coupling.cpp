// How receiver and inertial unit are coupled, and how the receiver is controlled.
#include "schuler/settings/config/config.h"
#include "schuler/settings/config/sections.h"
#include "schuler/settings/option_builders.h"

namespace schuler::settings {

void add_coupling_options(OptionTable<Config>& table) {
    using fusion::IntegritySettings;
    using fusion::LooseKind;
    using fusion::SeparateSettings;
    const auto separate = [](double SeparateSettings::*field) { return [=](auto& c) -> auto& { return c.filter.separate.*field; }; };
    const auto integrity = [](auto IntegritySettings::*field) { return [=](auto& c) -> auto& { return c.filter.integrity.*field; }; };
    table
        .add(choice<Config, LooseKind>("filter.loose", {{"standard", LooseKind::Standard}, {"aggressive", LooseKind::Aggressive}},
                                       "loose coupling: each fix at its time (standard), or carried on by the inertial accelerations and used in "
                                       "parts until the next one (aggressive)",
                                       [](auto& c) -> auto& { return c.filter.loose_kind; }))
        .add(integer<Config>("filter.aggressive_parts", 2, 1000, "... the number of those parts",
                             [](auto& c) -> auto& { return c.filter.aggressive_parts; }))
        .add(number<Config>("filter.separate.restart_s", 1.0, 0, 1e6,
                            "separate: position and velocity are set to the fix so often; 0 = continuous correction",
                            separate(&SeparateSettings::restart_period)))
        .add(number<Config>("filter.separate.position_time_s", 1.0, 1e-3, 1e6, "separate: time constant of the continuous correction of the position",
                            separate(&SeparateSettings::position_time)))
        .add(number<Config>("filter.separate.velocity_time_s", 1.0, 1e-3, 1e6, "... of the velocity", separate(&SeparateSettings::velocity_time)))
        .add(number<Config>("filter.separate.baro_time_s", 1.0, 5, 1e4, "separate: time constant of the barometer's loop in the vertical channel",
                            separate(&SeparateSettings::baro_time)))
        .add(flag<Config>("filter.integrity.use", "control the receiver's integrity: exclude it while its fixes cannot be right",
                          integrity(&IntegritySettings::use)))
        .add(number<Config>("filter.integrity.accel_limit_m_s2", 1.0, 0, 1e4, "acceleration the vehicle is capable of, for the tolerance check; 0 = none",
                            integrity(&IntegritySettings::accel_limit)))
        .add(number<Config>("filter.integrity.trace_ratio", 1.0, 0, 1e6, "delta of the innovation test, 10 or more; 0 = none",
                            integrity(&IntegritySettings::trace_ratio)))
        .add(number<Config>("filter.integrity.window_s", 1.0, 0, 1e5, "age at which the solution without GNSS that shows slow ramps begins anew; 0 = none",
                            integrity(&IntegritySettings::window)))
        .add(number<Config>("filter.integrity.false_alarm", 1.0, 1e-15, 0.1, "probability that a healthy fix exceeds the limit of the slow-ramp test",
                            integrity(&IntegritySettings::false_alarm)))
        .add(integer<Config>("filter.integrity.count", 1, 1000, "tests in a row that must fail until the receiver is excluded",
                             integrity(&IntegritySettings::slow_count)))
        .add(number<Config>("filter.integrity.readmission_s", 1.0, 0, 1e5, "it is used again after agreeing for so long",
                            integrity(&IntegritySettings::readmission_time)));
}

}  // namespace schuler::settings
