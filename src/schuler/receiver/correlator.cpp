#include "schuler/receiver/correlator.h"

#include "schuler/core/error.h"

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include <cmath>
#include <numbers>

namespace schuler::receiver {

using std::numbers::pi;

Replica Replica::after(double dt) const {
    return {code_phase + code_rate * dt, code_rate, carrier_phase + carrier_frequency * dt, carrier_frequency};
}

Replica aligned_replica(const SignalStructure& signal, const LineOfSight& truth) {
    const double doppler = -truth.rate / signal.wavelength();
    return {-truth.range / signal.chip_length(), doppler * signal.chips_per_cycle(), -truth.range / signal.wavelength(), doppler};
}

LineOfSight followed(const SignalStructure& signal, const Replica& replica) {
    return {-replica.code_phase * signal.chip_length(), -replica.carrier_frequency * signal.wavelength(), 0.0, 0.0};
}

ReplicaError replica_error(const SignalStructure& signal, const Replica& replica, const LineOfSight& truth, double duration) {
    const Replica middle = replica.after(duration / 2.0);
    const LineOfSight there = truth.after(duration / 2.0);
    const double cycles = middle.carrier_phase + there.range / signal.wavelength();
    return {middle.code_phase + there.range / signal.chip_length(), 2.0 * pi * (cycles - std::round(cycles)),
            middle.carrier_frequency + there.rate / signal.wavelength()};
}

CorrelatorModel::CorrelatorModel(const CorrelationPeak& peak, double spacing) : peak_(peak), spacing_(spacing) {
    if (!(spacing > 0.0 && spacing < 2.0))
        throw input_error(fmt::format("correlator spacing {} chips is not between 0 and 2", spacing), {.key = "spacing"},
                          "give early to late in chips, 1 or less");
    const double all = peak(0.0), half = peak(spacing / 2.0), full = peak(spacing);
    covariance_ << all, half, full, half, all, half, full, half, all;
    // Early minus twice prompt plus late has almost no noise in a narrow band at a small spacing: the root must permit a rank of
    // two.
    const Eigen::LLT<Eigen::Matrix3d> factor(covariance_ + 1e-12 * Eigen::Matrix3d::Identity());
    if (factor.info() != Eigen::Success)
        throw computation_error(fmt::format("correlators {} chips apart cannot be distinguished in this bandwidth", spacing),
                                "widen the front end or the spacing");
    root_ = factor.matrixL();
}

Correlators CorrelatorModel::expected(const ReplicaError& error, double cn0, double duration, int sign) const {
    const double x = pi * error.frequency * duration;
    const double sinc = std::abs(x) < 1e-4 ? 1.0 - x * x / 6.0 : std::sin(x) / x;
    const std::complex<double> carrier = std::polar(1.0, -error.phase) * (sign * sinc * std::sqrt(2.0 * cn0 * duration));
    return {carrier * peak_(error.code + spacing_ / 2.0), carrier * peak_(error.code),
            carrier * peak_(error.code - spacing_ / 2.0)};
}

Correlators CorrelatorModel::dump(const ReplicaError& error, double cn0, double duration, int sign, math::Random& random) const {
    Correlators out = expected(error, cn0, duration, sign);
    const Eigen::Vector3d i = random.normal3(), q = random.normal3();
    const auto noise = [&](int row) {
        std::complex<double> sum = 0.0;
        for (int k = 0; k <= row; ++k) sum += root_(row, k) * std::complex<double>(i[k], q[k]);
        return sum;
    };
    out.early += noise(0);
    out.prompt += noise(1);
    out.late += noise(2);
    return out;
}

}  // namespace schuler::receiver
