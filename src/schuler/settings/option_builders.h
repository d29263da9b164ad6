// Builders of bound options: each takes an accessor `[](auto& target) -> auto& { return target.field; }` for both directions.
#pragma once

#include "schuler/settings/option_table.h"

#include <Eigen/Core>

#include <cmath>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

namespace schuler::settings {

inline constexpr double unbounded = std::numeric_limits<double>::infinity();

namespace detail {

inline OptionSpec spec(std::string key, Shape shape, std::string help) {
    OptionSpec s;
    s.key = std::move(key);
    s.shape = shape;
    s.help = std::move(help);
    return s;
}

inline std::optional<Value> given(double si, double factor) {
    if (std::isnan(si)) return std::nullopt;
    return Value{in_unit(si, factor)};
}

}  // namespace detail

/// A floating number; factor takes the key's unit to SI; low and high in the key's unit. A field of NaN or an empty optional
/// means "not given".
template <class Target, class Access>
Option<Target> number(std::string key, double factor, double low, double high, std::string help, Access access) {
    OptionSpec s = detail::spec(std::move(key), Shape::Number, std::move(help));
    s.low = low;
    s.high = high;
    return {std::move(s), [=](Target& t, const Value& v) { access(t) = v.number() * factor; },
            [=](const Target& t) -> std::optional<Value> {
                if constexpr (std::is_same_v<std::decay_t<decltype(access(t))>, std::optional<double>>) {
                    if (!access(t)) return std::nullopt;
                    return detail::given(*access(t), factor);
                } else {
                    return detail::given(access(t), factor);
                }
            }};
}

/// A whole number, also into std::optional.
template <class Target, class Access>
Option<Target> integer(std::string key, double low, double high, std::string help, Access access) {
    OptionSpec s = detail::spec(std::move(key), Shape::Integer, std::move(help));
    s.low = low;
    s.high = high;
    return {std::move(s),
            [=](Target& t, const Value& v) {
                using Field = std::decay_t<decltype(access(t))>;
                if constexpr (std::is_integral_v<Field>) {
                    access(t) = static_cast<Field>(*v.integer());
                } else {
                    access(t) = static_cast<typename Field::value_type>(*v.integer());
                }
            },
            [=](const Target& t) -> std::optional<Value> {
                if constexpr (std::is_integral_v<std::decay_t<decltype(access(t))>>) {
                    return Value{static_cast<std::int64_t>(access(t))};
                } else {
                    if (!access(t)) return std::nullopt;
                    return Value{static_cast<std::int64_t>(*access(t))};
                }
            }};
}

/// true or false, also into std::optional<bool>.
template <class Target, class Access>
Option<Target> flag(std::string key, std::string help, Access access) {
    return {detail::spec(std::move(key), Shape::Flag, std::move(help)), [=](Target& t, const Value& v) { access(t) = *v.flag(); },
            [=](const Target& t) -> std::optional<Value> {
                if constexpr (std::is_same_v<std::decay_t<decltype(access(t))>, std::optional<bool>>) {
                    if (!access(t)) return std::nullopt;
                    return Value{*access(t)};
                } else {
                    return Value{static_cast<bool>(access(t))};
                }
            }};
}

/// Free text; empty means "not given".
template <class Target, class Access>
Option<Target> text(std::string key, std::string help, Access access) {
    return {detail::spec(std::move(key), Shape::Text, std::move(help)), [=](Target& t, const Value& v) { access(t) = *v.text(); },
            [=](const Target& t) -> std::optional<Value> {
                if (access(t).empty()) return std::nullopt;
                return Value{access(t)};
            }};
}

/// One of several names, each representing a value of an enumeration.
template <class Target, class Enum, class Access>
Option<Target> choice(std::string key, std::vector<std::pair<std::string, Enum>> names, std::string help, Access access) {
    OptionSpec s = detail::spec(std::move(key), Shape::Text, std::move(help));
    for (const auto& [name, value] : names) s.choices.push_back(name);
    return {std::move(s),
            [=](Target& t, const Value& v) {
                for (const auto& [name, value] : names) {
                    if (name == *v.text()) access(t) = value;
                }
            },
            [=](const Target& t) -> std::optional<Value> {
                for (const auto& [name, value] : names) {
                    if (value == access(t)) return Value{name};
                }
                return std::nullopt;
            }};
}

/// Three numbers; NaN means "not given".
template <class Target, class Access>
Option<Target> vector3(std::string key, double factor, double low, double high, std::string help, Access access) {
    OptionSpec s = detail::spec(std::move(key), Shape::Numbers, std::move(help));
    s.length = 3;
    s.low = low;
    s.high = high;
    return {std::move(s),
            [=](Target& t, const Value& v) {
                const ValueList& list = *v.list();
                access(t) = Eigen::Vector3d(list[0].number() * factor, list[1].number() * factor, list[2].number() * factor);
            },
            [=](const Target& t) -> std::optional<Value> {
                const Eigen::Vector3d& x = access(t);
                if (x.hasNaN()) return std::nullopt;
                return Value{ValueList{{in_unit(x.x(), factor)}, {in_unit(x.y(), factor)}, {in_unit(x.z(), factor)}}};
            }};
}

/// A table of texts, such as `columns`: { height_m = "height_msl_m" }.
template <class Target, class Access>
Option<Target> text_map(std::string key, std::string help, Access access) {
    OptionSpec s = detail::spec(std::move(key), Shape::Table, std::move(help));
    return {std::move(s),
            [=](Target& t, const Value& v) {
                access(t).clear();
                for (const auto& [name, item] : *v.table()) {
                    if (item.text() == nullptr)
                        throw input_error(fmt::format("{} is {}, expected text", name, kind_of(item)), {}, "put it in quotes");
                    access(t)[name] = *item.text();
                }
            },
            [=](const Target& t) -> std::optional<Value> {
                ValueTable table;
                for (const auto& [name, item] : access(t)) table.emplace_back(name, Value{item});
                if (table.empty()) return std::nullopt;
                return Value{std::move(table)};
            }};
}

/// A table of numbers, such as `scale`: { std_n_m = 0.001 }.
template <class Target, class Access>
Option<Target> number_map(std::string key, std::string help, Access access) {
    OptionSpec s = detail::spec(std::move(key), Shape::Table, std::move(help));
    return {std::move(s),
            [=](Target& t, const Value& v) {
                access(t).clear();
                for (const auto& [name, item] : *v.table()) {
                    if (!item.is_number() || !std::isfinite(item.number()) || item.number() == 0.0) {
                        throw input_error(fmt::format("{} = {} is not a usable factor", name, to_toml(item)), {},
                                          "give a finite number other than zero");
                    }
                    access(t)[name] = item.number();
                }
            },
            [=](const Target& t) -> std::optional<Value> {
                ValueTable table;
                for (const auto& [name, item] : access(t)) table.emplace_back(name, Value{item});
                if (table.empty()) return std::nullopt;
                return Value{std::move(table)};
            }};
}

/// A value with a special form; `set` may throw input_error without a place, which is added by the table.
template <class Target, class Set, class Get>
Option<Target> special(std::string key, std::string form, std::string help, Set set, Get get) {
    OptionSpec s = detail::spec(std::move(key), Shape::Any, std::move(help));
    s.form = std::move(form);
    return {std::move(s), std::move(set), std::move(get)};
}

}  // namespace schuler::settings
