// [[fault]]: faults of a sensor in a scenario.
#include "schuler/core/units.h"
#include "schuler/settings/option_builders.h"
#include "schuler/settings/scenario/scenario.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace schuler::settings {
namespace {

using sim::Channel;
using sim::Fault;
using sim::FaultKind;

struct KnownFault {
    const char* sensor;
    const char* kind;
    Channel channel;
    FaultKind fault;
    double si;  ///< of the size's unit
};
constexpr KnownFault known[] = {{"gnss", "step", Channel::Gnss, FaultKind::Step, 1.0},
                                {"gnss", "ramp", Channel::Gnss, FaultKind::Ramp, 1.0},
                                {"gnss", "drift", Channel::Gnss, FaultKind::Drift, 1.0},
                                {"gnss", "velocity", Channel::Gnss, FaultKind::Velocity, 1.0},
                                {"gnss", "freeze", Channel::Gnss, FaultKind::Freeze, 1.0},
                                {"gnss", "stuck", Channel::Gnss, FaultKind::Freeze, 1.0},
                                {"gnss", "noise", Channel::Gnss, FaultKind::Noise, 1.0},
                                {"gnss", "dropout", Channel::Gnss, FaultKind::Dropout, 1.0},
                                {"baro", "step", Channel::Baro, FaultKind::Step, 1.0},
                                {"baro", "ramp", Channel::Baro, FaultKind::Ramp, 1.0},
                                {"baro", "freeze", Channel::Baro, FaultKind::Freeze, 1.0},
                                {"baro", "stuck", Channel::Baro, FaultKind::Freeze, 1.0},
                                {"baro", "noise", Channel::Baro, FaultKind::Noise, 1.0},
                                {"baro", "dropout", Channel::Baro, FaultKind::Dropout, 1.0},
                                {"imu", "gyro", Channel::Imu, FaultKind::Gyro, units::deg_per_hour},
                                {"imu", "accel", Channel::Imu, FaultKind::Accel, units::mg},
                                {"imu", "saturate", Channel::Imu, FaultKind::Saturate, units::deg_per_s},
                                {"imu", "freeze", Channel::Imu, FaultKind::Freeze, 1.0},
                                {"imu", "stuck", Channel::Imu, FaultKind::Freeze, 1.0},
                                {"imu", "dropout", Channel::Imu, FaultKind::Dropout, 1.0}};

constexpr const char* form = "write [[fault]] start_s = 300, sensor = \"gnss\", kind = \"ramp\", size = 0.5";

Error bad(const std::string& what) { return input_error(what, {}, form); }

double number_of(const std::string& name, const Value& v) {
    if (!v.is_number() || !(std::abs(v.number()) < 1e12)) throw bad(fmt::format("{} = {} is not a number", name, to_toml(v)));
    return v.number();
}

Fault fault_of(const ValueTable& table) {
    Fault out;
    std::string sensor = "gnss", kind;
    bool started = false;
    for (const auto& [name, v] : table) {
        if (name == "sensor" || name == "kind") {
            if (v.text() == nullptr) throw bad(fmt::format("{} = {} is not a name", name, to_toml(v)));
            (name == "kind" ? kind : sensor) = *v.text();
        } else if (name == "start_s") {
            out.start = number_of(name, v);
            started = true;
        } else if (name == "duration_s") {
            out.duration = number_of(name, v);
        } else if (name == "size") {
            out.size = number_of(name, v);
        } else if (name == "direction") {
            const ValueList* list = v.list();
            if (list == nullptr || list->size() != 3 || !std::ranges::all_of(*list, [](const Value& x) { return x.is_number(); }))
                throw bad("direction is not three numbers");
            out.direction = {(*list)[0].number(), (*list)[1].number(), (*list)[2].number()};
        } else {
            throw bad(fmt::format("a fault has no \"{}\"", name));
        }
    }
    if (!started || kind.empty()) throw bad("lacks start_s or kind");
    if (out.duration < 0.0) throw bad("duration_s is negative");
    if (!(out.direction.norm() > 0.0)) throw bad("direction is a zero vector");
    std::vector<std::string> kinds;
    for (const KnownFault& k : known) {
        if (sensor != k.sensor) continue;
        kinds.emplace_back(k.kind);
        if (kind != k.kind) continue;
        out.channel = k.channel;
        out.kind = k.fault;
        out.size *= k.si;
        return out;
    }
    if (kinds.empty()) throw bad(fmt::format("sensor \"{}\" is not gnss, baro or imu", sensor));
    throw bad(fmt::format("kind \"{}\" of {} is not one of {}", kind, sensor, fmt::join(kinds, ", ")));
}

}  // namespace

Option<ScenarioConfig> fault_option() {
    OptionSpec spec =
        detail::spec("fault", Shape::Tables,
                     "faults: [[fault]] with start_s, kind (gnss: step, ramp, drift, velocity, freeze, noise, dropout; imu: "
                     "gyro, accel, saturate ...), sensor, size (m, m/s; deg/h, mg, deg/s), duration_s, direction");
    return {std::move(spec),
            [](ScenarioConfig& s, const Value& v) {
                s.sim.faults.clear();
                for (const Value& item : *v.list()) s.sim.faults.push_back(fault_of(*item.table()));
            },
            [](const ScenarioConfig&) { return std::optional<Value>(); }};
}

}  // namespace schuler::settings
