#include "schuler/study/covariance/covariance.h"

#include "schuler/core/units.h"
#include "schuler/io/atomic_file.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outputs.h"
#include "schuler/report/report.h"
#include "schuler/report/result_folder.h"
#include "schuler/report/result_table.h"
#include "schuler/study/covariance/mismatch.h"
#include "schuler/study/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::study {
namespace {

using settings::SettingList;

double horizontal(const Variances& v) { return std::sqrt(v(0) + v(1)); }

/// Root mean squares over the settled rows, and at the end of the first outage, of the quantity that `of` extracts from a row.
template <class Of>
ErrorMeasures measures(const Mismatch& m, Of of) {
    Variances mean = Variances::Zero();
    double n = 0.0;
    for (const MismatchRow& row : m.rows) {
        if (row.time_s < m.settled_s - 1e-9) continue;
        mean += of(row);
        n += 1.0;
    }
    mean /= n;
    const double end = m.outage_ends.empty() ? std::nan("") : horizontal(of(m.outage_ends.front()));
    return {horizontal(mean),
            std::sqrt(mean(2)),
            std::sqrt(mean.segment<3>(3).sum()),
            std::sqrt(mean(6) + mean(7)) / units::deg,
            std::sqrt(mean(8)) / units::deg,
            end};
}

/// Value for a requirement: at the end of the first outage, or of the path if there is none.
double required(const Mismatch& m) { return horizontal((m.outage_ends.empty() ? m.rows.back() : m.outage_ends.front()).all()); }

SettingList scenario_of(const CovarianceRequest& request) {
    SettingList base = settings::scenario_settings(request.scenario, request.seed);
    if (request.outage > 0.0) {
        const double duration = settings::scenario_from(base).sim.duration;
        // one additional fix: an end requires an epoch after the outage
        const double start = duration - request.outage - 1.0;
        if (!(start > 0.0))
            throw input_error(fmt::format("the scenario lasts {:.6g} s only", duration), {.file = {}, .key = "--outage"},
                              "give a shorter outage");
        settings::ValueTable span{{"start_s", {start}}, {"duration_s", {request.outage}}, {"sensor", {std::string("gnss")}}};
        base.push_back({"outage", {settings::ValueList{{std::move(span)}}}, {"--outage", 0, 0, {}}});
    }
    return base;
}

struct Found {
    double value = 0.0, reached = 0.0;
    std::size_t evaluations = 0;
};

/// The value of a key for which the error equals the target, by bisection; the error must increase with it.
Found found(const CovarianceRequest& request, const SettingList& base) {
    const settings::Option<settings::ScenarioConfig>* option = settings::scenario_table().find(request.find);
    if (option == nullptr)
        throw input_error(
            fmt::format("unknown key \"{}\"", request.find), {.file = {}, .key = "--find"},
            fmt::format("did you mean \"{}\"?", settings::nearest_key(request.find, settings::scenario_table().keys())));
    if (option->spec.shape != settings::Shape::Number)
        throw input_error(fmt::format("{} is no key of one number", request.find), {.file = {}, .key = "--find"},
                          "name an error of a sensor, as imu.gyro_bias_deg_h");
    const double target = *request.target;
    Found out;
    const auto flown = flight_of_mismatch(settings::scenario_from(base), request.rate);
    const auto error = [&](double x) {
        SettingList with = base;
        with.push_back({request.find, {x}, {"--find", 0, 0, request.find}});
        ++out.evaluations;
        return required(mismatch(settings::scenario_from(with), request.above, request.rate, flown.get()));
    };
    double low = std::max(0.0, option->spec.low), low_error = error(low);
    if (low_error > target)
        throw computation_error(fmt::format("the error is {:.4g} m even with {} = {:.6g}", low_error, request.find, low),
                                "give a larger --target, or improve what else makes it");
    double high = std::max(1e-6, 2.0 * low), high_error = error(std::min(high, option->spec.high));
    while (high_error < target) {
        if (high >= option->spec.high)
            throw computation_error(
                fmt::format("the error is {:.4g} m even with {} = {:.6g}", high_error, request.find, option->spec.high),
                "give a smaller --target");
        low = high;
        low_error = high_error;
        high = std::min(10.0 * high, option->spec.high);
        high_error = error(high);
    }
    while (high - low > 1e-4 * high && out.evaluations < 80) {
        const double middle = low > 0.0 ? std::sqrt(low * high) : 0.5 * high;
        const double e = error(middle);
        (e < target ? low : high) = middle;
        (e < target ? low_error : high_error) = e;
    }
    out.value = high_error > low_error ? low + (high - low) * (target - low_error) / (high_error - low_error) : high;
    out.reached = target;
    return out;
}

std::string csv_of(const Mismatch& m) {
    constexpr std::array names{"n_m", "e_m", "d_m", "vn_m_s", "ve_m_s", "vd_m_s", "tilt_n_deg", "tilt_e_deg", "heading_deg"};
    std::string out = "time_s";
    for (const char* who : {"true", "filter"})
        for (const char* name : names) out += fmt::format(",{}_std_{}", who, name);
    for (const SourceName& s : m.sources) out += fmt::format(",{}_horizontal_m", s.key);
    out += '\n';
    for (const MismatchRow& row : m.rows) {
        out += fmt::format("{:.9g}", row.time_s);
        for (const Variances& v : {row.all(), row.filter})
            for (Eigen::Index i = 0; i < 9; ++i)
                out += fmt::format(",{:.6g}", std::sqrt(std::max(0.0, v(i))) / (i < 6 ? 1.0 : units::deg));
        for (const Variances& v : row.sources) out += fmt::format(",{:.6g}", horizontal(v.cwiseMax(0.0)));
        out += '\n';
    }
    return out;
}

report::ReportInput page_of(const Mismatch& m, const report::ResultTable& table, const std::string& version) {
    report::ReportInput page;
    page.title = m.name + ": covariance";
    page.subtitle = "true covariance under the filter's gains, and the one that the filter states";
    page.version = version;
    report::Section& section = page.sections.emplace_back();
    section.title = "One sigma over time";
    section.intro = "Where the true curve is above the filter's, the filter trusts itself too much.";
    report::Group& group = section.groups.emplace_back();
    const auto panel = [&](const char* title, const char* unit, auto of) {
        report::Panel& p = group.panels.emplace_back();
        p.title = title;
        p.x_label = "time, s";
        p.y_label = unit;
        for (const bool own : {false, true}) {
            report::Series& line = p.series.emplace_back();
            line.name = own ? "filter" : "true";
            line.ink = own ? report::Ink::Sky : report::Ink::Blue;
            for (const MismatchRow& row : m.rows) {
                line.x.push_back(row.time_s);
                line.y.push_back(of(own ? row.filter : row.all()));
            }
        }
    };
    panel("Horizontal position", "m", horizontal);
    panel("Height", "m", [](const Variances& v) { return std::sqrt(v(2)); });
    panel("Velocity", "m/s", [](const Variances& v) { return std::sqrt(v.segment<3>(3).sum()); });
    panel("Tilt", "deg", [](const Variances& v) { return std::sqrt(v(6) + v(7)) / units::deg; });
    panel("Heading", "deg", [](const Variances& v) { return std::sqrt(v(8)) / units::deg; });
    group.tables.push_back(report::table_block(table));
    return page;
}

}  // namespace

report::Outcome analyze_covariance(const CovarianceRequest& request) {
    if (request.find.empty() != !request.target)
        throw input_error("--find and --target go together", {.file = {}, .key = request.find.empty() ? "--target" : "--find"},
                          "give both: --find imu.gyro_bias_deg_h --target 5");
    if (request.target && !(*request.target > 0.0))
        throw input_error("is not positive", {.file = {}, .key = "--target"}, "give metres");
    const SettingList base = scenario_of(request);
    const Mismatch m = mismatch(settings::scenario_from(base), request.above, request.rate);
    if (m.rows.empty() || m.rows.back().time_s < m.settled_s)
        throw input_error("no epoch is late enough to count", {.file = {}, .key = "--settle"},
                          "give a longer scenario, or --set run.settle_s");

    report::Outcome out;
    report::ResultTable table =
        source_table(fmt::format("{}: one sigma from {:.1f} s, by source of errors", m.name, m.settled_s));
    for (std::size_t i = 0; i < m.sources.size(); ++i)
        add_source(table, m.sources[i].key, m.sources[i].title,
                   measures(m, [i](const MismatchRow& row) -> Variances { return row.sources[i].cwiseMax(0.0); }));
    add_source(table, "all", "all together: true", measures(m, [](const MismatchRow& row) { return row.all(); }));
    add_source(table, "filter", "the filter states", measures(m, [](const MismatchRow& row) { return row.filter; }));
    out.tables = report::table_text(table);
    report::Json json{
        {"name", m.name}, {"settled_after_s", report::json_number(m.settled_s)}, {"rows", report::table_json(table)}};
    report::Json& ends = json["outages"] = report::Json::array();
    for (const MismatchRow& row : m.outage_ends)
        ends.push_back({{"end_s", row.time_s},
                        {"true_horizontal_m", report::json_number(horizontal(row.all()))},
                        {"filter_horizontal_m", report::json_number(horizontal(row.filter))}});
    json["left_out"] = m.left_out;
    if (!m.left_out.empty()) out.warnings.push_back(fmt::format("not in this analysis: {}", fmt::join(m.left_out, ", ")));
    if (request.target) {
        const Found f = found(request, base);
        const char* when = m.outage_ends.empty() ? "at the end of the path" : "at the end of the outage";
        out.tables += fmt::format("\n{} = {:.4g} gives {:.4g} m horizontal {} (one sigma, radial)\n", request.find, f.value,
                                  f.reached, when);
        json["found"] = {
            {"key", request.find}, {"value", f.value}, {"target_m", *request.target}, {"evaluations", f.evaluations}};
    }
    out.json = report::text_of(json);
    if (!request.output.empty()) {
        report::ResultFolder files(out, request.output);
        files.write("covariance.csv", csv_of(m));
        files.write("covariance.json", out.json);
        files.write("report.html", report::render(page_of(m, table, request.version)));
        files.publish("covariance.json");
    }
    return out;
}

}  // namespace schuler::study
