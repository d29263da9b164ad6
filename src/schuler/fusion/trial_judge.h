// The judge of the trials by which noise and latencies are found.
#pragma once

#include "schuler/fusion/gnss_faults.h"
#include "schuler/fusion/run_pass.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace schuler::fusion {

/// A trial: one run over a limited span, judged by how probable its innovations were.
class TrialJudge {
public:
    /// `data` is that of the trials and gets their events; `start` was made with the latencies of `before`; all but these have to outlive
    /// this.
    TrialJudge(RunData& data, const Start& start, const GnssSettings& before, const FixScreen& screen);

    [[nodiscard]] Time stop() const { return data_.imu.increments[last_].time; }
    /// Components that the last cost was the mean of, by weight.
    [[nodiscard]] double count() const { return count_; }
    /// Mean negative log-likelihood per component: of the GNSS alone, or of barometer and magnetometer too.
    double cost(const Settings& settings, bool surroundings);

private:
    void find_speeds(Time stop);
    void find_spoiled();
    [[nodiscard]] bool is_spoiled(Time t) const;

    std::vector<std::pair<Time, double>> speeds_;
    std::vector<std::pair<Time, Time>> spoiled_;
    double slow_ = 0.0;
    RunData& data_;
    const Start& start_;
    double latency_, velocity_latency_;  // s, of the fixes that the start is made of
    const FixScreen& screen_;
    std::size_t last_;
    double count_ = 0.0;
};

}  // namespace schuler::fusion
