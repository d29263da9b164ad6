// Tables of u-blox navigation solutions: whole numbers of millimetres and millimetres per second under names without a unit.
#include "schuler/inspect/detail/robust.h"
#include "schuler/inspect/detail/units_by_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace schuler::inspect::detail {
namespace {

struct Field {
    std::string_view canonical, name;  // the field's name, in lower-case letters alone
    bool accuracy = false, speed = false;
};
constexpr std::array<Field, 8> fields{{{"height_m", "height"},
                                       {"height_m", "hmsl"},
                                       {"std_h_m", "hacc", true},
                                       {"std_d_m", "vacc", true},
                                       {"vel_n_m_s", "veln", false, true},
                                       {"vel_e_m_s", "vele", false, true},
                                       {"vel_d_m_s", "veld", false, true},
                                       {"std_vel_m_s", "sacc", true, true}}};

const Field* field_of(const io::ColumnMatch& match) {
    std::string name;
    for (const std::string& word : io::words_of_name(match.file_name)) name += word;
    const auto found =
        std::ranges::find_if(fields, [&](const Field& f) { return f.canonical == match.canonical && f.name == name; });
    return found == fields.end() || match.unit_stated ? nullptr : &*found;
}

bool whole_numbers(const std::vector<double>& values) {
    return std::ranges::all_of(values, [](double v) { return !std::isfinite(v) || v == std::floor(v); });
}

}  // namespace

void judge_receiver_integers(LoadedFile& file, std::vector<UnitChange>& changes) {
    std::vector<std::pair<const io::ColumnMatch*, const Field*>> found;
    std::size_t accuracies = 0, velocities = 0;
    const auto scaled = [&](std::string_view key) { return std::ranges::find(changes, key, &UnitChange::key) != changes.end(); };
    for (const io::ColumnMatch& match : file.plan.matches) {
        const Field* field = field_of(match);
        if (field == nullptr || !file.has(match.canonical) || scaled(match.canonical)) continue;
        if (!whole_numbers(file[match.canonical])) return;
        found.emplace_back(&match, field);
        accuracies += field->accuracy ? 1 : 0;
        velocities += field->speed && !field->accuracy ? 1 : 0;
    }
    if (accuracies < 2 || (velocities == 0 && !file.has("std_vel_m_s"))) return;
    // Whole numbers of metres are told apart by the position, or by a speed that no receiver is so uncertain of.
    constexpr double absurd = 10.0;  // m/s
    const bool angles = std::ranges::any_of(changes, [](const UnitChange& c) { return c.unit == "1e-7 deg"; });
    const bool speeds = file.has("std_vel_m_s") && median(file["std_vel_m_s"]) >= absurd;
    if (!angles && !speeds) return;
    const std::string why = fmt::format("whole numbers under the names of the u-blox navigation solution{}",
                                        angles ? ", as its angles" : ", with speeds otherwise uncertain by more than 10 m/s");
    constexpr double thousandth = 1e-3;
    for (const auto& [match, field] : found) {
        for (double& v : file.columns[match->canonical]) v *= thousandth;
        changes.push_back({match->canonical, thousandth * match->factor, field->speed ? "mm/s" : "mm", 0.97, why, false});
    }
}

}  // namespace schuler::inspect::detail
