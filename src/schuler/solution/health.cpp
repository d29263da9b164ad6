#include "schuler/solution/health.h"

#include "schuler/filter/measurement/instruments.h"
#include "schuler/filter/stream/imu_intervals.h"
#include "schuler/math/quantile.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>

namespace schuler::solution {
namespace {

using fusion::MeasurementKind;
using fusion::MeasurementRecord;
using fusion::MeasurementStatus;

struct Instant {
    Time time;
    SourceState state;
};

SourceState state_of(const MeasurementRecord& r) {
    switch (r.status) {
        case MeasurementStatus::Accepted: return r.other_level ? SourceState::Distrusted : SourceState::Used;
        case MeasurementStatus::Rejected: return SourceState::Refused;
        case MeasurementStatus::Withheld: return SourceState::Withheld;
        case MeasurementStatus::Excluded: return SourceState::Distrusted;
    }
    return SourceState::Used;
}

/// Median interval of instants in order, s; 0 for fewer than two.
double usual_step(const std::vector<Instant>& instants) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < instants.size(); ++i)
        if (const double step = (instants[i].time - instants[i - 1].time).seconds(); step > 0.0) steps.push_back(step);
    return steps.empty() ? 0.0 : math::median(std::move(steps));
}

constexpr double rare = 0.1;  // fraction of brief samples among the surrounding ones, below which they are merged with these

bool is_brief(const HealthInterval& h) {
    constexpr double brief = 1.0;  // s
    return h.samples <= 2 && (h.to - h.from).seconds() <= brief;
}

void append(HealthInterval& to, const HealthInterval& h) {
    to.to = h.to;
    to.samples += h.samples;
    to.used += h.used;
}

/// Intervals without a silence between them: brief ones within one state are merged with it; alternating states are represented
/// by one interval.
void add_settled(std::span<const HealthInterval> all, std::vector<HealthInterval>& out) {
    enum class Sort { Lasting, Rare, Unsettled };
    std::vector<Sort> sorts(all.size(), Sort::Lasting);
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (!is_brief(all[i]) || all.size() == 1) continue;
        sorts[i] = Sort::Unsettled;
        if (i == 0 || i + 1 == all.size() || all[i - 1].state != all[i + 1].state) continue;
        const auto n = static_cast<double>(all[i].samples);  // each neighbour is shared with the following brief one
        if (n < rare * (n + 0.5 * static_cast<double>(all[i - 1].samples + all[i + 1].samples))) sorts[i] = Sort::Rare;
    }
    // a longer state, but too short for the brief ones at its two ends to be rare, is part of the alternation
    for (std::size_t i = 1; i + 1 < all.size(); ++i) {
        const bool between =
            sorts[i - 1] == Sort::Unsettled && sorts[i + 1] == Sort::Unsettled && is_brief(all[i - 1]) && !is_brief(all[i]);
        const auto brief = static_cast<double>(all[i - 1].samples + all[i + 1].samples);
        if (between && 0.5 * brief >= rare * (0.5 * brief + static_cast<double>(all[i].samples))) sorts[i] = Sort::Unsettled;
    }
    const std::size_t before = out.size();
    for (std::size_t i = 0; i < all.size();) {
        std::size_t end = i + 1;
        HealthInterval one = all[i];
        if (sorts[i] == Sort::Unsettled) {
            bool refused = one.state == SourceState::Refused;
            for (; end < all.size() && sorts[end] == Sort::Unsettled; ++end) {
                refused = refused || all[end].state == SourceState::Refused;
                append(one, all[end]);
            }
            if (end > i + 1 && one.used > 0) one.state = refused ? SourceState::PartlyRefused : SourceState::PartlyUsed;
        }
        if (out.size() > before && (sorts[i] == Sort::Rare || out.back().state == one.state)) append(out.back(), one);
        else out.push_back(one);
        i = end;
    }
}

/// The time covered by a run.
struct Span {
    Time begin, end;
};

std::vector<HealthInterval> intervals_of(std::string_view source, const std::vector<Instant>& instants,
                                         const std::optional<Span>& run) {
    if (instants.empty()) return {};
    constexpr double least_silence = 1.0;  // s
    const double silence = std::max(least_silence, 3.0 * usual_step(instants));
    std::vector<HealthInterval> out, stretch;
    const auto silent = [&](Time from, Time to) {
        add_settled(stretch, out);
        stretch.clear();
        out.push_back({source, SourceState::Silent, from, to, 0, 0});
    };
    if (run && (instants.front().time - run->begin).seconds() > silence) silent(run->begin, instants.front().time);
    for (std::size_t i = 0; i < instants.size(); ++i) {
        const Instant& now = instants[i];
        if (i > 0 && (now.time - instants[i - 1].time).seconds() > silence) silent(instants[i - 1].time, now.time);
        if (stretch.empty() || stretch.back().state != now.state)
            stretch.push_back({source, now.state, now.time, now.time, 0, 0});
        const bool used = now.state == SourceState::Used;
        append(stretch.back(), {source, now.state, now.time, now.time, 1, used ? std::size_t{1} : std::size_t{0}});
    }
    if (run && (run->end - instants.back().time).seconds() > silence) silent(instants.back().time, run->end);
    add_settled(stretch, out);
    return out;
}

/// That of the solution; if its rows were written and not kept, that of the inertial samples from the start on.
std::optional<Span> span_of(const LoadedDataset& data, const fusion::Result& result) {
    const std::vector<SolutionRow>& rows = result.forward.rows;
    if (!rows.empty()) return Span{rows.front().time, rows.back().time};
    const std::vector<ImuSample>& imu = data.recording.imu;
    if (imu.empty()) return std::nullopt;
    const std::optional<Time>& stop = data.config.filter.stop;
    return Span{std::max(imu.front().time, result.findings.started_at),
                stop ? std::min(*stop, imu.back().time) : imu.back().time};
}

/// One or two fixes without a record before the first with one, or after the last, are those only partly covered by the run.
/// `records`: number of instants that are records, which come first and in order.
void drop_few_at_the_ends(std::vector<Instant>& instants, std::size_t records) {
    constexpr std::ptrdiff_t few = 2;
    const Time first = instants.front().time, last = instants[records - 1].time;
    const auto before = [&](const Instant& x) { return x.time < first; };
    const auto behind = [&](const Instant& x) { return x.time > last; };
    if (std::ranges::count_if(instants, before) <= few) std::erase_if(instants, before);
    if (std::ranges::count_if(instants, behind) <= few) std::erase_if(instants, behind);
}

/// The inertial unit, processed sample by sample without a list, because a long log has many samples.
std::vector<HealthInterval> imu_intervals(const std::vector<ImuSample>& samples, const fusion::ImuSettings& settings) {
    constexpr std::string_view source = "imu";
    if (samples.size() < 2) return {};
    std::vector<double> steps;
    const std::size_t every = std::max<std::size_t>(1, samples.size() / 10'000);  // sufficient for their median
    for (std::size_t i = 1; i < samples.size(); i += every) steps.push_back((samples[i].time - samples[i - 1].time).seconds());
    const double nominal = math::median(std::move(steps));
    filter::HangWatch watch(std::max(nominal, 1e-6));
    std::vector<HealthInterval> out;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const Time t = samples[i].time;
        const SourceState state = watch.hangs(samples[i]) ? SourceState::Hanging : SourceState::Used;
        if (i > 0 && filter::is_hole((t - samples[i - 1].time).seconds(), nominal, settings))
            out.push_back({source, SourceState::Silent, samples[i - 1].time, t, 0, 0});
        if (out.empty() || out.back().state != state) out.push_back({source, state, t, t, 0, 0});
        append(out.back(), {source, state, t, t, 1, state == SourceState::Used ? std::size_t{1} : std::size_t{0}});
    }
    return out;
}

}  // namespace

std::string_view name_of(SourceState state) {
    switch (state) {
        case SourceState::Used: return "used";
        case SourceState::Refused: return "refused";
        case SourceState::Distrusted: return "distrusted";
        case SourceState::LeftOut: return "left out";
        case SourceState::Withheld: return "withheld";
        case SourceState::Hanging: return "hanging";
        case SourceState::Silent: return "silent";
        case SourceState::PartlyRefused: return "partly refused";
        case SourceState::PartlyUsed: return "partly used";
    }
    return "?";
}

std::vector<HealthInterval> health_of(const LoadedDataset& data, const fusion::Result& result) {
    std::vector<HealthInterval> out = imu_intervals(data.recording.imu, data.config.filter.imu);
    const std::optional<Span> run = span_of(data, result);
    std::vector<MeasurementKind> sources{MeasurementKind::GnssPosition, MeasurementKind::GnssVelocity};
    sources.insert(sources.end(), filter::instrument_kinds.begin(), filter::instrument_kinds.end());
    for (const MeasurementKind kind : sources) {
        std::vector<Instant> records, instants;
        for (const MeasurementRecord& r : result.measurements)
            if (r.kind == kind) records.push_back({r.stamp, state_of(r)});
        std::ranges::stable_sort(records, {}, &Instant::time);
        for (const Instant& r :
             records) {  // parts of a fix with different ages are one sample: a refused part determines its state
            if (instants.empty() || instants.back().time != r.time) instants.push_back(r);
            else if (r.state == SourceState::Refused) instants.back().state = r.state;
        }
        if (kind == MeasurementKind::GnssPosition && !instants.empty()) {
            const std::size_t met = instants.size();
            const Time first = run ? std::min(run->begin, instants.front().time) : instants.front().time,
                       last = run ? std::max(run->end, instants.back().time) : instants.back().time;
            for (const GnssFix& fix : data.recording.gnss)
                if (fix.time >= first && fix.time <= last &&
                    !std::binary_search(instants.begin(), instants.begin() + static_cast<std::ptrdiff_t>(met),
                                        Instant{fix.time, {}},
                                        [](const Instant& x, const Instant& y) { return x.time < y.time; }))
                    instants.push_back({fix.time, SourceState::LeftOut});
            drop_few_at_the_ends(instants, met);
            std::ranges::stable_sort(instants, {}, &Instant::time);
        }
        const std::vector<HealthInterval> found = intervals_of(filter::info_of(kind).key, instants, run);
        out.insert(out.end(), found.begin(), found.end());
    }
    return out;
}

std::vector<HealthInterval> disputes_of(std::span<const HealthInterval> health) {
    constexpr std::size_t several = 4, fifth = 5;
    constexpr double long_enough = 3.0;  // s
    std::vector<HealthInterval> out;
    std::size_t refused = 0, all = 0;
    for (const HealthInterval& h : health) {
        if (h.source != filter::info_of(MeasurementKind::GnssVelocity).key) continue;
        all += h.samples;
        if (h.state != SourceState::Refused || h.samples < several || (h.to - h.from).seconds() < long_enough) continue;
        out.push_back(h);
        refused += h.samples;
    }
    if (fifth * refused > all) out.clear();
    return out;
}

}  // namespace schuler::solution
