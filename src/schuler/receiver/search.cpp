#include "schuler/receiver/search.h"

#include "schuler/core/error.h"
#include "schuler/math/chi_square.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace schuler::receiver {

SearchWindow cold_window(const SignalStructure& signal, double doppler, double oscillator_offset) {
    return {signal.code_length / 2.0, doppler + std::abs(oscillator_offset) * signal.carrier_frequency};
}

SearchWindow predicted_window(const SignalStructure& signal, double std_range, double std_rate) {
    return {std::clamp(3.0 * std_range / signal.chip_length(), 0.5, signal.code_length / 2.0),
            std::max(3.0 * std_rate / signal.wavelength(), 1.0)};
}

void SearchSettings::check() const {
    if (coherent < 1 || coherent > 20)
        throw input_error(fmt::format("{} code periods of coherent search", coherent), {.key = "coherent"}, "give 1 to 20");
    if (noncoherent < 1) throw input_error(fmt::format("{} sums a dwell", noncoherent), {.key = "noncoherent"}, "give 1 or more");
    if (!(code_step > 0.0 && code_step <= 1.0))
        throw input_error(fmt::format("code cells {} chips apart", code_step), {.key = "code_step"}, "give at most 1 chip");
    if (parallel < 1) throw input_error(fmt::format("{} cells at a time", parallel), {.key = "parallel"}, "give 1 or more");
    if (!(false_alarm > 0.0 && false_alarm < 1.0))
        throw input_error(fmt::format("false alarm probability {}", false_alarm), {.key = "false_alarm"}, "give 0 to 1");
    if (confirmations < 0) throw input_error(fmt::format("{} confirmations", confirmations), {.key = "confirmations"});
}

Search::Search(const SignalStructure& signal, const CorrelatorModel& model, const SearchSettings& settings,
               const SearchWindow& window, const Replica& centre)
    : signal_(signal), model_(model), settings_((settings.check(), settings)), centre_(centre) {
    if (!(window.code > 0.0 && window.frequency > 0.0))
        throw input_error("an empty search window", {.key = "window"}, "give half widths above zero");
    const double coherent = settings.coherent * signal.code_period();
    dwell_ = coherent * settings.noncoherent;
    frequency_step_ = 1.0 / (2.0 * coherent);  // the loss at the edge of a cell is 0.9 dB
    bins_ = 2 * static_cast<int>(std::ceil(std::max(0.0, window.frequency / frequency_step_ - 0.5))) + 1;
    cells_ = 2 * static_cast<int>(std::ceil(std::max(0.0, window.code / settings.code_step - 0.5))) + 1;
    batches_ = (cells_ + settings.parallel - 1) / settings.parallel;
    const double freedom = 2.0 * settings.noncoherent;
    threshold_ = model.peak()(0.0) * math::chi_square_quantile(1.0 - settings.false_alarm, freedom);
    any_false_alarm_ = 1.0 - std::pow(1.0 - settings.false_alarm, std::min(cells_, settings.parallel));
}

namespace {

/// 0, 1, -1, 2, -2 ... for 0, 1, 2, 3, 4 ...
int outward(int i) { return i % 2 == 1 ? (i + 1) / 2 : -i / 2; }
double nearest_in_period(double chips, int length) { return chips - length * std::round(chips / length); }
/// The inverse of outward().
int place_of(long cell) { return static_cast<int>(cell > 0 ? 2 * cell - 1 : -2 * cell); }

}  // namespace

bool Search::step(const LineOfSight& truth, double cn0, math::Random& random, const LineOfSight* aid) {
    if (aid != nullptr) {
        if (aid_rate_) centre_.carrier_frequency -= (aid->rate - *aid_rate_) / signal_.wavelength();
        aid_rate_ = aid->rate;
    }
    centre_.code_rate = centre_.carrier_frequency * signal_.chips_per_cycle();
    const Replica begin = centre_;
    centre_ = centre_.after(dwell_);
    elapsed_ += dwell_;
    if (candidate_) {
        // A strong signal is also visible in neighbouring bins: the largest of five is its own, and confirms it or not.
        std::optional<Replica> best;
        double largest = threshold_;
        for (int beside = -2; beside <= 2; ++beside) {
            Replica cell = *candidate_;
            cell.carrier_frequency += beside * frequency_step_;
            // beside the window noise would be taken for it
            if (std::abs(cell.carrier_frequency - begin.carrier_frequency) > (0.5 * bins_ + 0.01) * frequency_step_) continue;
            cell.code_rate = cell.carrier_frequency * signal_.chips_per_cycle();
            const double power = power_in(cell, truth, cn0, random);
            if (power <= largest) continue;
            largest = power;
            best = cell;
        }
        candidate_.reset();
        if (best) centre_ = best->after(dwell_);
        return best.has_value();
    }
    if (penalty_ > 0) {
        --penalty_;
        return false;
    }
    const int bin = outward(next_ / batches_), batch = next_ % batches_;
    next_ = (next_ + 1) % (bins_ * batches_);

    Replica cell = begin;
    cell.carrier_frequency += bin * frequency_step_;
    cell.code_rate = cell.carrier_frequency * signal_.chips_per_cycle();
    // the code cell nearest to the signal, if it is in this batch
    const ReplicaError middle = replica_error(signal_, cell, truth, dwell_);
    const long nearest = std::lround(-nearest_in_period(middle.code, signal_.code_length) / settings_.code_step);
    const int place = place_of(nearest);
    if (place < cells_ && place / settings_.parallel == batch) {
        cell.code_phase += static_cast<double>(nearest) * settings_.code_step;
        if (power_in(cell, truth, cn0, random) > threshold_) {
            candidate_ = cell.after(dwell_);
            return false;
        }
    }
    if (random.uniform() < any_false_alarm_) penalty_ = settings_.confirmations;
    return false;
}

double Search::power_in(const Replica& cell, const LineOfSight& truth, double cn0, math::Random& random) const {
    const double coherent = dwell_ / settings_.noncoherent;
    double sum = 0.0;
    for (int i = 0; i < settings_.noncoherent; ++i) {
        ReplicaError error = replica_error(signal_, cell.after(i * coherent), truth.after(i * coherent), coherent);
        error.code = nearest_in_period(error.code, signal_.code_length);
        sum += std::norm(model_.dump(error, cn0, coherent, 1, random).prompt);
    }
    return sum;
}

}  // namespace schuler::receiver
