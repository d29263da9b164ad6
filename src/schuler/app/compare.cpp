// One flight through several schemes (paper A, table 1.1.1, as numbers).
#include "schuler/app/commands.h"
#include "schuler/app/fuse.h"
#include "schuler/app/option_builders.h"
#include "schuler/app/scenario_sections.h"
#include "schuler/app/detail/json.h"
#include "schuler/core/error.h"
#include "schuler/core/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::app {
namespace {

namespace fs = std::filesystem;

/// A scheme by its name in compare.schemes: settings that make it.
struct KnownScheme {
    const char* name;
    const char* title;
    SettingList settings;
};

const std::vector<KnownScheme>& known_schemes() {
    static const std::vector<KnownScheme> list{
        {"gnss", "receiver alone", {{"filter.scheme", {std::string("gnss")}, {}}}},
        {"separate-restart",
         "a separate, restarted every minute",
         {{"filter.scheme", {std::string("separate")}, {}}, {"filter.separate.restart_s", {60.0}, {}}}},
        {"separate",
         "a separate, continuous correction",
         {{"filter.scheme", {std::string("separate")}, {}}, {"filter.separate.restart_s", {0.0}, {}}}},
        {"loose", "b loose, standard", {{"filter.scheme", {std::string("loose")}, {}}}},
        {"tight", "c tight", {{"filter.scheme", {std::string("tight")}, {}}}},
        {"medium", "intermediate", {{"filter.scheme", {std::string("medium")}, {}}}},
        {"deep", "d deep", {{"filter.scheme", {std::string("deep")}, {}}}},
        {"loose-aggressive",
         "b loose, aggressive",
         {{"filter.scheme", {std::string("loose")}, {}}, {"filter.loose", {std::string("aggressive")}, {}}}},
        {"loose-15",
         "b loose, 15 states",
         {{"filter.scheme", {std::string("loose")}, {}},
          {"filter.preset", {std::string("ins15")}, {}},
          {"gnss.correlated_m", {0.0}, {}},
          {"gnss.correlated_velocity_m_s", {0.0}, {}}}},
        {"loose-open", "b loose, open loop", {{"filter.scheme", {std::string("loose")}, {}}, {"filter.loop", {std::string("open")}, {}}}}};
    return list;
}

/// A number of the comparison: key of JSON and CSV, title of the table, and how it is got.
struct Column {
    const char* key;
    const char* title;
    double (*of)(const ResultBundle&);
};
double outage(const ResultBundle& b, double analysis::OutageStatistics::*field) {
    return b.evaluation.outages.empty() ? not_given : b.evaluation.outages.front().*field;
}
const std::array<Column, 10> columns{{
    {"horizontal_m", "horiz., m", [](const ResultBundle& b) { return b.evaluation.summary.horizontal.rms; }},
    {"up_m", "up, m", [](const ResultBundle& b) { return b.evaluation.summary.up.rms; }},
    {"velocity_m_s", "vel., m/s",
     [](const ResultBundle& b) {
         const analysis::ErrorSummary& s = b.evaluation.summary;
         return std::hypot(s.v_east.rms, s.v_north.rms, s.v_up.rms);
     }},
    {"tilt_deg", "tilt, deg",
     [](const ResultBundle& b) { return std::hypot(b.evaluation.summary.roll.rms, b.evaluation.summary.pitch.rms) / units::deg; }},
    {"heading_deg", "head., deg", [](const ResultBundle& b) { return b.evaluation.summary.heading.rms / units::deg; }},
    {"nees_position", "NEES pos.",
     [](const ResultBundle& b) { return b.evaluation.consistency ? b.evaluation.consistency->position.mean / 3.0 : not_given; }},
    {"outage_end_horizontal_m", "outage, m", [](const ResultBundle& b) { return outage(b, &analysis::OutageStatistics::end_horizontal); }},
    {"outage_end_vertical_m", "vertical, m", [](const ResultBundle& b) { return outage(b, &analysis::OutageStatistics::end_vertical); }},
    {"gnss_rejected", "rejected", [](const ResultBundle& b) { return static_cast<double>(b.result.counters.gnss_rejected); }},
    {"filter_s", "time, s", [](const ResultBundle& b) { return b.timing.filter_s; }},
}};

std::string cell(double x) {
    if (!std::isfinite(x)) return "-";
    const double a = std::abs(x);
    return a != 0.0 && (a < 1e-3 || a >= 1e5) ? fmt::format("{:.2e}", x) : fmt::format("{:.4g}", x);
}

}  // namespace

Option<ScenarioConfig> compared_option() {
    OptionSpec spec = detail::spec("compare.schemes", Shape::Texts, "`run` takes the same flight through these schemes and compares them");
    for (const KnownScheme& k : known_schemes()) spec.choices.emplace_back(k.name);
    spec.form = "a list out of";
    for (const KnownScheme& scheme : known_schemes()) spec.form += fmt::format(" \"{}\"", scheme.name);
    return {std::move(spec),
            [](ScenarioConfig& s, const Value& v) {
                s.compared.clear();
                for (const Value& item : *v.list()) s.compared.push_back(*item.text());
            },
            [](const ScenarioConfig&) { return std::optional<Value>(); }};
}

Option<ScenarioConfig> compared_satellites_option() {
    OptionSpec spec = detail::spec("compare.satellites", Shape::Numbers, "... each with so many satellites from the first of ranges.limit on");
    spec.form = "a list of whole numbers";
    spec.low = 0;
    spec.high = 99;
    return {std::move(spec),
            [](ScenarioConfig& s, const Value& v) {
                s.compared_satellites.clear();
                for (const Value& item : *v.list()) {
                    if (item.number() != std::floor(item.number()))
                        throw input_error(fmt::format("{:g} is not a number of satellites", item.number()), {}, "give whole numbers");
                    s.compared_satellites.push_back(static_cast<std::size_t>(item.number()));
                }
            },
            [](const ScenarioConfig&) { return std::optional<Value>(); }};
}

namespace {

/// The scenario with so many satellites; as it is where the number is not given.
ScenarioConfig with_satellites(const ScenarioConfig& scenario, std::optional<std::size_t> satellites) {
    ScenarioConfig out = scenario;
    if (!satellites) return out;
    if (out.ranging.settings.limits.empty())
        throw input_error("there is no limit whose number could change", {.file = {}, .key = "compare.satellites"},
                          "give ranges.limit = [{ start_s = 60, keep = 4 }]");
    out.ranging.settings.limits.front().keep = *satellites;
    return out;
}

}  // namespace

Outcome compare_schemes(const ProcessRequest& request) {
    const ScenarioConfig scenario = read_scenario(request.input, request.seed);
    Json rows = Json::array();
    std::string table = fmt::format("{:<36}", scenario.name), csv = scenario.compared_satellites.empty() ? "scheme" : "scheme,satellites";
    for (const Column& c : columns) {
        table += fmt::format("{:>13}", c.title);
        csv += fmt::format(",{}", c.key);
    }
    table += "\n";
    Outcome out;
    double done = 0.0;
    std::vector<std::optional<std::size_t>> counts(scenario.compared_satellites.begin(), scenario.compared_satellites.end());
    if (counts.empty()) counts.emplace_back();
    const double each = 1.0 / static_cast<double>(counts.size() * scenario.compared.size());
    for (const std::optional<std::size_t> satellites : counts) {
        const ScenarioConfig flight = with_satellites(scenario, satellites);
        if (satellites) table += fmt::format("{} satellites\n", *satellites);
        for (const std::string& name : scenario.compared) {
            const auto known = std::ranges::find(known_schemes(), name, [](const KnownScheme& k) { return std::string(k.name); });
            SettingList over = request.over({});
            over.insert(over.end(), known->settings.begin(), known->settings.end());
            WarningLog warnings;
            ResultBundle bundle = simulated_bundle(flight, over, warnings);
            fuse_and_evaluate(bundle, warnings, scenario.sim.reference_rate, {});
            Json row{{"scheme", name}};
            if (satellites) row["satellites"] = *satellites;
            table += fmt::format("  {:<34}", known->title);
            csv += "\n" + name + (satellites ? fmt::format(",{}", *satellites) : "");
            for (const Column& c : columns) {
                const double x = c.of(bundle);
                row[c.key] = number(x);
                table += fmt::format("{:>13}", cell(x));
                if (std::string_view(c.key) != "filter_s") csv += std::isfinite(x) ? fmt::format(",{:.9g}", x) : ",";   // files repeat
            }
            table += "\n";
            rows.push_back(std::move(row));
            for (const std::string& w : warnings.summary())
                if (std::ranges::find(out.warnings, w) == out.warnings.end()) out.warnings.push_back(w);
            done += each;
            if (request.progress) request.progress(done);
        }
    }
    csv = csv.replace(csv.find(",filter_s"), 9, "") + "\n";
    table += "root mean squares after settling; NEES of the position over its three degrees of freedom (1: honest); the first outage's end\n";
    out.folder = request.output.empty() ? fs::path("out") / scenario.name : request.output;
    make_folder(out.folder);
    out.json = text_of(Json{{"name", scenario.name}, {"command", "run"}, {"seed", scenario.sim.seed}, {"schemes", rows}});
    out.tables = table;
    const std::pair<const char*, std::string> files[] = {{"comparison.csv", csv}, {"summary.json", out.json}};
    for (const auto& [name, text] : files) write_text(out.files.emplace_back(out.folder / name), text);
    return out;
}

}  // namespace schuler::app
