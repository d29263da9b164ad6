// Search for a signal over code and frequency: how long it takes and whether it finds.
#pragma once

#include "schuler/receiver/correlator.h"

#include <optional>

namespace schuler::receiver {

/// Where a signal may be, about a replica that says where it is thought to be.
struct SearchWindow {
    double code;       ///< chips, half width; half a period at most
    double frequency;  ///< Hz, half width
};

/// Nothing known: the whole code, and Doppler of satellite and receiver up to `doppler` Hz with the oscillator's fractional
/// offset.
[[nodiscard]] SearchWindow cold_window(const SignalStructure& signal, double doppler, double oscillator_offset);
/// Prediction with one sigma of pseudorange (m) and its rate (m/s), clock included: three sigma, half a chip and a hertz at
/// least. Almanac and clock alone are a warm or hot start, an inertial system makes both small [PaperA:1.1].
[[nodiscard]] SearchWindow predicted_window(const SignalStructure& signal, double std_range, double std_rate);

struct SearchSettings {
    int coherent = 1;           ///< code periods a coherent sum, 20 at most
    int noncoherent = 10;       ///< such sums a dwell
    double code_step = 0.5;     ///< chips between cells
    int parallel = 1023;        ///< code cells looked at in one dwell
    double false_alarm = 1e-7;  ///< probability in one cell and dwell
    int confirmations = 3;      ///< further dwells that a false alarm costs

    /// Throws Error(Input) naming the setting.
    void check() const;
};

/// Cells in frequency from the middle outwards, in each the code from the middle outwards, again from the start where nothing was
/// found. The signal's cell is drawn from its correlators, of all the other cells only whether one of them gave a false alarm.
class Search {
public:
    Search(const SignalStructure& signal, const CorrelatorModel& model, const SearchSettings& settings,
           const SearchWindow& window, const Replica& centre);

    [[nodiscard]] double dwell() const { return dwell_; }  ///< s
    [[nodiscard]] int dwells_per_sweep() const { return bins_ * batches_; }
    /// One dwell of a signal that moves as `truth` says from now; `cn0` in Hz. A cell above the threshold becomes the
    /// candidate(), the next dwell tries it and its neighbours in frequency: true when it was confirmed, replica() is then the
    /// largest at the end of the dwell. An `aid` moves the window by what its rate changes.
    bool step(const LineOfSight& truth, double cn0, math::Random& random, const LineOfSight* aid = nullptr);
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
