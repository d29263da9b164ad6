#include "schuler/receiver/sample_receiver.h"

#include "schuler/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::receiver {

namespace {

constexpr double averaged = 1.0;  ///< s, for the means at the end

double within_period(double chips) { return chips - 1023.0 * std::floor(chips / 1023.0); }

/// Continuous samples of one satellite in phase, oldest first.
SatelliteRecord::Means means_of(const std::vector<ChannelSample>& samples) {
    SatelliteRecord::Means out;
    if (samples.empty()) return out;
    const ChannelSample &first = samples.front(), &last = samples.back();
    const auto n = static_cast<double>(samples.size());
    out = {0.0, last.doppler, 0.0, 0.0};
    for (const ChannelSample& s : samples) {
        out.time += s.time / n;
        out.cn0 += s.cn0 / n;
        out.code_delay += std::remainder(s.code_delay - first.code_delay, 1023.0) / n;
    }
    out.code_delay = within_period(first.code_delay + out.code_delay);
    if (samples.size() > 1) out.doppler = (last.carrier_phase - first.carrier_phase) / (last.time - first.time);
    return out;
}

}  // namespace

SampleReceiver::SampleReceiver(const IfFormat& format, const SampleReceiverSettings& settings)
    : format_(format),
      settings_((settings.tracking.check(gps_l1_ca()), settings)),
      acquisition_(format, settings.doppler, settings.search_periods) {
    if (!(settings.search_interval > 0.0))
        throw input_error(fmt::format("{} s between searches", settings.search_interval), {.key = "search_interval"},
                          "give more than 0");
    std::vector<int> prns = settings.satellites;
    if (prns.empty())
        for (int prn = 1; prn <= 32; ++prn) prns.push_back(prn);
    std::ranges::sort(prns);
    for (std::size_t i = 0; i < prns.size(); ++i) {
        if (i > 0 && prns[i] == prns[i - 1])
            throw input_error(fmt::format("satellite {} is listed twice", prns[i]), {.key = "satellites"}, "give it once");
        (void)ca_code(prns[i]);
        records_.push_back({.prn = prns[i]});
    }
}

void SampleReceiver::process(std::span<const IfSample> samples, const Sink& sink) {
    if (samples.empty()) return;
    const std::uint64_t first = base_ + window_.size();
    window_.insert(window_.end(), samples.begin(), samples.end());
    noise_ = noise_of(samples);
    const double begin = static_cast<double>(first) / format_.sample_rate;
    if (noise_ > 0.0 && samples.size() >= piece() && begin >= next_search_) {
        search(samples, first);
        next_search_ = begin + settings_.search_interval;
    }
    std::erase_if(channels_, [&](Channel& c) { return !advance(c, sink); });
    // a code period and some additional samples: the boundary of a channel may still move back
    const std::size_t keep = std::min(window_.size(), format_.samples_per_period() + 64);
    base_ += window_.size() - keep;
    window_.erase(window_.begin(), window_.end() - static_cast<std::ptrdiff_t>(keep));
}

void SampleReceiver::search(std::span<const IfSample> samples, std::uint64_t first) {
    const SignalStructure signal = gps_l1_ca();
    const double begin = static_cast<double>(first) / format_.sample_rate;
    for (SatelliteRecord& r : records_) {
        if (r.tracked) continue;
        const Acquired acquired = acquisition_.acquire(samples, r.prn);
        if (!r.found && acquired.statistic > r.acquired.statistic) r.acquired = acquired;
        if (!acquired.found) continue;
        if (!r.found) r.found_at = begin;
        r.found = r.tracked = true;
        // to the first sample of the code
        const auto ahead =
            static_cast<std::uint64_t>(std::lround(-acquired.replica.code_phase / signal.chip_rate * format_.sample_rate));
        Replica replica = acquired.replica;
        replica.code_phase -= signal.chip_rate * begin;
        channels_.push_back({&r, SampleCorrelator(format_, r.prn, settings_.tracking.spacing),
                             Tracker(signal, CorrelationPeak(signal.chip_rate), settings_.tracking), acquired.noise / noise_,
                             first + ahead});
        channels_.back().tracker.start(replica.after(static_cast<double>(ahead) / format_.sample_rate));
    }
}

bool SampleReceiver::advance(Channel& channel, const Sink& sink) {
    const std::size_t n = format_.samples_per_period();
    const SignalStructure signal = gps_l1_ca();
    const double dt = 1.0 / format_.sample_rate, end = static_cast<double>(n) * dt;
    while (channel.next + n + 1 <= base_ + window_.size()) {
        double begin = static_cast<double>(channel.next) * dt;
        // Dumps are a whole number of samples long, code periods are not: when they differ by a sample the next dump is moved.
        const double into = std::remainder(signal.chip_rate * begin + channel.tracker.replica().code_phase, 1023.0);
        const double late = into / signal.chip_rate * format_.sample_rate;
        if (std::abs(late) > 0.75) {
            const int moved = late > 0.0 ? -1 : 1;
            if (moved > 0 || channel.next > base_) {
                channel.next += static_cast<std::uint64_t>(static_cast<std::int64_t>(moved));
                channel.tracker.pass(moved * dt);
                begin += moved * dt;
            }
        }
        const std::span<const IfSample> samples(window_.data() + (channel.next - base_), n);
        const Correlators c =
            channel.correlator.correlate(samples, begin, channel.tracker.replica(), std::max(noise_ * channel.noise_ratio, 1e-3));
        channel.next += n;
        channel.tracker.step(c);
        channel.tracker.pass(end - signal.code_period());
        dump(channel, c, sink);
        if (channel.tracker.state() == TrackState::Lost) {
            channel.record->tracked = channel.record->locked = false;
            ++channel.record->losses;
            return false;
        }
    }
    return true;
}

void SampleReceiver::dump(Channel& channel, const Correlators& c, const Sink& sink) {
    SatelliteRecord& r = *channel.record;
    const Tracker& tracker = channel.tracker;
    const double time = static_cast<double>(channel.next) / format_.sample_rate;
    const bool locked = r.locked = tracker.phase_locked();
    if (locked && !(r.locked_at <= time)) r.locked_at = time;
    const int into = tracker.dumps_into_symbol();  // for the next dump
    if (locked && channel.locked_dumps > 0 && (c.prompt.real() < 0.0) != (channel.before.real() < 0.0)) {
        ++r.dump_changes;
        if (into == 1) ++r.edge_changes;
    }
    channel.before = c.prompt;
    channel.sum += c.prompt;
    ++channel.dumps;
    channel.locked_dumps = locked ? channel.locked_dumps + 1 : 0;
    if (into != 0) return;

    const SignalStructure signal = gps_l1_ca();
    const Replica& replica = tracker.replica();
    const ChannelSample sample{time,
                               r.prn,
                               tracker.state(),
                               locked,
                               tracker.phase_lock(),
                               tracker.cn0(),
                               replica.carrier_frequency,
                               within_period(-replica.code_phase),
                               replica.carrier_phase,
                               channel.sum / std::sqrt(static_cast<double>(channel.dumps))};
    const auto whole = static_cast<int>(std::lround(signal.symbol_duration / signal.code_period()));
    if (channel.locked_dumps >= whole && channel.dumps == whole) {
        const int symbol = sample.prompt.real() < 0.0 ? -1 : 1;
        ++r.symbols;
        if (channel.symbol == -symbol) ++r.changes;
        channel.symbol = symbol;
    } else {
        channel.symbol = 0;
    }
    if (!locked) channel.recent.clear();
    if (locked) {
        if (!channel.recent.empty() && time - channel.recent.front().time >= averaged)
            channel.recent.erase(channel.recent.begin());
        channel.recent.push_back(sample);
        r.last = means_of(channel.recent);
    }
    channel.sum = 0.0;
    channel.dumps = 0;
    if (sink) sink(sample);
}

}  // namespace schuler::receiver
