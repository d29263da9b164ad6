#include "schuler/receiver/loops.h"

#include "schuler/core/error.h"

#include <fmt/format.h>

#include <cmath>

namespace schuler::receiver {

namespace {

void check(double bandwidth, double interval, const char* key) {
    if (!(interval > 0.0)) throw input_error(fmt::format("loop interval {} s is not positive", interval));
    if (!(bandwidth >= 0.0)) throw input_error(fmt::format("loop bandwidth {} Hz is negative", bandwidth), {.key = key});
    if (bandwidth * interval > loop::largest_product)
        throw input_error(fmt::format("loop bandwidth {} Hz is too wide for updates every {} ms", bandwidth, 1e3 * interval),
                          {.key = key},
                          fmt::format("give at most {:.3g} Hz, or shorten the integration", loop::largest_product / interval));
}

}  // namespace

CarrierLoop::CarrierLoop(double pll_bandwidth, double fll_bandwidth, double interval)
    : interval_(interval), w_phase_(loop::third_order(pll_bandwidth)), w_frequency_(loop::second_order(fll_bandwidth)) {
    check(pll_bandwidth, interval, "pll_bandwidth");
    check(fll_bandwidth, interval, "fll_bandwidth");
    if (pll_bandwidth == 0.0 && fll_bandwidth == 0.0)
        throw input_error("a carrier loop without phase and without frequency", {.key = "pll_bandwidth"},
                          "give one of them a bandwidth");
}

void CarrierLoop::start(double frequency, double rate) {
    frequency_ = frequency;
    rate_ = rate;
}

double CarrierLoop::update(double phase_error, double frequency_error) {
    const double w = w_phase_, v = w_frequency_;
    rate_ -= interval_ * (w * w * w * phase_error + v * v * frequency_error);
    frequency_ += interval_ * (rate_ - loop::a3 * w * w * phase_error - loop::a2 * v * frequency_error);
    return frequency_ - loop::b3 * w * phase_error;
}

void CarrierLoop::hand_over(double frequency, double rate) {
    frequency_ -= frequency;
    rate_ -= rate;
}

CodeLoop::CodeLoop(double bandwidth, double interval) : interval_(interval), w_(loop::second_order(bandwidth)) {
    check(bandwidth, interval, "dll_bandwidth");
    if (bandwidth == 0.0) throw input_error("a code loop without bandwidth", {.key = "dll_bandwidth"}, "give it some hertz");
}

double CodeLoop::update(double code_error) {
    rate_ -= interval_ * w_ * w_ * code_error;
    return rate_ - loop::a2 * w_ * code_error;
}

}  // namespace schuler::receiver
