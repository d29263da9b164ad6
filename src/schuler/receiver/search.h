// Search for a signal over code and frequency: duration and success.
#pragma once

#include "schuler/receiver/correlator.h"
#include "schuler/receiver/loop_error.h"

#include <optional>

namespace schuler::receiver {

/// Search range of a signal about a replica at its expected position.
struct SearchWindow {
    double code;       ///< chips, half width; at most half a period
    double frequency;  ///< Hz, half width
};

/// No prior knowledge: the whole code, and Doppler of satellite and receiver up to `doppler` Hz plus the oscillator's fractional
/// offset.
[[nodiscard]] SearchWindow cold_window(const SignalStructure& signal, double doppler, double oscillator_offset);
/// Prediction with one sigma of pseudorange (m) and its rate (m/s), clock included: three sigma, at least half a chip and one
/// hertz. Almanac and clock alone are a warm or hot start; an inertial system makes both small [PaperA:1.1].
[[nodiscard]] SearchWindow predicted_window(const SignalStructure& signal, double std_range, double std_rate);

struct SearchSettings {
    int coherent = 1;           ///< code periods per coherent sum, at most 20
    int noncoherent = 10;       ///< number of such sums per dwell
    double code_step = 0.5;     ///< chips between cells
    int parallel = 1023;        ///< code cells evaluated in one dwell
    double false_alarm = 1e-7;  ///< probability per cell and dwell
    int confirmations = 3;      ///< additional dwells caused by a false alarm

    /// Throws Error(Input) that names the setting.
    void check() const;
};

/// Frequency cells from the centre outwards, and in each the code from the centre outwards; restarted if nothing was found. The
/// signal's cell is drawn from its correlators; for all other cells only the occurrence of a false alarm is drawn.
class Search {
public:
    Search(const SignalStructure& signal, const CorrelatorModel& model, const SearchSettings& settings,
           const SearchWindow& window, const Replica& centre);

    [[nodiscard]] double dwell() const { return dwell_; }  ///< s
    [[nodiscard]] int dwells_per_sweep() const { return bins_ * batches_; }
    /// One dwell of a signal moving as `truth` from now on; `cn0` in Hz. A cell above the threshold becomes the candidate(),
    /// which the next dwell tests together with its neighbours in frequency: true if confirmed; replica() is then the largest at
    /// the end of the dwell. An `aid` moves the window by the change of its rate.
    bool step(const LineOfSight& truth, double cn0, math::Random& random, const LineOfSight* aid = nullptr);
    /// Of the replica of a signal found: cells and bins about it.
    [[nodiscard]] ReplicaUncertainty uncertainty() const {
        return {settings_.code_step / std::sqrt(12.0), frequency_step_ / std::sqrt(12.0)};
    }
    [[nodiscard]] const Replica& replica() const { return centre_; }
    [[nodiscard]] double elapsed() const { return elapsed_; }                ///< s
    [[nodiscard]] double frequency_step() const { return frequency_step_; }  ///< Hz

    [[nodiscard]] bool candidate() const { return candidate_.has_value(); }
    /// Sum of squared prompts above which a cell counts as found.
    [[nodiscard]] double threshold() const { return threshold_; }

private:
    [[nodiscard]] double power_in(const Replica& cell, const LineOfSight& truth, double cn0, math::Random& random) const;

    SignalStructure signal_;
    CorrelatorModel model_;
    SearchSettings settings_;
    Replica centre_;
    std::optional<double> aid_rate_;
    std::optional<Replica> candidate_;
    double dwell_, frequency_step_, threshold_, any_false_alarm_;
    int bins_, cells_, batches_;
    int next_ = 0, penalty_ = 0;
    double elapsed_ = 0.0;
};

}  // namespace schuler::receiver
