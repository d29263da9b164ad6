#include "schuler/receiver/loop_theory.h"

#include "schuler/receiver/loops.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace schuler::receiver::theory {

double pll_jitter(double bandwidth, double cn0, double interval) {
    return std::sqrt(bandwidth / cn0 * (1.0 + 1.0 / (2.0 * interval * cn0)));
}

PllResponse pll_response(double bandwidth, int integration, double period) {
    // the slowest root of the standard form decays in about 5.2/bandwidth
    const int periods = static_cast<int>(std::ceil(20.0 / (bandwidth * period) / integration)) * integration;
    const double interval = integration * period;
    PllResponse out;
    {
        CarrierLoop of_noise(bandwidth, 0.0, interval);
        double phase = 0.0, command = 0.0;
        for (int k = 0; k < periods / integration; ++k) {
            const double measured = phase + 0.5 * interval * command + (k == 0 ? 1.0 : 0.0);
            phase += interval * command;
            command = of_noise.update(measured, 0.0);
            out.noise += command * command;
        }
    }
    // mean and mean square, over all instants within a sum, of the command `age` periods after a one-cycle step of the clock's phase
    std::vector<double> mean(static_cast<std::size_t>(periods), 0.0);
    double square = 0.0;
    for (int first = 0; first < integration; ++first) {  // period within its sum in which the step occurred
        CarrierLoop loop(bandwidth, 0.0, interval);
        double phase = 0.0, command = 0.0, sum = 0.0;
        for (int age = 0; age < periods; ++age) {
            sum += phase + 0.5 * period * command - (age == 0 ? 0.5 : 1.0);
            phase += period * command;
            if ((first + age + 1) % integration == 0) {
                command = loop.update(sum / integration, 0.0);
                sum = 0.0;
            }
            mean[static_cast<std::size_t>(age)] += command / integration;
            square += command * command / integration;
        }
    }
    for (const double m : mean) out.clock_common += period * m * m;
    out.clock_own = period * square - out.clock_common;
    return out;
}

double pll_command_jitter(const PllResponse& response, double cn0, double interval) {
    const double power = 2.0 * cn0 * interval;
    return std::sqrt(response.noise * (1.0 + 1.0 / power) / power) / (2.0 * std::numbers::pi);
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
