// Coupling of receiver and inertial unit, and monitoring of the receiver.
#include "schuler/settings/config/config.h"
#include "schuler/settings/config/sections.h"
#include "schuler/settings/option_builders.h"

namespace schuler::settings {

void add_coupling_options(OptionTable<Config>& table) {
    using fusion::IntegritySettings;
    using fusion::LooseKind;
    using fusion::SeparateSettings;
    const auto separate = [](double SeparateSettings::*field) {
        return [=](auto& c) -> auto& { return c.filter.separate.*field; };
    };
    const auto integrity = [](auto IntegritySettings::*field) {
        return [=](auto& c) -> auto& { return c.filter.integrity.*field; };
    };
    table
        .add(choice<Config, LooseKind>(
            "filter.loose", {{"standard", LooseKind::Standard}, {"aggressive", LooseKind::Aggressive}},
            "loose coupling: each fix at its time (standard), or propagated by the inertial accelerations and applied in "
            "parts until the next one (aggressive)",
            [](auto& c) -> auto& { return c.filter.loose_kind; }))
        .add(integer<Config>("filter.aggressive_parts", 2, 1000, "number of parts in which a fix is applied",
                             [](auto& c) -> auto& { return c.filter.aggressive_parts; }))
        .add(number<Config>("filter.separate.restart_s", 1.0, 0, 1e6,
                            "interval at which position and velocity are reset to the fix; 0 = continuous correction",
                            separate(&SeparateSettings::restart_period)))
        .add(number<Config>("filter.separate.position_time_s", 1.0, 1e-3, 1e6,
                            "time constant of the continuous correction of the position",
                            separate(&SeparateSettings::position_time)))
        .add(number<Config>("filter.separate.velocity_time_s", 1.0, 1e-3, 1e6,
                            "time constant of the continuous correction of the velocity",
                            separate(&SeparateSettings::velocity_time)))
        .add(number<Config>("filter.separate.baro_time_s", 1.0, 5, 1e4,
                            "time constant of the barometer's loop in the vertical channel",
                            separate(&SeparateSettings::baro_time)))
        .add(flag<Config>("filter.integrity.use", "monitor the receiver's integrity: exclude it while its fixes are inconsistent",
                          integrity(&IntegritySettings::use)))
        .add(number<Config>("filter.integrity.accel_limit_m_s2", 1.0, 0, 1e4,
                            "acceleration the vehicle is capable of, for the tolerance check; 0 = none",
                            integrity(&IntegritySettings::accel_limit)))
        .add(number<Config>("filter.integrity.trace_ratio", 1.0, 0, 1e6, "delta of the innovation test, 10 or more; 0 = none",
                            integrity(&IntegritySettings::trace_ratio)))
        .add(number<Config>("filter.integrity.window_s", 1.0, 0, 1e5,
                            "age at which the reference solution without GNSS, which reveals slow ramps, is restarted; 0 = none",
                            integrity(&IntegritySettings::window)))
        .add(number<Config>("filter.integrity.false_alarm", 1.0, 1e-15, 0.1,
                            "probability that a healthy fix exceeds the limit of the slow-ramp test",
                            integrity(&IntegritySettings::false_alarm)))
        .add(integer<Config>("filter.integrity.count", 1, 1000, "consecutive failed tests after which the receiver is excluded",
                             integrity(&IntegritySettings::slow_count)))
        .add(number<Config>("filter.integrity.readmission_s", 1.0, 0, 1e5,
                            "time of agreement after which an excluded receiver is used again",
                            integrity(&IntegritySettings::readmission_time)));
}

}  // namespace schuler::settings
