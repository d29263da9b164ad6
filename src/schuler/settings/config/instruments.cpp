// Options of the additional survey instruments, for data sets and scenarios.
#include "schuler/settings/config/instruments.h"

#include "schuler/core/units.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/config/sections.h"
#include "schuler/settings/option_builders.h"
#include "schuler/settings/scenario/scenario.h"

namespace schuler::settings {
namespace {

using units::deg;
using Places = std::vector<Eigen::Vector3d>;

Places places_from(const Value& v) {
    const auto bad = [&v] {
        return input_error(fmt::format("{} is not a list of one to three lever arms", to_toml(v)), {},
                           "write lever_arms_m = [[0, 0, 0], [10, 0, 0]]: forward, right, down of each gauge");
    };
    if (v.list() == nullptr || v.list()->empty() || v.list()->size() > 3) throw bad();
    Places out;
    for (const Value& item : *v.list()) {
        if (item.list() == nullptr || item.list()->size() != 3) throw bad();
        Eigen::Vector3d place;
        for (std::size_t i = 0; i < 3; ++i) {
            const Value& x = (*item.list())[i];
            if (!x.is_number() || !(std::abs(x.number()) < 1000.0)) throw bad();
            place(static_cast<int>(i)) = x.number();
        }
        out.push_back(place);
    }
    return out;
}

template <class Target, class Access>
Option<Target> places(const std::string& key, Access access) {
    return special<Target>(
        key, "[[forward, right, down], ...]", "IMU to each gauge, m; several of them observe attitude",
        [=](Target& t, const Value& v) { access(t) = places_from(v); },
        [=](const Target& t) -> std::optional<Value> {
            ValueList list;
            for (const Eigen::Vector3d& p : access(t)) list.push_back({ValueList{{p.x()}, {p.y()}, {p.z()}}});
            return Value{std::move(list)};
        });
}

/// The errors drawn by the simulator and assumed by the filter: the same keys in both.
template <class Target, class Aids>
void add_errors(OptionTable<Target>& table, Aids instruments) {
    table
        .add(number<Target>("gauges.white_m", 1.0, 1e-4, 1e4, "depth gauges, barometers: white error of a height",
                            [=](auto& t) -> auto& { return instruments(t).gauges.white; }))
        .add(number<Target>("gauges.bias_m", 1.0, 0, 1e5, "constant error of each gauge, one sigma",
                            [=](auto& t) -> auto& { return instruments(t).gauges.bias; }))
        .add(places<Target>("gauges.lever_arms_m", [=](auto& t) -> auto& { return instruments(t).gauges.lever_arms_b; }))
        .add(number<Target>("log.white_m_s", 1.0, 1e-5, 100, "log of velocity in body axes: white error",
                            [=](auto& t) -> auto& { return instruments(t).log.white; }))
        .add(number<Target>("log.scale_factor_ppm", units::ppm, 0, 1e6, "scale-factor error of the velocity log, one sigma",
                            [=](auto& t) -> auto& { return instruments(t).log.scale; }))
        .add(number<Target>("log.misalignment_deg", deg, 0, 45,
                            "misalignment of the velocity log about the right and down axes, one sigma",
                            [=](auto& t) -> auto& { return instruments(t).log.misalignment; }))
        .add(vector3<Target>("log.lever_arm_m", 1.0, -1000, 1000, "IMU to log, forward, right, down",
                             [=](auto& t) -> auto& { return instruments(t).log.lever_arm_b; }))
        .add(number<Target>("compass.white_deg", deg, 1e-5, 90, "compass: white error of true heading",
                            [=](auto& t) -> auto& { return instruments(t).compass.white; }))
        .add(number<Target>("compass.bias_deg", deg, 0, 180, "constant error of the compass, one sigma",
                            [=](auto& t) -> auto& { return instruments(t).compass.bias; }));
}

}  // namespace

void add_instrument_options(OptionTable<Config>& table) {
    table
        .add(text<Config>("gauges.file", "heights of depth gauges or barometers: time_s, height_1_m, ...",
                          [](auto& c) -> auto& { return c.instruments.gauges.file; }))
        .add(text<Config>("log.file", "velocity in body axes: time_s, vel_x_m_s, vel_y_m_s, vel_z_m_s",
                          [](auto& c) -> auto& { return c.instruments.log.file; }))
        .add(text<Config>("compass.file", "true heading: time_s, heading_deg",
                          [](auto& c) -> auto& { return c.instruments.compass.file; }));
    add_errors<Config>(table, [](auto& c) -> auto& { return c.instruments; });
}

void add_instrument_scenario_options(OptionTable<ScenarioConfig>& table) {
    using S = ScenarioConfig;
    table
        .add(number<S>("gauges.rate_hz", 1.0, 0, 1000, "rate of depth gauges or barometers; 0 = none",
                       [](auto& s) -> auto& { return s.instruments.gauges.rate; }))
        .add(number<S>("log.rate_hz", 1.0, 0, 1000, "rate of a log of velocity in body axes; 0 = none",
                       [](auto& s) -> auto& { return s.instruments.log.rate; }))
        .add(number<S>("compass.rate_hz", 1.0, 0, 1000, "rate of a compass; 0 = none",
                       [](auto& s) -> auto& { return s.instruments.compass.rate; }));
    add_errors<S>(table, [](auto& s) -> auto& { return s.instruments; });
}

}  // namespace schuler::settings
