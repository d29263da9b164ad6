#include "schuler/ins/increments.h"

#include "schuler/core/fail.h"
#include "schuler/math/rotation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::ins {
namespace {

using Eigen::Vector3d;
using math::Triple;

/// Sums of raw increments and the second-order corrections 1/2 int(alpha x w) and 1/2 int(alpha x f + nu x w), alpha and nu
/// being the running integrals of rate w and specific force f.
struct Sums {
    Triple alpha, nu, coning, sculling;
};

/// Sums to a step. With phi = alpha + coning the velocity increment in the axes halfway through the rotation is u = nu + sculling
/// + k phi x (phi x nu): k = (1 - sin(|phi|/2)/(|phi|/2))/|phi|^2 makes it exact for constant w and f, and with the halfway axes
/// the formula is even in time, so that no fourth-order term is missing. Then u is rotated by phi/2.
CompensatedIncrement step_from(Time time, double dt, const Sums& s) {
    const Triple phi = s.alpha + s.coning;
    const double p2 = phi.squared_norm();
    const double k = (1.0 - p2 * (1.0 / 80 - p2 * (1.0 / 13440))) * (1.0 / 24);
    // sin(|phi|/2)/|phi| and (1 - cos(|phi|/2))/|phi|^2
    const double half_sine = 0.5 * (1.0 - p2 * (1.0 / 24 - p2 * (1.0 / 1920 - p2 * (1.0 / 322560))));
    const double versine = 0.125 * (1.0 - p2 * (1.0 / 48 - p2 * (1.0 / 5760 - p2 * (1.0 / 1290240))));
    const Triple u = s.nu + s.sculling + k * phi.cross(phi.cross(s.nu));
    const Triple turned = phi.cross(u);
    return {time, dt, phi.vector(), (u + half_sine * turned + versine * phi.cross(turned)).vector()};
}

/// One cross product of samples i and j (0-based, i < j) with its weight.
struct Pair {
    int i, j;
    double weight;
};

// Weights. Under classical coning, w = (cos, sin, 0) of angle Omega t, the product of samples at distance k is 4 sin^2(lambda/2)
// sin(k lambda) along z for unit cone angle, for any such pair, and the exact correction of a step of N is (N lambda - sin N
// lambda)/2. Matching powers of lambda up to lambda^(2N-1) determines the sum of weights of each distance: N = 2: 2/3; N = 3:
// 27/20, 9/20; N = 4: 214/105, 92/105, 54/105 (as Miller and Ignagni). The sums are spread symmetrically in time, which removes
// all errors of even order in general motion. One free parameter remains for N = 4, the weight of the middle pair: it is set so
// that the fifth order is correct for any motion (rates cubic in time), not only for coning.
constexpr std::array<Pair, 1> two_sample{Pair{0, 1, 2.0 / 3}};
constexpr std::array<Pair, 3> three_sample{Pair{0, 1, 27.0 / 40}, Pair{1, 2, 27.0 / 40}, Pair{0, 2, 9.0 / 20}};
constexpr std::array<Pair, 6> four_sample{Pair{0, 1, 232.0 / 315}, Pair{2, 3, 232.0 / 315}, Pair{1, 2, 178.0 / 315},
                                          Pair{0, 2, 138.0 / 315}, Pair{1, 3, 138.0 / 315}, Pair{0, 3, 162.0 / 315}};

/// Cross products of two samples in time order.
struct Products {
    Triple coning, sculling;

    Products(const ImuIncrement& a, const ImuIncrement& b)
        : coning(Triple(a.dtheta).cross(Triple(b.dtheta))),
          sculling(Triple(a.dtheta).cross(Triple(b.dv)) + Triple(a.dv).cross(Triple(b.dtheta))) {}
};

Sums sums_of(std::span<const ImuIncrement> samples, std::span<const Pair> pairs) {
    const Triple zero(0.0, 0.0, 0.0);
    Sums s{zero, zero, zero, zero};
    for (const ImuIncrement& sample : samples) {
        s.alpha = s.alpha + Triple(sample.dtheta);
        s.nu = s.nu + Triple(sample.dv);
    }
    for (const Pair& p : pairs) {
        const ImuIncrement& a = samples[static_cast<std::size_t>(p.i)];
        const ImuIncrement& b = samples[static_cast<std::size_t>(p.j)];
        const Products products(a, b);
        s.coning = s.coning + p.weight * products.coning;
        s.sculling = s.sculling + p.weight * products.sculling;
    }
    return s;
}

/// The step of one sample corrected for linear rates through it and a neighbour; the mean rates of the two are half the sum of
/// their lengths apart. 1/12 of the cross product in time order for equal lengths.
CompensatedIncrement with_neighbour(const ImuIncrement& sample, const ImuIncrement& earlier, const ImuIncrement& later) {
    const double other = &sample == &earlier ? later.dt : earlier.dt;
    const double weight = sample.dt * sample.dt / (6.0 * other * (earlier.dt + later.dt));
    const Products products(earlier, later);
    return step_from(sample.time, sample.dt,
                     {Triple(sample.dtheta), Triple(sample.dv), weight * products.coning, weight * products.sculling});
}

bool evenly_spaced(std::span<const ImuIncrement> samples) {
    double least = samples.front().dt, most = least;
    for (const ImuIncrement& s : samples) {
        least = std::min(least, s.dt);
        most = std::max(most, s.dt);
    }
    return most <= 1.01 * least;
}

CompensatedIncrement one_by_one(std::span<const ImuIncrement> samples) {
    CompensatedIncrement step = with_neighbour(samples[0], samples[0], samples[1]);
    for (std::size_t k = 1; k < samples.size(); ++k) {
        step = combined(step, with_neighbour(samples[k], samples[k - 1], samples[k]));
    }
    return step;
}

std::span<const Pair> pairs_of(IncrementAlgorithm algorithm) {
    switch (algorithm) {
        case IncrementAlgorithm::TwoSample: return two_sample;
        case IncrementAlgorithm::ThreeSample: return three_sample;
        case IncrementAlgorithm::FourSample: return four_sample;
        case IncrementAlgorithm::OneSample:
        case IncrementAlgorithm::OneSamplePlusPrevious: break;
    }
    return {};
}

}  // namespace

int samples_per_step(IncrementAlgorithm algorithm) {
    switch (algorithm) {
        case IncrementAlgorithm::TwoSample: return 2;
        case IncrementAlgorithm::ThreeSample: return 3;
        case IncrementAlgorithm::FourSample: return 4;
        case IncrementAlgorithm::OneSample:
        case IncrementAlgorithm::OneSamplePlusPrevious: break;
    }
    return 1;
}

CompensatedIncrement compensate(const ImuIncrement& previous, const ImuIncrement& current) {
    if (previous.dt > 0.0) return with_neighbour(current, previous, current);
    const Triple zero(0.0, 0.0, 0.0);
    return step_from(current.time, current.dt, {Triple(current.dtheta), Triple(current.dv), zero, zero});
}

CompensatedIncrement compensate(std::span<const ImuIncrement> samples, IncrementAlgorithm algorithm) {
    const bool with_previous = algorithm == IncrementAlgorithm::OneSamplePlusPrevious;
    const std::size_t needed = with_previous ? 2 : static_cast<std::size_t>(samples_per_step(algorithm));
    if (samples.size() != needed) {
        fail(input_error(fmt::format("this coning algorithm takes {} increments, {} were given", needed, samples.size()), {},
                         "pass consecutive increments, as many as the algorithm takes"));
    }
    if (with_previous) return compensate(samples[0], samples[1]);
    if (samples.size() > 1 && !evenly_spaced(samples)) return one_by_one(samples);
    double dt = 0.0;
    for (const ImuIncrement& sample : samples) dt += sample.dt;
    return step_from(samples.back().time, dt, sums_of(samples, pairs_of(algorithm)));
}

CompensatedIncrement combined(const CompensatedIncrement& first, const CompensatedIncrement& second) {
    const Eigen::Quaterniond q = math::quaternion_from_rotation_vector(first.theta);
    const Vector3d theta = math::rotation_vector_from_quaternion(q * math::quaternion_from_rotation_vector(second.theta));
    const Vector3d dv = first.dv + q * second.dv;
    return {second.time, first.dt + second.dt, theta, dv};
}

}  // namespace schuler::ins
