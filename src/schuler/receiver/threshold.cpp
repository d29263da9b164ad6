#include "schuler/receiver/threshold.h"

#include "schuler/core/error.h"

#include <fmt/format.h>

#include <cmath>

namespace schuler::receiver {

namespace {

constexpr double settle = 2.0;  ///< s at 45 dB-Hz beforehand

struct Lost {
    bool carrier, code;
};

Lost run(const ThresholdStudy& study, const CorrelatorModel& model, double cn0, std::uint64_t seed) {
    const SignalStructure& signal = study.signal;
    math::Random random(seed, "threshold");
    LineOfSight truth{2.2e7, -400.0, 0.0, 0.0};
    const double aid_error = study.aid_noise * random.normal(), T = signal.code_period(), strong = cn0_from_db(45.0);
    Tracker tracker(signal, model.peak(), study.tracking);
    tracker.start(aligned_replica(signal, truth), 0);
    const int symbol = static_cast<int>(std::lround(signal.symbol_duration / T));
    const long begin = std::lround(settle / T), end = begin + std::lround(study.duration / T);
    const auto cycles = [&] { return tracker.replica().carrier_phase + truth.range / signal.wavelength(); };
    double locked_at = 0.0;
    int sign = 1;
    Lost lost{false, false};
    for (long i = 0; i < end; ++i) {
        if (i % symbol == 0) sign = random.bits() % 2 == 0 ? 1 : -1;
        if (i == begin) locked_at = std::round(2.0 * cycles()) / 2.0;
        const double t = static_cast<double>(i) * T;
        truth.jerk = study.jerk_amplitude * std::cos(turn * t);
        const ReplicaError error = replica_error(signal, tracker.replica(), truth, T);
        const Correlators dump = model.dump(error, i < begin ? strong : cn0, T, sign, random);
        truth = truth.after(T);
        LineOfSight aid = truth;
        aid.rate += aid_error;
        tracker.step(dump, study.aided ? &aid : nullptr);
        lost.carrier = lost.carrier || (i >= begin && std::abs(cycles() - locked_at) > 0.5);
    }
    lost.code = !(std::abs(tracker.replica().code_phase + truth.range / signal.chip_length()) < 0.5);
    return lost;
}

}  // namespace

void ThresholdStudy::check() const {
    tracking.check(signal);
    if (!(duration > 0.0 && duration < 1e5)) throw input_error(fmt::format("{} s of study", duration), {.key = "duration"});
    if (seeds < 1) throw input_error(fmt::format("{} seeds", seeds), {.key = "seeds"}, "give 1 or more");
    if (!(resolution > 0.01)) throw input_error(fmt::format("{} dB of resolution", resolution), {.key = "resolution"});
}

LossShares loss_shares(const ThresholdStudy& study, double db_hz) {
    study.check();
    const CorrelatorModel model(CorrelationPeak(study.signal.chip_rate, study.bandwidth), study.tracking.spacing);
    LossShares out;
    for (int seed = 1; seed <= study.seeds; ++seed) {
        const Lost lost = run(study, model, cn0_from_db(db_hz), static_cast<std::uint64_t>(seed));
        out.carrier += (lost.carrier ? 1.0 : 0.0) / study.seeds;
        out.code += (lost.code ? 1.0 : 0.0) / study.seeds;
    }
    return out;
}

LossThresholds loss_thresholds(const ThresholdStudy& study) {
    const auto half = [&](double LossShares::*share) {
        double low = 5.0, high = 45.0;
        while (high - low > study.resolution) {
            const double middle = 0.5 * (low + high);
            (loss_shares(study, middle).*share > 0.5 ? low : high) = middle;
        }
        return 0.5 * (low + high);
    };
    study.check();
    return {half(&LossShares::carrier), half(&LossShares::code)};
}

}  // namespace schuler::receiver
