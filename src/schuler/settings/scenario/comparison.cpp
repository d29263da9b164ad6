// "compare.*": schemes, numbers of satellites, and the comparison windows.
#include "schuler/settings/scenario/comparison.h"

#include "schuler/core/error.h"
#include "schuler/settings/option_builders.h"
#include "schuler/settings/scenario/scenario.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::settings {

const std::vector<KnownScheme>& known_schemes() {
    static const std::vector<KnownScheme> list{
        {"gnss", "receiver alone", {{"filter.scheme", {std::string("gnss")}, {}}}},
        {"separate-restart",
         "a uncoupled, restarted every minute",
         // clang-format off
         {{"filter.scheme", {std::string("separate")}, {}}, {"filter.separate.restart_s", {60.0}, {}}}},
        {"separate",
         // clang-format on
         "a uncoupled, continuous correction",
         // clang-format off
         {{"filter.scheme", {std::string("separate")}, {}}, {"filter.separate.restart_s", {0.0}, {}}}},
        {"loose", "b loose, standard", {{"filter.scheme", {std::string("loose")}, {}}}},
        {"tight", "c tight", {{"filter.scheme", {std::string("tight")}, {}}}},
        {"intermediate", "intermediate", {{"filter.scheme", {std::string("intermediate")}, {}}}},
        {"medium", "intermediate", {{"filter.scheme", {std::string("intermediate")}, {}}}},  // the older name
        {"deep", "d deep", {{"filter.scheme", {std::string("deep")}, {}}}},
        {"loose-aggressive",
         // clang-format on
         "b loose, aggressive",
         // clang-format off
         {{"filter.scheme", {std::string("loose")}, {}}, {"filter.loose", {std::string("aggressive")}, {}}}},
        {"loose-15",
         // clang-format on
         "b loose, 15 states",
         {{"filter.scheme", {std::string("loose")}, {}},
          {"filter.preset", {std::string("ins15")}, {}},
          {"gnss.consider_errors", {true}, {}}}},
        {"complex22",
         "b loose, 22 states",
         // clang-format off
         {{"filter.scheme", {std::string("loose")}, {}}, {"filter.preset", {std::string("complex22")}, {}}}},
        {"loose-open",
         // clang-format on
         "b loose, open loop",
         {{"filter.scheme", {std::string("loose")}, {}}, {"filter.loop", {std::string("open")}, {}}}}};
    return list;
}

const KnownScheme& known_scheme(const std::string& name) {
    return *std::ranges::find(known_schemes(), name, [](const KnownScheme& k) { return std::string(k.name); });
}

namespace {

using S = ScenarioConfig;

std::optional<Value> nothing(const S&) { return std::nullopt; }

Option<S> schemes_option() {
    OptionSpec spec =
        detail::spec("compare.schemes", Shape::Texts, "`run` processes the same flight with these schemes and compares them");
    for (const KnownScheme& k : known_schemes()) spec.choices.emplace_back(k.name);
    spec.form = "a list out of";
    for (const KnownScheme& scheme : known_schemes()) spec.form += fmt::format(" \"{}\"", scheme.name);
    return {std::move(spec),
            [](S& s, const Value& v) {
                s.compared.clear();
                for (const Value& item : *v.list()) s.compared.push_back(*item.text());
            },
            nothing};
}

Option<S> satellites_option() {
    OptionSpec spec = detail::spec("compare.satellites", Shape::Numbers,
                                   "numbers of satellites with which each scheme is compared, from the first of ranges.limit on");
    spec.form = "a list of whole numbers";
    spec.low = 0;
    spec.high = 99;
    return {std::move(spec),
            [](S& s, const Value& v) {
                s.compared_satellites.clear();
                for (const Value& item : *v.list()) {
                    if (item.number() != std::floor(item.number()))
                        throw input_error(fmt::format("{:g} is not a number of satellites", item.number()), {},
                                          "give whole numbers");
                    s.compared_satellites.push_back(static_cast<std::size_t>(item.number()));
                }
            },
            nothing};
}

/// One [[compare.window]] with its place: its index in the list, or an entry of it.
class WindowTable {
public:
    WindowTable(const Value& item, std::size_t index) : table_(*item.table()), line_(item.line), index_(index) {
        for (const auto& [name, v] : table_)
            if (name != "name" && name != "start_s" && name != "end_s")
                throw bad(fmt::format("a window has no \"{}\"", name), name);
    }

    /// @throws Error(Input) at the entry, or at the window if the entry is empty.
    [[nodiscard]] Error bad(const std::string& what, const std::string& entry = "", const std::string& hint = "") const {
        const Value* v = find(entry);
        const SourcePlace place{{},
                                v != nullptr ? v->line : line_,
                                0,
                                fmt::format("compare.window[{}]{}{}", index_, entry.empty() ? "" : ".", entry)};
        return input_error(what, place,
                           hint.empty() ? "write [[compare.window]] name = \"jammed\", start_s = 300, end_s = 420" : hint);
    }

    /// A time of the scenario, s.
    [[nodiscard]] double time(const char* entry) const {
        const Value& v = required(entry);
        if (!v.is_number() || !(v.number() >= 0.0 && v.number() < unbounded))
            throw bad(fmt::format("{} is not a time of the scenario", to_toml(v)), entry);
        return v.number();
    }

    /// Used as a field in CSV files.
    [[nodiscard]] std::string name() const {
        const Value& v = required("name");
        const auto unfit = [](char c) { return c == ',' || c == '"' || static_cast<unsigned char>(c) < 0x20; };
        if (v.text() == nullptr || v.text()->empty() || std::ranges::any_of(*v.text(), unfit))
            throw bad(fmt::format("{} is not a name", to_toml(v)), "name", "give a text without commas and quotes");
        return *v.text();
    }

private:
    [[nodiscard]] const Value* find(const std::string& entry) const {
        const auto it = std::ranges::find(table_, entry, &NamedValue::first);
        return it == table_.end() ? nullptr : &it->second;
    }
    [[nodiscard]] const Value& required(const char* entry) const {
        const Value* v = find(entry);
        if (v == nullptr) throw bad(fmt::format("a window lacks {}", entry));
        return *v;
    }

    const ValueTable& table_;
    long line_;
    std::size_t index_;
};

void add_window(S& s, const WindowTable& table) {
    const CompareWindow w{table.name(), table.time("start_s"), table.time("end_s")};
    if (!(w.end > w.start)) throw table.bad(fmt::format("{:g} s is not after start_s = {:g}", w.end, w.start), "end_s");
    if (w.end > s.sim.duration)
        throw table.bad(fmt::format("{:g} s is after the end of the scenario", w.end), "end_s",
                        fmt::format("give at most duration_s = {:g}", s.sim.duration));
    if (std::ranges::find(s.windows, w.name, &CompareWindow::name) != s.windows.end())
        throw table.bad(fmt::format("there is a window \"{}\" already", w.name), "name", "give every window a name of its own");
    if (s.compared.empty())
        throw table.bad("there are no schemes to compare in this window", "", "give [compare] schemes = [\"gnss\", \"loose\"]");
    if (s.sim.reference_rate * s.window_rules.age < 1.0)
        throw table.bad(fmt::format("the truth comes every {:g} s, and a solution counts for {:g} s only",
                                    1.0 / s.sim.reference_rate, s.window_rules.age),
                        "", "give a higher reference_rate_hz, or compare.solution_age_s");
    s.windows.push_back(w);
}

/// Must follow the options it is checked against: duration_s, reference_rate_hz, compare.schemes, compare.solution_age_s.
Option<S> windows_option() {
    return {detail::spec("compare.window", Shape::Tables,
                         "a window in which they are compared: [[compare.window]] with name, start_s, end_s"),
            [](S& s, const Value& v) {
                s.windows.clear();
                for (std::size_t i = 0; i < v.list()->size(); ++i) add_window(s, WindowTable((*v.list())[i], i));
            },
            nothing};
}

}  // namespace

void add_compare_options(OptionTable<S>& table) {
    table.add(schemes_option())
        .add(satellites_option())
        .add(number<S>("compare.limit_m", 1.0, 1e-3, 1e7,
                       "a scheme has recovered after a window where its horizontal error is below this",
                       [](auto& s) -> auto& { return s.window_rules.limit; }))
        .add(number<S>("compare.solution_age_s", 1.0, 1e-3, 1e4, "age beyond which a solution does not count in a window",
                       [](auto& s) -> auto& { return s.window_rules.age; }))
        .add(windows_option());
}

}  // namespace schuler::settings
