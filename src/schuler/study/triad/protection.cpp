#include "schuler/study/triad/protection.h"

#include "schuler/core/parallel.h"
#include "schuler/earth/earth.h"
#include "schuler/fusion/run_filter.h"
#include "schuler/math/binomial.h"
#include "schuler/math/random.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outcome.h"
#include "schuler/report/outputs.h"
#include "schuler/report/result_folder.h"
#include "schuler/report/result_table.h"
#include "schuler/study/parts.h"
#include "schuler/study/triad/triad.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

namespace schuler::study {
namespace {

constexpr double earliest = 90.0, scatter = 20.0, followed = 40.0, at_once = 3.0;  // s
constexpr double least_size = 2.0, most_size = 60.0;                               // m
constexpr double ramp_followed = 100.0, least_ramp = 0.1, most_ramp = 5.0;         // s, m/s

double followed_for(FaultKind kind) { return kind.ramp ? ramp_followed : followed; }

/// Draws the faults and injects them into the ranges.
void inject(ProtectionTrial& trial, RangingLog& log, Time origin, math::Random& random, FaultKind kind) {
    trial.start = std::floor(earliest + scatter * random.uniform());
    const auto first =
        std::ranges::find_if(log.epochs, [&](const RangeEpoch& e) { return (e.time - origin).seconds() >= trial.start - 1e-6; });
    if (first == log.epochs.end()) throw computation_error("a flight has no ranges", "look at its settings");
    const int faults = kind.twice ? 2 : 1;
    for (int i = 0; i < faults; ++i) {
        const auto at = static_cast<std::size_t>(i);
        do {
            const auto which = static_cast<std::size_t>(random.uniform() * static_cast<double>(first->count));
            trial.satellite[at] = log.samples[first->first + std::min(which, first->count - 1)].source;
        } while (at == 1 && trial.satellite[1] == trial.satellite[0]);
        const bool ramp = kind.ramp;
        const double drawn = random.uniform();
        const double size =
            ramp ? least_ramp * std::pow(most_ramp / least_ramp, drawn) : least_size + (most_size - least_size) * drawn;
        trial.size[at] = random.uniform() < 0.5 ? -size : size;
        for (auto e = first; e != log.epochs.end(); ++e)
            for (std::size_t k = e->first; k < e->first + e->count; ++k)
                if (log.samples[k].source == trial.satellite[at])
                    log.samples[k].pseudorange += trial.size[at] * (ramp ? (e->time - first->time).seconds() : 1.0);
    }
}

/// Evaluates one epoch with the errors and levels, horizontal and vertical.
void judge(ProtectionTrial& trial, double t, const std::array<double, 2>& error, const fusion::ProtectionRow& row) {
    if (t < trial.start) {
        trial.alarm_before = trial.alarm_before || row.alarm >= 0;
        ++trial.epochs_before;
        return;
    }
    ++trial.epochs;
    if (row.alarm >= 0 && !trial.alarm) {
        trial.alarm = true;
        trial.time_to_alarm = t - trial.start;
    }
    trial.right = trial.right || (row.alarm >= 0 && (row.alarm == trial.satellite[0] || row.alarm == trial.satellite[1]));
    const std::array<double, 2> level{row.horizontal, row.vertical};
    for (std::size_t i = 0; i < 2; ++i) {
        trial.level[i] += level[i] * level[i];
        if (error[i] > level[i]) ++(trial.alarm ? trial.late : trial.misleading)[i];
        if (!trial.alarm) trial.worst[i] = std::max(trial.worst[i], error[i] / level[i]);
    }
}

/// Number of events in trials.
struct Share {
    const char *key, *title;  ///< without a key: for display only
    std::size_t events = 0, trials = 0;
};

/// With confidence bounds of the fractions.
report::ResultTable table_of_shares(std::string title, std::span<const Share> shares) {
    report::ResultTable table{std::move(title),
                              {{"", "faults and flights"},
                               {"events", "events"},
                               {"trials", "of"},
                               {"share", "share", "", ".2e"},
                               {"low95", "95 %: from", "", ".2e"},
                               {"high95", "to", "", ".2e"}}};
    for (const Share& s : shares) {
        const auto [low, high] = math::binomial_bounds(s.events, s.trials, 0.95);
        const double share = s.trials > 0 ? static_cast<double>(s.events) / static_cast<double>(s.trials) : not_given;
        table.rows.push_back({s.title, s.events, s.trials, share, low, high});
    }
    return table;
}

std::string csv_of(const std::vector<ProtectionTrial>& trials) {
    std::string text =
        "start_s,size_1_m,size_2_m,false_alarm,alarm,right,time_to_alarm_s,excluded,misleading_horizontal,misleading_vertical,"
        "late_horizontal,late_vertical,hpl_m,vpl_m,worst_horizontal,worst_vertical\n";
    for (const ProtectionTrial& t : trials)
        text += fmt::format("{:g},{:.4f},{:.4f},{:d},{:d},{:d},{:g},{:d},{},{},{},{},{:.3f},{:.3f},{:.4f},{:.4f}\n", t.start,
                            t.size[0], t.size[1], t.alarm_before, t.alarm, t.right, t.time_to_alarm, t.excluded, t.misleading[0],
                            t.misleading[1], t.late[0], t.late[1], t.level[0], t.level[1], t.worst[0], t.worst[1]);
    return text;
}

}  // namespace

ProtectionTrial run_protection_trial(std::size_t j, std::uint64_t seed, FaultKind kind,
                                     const fusion::ProtectionSettings& settings) {
    TriadCase all;
    all.satellites = 99;
    const std::uint64_t own = 1'000'000 * seed + j;
    TriadFlight flight = triad_flight(all, j % triad_geometries, own, earliest + scatter + followed_for(kind));
    math::Random random(own, "protection");
    ProtectionTrial trial;
    inject(trial, flight.recording.ranges, flight.origin, random, kind);
    flight.settings.ranging.protection = settings;
    flight.settings.ranging.protection.use = true;
    WarningLog unheard;
    const fusion::Result result = fusion::run_filter(flight.recording, flight.settings, unheard);
    std::map<Time, const fusion::StateRow*> states;
    for (const fusion::StateRow& s : result.forward.states) states[s.time] = &s;
    for (const fusion::ProtectionRow& row : result.forward.protection) {
        const double t = (row.time - flight.origin).seconds();
        const auto at = static_cast<std::size_t>(std::llround(t));
        const auto state = states.find(row.time);
        if (state == states.end() || at >= flight.recording.reference.size() || t >= trial.start + followed_for(kind)) continue;
        const Eigen::Vector3d error =
            earth::ned_difference(flight.settings.earth, state->second->nav.position, flight.recording.reference[at].position);
        judge(trial, t, {error.head<2>().norm(), std::abs(error.z())}, row);
        if (t >= trial.start && t < trial.start + at_once && row.excluded > 0) trial.excluded = true;
    }
    if (trial.epochs == 0) throw computation_error("a flight ended before its fault", "look at its settings");
    for (double& level : trial.level) level = std::sqrt(level / static_cast<double>(trial.epochs));
    return trial;
}

report::Outcome analyze_protection(const ProtectionRequest& request) {
    std::vector<ProtectionTrial> trials(request.runs);
    for_each_run(
        request.runs, request.jobs,
        [&](std::size_t j) { trials[j] = run_protection_trial(j, request.seed, request.kind, request.settings); },
        request.progress);
    const std::size_t n = trials.size();
    std::array shares{Share{"misleading_epochs", "misleading epochs (error above its level, no alarm)"},
                      Share{"misleading_faults", "faults with a misleading epoch", 0, n},
                      Share{"", "  horizontally", 0, n},
                      Share{"", "  vertically", 0, n},
                      Share{"late_faults", "faults with an error above its level after the alarm", 0, n},
                      Share{"alarms", "faults that raised an alarm", 0, n},
                      Share{"named_rightly", "  of these named rightly"},
                      Share{"excluded", "faults with ranges left out within 3 s", 0, n},
                      Share{"unnoticed", "faults neither left out nor alarmed", 0, n},
                      Share{"false_alarms", "flights with a false alarm before the fault", 0, n}};
    auto& [misleading_epochs, misleading, horizontal, vertical, late, alarms, right, excluded, neither, false_alarms] = shares;
    double level_horizontal = 0.0, level_vertical = 0.0, worst_horizontal = 0.0, worst_vertical = 0.0;
    for (const ProtectionTrial& t : trials) {
        false_alarms.events += t.alarm_before;
        alarms.events += t.alarm;
        right.trials += t.alarm;
        right.events += t.right;
        excluded.events += t.excluded;
        neither.events += !t.alarm && !t.excluded;
        horizontal.events += t.misleading[0] > 0;
        vertical.events += t.misleading[1] > 0;
        misleading.events += t.misleading[0] + t.misleading[1] > 0;
        misleading_epochs.events += static_cast<std::size_t>(std::max(t.misleading[0], t.misleading[1]));
        misleading_epochs.trials += static_cast<std::size_t>(t.epochs);
        late.events += t.late[0] + t.late[1] > 0;
        level_horizontal += t.level[0] / static_cast<double>(trials.size());
        level_vertical += t.level[1] / static_cast<double>(trials.size());
        worst_horizontal = std::max(worst_horizontal, t.worst[0]);
        worst_vertical = std::max(worst_vertical, t.worst[1]);
    }
    report::Outcome out;
    const auto [twice, ramp] = request.kind;
    const report::ResultTable table = table_of_shares(
        fmt::format("{} {} of {:g} to {:g} {}, navigation grade, all satellites in view; stated risk {:g} an epoch", request.runs,
                    twice  ? (ramp ? "double ramps" : "double faults")
                    : ramp ? "ramps"
                           : "single faults",
                    ramp ? least_ramp : least_size, ramp ? most_ramp : most_size, ramp ? "m/s" : "m",
                    request.settings.missed_detection),
        shares);
    out.tables = report::table_text(table);
    out.tables += fmt::format(
        "  mean level {:.1f} m horizontally, {:.1f} m vertically; largest error over its level without alarm {:.2f}, {:.2f}\n",
        level_horizontal, level_vertical, worst_horizontal, worst_vertical);
    report::Json json{{"runs", request.runs},
                      {"double", twice},
                      {"ramp", ramp},
                      {"missed_detection", request.settings.missed_detection},
                      {"false_alarm", request.settings.false_alarm}};
    for (std::size_t i = 0; i < shares.size(); ++i)
        if (*shares[i].key != '\0') report::put_row(json[shares[i].key], table.columns, table.rows[i]);
    json["level_m"] = {{"horizontal", level_horizontal}, {"vertical", level_vertical}};
    json["worst_ratio"] = {{"horizontal", worst_horizontal}, {"vertical", worst_vertical}};
    out.json = report::text_of(json);
    if (!request.output.empty()) {
        report::ResultFolder files(out, request.output);
        files.write("trials.csv", csv_of(trials));
        files.write("summary.json", out.json);
        files.publish();
    }
    return out;
}

}  // namespace schuler::study
