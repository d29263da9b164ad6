// Options of a receiver's slow errors, the same for data sets (as assumed by the filter) and scenarios.
#pragma once

#include "schuler/sensor/gnss_errors.h"
#include "schuler/settings/option_builders.h"

namespace schuler::settings {

/// One sigma for all axes, or north, east, down. 0: none.
template <class Target, class Access>
Option<Target> per_axis(std::string key, double high, std::string help, Access access) {
    const auto form = fmt::format("a number from 0 to {} or three of them", high);
    return special<Target>(
        std::move(key), form, std::move(help),
        [=](Target& t, const Value& v) {
            const ValueList list = v.list() != nullptr ? *v.list() : ValueList(3, v);
            const bool usable = list.size() == 3 && std::ranges::all_of(list, [high](const Value& x) {
                                    return x.is_number() && x.number() >= 0.0 && x.number() <= high;
                                });
            if (!usable) throw input_error(fmt::format("{} is out of range", to_toml(v)), {}, fmt::format("give {}", form));
            access(t) = Eigen::Vector3d(list[0].number(), list[1].number(), list[2].number());
        },
        [=](const Target& t) -> std::optional<Value> {
            const Eigen::Vector3d& x = access(t);
            return Value{ValueList{{x.x()}, {x.y()}, {x.z()}}};
        });
}

/// `errors`: access to the model in the target; `changes`: to the times of constellation changes as a list of seconds.
template <class Target, class Errors>
void add_gnss_error_options(OptionTable<Target>& table, Errors errors) {
    using M = sensor::GnssErrorModel;
    const struct {
        const char* name;
        double high;
        const char* help;
        Eigen::Vector3d M::*field;
    } sigmas[] = {
        {"correlated_m", 1e4, "slowly varying position error, one sigma; 0 = not modelled", &M::correlated_position},
        {"correlated_velocity_m_s", 1e3, "slowly varying velocity error, one sigma; 0 = not modelled", &M::correlated_velocity},
        {"change_white_m", 1e4, "extra white position error where the set of satellites changes", &M::change_white_position},
        {"change_correlated_m", 1e4, "jump of the slowly varying position error where the set of satellites changes",
         &M::change_correlated_position},
        {"change_white_velocity_m_s", 1e3, "extra white velocity error where the set of satellites changes",
         &M::change_white_velocity},
        {"change_correlated_velocity_m_s", 1e3, "jump of the slowly varying velocity error where the set of satellites changes",
         &M::change_correlated_velocity},
    };
    for (const auto& r : sigmas)
        table.add(per_axis<Target>(std::string("gnss.") + r.name, r.high, r.help,
                                   [errors, field = r.field](auto& t) -> auto& { return errors(t).*field; }));
    const struct {
        const char* name;
        double low, high;
        const char* help;
        double M::*field;
    } numbers[] = {
        {"correlated_time_s", 1e-2, 1e15, "correlation time of the slowly varying position error", &M::correlated_time},
        {"correlated_distance_m", 0, 1e9,
         "correlation distance over the ground of the slowly varying position error; 0 = independent of distance",
         &M::correlated_distance},
        {"correlated_velocity_time_s", 1e-2, 1e15, "correlation time of the slowly varying velocity error",
         &M::correlated_velocity_time},
    };
    for (const auto& r : numbers)
        table.add(number<Target>(std::string("gnss.") + r.name, 1.0, r.low, r.high, r.help,
                                 [errors, field = r.field](auto& t) -> auto& { return errors(t).*field; }));
}

/// "gnss.constellation_change_s": times at which the set of satellites changes; `times` is the access to a list of seconds.
template <class Target, class Get, class Set>
Option<Target> constellation_change_option(std::string help, Get get, Set set) {
    OptionSpec s = detail::spec("gnss.constellation_change_s", Shape::Numbers, std::move(help));
    return {std::move(s),
            [=](Target& t, const Value& v) {
                std::vector<double> times;
                for (const Value& x : *v.list()) times.push_back(x.number());
                std::ranges::sort(times);
                set(t, times);
            },
            [=](const Target& t) -> std::optional<Value> {
                ValueList list;
                for (const double x : get(t)) list.push_back({x});
                if (list.empty()) return std::nullopt;
                return Value{std::move(list)};
            }};
}

}  // namespace schuler::settings
