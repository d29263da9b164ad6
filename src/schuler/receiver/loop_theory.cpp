#include "schuler/receiver/loop_theory.h"

#include "schuler/receiver/loops.h"

#include <cmath>
#include <numbers>

namespace schuler::receiver::theory {

double pll_jitter(double bandwidth, double cn0, double interval) {
    return std::sqrt(bandwidth / cn0 * (1.0 + 1.0 / (2.0 * interval * cn0)));
}

double pll_command_jitter(double bandwidth, double cn0, double interval) {
    using loop::a3, loop::b3;
    const double w = loop::third_order(bandwidth), power = 2.0 * cn0 * interval;
    const double each = (1.0 + 1.0 / power) / power / std::pow(2.0 * std::numbers::pi, 2);   // cycles^2 of one sum
    const double memory = w * w * w * (a3 * a3 * a3 + 1.0) / (2.0 * (a3 * b3 - 1.0));
    return std::sqrt(each * (std::pow(b3 * w, 2) * (1.0 + 2.0 * bandwidth * interval) + memory * interval));
}

double fll_jitter(double bandwidth, double cn0, double interval) {
    return std::sqrt(4.0 * bandwidth / cn0 * (1.0 + 1.0 / (interval * cn0))) / (2.0 * std::numbers::pi * interval);
}

double dll_jitter(double bandwidth, double cn0, double interval, const CorrelationPeak& peak, double spacing,
                  CodeDiscriminator kind) {
    const double all = peak(0.0), half = peak(spacing / 2.0), full = peak(spacing), slope = peak.slope(spacing / 2.0);
    const double coherent = bandwidth * (all - full) / (2.0 * cn0 * slope * slope);
    const double loss = kind == CodeDiscriminator::EarlyLatePower ? (all + full) / (2.0 * half * half) : 1.0 / all;
    return std::sqrt(coherent * (1.0 + loss / (interval * cn0)));
}

double pll_stress(double bandwidth, double jerk) { return -jerk / std::pow(loop::third_order(bandwidth), 3); }
double fll_stress(double bandwidth, double second_derivative) {
    return -second_derivative / std::pow(loop::second_order(bandwidth), 2);
}
double dll_stress(double bandwidth, double acceleration) { return -acceleration / std::pow(loop::second_order(bandwidth), 2); }

}  // namespace schuler::receiver::theory
