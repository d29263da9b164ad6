#include "schuler/io/text/columns.h"

#include "schuler/core/samples.h"
#include "schuler/core/units.h"
#include "schuler/io/text/detail/column_dictionary.h"
#include "schuler/io/text/detail/companion_columns.h"
#include "schuler/math/quantile.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

namespace schuler::io {
namespace {

using detail::Dimension;
using detail::Quantity;
using Words = std::vector<std::string>;

std::string joined(const Words& words, std::size_t first, std::size_t last) {
    std::string text;
    for (std::size_t i = first; i < last; ++i) text += (i > first ? "_" : "") + words[i];
    return text;
}

enum class StemFound { No, Clear, Guess };

StemFound find_stem(const Quantity& quantity, const std::string& stem) {
    const std::string& stems = quantity.stems;
    for (std::size_t at = stems.find(stem); at != std::string::npos && !stem.empty(); at = stems.find(stem, at + 1)) {
        const std::size_t end = at + stem.size();
        if ((at > 0 && stems[at - 1] != ' ') || (end < stems.size() && stems[end] != ' ')) continue;
        return stems.find('|') < at ? StemFound::Guess : StemFound::Clear;
    }
    return StemFound::No;
}

/// Factor from the named unit to the unit in the canonical name; dtheta is in radians where other angles are in degrees.
std::optional<UnitFactor> factor_of(const Quantity& quantity, const std::string& unit) {
    std::optional<UnitFactor> factor = detail::unit_factor(quantity.dimension, unit);
    if (factor && quantity.canonical.ends_with("_rad")) factor->factor = unit == "rad" ? 1.0 : factor->factor * units::deg;
    return factor;
}

/// Applies the sign that a name implies, and its unit where none is stated.
void apply_implied(const Quantity& quantity, ColumnMatch& match) {
    const double implied = match.unit_stated ? std::copysign(1.0, quantity.sign) : quantity.sign;
    match.factor *= implied;
    match.offset *= implied;
    if (std::abs(quantity.sign) != 1.0) match.unit_stated = true;
}

/// Codes after "fix" belong to the name (fix_rtk1fix_2float_5single, fix_3is3d).
bool is_fix_with_codes(const Quantity& quantity, const Words& words) {
    return quantity.canonical == "fix" && words.size() > 1 && words[0] == "fix" && words[1] != "time" && words[1] != "age";
}

/// `of_name`: implied by a recognised name; the words of any name may state the kind.
HeightKind height_kind(HeightKind of_name, const Words& words) {
    const auto has = [&](std::string_view w) { return std::find(words.begin(), words.end(), w) != words.end(); };
    if (has("onboard") || has("autopilot") || has("ekf")) return HeightKind::Autopilot;
    if (of_name != HeightKind::Unstated) return of_name;
    if (has("msl") || has("amsl") || has("hmsl")) return HeightKind::Msl;
    if (has("rel") || has("relative") || has("agl")) return HeightKind::Relative;
    if (has("ellipsoidal") || has("hae") || has("ell")) return HeightKind::Ellipsoidal;
    return HeightKind::Unstated;
}

struct Candidate {
    ColumnMatch match;
    std::size_t stripped = 0;  ///< origin words removed
    bool empty = false;        ///< no value in the first rows: used as a last resort
    bool repeats = false;      ///< a time of samples that most rows share with the row before

    [[nodiscard]] bool better_than(const Candidate& other) const {
        return std::tuple(empty, repeats, match.certainty, stripped) <
               std::tuple(other.empty, other.repeats, other.match.certainty, other.stripped);
    }
};

void apply_unit(const Quantity& quantity, const std::string& unit, ColumnMatch& match) {
    if (quantity.dimension == Dimension::Time) {
        if (const auto found = detail::time_unit(unit)) {
            match.time_unit = *found;
            match.unit_stated = true;
        }
    } else if (const auto factor = factor_of(quantity, unit)) {
        match.factor = factor->factor;
        match.offset = factor->offset;
        match.unit_stated = true;
    }
}

/// Matches a name (its words) with this quantity, possibly after words of origin and before a unit.
std::optional<Candidate> recognise(const Quantity& quantity, const Words& words) {
    for (std::size_t first = 0; first < words.size(); ++first) {
        if (first > 0 && !detail::is_origin_word(words[first - 1])) break;
        // The time of the velocity is not the time of the row.
        if (first > 0 && quantity.dimension == Dimension::Time &&
            (words[first - 1].starts_with("vel") || words[first - 1].starts_with("pos")))
            break;
        // Nor are the components and sigmas of a velocity those of a position.
        if (first > 0 && quantity.dimension == Dimension::Length && words[first - 1].starts_with("vel")) break;
        for (std::size_t unit_words = std::min<std::size_t>(3, words.size() - first) + 1; unit_words-- > 0;) {
            const std::size_t stop = words.size() - unit_words;
            if (stop == first && unit_words > 0) continue;
            Candidate c;
            if (unit_words > 0) {
                apply_unit(quantity, joined(words, stop, words.size()), c.match);
                if (!c.match.unit_stated) continue;
            }
            const std::string stem = joined(words, first, stop);
            StemFound found = find_stem(quantity, stem);
            if (found == StemFound::No && first == 0 && unit_words == 0 && is_fix_with_codes(quantity, words))
                found = StemFound::Clear;
            if (found == StemFound::No) continue;
            if (quantity.dimension == Dimension::Count) c.match.unit_stated = true;
            if (quantity.dimension == Dimension::Time && unit_words == 0)
                apply_unit(quantity, stem == "itow" || stem == "i_tow" ? "ms" : stem, c.match);
            c.match.canonical = quantity.canonical;
            c.match.certainty = found == StemFound::Clear && c.match.unit_stated ? Certainty::Synonym : Certainty::Guess;
            if (joined(words, 0, words.size()) == quantity.canonical) c.match.certainty = Certainty::Exact;
            if (quantity.dimension == Dimension::Length) c.match.height = height_kind(quantity.height, words);
            c.stripped = first;
            return c;
        }
    }
    return std::nullopt;
}

bool column_is_empty(const TableLayout& layout, int column) {
    if (layout.sample.empty()) return false;
    return std::all_of(layout.sample.begin(), layout.sample.end(), [&](const std::vector<std::string>& row) {
        return static_cast<std::size_t>(column) >= row.size() || row[static_cast<std::size_t>(column)].empty();
    });
}

/// A time without a unit: seconds, unless the numbers are too large. They are then ticks since 1970, or since the start of an
/// instrument, whose size follows from the usual interval between two rows, which is longer between fixes than between samples.
TimeUnit unit_by_size(const TableLayout& layout, int column, bool fixes) {
    const auto value_of = [&](const std::vector<std::string>& row) {
        return static_cast<std::size_t>(column) < row.size() ? number_from(row[static_cast<std::size_t>(column)]) : not_given;
    };
    if (layout.sample.empty()) return TimeUnit::Seconds;
    const double value = value_of(layout.sample.front());
    std::vector<double> steps;  // their median, because one may be a pause
    for (std::size_t i = 1; i < layout.sample.size(); ++i)
        if (const double d = value_of(layout.sample[i]) - value_of(layout.sample[i - 1]); d > 0.0) steps.push_back(d);
    const double step = steps.empty() ? not_given : math::median(std::move(steps));
    constexpr double seconds_most = 4e9;  // 2106
    if (!(value > seconds_most)) return TimeUnit::Seconds;
    if (value > 1e17) return TimeUnit::Nanoseconds;
    if (value > 3e14 && value < 4e15 && !(step > (fixes ? 3e8 : 5e6))) return TimeUnit::Microseconds;  // 1980 to 2096
    if (value > 3e11 && value < 4e12 && !(step > 3e5)) return TimeUnit::Milliseconds;
    if (!(step > 0.0)) return value > 1e14 ? TimeUnit::Microseconds : value > 1e11 ? TimeUnit::Milliseconds : TimeUnit::Seconds;
    if (step >= (fixes ? 2e7 : 2.5e5)) return TimeUnit::Nanoseconds;
    return step >= (fixes ? 2e4 : 250.0) ? TimeUnit::Microseconds : TimeUnit::Milliseconds;
}

std::optional<Candidate> best_for(const Quantity& quantity, const TableLayout& layout, TableKind kind) {
    std::optional<Candidate> best;
    for (std::size_t i = 0; i < layout.names.size(); ++i) {
        const int column = static_cast<int>(i);
        std::optional<Candidate> c = recognise(quantity, words_of_name(layout.names[i]));
        if (!c) continue;
        c->empty = column_is_empty(layout, column);
        if (quantity.dimension == Dimension::Time && detail::is_fraction_of_seconds(layout, column)) continue;
        if (quantity.dimension == Dimension::Calendar && !detail::holds_dates(layout, column)) continue;
        if (!c->match.unit_stated && i < layout.units.size())
            apply_unit(quantity, joined(words_of_name(layout.units[i]), 0, words_of_name(layout.units[i]).size()), c->match);
        if (quantity.dimension == Dimension::Time && !c->match.unit_stated)
            c->match.time_unit = unit_by_size(layout, column, kind == TableKind::Gnss || kind == TableKind::Reference);
        apply_implied(quantity, c->match);
        c->match.column = column;
        c->match.file_name = layout.names[i];
        // Fixes held at the rate of another instrument repeat their own time rightly.
        constexpr double nearly_all = 0.9;
        c->repeats = quantity.dimension == Dimension::Calendar ||  // coarse beside a count of seconds
                     (quantity.dimension == Dimension::Time && kind == TableKind::Imu &&
                      detail::repeated_share(layout, column) > nearly_all);
        if (!best || c->better_than(*best)) best = std::move(c);
    }
    return best;
}

std::string list_of(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < names.size() && i < 40; ++i) text += (i > 0 ? ", " : "") + names[i];
    return names.size() > 40 ? text + ", ..." : text;
}

int column_named(const TableLayout& layout, TableKind kind, const std::string& canonical, const std::string& wanted) {
    const auto exact = std::find(layout.names.begin(), layout.names.end(), wanted);
    if (exact != layout.names.end()) return static_cast<int>(exact - layout.names.begin());
    const std::string words = joined(words_of_name(wanted), 0, words_of_name(wanted).size());
    for (std::size_t i = 0; i < layout.names.size(); ++i) {
        const Words w = words_of_name(layout.names[i]);
        if (!words.empty() && joined(w, 0, w.size()) == words) return static_cast<int>(i);
    }
    const double number = number_from(wanted.starts_with('#') ? std::string_view(wanted).substr(1) : std::string_view(wanted));
    if (number >= 1.0 && number <= layout.columns && number == std::floor(number)) return static_cast<int>(number) - 1;
    const std::string near = nearest_name(wanted, layout.names);
    const std::string place = fmt::format("{} columns.{}", name_of(kind), canonical);
    throw input_error(
        fmt::format("there is no column '{}'", wanted), {layout.file, layout.header_line, 0, place},
        near.empty() ? fmt::format("the columns are: {}", list_of(layout.names)) : fmt::format("did you mean '{}'?", near));
}

/// A column given by the user. Sign and unit are taken from the column's own name if stated there.
ColumnMatch given_match(const TableLayout& layout, TableKind kind, const std::string& canonical, const std::string& wanted) {
    const int column = column_named(layout, kind, canonical, wanted);
    const std::string file_name =
        layout.names.empty() ? fmt::format("#{}", column + 1) : layout.names[static_cast<std::size_t>(column)];
    const Words words = words_of_name(file_name);
    ColumnMatch match;
    bool recognised = false;
    for (const Quantity& q : detail::quantities(kind)) {
        if (q.canonical != canonical) continue;
        if (auto c = recognise(q, words)) {
            match = c->match;
            apply_implied(q, match);
            recognised = true;
            break;
        }
        for (std::size_t n = std::min<std::size_t>(3, words.size()); n-- > 0 && !match.unit_stated;) {
            apply_unit(q, joined(words, words.size() - n - 1, words.size()), match);
        }
        if (q.dimension == Dimension::Length) match.height = height_kind(HeightKind::Unstated, words);
    }
    if (!recognised) match.canonical = canonical;
    match.column = column;
    match.file_name = file_name;
    match.certainty = Certainty::Given;
    return match;
}

std::string without_axis(std::string name) {
    for (const std::string_view axis : {"_x_", "_y_", "_z_"}) {
        const std::size_t at = name.find(axis);
        if (at != std::string::npos) return name.erase(at, 2);
    }
    return name;
}

/// Times are read as integer nanoseconds: only powers of ten are valid units.
TimeUnit time_unit_of(double factor, const SourcePlace& place) {
    constexpr std::pair<double, TimeUnit> units[] = {
        {1.0, TimeUnit::Seconds}, {1e-3, TimeUnit::Milliseconds}, {1e-6, TimeUnit::Microseconds}, {1e-9, TimeUnit::Nanoseconds}};
    for (const auto& [size, unit] : units)
        if (std::abs(factor / size - 1.0) < 1e-9) return unit;
    throw input_error(fmt::format("{} s is not a valid unit of time", factor), place, "give 1, 1e-3, 1e-6 or 1e-9 seconds");
}

void apply_scale(ColumnPlan& plan, const TableLayout& layout, const ColumnOverrides& overrides) {
    const std::vector<std::string> known = canonical_names(plan.kind);
    for (const auto& [key, factor] : overrides.scale) {
        bool used = std::find(known.begin(), known.end(), key) != known.end();
        for (const std::string& name : known) used = used || without_axis(name) == key;
        const SourcePlace place{layout.file, 0, 0, fmt::format("{} scale.{}", name_of(plan.kind), key)};
        if (!used) {
            const std::string near = nearest_name(key, known);
            throw input_error("is not a canonical column name", place,
                              near.empty() ? "known: " + list_of(known) : fmt::format("did you mean '{}'?", near));
        }
        if (!std::isfinite(factor) || factor == 0.0)
            throw input_error(fmt::format("{} is not a usable factor", factor), place, "give a number other than zero");
        for (ColumnMatch& match : plan.matches) {
            if (match.canonical != key && without_axis(match.canonical) != key) continue;
            if (match.canonical.find("time") != std::string::npos) match.time_unit = time_unit_of(factor, place);
            else match.factor = factor;
            match.offset = 0.0;
            match.unit_stated = true;
        }
    }
}

}  // namespace

const ColumnMatch* ColumnPlan::find(std::string_view canonical) const {
    const auto it = std::find_if(matches.begin(), matches.end(), [&](const ColumnMatch& m) { return m.canonical == canonical; });
    return it == matches.end() ? nullptr : &*it;
}

std::vector<std::string> canonical_names(TableKind kind) {
    std::vector<std::string> names;
    for (const Quantity& q : detail::quantities(kind)) {
        if (std::find(names.begin(), names.end(), q.canonical) == names.end()) names.push_back(q.canonical);
    }
    return names;
}

/// Digits before the decimal point.
static std::size_t whole_digits(std::string_view text) {
    const std::size_t first = std::min(text.find_first_of("0123456789"), text.size());
    return std::min(text.find_first_not_of("0123456789", first), text.size()) - first;
}

/// Degrees and minutes: the minutes stay below 60 in every row, and the latitudes or the longitudes are beyond 360, as which no angle
/// in degrees is written, or both have all the digits of NMEA (0030.50, 00130.25), as near the equator and Greenwich.
static void find_degrees_minutes(ColumnPlan& plan, const TableLayout& layout, const ColumnOverrides& overrides) {
    constexpr double quarter = 90.0, circle = 360.0, hundred = 100.0, sixty = 60.0;
    std::array<ColumnMatch*, 2> found{};
    for (ColumnMatch& match : plan.matches) {
        if (match.canonical == "lat_deg") found[0] = &match;
        if (match.canonical == "lon_deg") found[1] = &match;
    }
    if (found[0] == nullptr || found[1] == nullptr || overrides.scale.contains("lat_deg") || overrides.scale.contains("lon_deg"))
        return;
    std::size_t rows = 0;
    std::array<double, 2> lowest{quarter * hundred, quarter * hundred};
    bool all_digits = true;
    for (const std::vector<std::string>& row : layout.sample) {
        for (std::size_t i = 0; i < 2; ++i) {
            const auto column = static_cast<std::size_t>(found[i]->column);
            const double value = column < row.size() ? std::abs(detail::angle_with_hemisphere(row[column])) : not_given;
            if (std::isnan(value)) continue;
            if (value >= (i == 0 ? 1.0 : 2.0) * quarter * hundred + hundred || std::fmod(value, hundred) >= sixty) return;
            if (value == 0.0) continue;  // before the first fix
            all_digits = all_digits && whole_digits(row[column]) == 4 + i;
            lowest[i] = std::min(lowest[i], value);
            if (i == 0) ++rows;
        }
    }
    if (rows == 0 || (std::ranges::max(lowest) <= circle && !all_digits)) return;
    for (ColumnMatch* match : found) {
        match->degrees_minutes = true;
        match->unit_stated = true;
        match->factor = 1.0;
    }
}

/// `std_h` is the vertical sigma beside those of north and east, and the horizontal one without them.
static void settle_std_h(std::vector<Candidate>& found) {
    const auto of = [&](std::string_view canonical) {
        return std::ranges::find(found, canonical, [](const Candidate& c) { return std::string_view(c.match.canonical); });
    };
    const auto horizontal = of("std_h_m"), vertical = of("std_d_m");
    if (horizontal == found.end() || vertical == found.end() || horizontal->match.column != vertical->match.column) return;
    found.erase(of("std_n_m") != found.end() ? horizontal : vertical);
}

ColumnPlan match_columns(const TableLayout& layout, TableKind kind, const ColumnOverrides& overrides) {
    ColumnPlan plan;
    plan.kind = kind;
    const std::vector<std::string> known = canonical_names(kind);
    for (const auto& [canonical, wanted] : overrides.columns) {
        if (std::find(known.begin(), known.end(), canonical) == known.end()) {
            const std::string near = nearest_name(canonical, known);
            throw input_error("is not a canonical column name",
                              {layout.file, 0, 0, fmt::format("{} columns.{}", name_of(kind), canonical)},
                              near.empty() ? "known: " + list_of(known) : fmt::format("did you mean '{}'?", near));
        }
        plan.matches.push_back(given_match(layout, kind, canonical, wanted));
    }
    std::vector<Candidate> found;
    for (const Quantity& quantity : detail::quantities(kind)) {
        if (overrides.columns.contains(quantity.canonical)) continue;
        std::optional<Candidate> best = best_for(quantity, layout, kind);
        if (!best) continue;
        const auto have =
            std::find_if(found.begin(), found.end(), [&](const Candidate& c) { return c.match.canonical == quantity.canonical; });
        if (have == found.end()) found.push_back(std::move(*best));
        else if (best->better_than(*have)) *have = std::move(*best);
    }
    settle_std_h(found);
    for (Candidate& c : found) plan.matches.push_back(std::move(c.match));
    apply_scale(plan, layout, overrides);
    for (ColumnMatch& match : plan.matches) {
        if (!overrides.time_unit || match.canonical.find("time") == std::string::npos) continue;
        if (match.canonical == "time_s" || !match.unit_stated) match.time_unit = *overrides.time_unit;
        match.unit_stated = true;
    }
    detail::find_companions(plan, layout);
    if (kind == TableKind::Gnss || kind == TableKind::Reference) find_degrees_minutes(plan, layout, overrides);
    for (std::size_t i = 0; i < layout.names.size(); ++i) {
        const int column = static_cast<int>(i);
        const bool used =
            std::ranges::any_of(plan.matches, [&](const ColumnMatch& m) { return m.column == column || m.companion == column; });
        if (!used) plan.unused.push_back(layout.names[i]);
    }
    return plan;
}

}  // namespace schuler::io
