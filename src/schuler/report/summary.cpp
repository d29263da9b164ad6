#include "schuler/report/summary.h"

#include "schuler/core/units.h"
#include "schuler/report/evaluation_json.h"
#include "schuler/report/inner/json.h"
#include "schuler/settings/config/config.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/events.h"
#include "schuler/solution/health.h"

#include <algorithm>
#include <cmath>

namespace schuler::report {
namespace {

Json position_of(const analysis::ErrorSummary& s) {
    return {{"east", spread(s.east)},
            {"north", spread(s.north)},
            {"up", spread(s.up)},
            {"horizontal", spread(s.horizontal)},
            {"three_d", spread(s.three_d)}};
}

Json final_of(const std::optional<Eigen::Vector3d>& v, double unit) {
    if (!v) return nullptr;
    Json out;
    for (int i = 0; i < 3; ++i) out[std::string(1, "xyz"[i])] = {{"final", json_number((*v)[i] / unit)}};
    return out;
}

Json errors_of(const solution::Evaluation& e) {
    const analysis::ErrorSummary& s = e.summary;
    if (s.epochs == 0) return nullptr;
    Json out;
    out["position_m"] = position_of(s);
    out["velocity_m_s"] = {{"east", spread(s.v_east)}, {"north", spread(s.v_north)}, {"up", spread(s.v_up)}};
    out["attitude_deg"] = {
        {"roll", spread(s.roll, units::deg)}, {"pitch", spread(s.pitch, units::deg)}, {"heading", spread(s.heading, units::deg)}};
    out["gyro_bias_deg_h"] = final_of(e.gyro_bias_error, units::deg_per_hour);
    out["accel_bias_ug"] = final_of(e.accel_bias_error, units::ug);
    out["position_m_forward"] = e.forward ? position_of(*e.forward) : Json(nullptr);
    return out;
}

Json of(const analysis::NeesStatistics& s) {
    return {{"mean", json_number(s.mean)},
            {"expected", json_number(s.expected)},
            {"low95", json_number(s.low95)},
            {"high95", json_number(s.high95)}};
}

Json consistency_of(const solution::Evaluation& e) {
    Json out;
    out["nees_position"] = e.consistency ? of(e.consistency->position) : Json(nullptr);
    out["nees_velocity"] = e.consistency ? of(e.consistency->velocity) : Json(nullptr);
    out["nees_attitude"] = e.consistency ? of(e.consistency->attitude) : Json(nullptr);
    Json nis;
    for (const char* name : {"gnss_position", "gnss_velocity", "baro", "pseudorange", "range_rate", "mag"}) nis[name] = nullptr;
    for (const solution::MeasurementConsistency& a : e.measurements) {
        nis[std::string(a.name)] = {{"mean", json_number(a.nis.mean)},
                                    {"dof", json_number(a.nis.dof)},
                                    {"accepted", a.nis.accepted},
                                    {"rejected", a.nis.rejected},
                                    {"lag1", json_number(a.nis.lag1)}};
    }
    out["nis"] = std::move(nis);
    return out;
}

Json of(const std::vector<analysis::OutageStatistics>& outages, Time origin) {
    Json list = Json::array();
    for (const analysis::OutageStatistics& o : outages) {
        Json row;
        row["start_s"] = (o.span.start - origin).seconds();
        row["duration_s"] = o.span.duration.seconds();
        row["end_horizontal_m"] = json_number(o.end_horizontal);
        row["max_horizontal_m"] = json_number(o.max_horizontal);
        row["end_vertical_m"] = json_number(o.end_vertical);
        row["max_3d_m"] = json_number(o.max_3d);
        row["inside_3sigma"] = o.epochs > 0 ? Json(o.inside_3sigma) : Json(nullptr);
        row["epochs"] = o.epochs;
        row["epochs_inside_3sigma"] = o.epochs_inside;
        list.push_back(std::move(row));
    }
    return list;
}

Json text_or_null(const std::string& s) { return s.empty() ? Json(nullptr) : Json(s); }

Json head_of(const solution::ResultBundle& b) {
    const settings::Config& c = b.data.config;
    Json out;
    out["name"] = b.name;
    out["command"] = b.command;
    out["scheme"] = settings::scheme_name(c.scheme);
    out["mechanization"] = c.filter.mechanization == fusion::Mechanization::Geographic ? "geographic" : "ecef";
    out["loop"] = settings::loop_name(b.result.findings.in_force ? b.result.findings.in_force->loop : c.filter.loop);
    out["smoothed"] = b.smoothed();
    out["point"] = b.at_antenna() ? "antenna" : "imu";
    out["seed"] = b.seed ? Json(*b.seed) : Json(nullptr);
    out["version"] = b.version;
    const auto& rows = b.solution().rows;
    out["duration_s"] = rows.empty() ? 0.0 : (rows.back().time - rows.front().time).seconds();
    const fusion::Counters& n = b.result.counters;
    out["imu"] = {{"epochs", n.imu_epochs}, {"rate_hz", json_number(n.imu_rate)}, {"gaps", n.imu_gaps}};
    out["gnss"] = {
        {"epochs", n.gnss_epochs}, {"accepted", n.gnss_accepted}, {"rejected", n.gnss_rejected}, {"withheld", n.gnss_withheld}};
    return out;
}

/// Verdicts of the integrity monitor and about refused fixes; null if there are none.
Json integrity_of(const solution::ResultBundle& b) {
    if (!b.data.config.filter.integrity.use && b.result.alerts.empty()) return nullptr;
    Json alerts = Json::array();
    for (const fusion::Alert& a : b.result.alerts)
        alerts.push_back({{"time_s", b.relative(a.time)},
                          {"channel", a.kind == fusion::MeasurementKind::GnssVelocity ? "gnss_velocity" : "gnss_position"},
                          {"test", integrity_test_name(a.test)},
                          {"size", json_number(a.size > 0.0 ? a.size : not_given)}});
    return {{"alerts", alerts}};
}

Json events_of(const solution::ResultBundle& b) {
    if (b.data.events.empty() || b.data.config.scheme == settings::Scheme::Gnss) return nullptr;
    const solution::EventRows events = solution::event_rows(b);
    Json outside = Json::array();
    for (const NamedInstant& e : events.outside) outside.push_back({{"line", e.line}, {"time_s", e.time.seconds()}});
    return {{"asked", events.rows.size()}, {"outside", outside}};
}

Json separation_of(const solution::Evaluation& e) {
    if (e.separation.empty()) return nullptr;
    const auto of_one = [](const analysis::SeparationSpread& s, double unit) {
        return Json{{"rms", json_number(s.rms / unit)}, {"inside_3sigma", json_number(s.inside_3sigma)}};
    };
    const analysis::SeparationSummary& s = e.separated;
    return {{"epochs", s.epochs},
            {"north_m", of_one(s.north, 1.0)},
            {"east_m", of_one(s.east, 1.0)},
            {"up_m", of_one(s.up, 1.0)},
            {"heading_deg", of_one(s.heading, units::deg)}};
}

Json findings_of(const solution::ResultBundle& b) {
    const fusion::Findings& f = b.result.findings;
    const Eigen::Vector3d m = f.mounting_rpy / units::deg;
    return {{"aligned_at_s", b.relative(f.aligned_at)},
            {"alignment", text_or_null(f.alignment)},
            {"mounting_deg", {m.x(), m.y(), m.z()}},
            {"latency_s",
             {{"position", f.position_latency},
              {"velocity", f.velocity_latency},
              {"height", f.height_latency},
              {"velocity_down", f.velocity_down_latency}}},
            {"lever_arm_m", {f.lever_arm_b.x(), f.lever_arm_b.y(), f.lever_arm_b.z()}}};
}

Json of(const solution::Coverage& c) {
    return {{"windows", c.windows.epochs},
            {"epochs", c.epochs.epochs},
            {"inside_3sigma_epochs", json_number(c.epochs.share())},
            {"inside_3sigma_windows", json_number(c.windows.share())},
            {"inside_3sigma_horizontal", json_number(c.horizontal.share())},
            {"inside_3sigma_vertical", json_number(c.vertical.share())},
            {"held_windows", json_number(c.held.share())},
            {"end_rms_m", json_number(c.end_rms)},
            {"sigma_rms_m", json_number(c.sigma_rms)}};
}

/// Fractions from 0 to 1; null if there are none, the reason being among those of the verdict.
Json self_check_of(const solution::ResultBundle& b) {
    if (!b.self_check || !b.self_check->done()) return nullptr;
    const solution::SelfCheck& c = *b.self_check;
    Json out = of(c.coverage);
    out["length_s"] = c.length;
    out["widened"] = c.widened;
    out["before"] = c.before ? of(*c.before) : Json(nullptr);
    out["all"] = c.all ? of(*c.all) : Json(nullptr);
    out["noise_scale"] =
        c.tried ? Json{{"gyro", c.tried->gyro}, {"accel", c.tried->accel}, {"apart", c.tried->apart}} : Json(nullptr);
    out["growth"] = Json::array();
    for (const solution::GrowthPoint& p : c.coverage.growth)
        out["growth"].push_back({{"since_s", p.since}, {"error_rms_m", p.error}, {"sigma_rms_m", p.sigma}, {"epochs", p.epochs}});
    out["regimes"] = Json::array();
    for (std::size_t k = 0; k < solution::regimes; ++k) {
        const solution::FixRegime& f = c.fixes[k];
        const solution::Inside& w = c.coverage.by_regime[k];
        out["regimes"].push_back({{"name", name_of(static_cast<solution::Regime>(k))},
                                  {"fixes", f.fixes},
                                  {"refused", f.refused},
                                  {"inside_3sigma", json_number(f.inside.share())},
                                  {"nis_per_component", json_number(f.nis)},
                                  {"withheld", w.epochs},
                                  {"withheld_inside_3sigma", json_number(w.share())}});
    }
    return out;
}

/// Results of carrier phases relative to a base; null if there are none.
Json carrier_of(const solution::ResultBundle& b) {
    const auto& epochs = b.data.carrier.epochs;
    if (epochs.empty()) return nullptr;
    const auto count = [&](ppk::Quality quality) { return std::ranges::count(epochs, quality, &ppk::EpochSolution::quality); };
    return {{"epochs", epochs.size()},
            {"fixed", count(ppk::Quality::Fixed)},
            {"float", count(ppk::Quality::Float)},
            {"single", count(ppk::Quality::Single)}};
}

/// Carrier phases whose ambiguities are states of the filter; null if there are none.
Json ambiguities_of(const solution::ResultBundle& b) {
    const auto& rows = b.result.forward.carriers;
    if (rows.empty()) return nullptr;
    int phases = 0, slipped = 0, held = 0, doubted = 0;
    for (const fusion::CarrierRow& r : rows)
        phases += r.phases, slipped += r.slipped, held += r.held, doubted += r.doubted ? 1 : 0;
    return {{"epochs", rows.size()},
            {"with_integers", std::ranges::count_if(rows, [](const fusion::CarrierRow& r) { return r.held > 0; })},
            {"phases", phases},
            {"slipped", slipped},
            {"doubted", doubted},
            {"held", held}};
}

Json health_json(const solution::ResultBundle& b) {
    Json list = Json::array();
    for (const solution::HealthInterval& h : solution::health_of(b.data, b.result))
        // clang-format off
        list.push_back({{"source", h.source}, {"state", name_of(h.state)}, {"from_s", json_number(b.relative(h.from))},
                        {"to_s", json_number(b.relative(h.to))}, {"samples", h.samples}, {"used", h.used}});
    // clang-format on
    return list;
}

/// Null if none was formed: surveys and campaigns are judged by other figures. A verdict always has reasons.
Json verdict_json(const solution::SolutionVerdict& verdict) {
    if (verdict.reasons.empty()) return nullptr;
    return {{"word", solution::word_of(verdict.word)}, {"reasons", verdict.reasons}};
}

}  // namespace

Json ignored_json(const std::vector<solution::Ignored>& ignored) {
    Json list = Json::array();
    for (const solution::Ignored& i : ignored) list.push_back({{"key", i.key}, {"reason", i.reason}});
    return list;
}

std::string_view integrity_test_name(fusion::IntegrityTest test) {
    switch (test) {
        case fusion::IntegrityTest::Tolerance: return "tolerance";
        case fusion::IntegrityTest::Innovation: return "innovation";
        case fusion::IntegrityTest::Slow: return "slow";
        case fusion::IntegrityTest::Readmitted: return "readmitted";
        case fusion::IntegrityTest::Returned: return "returned";
        case fusion::IntegrityTest::Unjudged: return "unjudged";
        case fusion::IntegrityTest::Jump: return "jump";
        case fusion::IntegrityTest::JumpBack: return "jump back";
        case fusion::IntegrityTest::OtherLevel: return "other level";
        case fusion::IntegrityTest::Navigation: return "navigation";
        case fusion::IntegrityTest::Receiver: return "receiver";
    }
    return "?";
}

std::string summary_json(const solution::ResultBundle& b) {
    Json out = head_of(b);
    const solution::Evaluation& e = b.evaluation;
    out["reference"] = text_or_null(e.reference);
    out["errors"] = errors_of(e);
    out["settled_after_s"] = json_number(b.relative(e.settled));
    out["consistency"] = consistency_of(e);
    out["outages"] = of(e.outages, b.data.origin);
    out["outages_forward"] = b.smoothed() ? of(e.outages_forward, b.data.origin) : Json(nullptr);
    out["separation"] = separation_of(e);
    out["events"] = events_of(b);
    out["findings"] = findings_of(b);
    out["integrity"] = integrity_of(b);
    out["health"] = health_json(b);
    out["carrier"] = carrier_of(b);
    out["ambiguities"] = ambiguities_of(b);
    out["facts"] = facts_json(b.facts);
    out["ignored"] = ignored_json(b.ignored);
    out["verdict"] = verdict_json(b.verdict);
    out["self_check"] = self_check_of(b);
    out["gravity"] = nullptr;
    out["montecarlo"] = nullptr;
    out["timing"] = timing(b.timing, b.result.counters.imu_epochs, b.result.filter_seconds);
    out["warnings"] = b.warnings;
    return text_of(out);
}

std::string evaluation_json(const solution::Evaluation& e, const std::string& solution, const std::string& reference) {
    Json out;
    out["command"] = "evaluate";
    out["solution"] = solution;
    out["reference_file"] = reference;
    out["reference"] = "file";
    out["epochs"] = e.summary.epochs;
    out["errors"] = errors_of(e);
    out["settled_after_s"] = e.errors.empty() ? Json(nullptr) : json_number((e.settled - e.errors.front().time).seconds());
    out["consistency"] = consistency_of(e);
    return text_of(out);
}

}  // namespace schuler::report
