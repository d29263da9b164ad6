// Evaluation of the trials that determine noise and latencies.
#pragma once

#include "schuler/fusion/faults/gnss_faults.h"
#include "schuler/fusion/run_pass.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace schuler::fusion {

/// A trial: one run over a limited interval, evaluated by the likelihood of its innovations.
class TrialJudge {
public:
    /// `data` is that of the trials and receives their events; `start` was formed with the latencies of `before`; both must outlive
    /// this object. Positions that moved away and back at once (displaced_positions) are left out: in the noise of all fixes they would
    /// make the gates so wide that the filter follows them.
    TrialJudge(RunData& data, const Start& start, const GnssSettings& before, const FixScreen& screen);

    [[nodiscard]] Time stop() const { return data_.imu.increments[last_].time; }
    /// Weighted number of components averaged in the last cost.
    [[nodiscard]] double count() const { return count_; }
    /// Mean negative log-likelihood per component: of GNSS alone, or also of barometer and magnetometer.
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
    double latency_, velocity_latency_;  // s, of the fixes used for the start
    FixScreen screen_;
    std::size_t last_;
    double count_ = 0.0;
};

}  // namespace schuler::fusion
