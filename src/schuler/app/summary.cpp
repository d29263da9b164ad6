#include "schuler/app/bundle.h"
#include "schuler/app/evaluation_json.h"
#include "schuler/app/detail/json.h"
#include "schuler/app/provenance.h"
#include "schuler/core/units.h"

#include <cmath>

namespace schuler::app {
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
    for (int i = 0; i < 3; ++i) out[std::string(1, "xyz"[i])] = {{"final", number((*v)[i] / unit)}};
    return out;
}

Json errors_of(const Evaluation& e) {
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
    return {{"mean", number(s.mean)}, {"expected", number(s.expected)}, {"low95", number(s.low95)}, {"high95", number(s.high95)}};
}

Json consistency_of(const Evaluation& e) {
    Json out;
    out["nees_position"] = e.consistency ? of(e.consistency->position) : Json(nullptr);
    out["nees_velocity"] = e.consistency ? of(e.consistency->velocity) : Json(nullptr);
    out["nees_attitude"] = e.consistency ? of(e.consistency->attitude) : Json(nullptr);
    Json nis;
    for (const char* name : {"gnss_position", "gnss_velocity", "baro", "pseudorange", "range_rate", "mag"}) nis[name] = nullptr;
    for (const AidConsistency& a : e.aids) {
        nis[std::string(a.name)] = {{"mean", number(a.nis.mean)},
                                    {"dof", number(a.nis.dof)},
                                    {"accepted", a.nis.accepted},
                                    {"rejected", a.nis.rejected},
                                    {"lag1", number(a.nis.lag1)}};
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
        row["end_horizontal_m"] = number(o.end_horizontal);
        row["max_horizontal_m"] = number(o.max_horizontal);
        row["end_vertical_m"] = number(o.end_vertical);
        row["max_3d_m"] = number(o.max_3d);
        row["inside_3sigma"] = o.epochs > 0 ? Json(o.inside_3sigma) : Json(nullptr);
        row["epochs"] = o.epochs;
        row["epochs_inside_3sigma"] = o.epochs_inside;
        list.push_back(std::move(row));
    }
    return list;
}

Json text_or_null(const std::string& s) { return s.empty() ? Json(nullptr) : Json(s); }

Json head_of(const ResultBundle& b) {
    const Config& c = b.data.config;
    Json out;
    out["name"] = b.name;
    out["command"] = b.command;
    out["scheme"] = scheme_name(c.scheme);
    out["mechanization"] = c.filter.mechanization == fusion::Mechanization::Geographic ? "geographic" : "ecef";
    out["loop"] = loop_name(c.filter.loop);
    out["smoothed"] = b.smoothed();
    out["seed"] = b.seed ? Json(*b.seed) : Json(nullptr);
    out["version"] = b.version;
    const auto& rows = b.solution().rows;
    out["duration_s"] = rows.empty() ? 0.0 : (rows.back().time - rows.front().time).seconds();
    const fusion::Counters& n = b.result.counters;
    out["imu"] = {{"epochs", n.imu_epochs}, {"rate_hz", number(n.imu_rate)}, {"gaps", n.imu_gaps}};
    out["gnss"] = {
        {"epochs", n.gnss_epochs}, {"accepted", n.gnss_accepted}, {"rejected", n.gnss_rejected}, {"withheld", n.gnss_withheld}};
    return out;
}

/// Verdicts of the integrity monitor and about refused fixes; null where there is neither.
Json integrity_of(const ResultBundle& b) {
    if (!b.data.config.filter.integrity.use && b.result.alerts.empty()) return nullptr;
    Json alerts = Json::array();
    for (const fusion::Alert& a : b.result.alerts)
        alerts.push_back({{"time_s", b.relative(a.time)},
                          {"channel", a.kind == fusion::AidKind::GnssVelocity ? "gnss_velocity" : "gnss_position"},
                          {"test", integrity_test_name(a.test)},
                          {"size", number(a.size > 0.0 ? a.size : not_given)}});
    return {{"alerts", alerts}};
}

Json events_of(const ResultBundle& b) {
    if (b.data.events.empty() || b.data.config.scheme == Scheme::Gnss) return nullptr;
    const EventRows events = event_rows(b);
    Json outside = Json::array();
    for (const NamedInstant& e : events.outside) outside.push_back({{"line", e.line}, {"time_s", e.time.seconds()}});
    return {{"asked", events.rows.size()}, {"outside", outside}};
}

Json separation_of(const Evaluation& e) {
    if (e.separation.empty()) return nullptr;
    const auto of_one = [](const analysis::SeparationSpread& s, double unit) {
        return Json{{"rms", number(s.rms / unit)}, {"inside_3sigma", number(s.inside_3sigma)}};
    };
    const analysis::SeparationSummary& s = e.separated;
    return {{"epochs", s.epochs},
            {"north_m", of_one(s.north, 1.0)},
            {"east_m", of_one(s.east, 1.0)},
            {"up_m", of_one(s.up, 1.0)},
            {"heading_deg", of_one(s.heading, units::deg)}};
}

Json findings_of(const ResultBundle& b) {
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

Json of(const Coverage& c) {
    return {{"windows", c.windows.epochs},
            {"epochs", c.epochs.epochs},
            {"inside_3sigma_epochs", number(c.epochs.share())},
            {"inside_3sigma_windows", number(c.windows.share())},
            {"inside_3sigma_horizontal", number(c.horizontal.share())},
            {"inside_3sigma_vertical", number(c.vertical.share())},
            {"held_windows", number(c.held.share())},
            {"end_rms_m", number(c.end_rms)},
            {"sigma_rms_m", number(c.sigma_rms)}};
}

/// Shares from 0 to 1; null where there is none, whose reason is among those of the verdict.
Json self_check_of(const ResultBundle& b) {
    if (!b.self_check || !b.self_check->done()) return nullptr;
    const SelfCheck& c = *b.self_check;
    Json out = of(c.coverage);
    out["length_s"] = c.length;
    out["widened"] = c.widened;
    out["before"] = c.before ? of(*c.before) : Json(nullptr);
    out["all"] = c.all ? of(*c.all) : Json(nullptr);
    out["noise_scale"] = c.tried ? Json{{"gyro", c.tried->gyro}, {"accel", c.tried->accel}, {"apart", c.tried->apart}} : Json(nullptr);
    out["growth"] = Json::array();
    for (const GrowthPoint& p : c.coverage.growth)
        out["growth"].push_back({{"since_s", p.since}, {"error_rms_m", p.error}, {"sigma_rms_m", p.sigma}, {"epochs", p.epochs}});
    out["regimes"] = Json::array();
    for (std::size_t k = 0; k < regimes; ++k) {
        const FixRegime& f = c.fixes[k];
        const Inside& w = c.coverage.by_regime[k];
        out["regimes"].push_back({{"name", name_of(static_cast<Regime>(k))},
                                  {"fixes", f.fixes},
                                  {"refused", f.refused},
                                  {"inside_3sigma", number(f.inside.share())},
                                  {"nis_per_component", number(f.nis)},
                                  {"withheld", w.epochs},
                                  {"withheld_inside_3sigma", number(w.share())}});
    }
    return out;
}

Json verdict_json(const SolutionVerdict& verdict) { return {{"word", word_of(verdict.word)}, {"reasons", verdict.reasons}}; }

Json ignored_json(const std::vector<Ignored>& ignored) {
    Json list = Json::array();
    for (const Ignored& i : ignored) list.push_back({{"key", i.key}, {"reason", i.reason}});
    return list;
}

}  // namespace

std::string_view scheme_name(Scheme scheme) {
    switch (scheme) {
        case Scheme::Gnss: return "gnss";
        case Scheme::Separate: return "separate";
        case Scheme::Tight: return "tight";
        case Scheme::Medium: return "intermediate";
        case Scheme::Deep: return "deep";
        default: return "loose";
    }
}

std::string_view integrity_test_name(fusion::IntegrityTest test) {
    switch (test) {
        case fusion::IntegrityTest::Tolerance: return "tolerance";
        case fusion::IntegrityTest::Innovation: return "innovation";
        case fusion::IntegrityTest::Slow: return "slow";
        case fusion::IntegrityTest::Readmitted: return "readmitted";
        case fusion::IntegrityTest::Jump: return "jump";
        case fusion::IntegrityTest::JumpBack: return "jump back";
        case fusion::IntegrityTest::OtherLevel: return "other level";
        case fusion::IntegrityTest::Navigation: return "navigation";
        case fusion::IntegrityTest::Receiver: return "receiver";
    }
    return "?";
}

std::string_view loop_name(fusion::Loop loop) {
    return loop == fusion::Loop::Open ? "open" : loop == fusion::Loop::Mixed ? "mixed" : "closed";
}

std::string summary_json(const ResultBundle& b) {
    Json out = head_of(b);
    const Evaluation& e = b.evaluation;
    out["reference"] = text_or_null(e.reference);
    out["errors"] = errors_of(e);
    out["settled_after_s"] = number(b.relative(e.settled));
    out["consistency"] = consistency_of(e);
    out["outages"] = of(e.outages, b.data.origin);
    out["outages_forward"] = b.smoothed() ? of(e.outages_forward, b.data.origin) : Json(nullptr);
    out["separation"] = separation_of(e);
    out["events"] = events_of(b);
    out["findings"] = findings_of(b);
    out["integrity"] = integrity_of(b);
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

std::string evaluation_json(const Evaluation& e, const std::string& solution, const std::string& reference) {
    Json out;
    out["command"] = "evaluate";
    out["solution"] = solution;
    out["reference_file"] = reference;
    out["reference"] = "file";
    out["epochs"] = e.summary.epochs;
    out["errors"] = errors_of(e);
    out["settled_after_s"] = e.errors.empty() ? Json(nullptr) : number((e.settled - e.errors.front().time).seconds());
    out["consistency"] = consistency_of(e);
    return text_of(out);
}

}  // namespace schuler::app
