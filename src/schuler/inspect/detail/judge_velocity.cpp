// Velocity columns of a table: unit, order and signs from the displacement of the positions.
#include "schuler/inspect/detail/motion/velocity_columns.h"
#include "schuler/inspect/detail/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::inspect::detail {
namespace {

constexpr std::array<const char*, 3> velocity_names{"vel_n_m_s", "vel_e_m_s", "vel_d_m_s"};

struct SpeedUnit {
    const char* name;
    double factor;  // to m/s
};
constexpr std::array<SpeedUnit, 8> speed_units{{{"m/s", 1.0},
                                                {"km/h", 1.0 / 3.6},
                                                {"kn", 1852.0 / 3600.0},
                                                {"mph", 0.44704},
                                                {"ft/s", 0.3048},
                                                {"cm/s", 1e-2},
                                                {"mm/s", 1e-3},
                                                {"ft/min", 0.3048 / 60.0}}};
struct LengthUnit {
    const char* name;
    double factor;  // to m
};
constexpr std::array<LengthUnit, 3> length_units{{{"mm", 1e-3}, {"cm", 1e-2}, {"ft", 0.3048}}};

constexpr int fewest_intervals = 10;

/// Half the distance between the two nearest units, ft/s and km/h.
constexpr double near_unit = 0.045;

template <class Units>
const typename Units::value_type* unit_of(const Units& units, double factor, double sigma) {
    const auto* best = std::ranges::min_element(units, {}, [&](const auto& u) { return std::abs(std::log(factor / u.factor)); });
    const double off = std::abs(factor / best->factor - 1.0);
    return off < near_unit && 3.0 * sigma < near_unit * factor ? best : nullptr;
}

/// Factor from the number in the file to the values as they are now.
double factor_now(const Study& study, const char* name) {
    const auto change = std::ranges::find(study.gnss_units, name, &UnitChange::key);
    if (change != study.gnss_units.end()) return change->factor;
    const io::ColumnMatch* match = study.gnss_file->plan.find(name);
    return match != nullptr ? match->factor : 1.0;
}

bool given_column(const LoadedFile& file) {
    return std::ranges::any_of(velocity_names, [&](const char* name) { return file.as.overrides.columns.contains(name); });
}
bool given_scale(const LoadedFile& file) {
    return std::ranges::any_of(velocity_names, [&](const char* name) { return file.as.overrides.scale.contains(name); });
}

/// "north from vel_e turned round".
std::string words_of(const VelocityOrder& order, const LoadedFile& file, bool vertical) {
    constexpr std::array<const char*, 3> components{"north", "east", "down"};
    std::string text;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto from = static_cast<std::size_t>(order.from[i]);
        const io::ColumnMatch* match = file.plan.find(velocity_names[from]);
        if ((from == i && order.sign[i] > 0.0) || match == nullptr || (i == 2 && !vertical)) continue;
        text += fmt::format("{}{} is {}{}", text.empty() ? "" : ", ", components[i], match->file_name,
                            order.sign[i] < 0.0 ? " turned round" : "");
    }
    return text;
}

struct Reading {
    VelocityOrder order;
    std::array<double, 3> factor{1.0, 1.0, 1.0};  // on top of the values as they are, without the sign
    std::string unit;                             // of the columns; empty if it is as read
    std::string why;
    double confidence = 0.95;
};

/// Reads the columns so; the settings that have the loader do the same.
void read_so(Study& study, const Reading& reading) {
    LoadedFile& file = *study.gnss_file;
    std::array<std::vector<double>, 3> values;
    std::array<double, 3> now{1.0, 1.0, 1.0};
    std::array<std::string, 3> names;
    for (std::size_t i = 0; i < 3; ++i) {
        if (!file.has(velocity_names[i])) continue;
        values[i] = file.columns[velocity_names[i]];
        now[i] = factor_now(study, velocity_names[i]);
        names[i] = file.plan.find(velocity_names[i])->file_name;
    }
    std::vector<UnitChange> changes;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto from = static_cast<std::size_t>(reading.order.from[i]);
        if (names[i].empty() || names[from].empty()) continue;
        const double factor = reading.order.sign[i] * reading.factor[i], total = factor * now[from];
        std::vector<double>& column = file.columns[velocity_names[i]] = values[from];
        for (double& v : column) v *= factor;
        if (from != i) file.column_map[velocity_names[i]] = names[from];
        // the loader takes the unit from the column's name, and the sign only under its own
        const double by_name = from == i ? now[i] : std::abs(file.plan.find(velocity_names[from])->factor);
        if (std::abs(total / by_name - 1.0) > 1e-9) {
            const std::string unit = reading.order.sign[i] < 0.0
                                         ? reading.unit.empty() ? std::string("turned round") : reading.unit + ", turned round"
                                     : reading.unit.empty() ? std::string("as its own name says")
                                                            : reading.unit;
            changes.push_back({velocity_names[i], total, unit, reading.confidence, reading.why, false});
        }
    }
    std::erase_if(study.gnss_units, [&](const UnitChange& old) {
        return std::ranges::any_of(changes, [&](const UnitChange& c) { return c.key == old.key; });
    });
    for (UnitChange& change : changes) study.gnss_units.push_back(std::move(change));
}

/// The height's own unit, or the vertical column's sign or unit, from the two together.
void judge_vertical(Study& study, const VelocityColumns& seen, const Reading& horizontal) {
    LoadedFile& file = *study.gnss_file;
    if (std::isnan(seen.vertical_factor)) return;
    constexpr double alike = 1.6;  // heights are filtered, and often barometric
    const double slope = seen.vertical_factor, size = std::abs(slope);
    const bool turned = slope < 0.0;
    const std::string why = fmt::format("height change / vertical velocity = {:.3g} +- {:.2g} over {} intervals", slope,
                                        seen.vertical_sigma, seen.vertical_intervals);
    Reading vertical;
    vertical.order.sign[2] = turned ? -1.0 : 1.0;
    vertical.why = why;
    const io::ColumnMatch* height = file.plan.find("height_m");
    if (size < 1.0 / alike || size > alike) {
        const SpeedUnit* unit =
            size < 1.0 ? unit_of(speed_units, size * std::abs(factor_now(study, "vel_d_m_s")), seen.vertical_sigma) : nullptr;
        const LengthUnit* length = size > 1.0 ? unit_of(length_units, 1.0 / size, seen.vertical_sigma / (size * size)) : nullptr;
        if (length != nullptr && height != nullptr && !turned) {
            const double total = length->factor * height->factor;
            if (file.as.overrides.scale.contains("height_m")) {
                study.contradicts("gnss.scale", fmt::format("height_m = {} is given; the data show {:.6g} ({})",
                                                            file.as.overrides.scale.at("height_m"), total, why));
                return;
            }
            for (double& h : file.columns["height_m"]) h *= length->factor;
            study.gnss_units.push_back({"height_m", total, length->name, 0.9, why, false});
            if (height->unit_stated) {
                study.doubts.push_back(fmt::format("{}: the heights are in {}, against the name {}: {}; taken so",
                                                   file.report.path, length->name, height->file_name, why));
                file.problem(Level::Warning, study.doubts.back(), "name the column rightly");
            }
            return;
        }
        if (unit == nullptr || unit->factor == 1.0) {
            study.doubts.push_back(
                fmt::format("{}: the heights do not move as the vertical velocity says: {}", file.report.path, why));
            file.problem(Level::Warning, study.doubts.back(), "check the units of both columns: [gnss] scale");
            return;
        }
        // One solution has one unit: a vehicle that hovers shows it in the vertical only.
        const double now = std::abs(factor_now(study, velocity_names[2]));
        for (std::size_t i = 0; i < 3; ++i)
            if (i == 2 || (seen.intervals < fewest_intervals && std::abs(factor_now(study, velocity_names[i])) == now))
                vertical.factor[i] = unit->factor / now;
        vertical.unit = unit->name;
    } else if (!turned) {
        return;
    }
    const char* name = velocity_names[2];
    const std::string text =
        fmt::format("the vertical velocity {}{}{}: {}", file.plan.find(name)->file_name, turned ? " has the opposite sign" : "",
                    vertical.unit.empty() ? std::string() : fmt::format(" is in {}", vertical.unit), why);
    if (given_scale(file) || given_column(file)) {
        study.contradicts(given_scale(file) ? "gnss.scale" : "gnss.columns", text);
        return;
    }
    if (vertical.unit.empty()) vertical.unit = horizontal.unit;
    read_so(study, vertical);
    study.doubts.push_back(fmt::format("{}: {}; taken so", file.report.path, text));
    file.problem(Level::Warning, study.doubts.back(), "check the sign and the unit of the column");
}

}  // namespace

void leave_out_velocities(Study& study, const std::string& why) {
    LoadedFile& file = *study.gnss_file;
    if (study.given.use_velocity.value_or(false)) {
        study.contradicts("gnss.use_velocity", why);
        return;
    }
    for (const char* name : velocity_names) file.columns.erase(name);
    study.velocity_left_out = why;
    file.problem(
        Level::Warning, why,
        "they are not used; give their columns and units ([gnss] columns, scale), or log the receiver's Doppler velocity");
}

void judge_velocity(Study& study) {
    if (study.gnss_file == nullptr || study.gnss_file->computed || study.idle_velocity) return;
    LoadedFile& file = *study.gnss_file;
    if (!file.has("vel_n_m_s") || !file.has("vel_e_m_s") || !file.has("lat_deg") || !file.has("lon_deg")) return;
    const bool down = file.has("vel_d_m_s");
    const VelocityColumns seen = velocity_columns(gnss_fixes(file), down);
    Reading reading;
    if (seen.intervals >= fewest_intervals) {
        // Relative squared misfits: a wrong order or unit leaves most of the motion, noise and delays little of it.
        constexpr double well = 0.1, clearly = 0.3, least = 0.005, sigmas = 6.0, most_left = 0.5;
        constexpr double other = 0.08, tolerated = 0.15;  // of the factor: one unit from another, and of no unit at all
        const double gain = seen.miss_as_named - seen.miss;
        const bool better = seen.miss < clearly * seen.miss_as_named && gain > std::max(least, sigmas * seen.gain_sigma);
        const bool reordered = !(seen.order == VelocityOrder{});
        const double now = std::abs(factor_now(study, velocity_names[static_cast<std::size_t>(seen.order.from[0])]));
        const SpeedUnit* unit = unit_of(speed_units, seen.factor * now, seen.factor_sigma * now);
        const double off = std::abs(seen.factor - 1.0);
        const std::string ratio = fmt::format("displacement / integrated velocity = {:.3g} +- {:.2g} over {} intervals",
                                              seen.factor, seen.factor_sigma, seen.intervals);
        const std::string remain = fmt::format("of the motion {:.1g} remain, as the columns are named {:.1g}",
                                               std::sqrt(seen.miss), std::sqrt(seen.miss_as_named));
        const bool other_unit = off > other && unit != nullptr && std::abs(unit->factor / now - 1.0) > other;
        const bool as_read = off <= tolerated;
        if (seen.miss < well && better && (reordered || other_unit) && (as_read || other_unit)) {
            reading.order = seen.order;
            if (seen.order.from[2] != 2 && seen.vertical_factor < 0.0) reading.order.sign[2] = -1.0;
            if (other_unit) {
                reading.factor.fill(unit->factor / now);
                reading.unit = unit->name;
            }
            reading.why = reordered ? fmt::format("{}; {}", ratio, remain) : ratio;
            const std::string words = words_of(reading.order, file, down);
            const io::ColumnMatch* first = file.plan.find("vel_n_m_s");
            const std::string text = fmt::format("the velocities do not agree with the positions as they are named: {}{}{} ({})",
                                                 words, words.empty() || reading.unit.empty() ? "" : ", ",
                                                 reading.unit.empty() ? std::string() : "in " + reading.unit, reading.why);
            if (given_column(file) && reordered) {
                study.contradicts("gnss.columns", text);
                return;
            }
            if (given_scale(file)) {
                study.contradicts("gnss.scale", text);
                return;
            }
            read_so(study, reading);
            if (reordered) study.found("gnss.columns", words, 0.95, reading.why);
            if (reordered || first->unit_stated) {
                study.doubts.push_back(fmt::format("{}: {}; taken so", file.report.path, text));
                file.problem(Level::Warning, study.doubts.back(), "name the columns rightly, with their unit");
            } else {
                file.problem(Level::Info, fmt::format("the velocities are in {}: {}", reading.unit, ratio), "");
            }
        } else if ((seen.miss < well && off > std::max(tolerated, sigmas * seen.factor_sigma)) ||
                   (seen.miss_as_named > most_left && seen.miss > well)) {
            const std::string text =
                seen.miss < well
                    ? fmt::format("the velocities do not agree with the positions in any known unit: {}", ratio)
                    : fmt::format(
                          "the velocities do not agree with the positions in any order, sign or unit ({} intervals; of "
                          "the motion {:.1g} remain)",
                          seen.intervals, std::sqrt(seen.miss));
            if (given_column(file) || given_scale(file))
                study.contradicts(given_scale(file) ? "gnss.scale" : "gnss.columns", text);
            else leave_out_velocities(study, text);
            return;
        }
    }
    if (!down || file.column_map.contains("vel_d_m_s")) return;
    judge_vertical(study, seen, reading);
}

}  // namespace schuler::inspect::detail
