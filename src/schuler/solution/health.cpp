#include "schuler/solution/health.h"

#include "schuler/filter/stream/imu_intervals.h"
#include "schuler/math/quantile.h"

#include <algorithm>
#include <array>

namespace schuler::solution {
namespace {

using fusion::AidKind;
using fusion::AidRecord;
using fusion::AidStatus;

struct Instant {
    Time time;
    SourceState state;
};

SourceState state_of(const AidRecord& r) {
    switch (r.status) {
        case AidStatus::Accepted: return r.other_level ? SourceState::Distrusted : SourceState::Used;
        case AidStatus::Rejected: return SourceState::Refused;
        case AidStatus::Withheld: return SourceState::Withheld;
        case AidStatus::Excluded: return SourceState::Distrusted;
    }
    return SourceState::Used;
}

/// Median step of instants in order, s; 0 of fewer than two.
double usual_step(const std::vector<Instant>& instants) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < instants.size(); ++i)
        if (const double step = (instants[i].time - instants[i - 1].time).seconds(); step > 0.0) steps.push_back(step);
    return steps.empty() ? 0.0 : math::median(std::move(steps));
}

/// Short intervals between two of one state are counted with these.
std::vector<HealthInterval> without_brief_ones(const std::vector<HealthInterval>& all) {
    constexpr double brief = 1.0;  // s
    std::vector<HealthInterval> out;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const HealthInterval& now = all[i];
        const bool between = !out.empty() && i + 1 < all.size() && out.back().state == all[i + 1].state;
        const bool is_brief = now.state != SourceState::Silent && now.samples <= 2 && (now.to - now.from).seconds() < brief;
        if (!out.empty() && (now.state == out.back().state || (between && is_brief))) {
            out.back().to = now.to;
            out.back().samples += now.samples;
        } else {
            out.push_back(now);
        }
    }
    return out;
}

std::vector<HealthInterval> intervals_of(std::string_view source, const std::vector<Instant>& instants) {
    constexpr double least_silence = 1.0;  // s
    const double silence = std::max(least_silence, 3.0 * usual_step(instants));
    std::vector<HealthInterval> out;
    for (std::size_t i = 0; i < instants.size(); ++i) {
        const Instant& now = instants[i];
        const bool after_silence = i > 0 && (now.time - instants[i - 1].time).seconds() > silence;
        if (after_silence) out.push_back({source, SourceState::Silent, instants[i - 1].time, now.time, 0});
        if (out.empty() || after_silence || out.back().state != now.state)
            out.push_back({source, now.state, now.time, now.time, 0});
        out.back().to = now.time;
        ++out.back().samples;
    }
    return without_brief_ones(out);
}

/// The inertial unit, sample by sample without a list of them: a long log has many.
std::vector<HealthInterval> imu_intervals(const std::vector<ImuSample>& samples, const fusion::ImuSettings& settings) {
    constexpr std::string_view source = "imu";
    if (samples.size() < 2) return {};
    std::vector<double> steps;
    const std::size_t every = std::max<std::size_t>(1, samples.size() / 10'000);  // enough for their median
    for (std::size_t i = 1; i < samples.size(); i += every) steps.push_back((samples[i].time - samples[i - 1].time).seconds());
    const double nominal = math::median(std::move(steps));
    filter::HangWatch watch(std::max(nominal, 1e-6));
    std::vector<HealthInterval> out;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const Time t = samples[i].time;
        const SourceState state = watch.hangs(samples[i]) ? SourceState::Hanging : SourceState::Used;
        if (i > 0 && filter::is_hole((t - samples[i - 1].time).seconds(), nominal, settings))
            out.push_back({source, SourceState::Silent, samples[i - 1].time, t, 0});
        if (out.empty() || out.back().state != state) out.push_back({source, state, t, t, 0});
        out.back().to = t;
        ++out.back().samples;
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
    }
    return "?";
}

std::vector<HealthInterval> health_of(const LoadedDataset& data, const fusion::Result& result) {
    std::vector<HealthInterval> out = imu_intervals(data.recording.imu, data.config.filter.imu);
    constexpr std::array sources{AidKind::GnssPosition, AidKind::GnssVelocity, AidKind::Baro,   AidKind::Mag,
                                 AidKind::Odometer,     AidKind::Heading,      AidKind::Gauges, AidKind::BodyVelocity};
    for (const AidKind kind : sources) {
        std::vector<Instant> records, instants;
        for (const AidRecord& r : result.aids)
            if (r.kind == kind) records.push_back({r.stamp, state_of(r)});
        std::ranges::stable_sort(records, {}, &Instant::time);
        for (const Instant& r :
             records) {  // parts of a fix that are of different ages are one sample: what was refused of it counts
            if (instants.empty() || instants.back().time != r.time) instants.push_back(r);
            else if (r.state == SourceState::Refused) instants.back().state = r.state;
        }
        if (kind == AidKind::GnssPosition && !instants.empty()) {
            const std::size_t met = instants.size();
            const Time first = instants.front().time, last = instants.back().time;
            for (const GnssFix& fix : data.recording.gnss)
                if (fix.time >= first && fix.time <= last &&
                    !std::binary_search(instants.begin(), instants.begin() + static_cast<std::ptrdiff_t>(met),
                                        Instant{fix.time, {}},
                                        [](const Instant& x, const Instant& y) { return x.time < y.time; }))
                    instants.push_back({fix.time, SourceState::LeftOut});
            std::ranges::stable_sort(instants, {}, &Instant::time);
        }
        const std::vector<HealthInterval> found = intervals_of(filter::info_of(kind).key, instants);
        out.insert(out.end(), found.begin(), found.end());
    }
    return out;
}

}  // namespace schuler::solution
