#include "schuler/core/units.h"
#include "schuler/earth/enu.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/result_table.h"
#include "schuler/report/summary.h"
#include "schuler/study/gravity/gravity.h"

#include <cmath>

namespace schuler::study {
namespace {

using Eigen::Vector3d;

report::Json in_mgal(double x) { return report::json_number(x / units::mgal); }

/// A component of the result: errors if the truth is known, sigma and estimate at the last fix.
report::Json component(const GravityBundle& b, int axis, double sign) {
    if (!b.attainable.usable && b.verdict.usable)  // a survey that is not usable has some error in any case
        return {{"rms", nullptr}, {"spread", nullptr}, {"final", nullptr}, {"sigma", nullptr}, {"estimate", nullptr}};
    const gravimetry::SurveyEpoch& last = b.epochs().back();
    return {{"rms", in_mgal(b.errors.rms(axis))},
            {"spread", in_mgal(b.errors.spread(axis))},
            {"final", in_mgal(sign * b.errors.last(axis))},
            {"sigma", in_mgal(last.sigma_disturbance_n(axis))},
            {"estimate", in_mgal(sign * last.disturbance_n(axis))}};
}

report::ResultTable repeats_of(const GravityBundle& b) {
    report::ResultTable table{"lines that repeat each other",
                              {{"line_a", "line"},
                               {"line_b", "and line"},
                               {"length_m", "over", "m"},
                               {"mean_mgal", "mean difference", "mGal", ".3f"},
                               {"deviation_mgal", "deviation", "mGal", ".3f"}}};
    for (const gravimetry::RepeatedLine& r : b.lines.repeats)
        table.rows.push_back({r.line_a + 1, r.line_b + 1, r.length, r.mean / units::mgal, r.deviation / units::mgal});
    return table;
}

report::ResultTable changes_of(const GravityBundle& b) {
    report::ResultTable table{"changes at steps, with one sigma",
                              {{"at_s", "at", "s", "g"},
                               {"vertical_mgal/change", "up", "mGal", "+.3f"},
                               {"vertical_mgal/sigma", "sigma", "", ".3f"},
                               {"north_mgal/change", "north", "mGal", "+.3f"},
                               {"north_mgal/sigma", "sigma", "", ".3f"},
                               {"east_mgal/change", "east", "mGal", "+.3f"},
                               {"east_mgal/sigma", "sigma", "", ".3f"}}};
    for (const GravityChange& c : b.changes) {
        const Vector3d change = c.change_n / units::mgal, sigma = c.sigma_n / units::mgal;
        table.rows.push_back({c.at, -change.z(), sigma.z(), change.x(), sigma.x(), change.y(), sigma.y()});
    }
    return table;
}

report::Json separation_json(const GravityBundle& b) {
    if (b.separation.epochs == 0) return nullptr;
    const auto of_one = [&](int axis) {
        return report::Json{{"rms", in_mgal(b.separation.rms(axis))},
                            {"inside_3sigma", report::json_number(b.separation.inside_3sigma(axis))}};
    };
    return {{"epochs", b.separation.epochs}, {"vertical_mgal", of_one(2)}, {"north_mgal", of_one(0)}, {"east_mgal", of_one(1)}};
}

/// Empty if there are no rows.
std::string text_where_any(const report::ResultTable& table) { return table.rows.empty() ? "" : report::table_text(table); }

std::string field(double x, double unit, int decimals) {
    return std::isfinite(x) ? fmt::format("{:.{}f}", x / unit, decimals) : "";
}

}  // namespace

std::string gravity_csv(const GravityBundle& b, const std::vector<GravityRow>& rows) {
    const bool truth = !b.truth.empty(), separation = !b.survey.separation.empty();
    std::string out =
        "time_s,distance_m,lat_deg,lon_deg,height_m,disturbance_east_mgal,disturbance_north_mgal,disturbance_up_mgal,"
        "std_disturbance_east_mgal,std_disturbance_north_mgal,std_disturbance_up_mgal,gravity_disturbance_mgal,"
        "free_air_anomaly_mgal,eotvos_mgal,vertical_acceleration_mgal,classical_mgal,line,levelled_mgal";
    if (separation)
        out +=
            ",separation_east_mgal,separation_north_mgal,separation_up_mgal,std_separation_east_mgal,std_separation_north_mgal,"
            "std_separation_up_mgal";
    out += truth ? ",true_east_mgal,true_north_mgal,true_up_mgal\n" : "\n";
    for (const GravityRow& r : rows) {
        const Vector3d d = earth::enu_from_ned(r.disturbance_n) / units::mgal, t = earth::enu_from_ned(r.truth_n);
        out += fmt::format("{:.3f},{:.2f},{:.9f},{:.9f},{:.3f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{},{:.3f},{:.3f}",
                           r.t, r.distance, r.position.lat / units::deg, r.position.lon / units::deg, r.position.h, d.x(), d.y(),
                           d.z(), r.sigma_n.y() / units::mgal, r.sigma_n.x() / units::mgal, r.sigma_n.z() / units::mgal,
                           r.disturbance_n.z() / units::mgal, field(r.free_air, units::mgal, 4), r.eotvos / units::mgal,
                           r.vertical_acceleration / units::mgal);
        out += fmt::format(",{:.4f},{},{}", r.classical / units::mgal, r.line < 0 ? std::string{} : fmt::format("{}", r.line + 1),
                           field(r.levelled, units::mgal, 4));
        if (separation) {
            const Vector3d s = earth::enu_from_ned(r.separation_n), sigma = earth::sigma_swapped(r.sigma_separation_n);
            for (const Vector3d& v : {s, sigma})
                out += fmt::format(",{},{},{}", field(v.x(), units::mgal, 4), field(v.y(), units::mgal, 4),
                                   field(v.z(), units::mgal, 4));
        }
        if (truth)
            out += fmt::format(",{},{},{}", field(t.x(), units::mgal, 4), field(t.y(), units::mgal, 4),
                               field(t.z(), units::mgal, 4));
        out += '\n';
    }
    return out;
}

std::string gravity_geojson(const GravityBundle& b, const std::vector<GravityRow>& rows) {
    // Points at most once per second, at most ten thousand of them.
    const std::size_t stride = 1 + rows.size() / 10'000;
    report::Json features = report::Json::array();
    const auto short_mgal = [](double x) { return report::Json(std::round(1e4 * x / units::mgal) / 1e4); };
    for (std::size_t i = 0; i < rows.size(); i += stride) {
        const GravityRow& r = rows[i];
        const double lat = std::round(1e9 * r.position.lat / units::deg) / 1e9,
                     lon = std::round(1e9 * r.position.lon / units::deg) / 1e9;
        report::Json properties{{"time_s", std::round(1e3 * r.t) / 1e3},
                                {"gravity_disturbance_mgal", short_mgal(r.disturbance_n.z())},
                                {"std_mgal", short_mgal(r.sigma_n.z())},
                                {"disturbance_east_mgal", short_mgal(r.disturbance_n.y())},
                                {"disturbance_north_mgal", short_mgal(r.disturbance_n.x())}};
        if (std::isfinite(r.free_air)) properties["free_air_anomaly_mgal"] = short_mgal(r.free_air);
        features.push_back({{"type", "Feature"},
                            {"geometry", {{"type", "Point"}, {"coordinates", {lon, lat, std::round(1e3 * r.position.h) / 1e3}}}},
                            {"properties", std::move(properties)}});
    }
    const report::Json document{{"type", "FeatureCollection"}, {"name", b.run.name}, {"features", std::move(features)}};
    return document.dump(1, ' ', false, report::Json::error_handler_t::replace) + "\n";
}

std::string gravity_summary_json(const GravityBundle& b, std::size_t rows) {
    report::Json out = report::Json::parse(report::summary_json(b.run));
    const Attainability& a = b.attainable;
    out["preset"] = "gravity27";
    out["gravity"] = {{"vertical_mgal", component(b, 2, -1.0)},
                      {"north_mgal", component(b, 0, 1.0)},
                      {"east_mgal", component(b, 1, 1.0)},
                      {"attainable_vertical_mgal", in_mgal(a.vertical)},
                      {"attainable_horizontal_mgal", in_mgal(a.horizontal)},
                      {"resolved_period_s", report::json_number(a.resolved_period)},
                      {"innovations",
                       {{"nis", report::json_number(b.innovations.nis)},
                        {"low", report::json_number(b.innovations.low)},
                        {"high", report::json_number(b.innovations.high)},
                        {"epochs", b.innovations.epochs},
                        {"independence", b.biased.tests == 0 ? report::Json(nullptr)
                                                             : report::Json{{"sigmas", b.biased.sigmas},
                                                                            {"throughout", b.biased.throughout},
                                                                            {"probability", b.biased.probability}}}}},
                      {"separation", separation_json(b)},
                      {"usable", a.usable},
                      {"judged", {{"usable", b.verdict.usable}, {"reasons", b.verdict.reasons}}},
                      {"changes", report::table_json(changes_of(b))},
                      {"statement", a.statement},
                      {"epochs", rows},
                      {"classical",
                       // clang-format off
         {{"period_s", report::json_number(b.classical.period)}, {"rms", in_mgal(b.classical.rms)}, {"spread", in_mgal(b.classical.spread)}}},
        {"lines", b.lines.lines.size()},
        {"resolved_error_mgal", in_mgal(b.lines.resolved_spread)},
        {"crossovers",
         {{"count", b.lines.crossings.size()},
          {"rms_mgal", in_mgal(b.lines.rms_before)},
          {"levelled_rms_mgal", in_mgal(b.lines.rms_after)},
          {"levelled_error_mgal", in_mgal(b.lines.levelled_spread)}}},
        {"repeated_lines", report::table_json(repeats_of(b))}};
    // clang-format on
    if (!b.attainable.usable)
        out["gravity"]["classical"] = out["gravity"]["crossovers"] = out["gravity"]["repeated_lines"] = nullptr;
    return report::text_of(out);
}

std::string gravity_tables(const GravityBundle& b) {
    std::string out = report::summary_tables(b.run);
    out += fmt::format("\n{}\n", b.attainable.statement);
    if (std::isfinite(b.innovations.nis))
        out += fmt::format("innovations: NIS {:.3f} a degree of freedom, {:.3f} to {:.3f} in 95 of 100 consistent runs{}\n",
                           b.innovations.nis, b.innovations.low, b.innovations.high,
                           b.biased.tests == 0 ? "; too few for a test of their independence in time"
                                               : fmt::format("; independence in time: p-value {:.2g}", b.biased.probability));
    if (!b.attainable.usable) return out + text_where_any(changes_of(b));
    const gravimetry::SurveyEpoch& last = b.epochs().back();
    report::ResultTable table{"", {{"", "disturbance"}, {"", "at the end", "mGal", ".3f"}, {"", "sigma", "mGal", ".3f"}}};
    if (!b.truth.empty())
        table.columns.insert(table.columns.end(),
                             {{"", "error", "mGal", ".3f"}, {"", "rms", "mGal", ".3f"}, {"", "rms - mean", "mGal", ".3f"}});
    const struct {
        const char* name;
        int axis;
        double sign;
    } lines[] = {{"east", 1, 1.0}, {"north", 0, 1.0}, {"up", 2, -1.0}};
    for (const auto& l : lines) {
        const double in = l.sign / units::mgal;
        table.rows.push_back({l.name, in * last.disturbance_n(l.axis), last.sigma_disturbance_n(l.axis) / units::mgal,
                              in * b.errors.last(l.axis), b.errors.rms(l.axis) / units::mgal,
                              b.errors.spread(l.axis) / units::mgal});
    }
    out += report::table_text(table);
    out += text_where_any(changes_of(b));
    if (b.separation.epochs > 0) {
        report::ResultTable parted{
            "", {{"", "forward minus backward"}, {"", "rms", "mGal", ".3f"}, {"", "inside 3 sigma", "", ".1f%"}}};
        for (const auto& l : lines)
            parted.rows.push_back({l.name, b.separation.rms(l.axis) / units::mgal, b.separation.inside_3sigma(l.axis)});
        out += report::table_text(parted);
    }
    if (std::isfinite(b.classical.rms))
        out += fmt::format("classical pipeline, {:.3g} s: error of up {:.3f} rms, {:.3f} less its mean\n", b.classical.period,
                           b.classical.rms / units::mgal, b.classical.spread / units::mgal);
    const GravityLines& l = b.lines;
    if (std::isfinite(l.resolved_spread))
        out += fmt::format("on lines and at {:.3g} s full wavelength: error less its mean {:.3f}\n", b.attainable.resolved_period,
                           l.resolved_spread / units::mgal);
    if (!l.crossings.empty()) {
        out += fmt::format("{} lines, {} crossovers: {:.3f} rms, {:.3f} after levelling", l.lines.size(), l.crossings.size(),
                           l.rms_before / units::mgal, l.rms_after / units::mgal);
        out += std::isfinite(l.levelled_spread)
                   ? fmt::format("; error of the levelled lines less their mean {:.3f}\n", l.levelled_spread / units::mgal)
                   : "\n";
    }
    return out + text_where_any(repeats_of(b));
}

}  // namespace schuler::study
