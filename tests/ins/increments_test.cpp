#include "schuler/ins/increments.h"

#include "schuler/core/error.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <vector>

namespace schuler::ins {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

struct Case {
    IncrementAlgorithm algorithm;
    double lambda;  ///< phase of the oscillation in one raw interval, rad
    const char* name;
};

/// Second-order residual of a step under rotation at phase lambda a sample, for unit amplitude: what the algorithm's weights give
/// minus the exact (N lambda - sin N lambda)/2, from the trigonometric sums of each algorithm as published.
double residual(IncrementAlgorithm algorithm, double lambda) {
    const double pair = 4.0 * std::pow(std::sin(0.5 * lambda), 2);
    const auto at = [&](int k) { return pair * std::sin(k * lambda); };
    const auto exact = [&](int n) { return 0.5 * (n * lambda - std::sin(n * lambda)); };
    switch (algorithm) {
        case IncrementAlgorithm::OneSample: return -exact(1);
        case IncrementAlgorithm::OneSamplePlusPrevious: return at(1) / 12.0 - exact(1);
        case IncrementAlgorithm::TwoSample: return 2.0 / 3 * at(1) - exact(2);
        case IncrementAlgorithm::ThreeSample: return 27.0 / 20 * at(1) + 9.0 / 20 * at(2) - exact(3);
        case IncrementAlgorithm::FourSample: return 214.0 / 105 * at(1) + 92.0 / 105 * at(2) + 54.0 / 105 * at(3) - exact(4);
    }
    return NAN;
}

/// Its leading order, as the header states it relative to the coning drift itself.
double leading(IncrementAlgorithm algorithm, double lambda) {
    switch (algorithm) {
        case IncrementAlgorithm::OneSample: return std::pow(lambda, 2) / 6;
        case IncrementAlgorithm::OneSamplePlusPrevious:
        case IncrementAlgorithm::TwoSample: return std::pow(lambda, 4) / 30;
        case IncrementAlgorithm::ThreeSample: return std::pow(lambda, 6) / 140;
        case IncrementAlgorithm::FourSample: return std::pow(lambda, 8) / 630;
    }
    return NAN;
}

class Vibration : public testing::TestWithParam<Case> {
protected:
    static constexpr double frequency = 2.0 * std::numbers::pi * 10.0;  // rad/s
    static constexpr int steps = 4000;

    IncrementAlgorithm algorithm() const { return GetParam().algorithm; }
    double h() const { return GetParam().lambda / frequency; }
    int per_step() const { return samples_per_step(algorithm()); }
    double duration() const { return steps * per_step() * h(); }

    /// Runs the algorithm over samples(k) for raw intervals k = -1, 0, 1, ...
    template <class Sample, class Use>
    void run(Sample sample, Use use) const {
        for (int step = 0; step < steps; ++step) {
            const int first = step * per_step();
            std::array<ImuIncrement, 4> window;
            const bool with_previous = algorithm() == IncrementAlgorithm::OneSamplePlusPrevious;
            const int count = with_previous ? 2 : per_step();
            for (int k = 0; k < count; ++k) window[static_cast<std::size_t>(k)] = sample(first + k - (with_previous ? 1 : 0));
            use(compensate(std::span<const ImuIncrement>(window.data(), static_cast<std::size_t>(count)), algorithm()));
        }
    }
};

TEST_P(Vibration, ConingDriftIsTheTheoreticalOne) {
    // Exact classical coning: q = (cos e/2, sin e/2 (cos Wt, sin Wt, 0)); integrals of its body rate are closed forms.
    const double cone = 1e-3;
    const double phase = GetParam().lambda;
    const auto sample = [&](int k) {
        const double a = k * phase, b = (k + 1) * phase, s = std::sin(0.5 * cone);
        return ImuIncrement{
            Time::from_seconds((k + 1) * h()),
            h(),
            {std::sin(cone) * (std::cos(b) - std::cos(a)), std::sin(cone) * (std::sin(b) - std::sin(a)), -2.0 * s * s * phase},
            Vector3d::Zero()};
    };
    const auto attitude = [&](double angle) {
        const double s = std::sin(0.5 * cone);
        return Quaterniond(std::cos(0.5 * cone), s * std::cos(angle), s * std::sin(angle), 0.0);
    };
    Quaterniond q = attitude(0.0);
    run(sample,
        [&](const CompensatedIncrement& step) { q = (q * math::quaternion_from_rotation_vector(step.theta)).normalized(); });
    const Vector3d error = math::rotation_vector_from_quaternion(q * attitude(steps * per_step() * phase).conjugate());
    const double drift = error.z() / duration();
    const double theory = std::pow(std::sin(cone), 2) * residual(algorithm(), phase) / (per_step() * h());
    EXPECT_NEAR(drift, theory, 0.1 * std::abs(theory)) << GetParam().name;
    // and the documented leading order, relative to the coning drift e^2 W/2, at this moderately small phase
    const double stated = leading(algorithm(), phase);
    EXPECT_NEAR(std::abs(drift) / (0.5 * cone * cone * frequency), stated, 0.35 * stated);
}

TEST_P(Vibration, ScullingErrorIsTheTheoreticalOne) {
    // Roll e sin Wt about x with f_b = (0, A sin Wt, 0) in moving axes: inertial z component A sin(Wt) sin(e sin Wt).
    const double roll = 1e-3, force = 20.0;
    const double phase = GetParam().lambda;
    const auto sample = [&](int k) {
        const double a = k * phase, b = (k + 1) * phase;
        return ImuIncrement{Time::from_seconds((k + 1) * h()),
                            h(),
                            {roll * (std::sin(b) - std::sin(a)), 0.0, 0.0},
                            {0.0, force / frequency * (std::cos(a) - std::cos(b)), 0.0}};
    };
    Vector3d v = Vector3d::Zero();
    int step = 0;
    run(sample, [&](const CompensatedIncrement& increment) {
        // True attitude at the start of the step: what is measured here is the velocity algorithm alone.
        const double angle = roll * std::sin(step * per_step() * phase);
        v += math::quaternion_from_rotation_vector(Vector3d(angle, 0.0, 0.0)) * increment.dv;
        ++step;
    });
    // Exact z velocity: integral of A sin x sin(e sin x), expanded to e^3 and integrated over the phase.
    const double end = steps * per_step() * phase;
    const double first = 0.5 * end - 0.25 * std::sin(2.0 * end);
    const double third = 0.375 * end - 0.25 * std::sin(2.0 * end) + std::sin(4.0 * end) / 32.0;
    const double exact = force / frequency * (roll * first - std::pow(roll, 3) / 6.0 * third);
    const double error = (v.z() - exact) / duration();
    const double theory = roll * force / frequency * residual(algorithm(), phase) / (per_step() * h());
    EXPECT_NEAR(error, theory, 0.1 * std::abs(theory)) << GetParam().name;
}

INSTANTIATE_TEST_SUITE_P(Algorithms, Vibration,
                         testing::Values(Case{IncrementAlgorithm::OneSample, 0.1, "OneSample"},
                                         Case{IncrementAlgorithm::OneSamplePlusPrevious, 0.3, "OneSamplePlusPrevious"},
                                         Case{IncrementAlgorithm::TwoSample, 0.3, "TwoSample"},
                                         Case{IncrementAlgorithm::ThreeSample, 0.5, "ThreeSample"},
                                         Case{IncrementAlgorithm::FourSample, 0.7, "FourSample"}),
                         [](const auto& tested) { return std::string(tested.param.name); });

/// A smooth motion in body axes with polynomial rates, and its exact step by brute force: many tiny constant-rate turns.
struct Polynomial {
    std::array<Vector3d, 4> w, f;
    static Vector3d integral(const std::array<Vector3d, 4>& c, double a, double b) {
        Vector3d sum = Vector3d::Zero();
        for (std::size_t k = 0; k < 4; ++k) {
            const double n = static_cast<double>(k) + 1.0;
            sum += c[k] * (std::pow(b, n) - std::pow(a, n)) / n;
        }
        return sum;
    }
    static Vector3d value(const std::array<Vector3d, 4>& c, double t) { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); }
    ImuIncrement increment(double a, double b) const {
        return {Time::from_seconds(b), b - a, integral(w, a, b), integral(f, a, b)};
    }
    /// Rotation and velocity over (a, b] by classical Runge-Kutta on q' = q w/2, v' = q f.
    CompensatedIncrement exact(double a, double b) const {
        using State = Eigen::Matrix<double, 7, 1>;
        const auto rate = [&](double t, const State& x) {
            const Quaterniond q(x(0), x(1), x(2), x(3));
            const Vector3d wt = value(w, t);
            const Quaterniond qd = q * Quaterniond(0.0, 0.5 * wt.x(), 0.5 * wt.y(), 0.5 * wt.z());
            State d;
            d << qd.w(), qd.vec(), q.normalized() * value(f, t);
            return d;
        };
        State x = State::Zero();
        x(0) = 1.0;
        const int n = 400;
        const double h = (b - a) / n;
        for (int k = 0; k < n; ++k) {
            const double t = a + k * h;
            const State k1 = rate(t, x), k2 = rate(t + h / 2, x + h / 2 * k1), k3 = rate(t + h / 2, x + h / 2 * k2),
                        k4 = rate(t + h, x + h * k3);
            x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
        }
        const Quaterniond q = Quaterniond(x(0), x(1), x(2), x(3)).normalized();
        return {Time::from_seconds(b), b - a, math::rotation_vector_from_quaternion(q), x.tail<3>()};
    }
};

Polynomial manoeuvre() {
    return {{Vector3d(0.4, -0.3, 0.5), Vector3d(1.0, 2.0, -1.5), Vector3d(-3.0, 2.0, 4.0), Vector3d(5.0, -9.0, 7.0)},
            {Vector3d(1.0, -2.0, -9.8), Vector3d(6.0, 9.0, -4.0), Vector3d(-20.0, 15.0, 30.0), Vector3d(90.0, -40.0, 60.0)}};
}

/// Errors of rotation (rad) and velocity (m/s) of one step of length `span` in the middle of a manoeuvre.
std::pair<double, double> step_error(IncrementAlgorithm algorithm, double span) {
    const Polynomial motion = manoeuvre();
    const int n = samples_per_step(algorithm);
    const double h = span / n;
    std::vector<ImuIncrement> window;
    if (algorithm == IncrementAlgorithm::OneSamplePlusPrevious) window.push_back(motion.increment(-h, 0.0));
    for (int k = 0; k < n; ++k) window.push_back(motion.increment(k * h, (k + 1) * h));
    const CompensatedIncrement step = compensate(window, algorithm), exact = motion.exact(0.0, span);
    return {(step.theta - exact.theta).norm(), (step.dv - exact.dv).norm()};
}

TEST(Increments, LocalOrderInAManoeuvre) {
    // Doubling the step multiplies the error of a step by 2^order: 3 without correction, 4 with the previous sample, and 5 for
    // the symmetric multi-sample ones (linear rates are exact in them, errors even in time vanish).
    for (const auto& [algorithm, order] :
         {std::pair{IncrementAlgorithm::OneSample, 3.0}, std::pair{IncrementAlgorithm::OneSamplePlusPrevious, 4.0},
          std::pair{IncrementAlgorithm::TwoSample, 5.0}, std::pair{IncrementAlgorithm::ThreeSample, 5.0},
          std::pair{IncrementAlgorithm::FourSample, 5.0}}) {
        const auto [theta, dv] = step_error(algorithm, 0.005);
        const auto [theta2, dv2] = step_error(algorithm, 0.01);
        EXPECT_GT(std::log2(theta2 / theta), order - 0.35) << samples_per_step(algorithm);
        EXPECT_GT(std::log2(dv2 / dv), order - 0.35) << samples_per_step(algorithm);
    }
}

TEST(Increments, ExactForASpinWithConstantForce) {
    // 20 rad/s at 200 Hz: 0.1 rad a step. Closed form: integral of Exp(w t) f.
    const Vector3d axis(0.36, -0.48, 0.8), f(3.0, -4.0, 9.0);
    const double rate = 20.0, dt = 0.005, angle = rate * dt;
    const Vector3d along = axis * axis.dot(f), across = f - along, turned = axis.cross(f);
    const Vector3d exact = dt * along + (std::sin(angle) * across + (1.0 - std::cos(angle)) * turned) / rate;
    const ImuIncrement sample{Time{}, dt, angle * axis, dt * f};
    const std::array<ImuIncrement, 4> window{sample, sample, sample, sample};

    const CompensatedIncrement one = compensate(sample, sample);
    EXPECT_LT((one.theta - angle * axis).norm(), 1e-16);
    EXPECT_LT((one.dv - exact).norm(), 1e-15);

    CompensatedIncrement four = compensate(window, IncrementAlgorithm::FourSample);
    CompensatedIncrement chained = combined(combined(one, one), combined(one, one));
    EXPECT_LT((four.theta - 4.0 * angle * axis).norm(), 1e-15);
    EXPECT_LT((four.dv - chained.dv).norm(), 5e-13);  // 0.4 rad a step
    EXPECT_LT((chained.theta - 4.0 * angle * axis).norm(), 1e-15);
    EXPECT_DOUBLE_EQ(four.dt, 4.0 * dt);
}

Polynomial linear_rates() {
    Polynomial motion = manoeuvre();
    motion.w[2].setZero();
    motion.w[3].setZero();
    motion.f[2].setZero();
    motion.f[3].setZero();
    return motion;
}

TEST(Increments, PreviousOfAnotherLengthIsExactForLinearRates) {
    const Polynomial motion = linear_rates();
    for (const double before : {0.005, 0.02, 0.1}) {
        const CompensatedIncrement step = compensate(motion.increment(-before, 0.0), motion.increment(0.0, 0.02));
        const CompensatedIncrement exact = motion.exact(0.0, 0.02);
        EXPECT_LT((step.theta - exact.theta).norm(), 3e-9) << before;  // without weighting by length: 2e-6
        EXPECT_LT((step.dv - exact.dv).norm(), 1e-7) << before;
    }
    const ImuIncrement none{Time{}, 0.0, Vector3d::Ones(), Vector3d::Ones()};
    const CompensatedIncrement alone = compensate(none, motion.increment(0.0, 0.02));
    EXPECT_EQ(alone.theta, motion.increment(0.0, 0.02).dtheta);  // no previous: nothing is taken from it
}

TEST(Increments, UnevenSamplesAreNotTakenForEven) {
    const Polynomial motion = linear_rates();
    const std::array<ImuIncrement, 4> window{motion.increment(0.0, 0.012), motion.increment(0.012, 0.016),
                                             motion.increment(0.016, 0.018), motion.increment(0.018, 0.02)};
    const CompensatedIncrement exact = motion.exact(0.0, 0.02);
    for (const auto& [algorithm, count] :
         {std::pair{IncrementAlgorithm::TwoSample, 2}, std::pair{IncrementAlgorithm::ThreeSample, 3},
          std::pair{IncrementAlgorithm::FourSample, 4}}) {
        std::vector<ImuIncrement> samples(window.begin(), window.begin() + count);
        samples.back() = motion.increment(samples.back().time.seconds() - samples.back().dt, 0.02);
        const CompensatedIncrement step = compensate(samples, algorithm);
        EXPECT_LT((step.theta - exact.theta).norm(), 3e-9) << count;  // taken for even: 1e-7
        EXPECT_LT((step.dv - exact.dv).norm(), 1e-7) << count;
        EXPECT_NEAR(step.dt, 0.02, 1e-16);
    }
}

TEST(Increments, WrongNumberOfSamplesIsRefused) {
    const std::vector<ImuIncrement> three(3, ImuIncrement{Time{}, 0.01, Vector3d::Zero(), Vector3d::Zero()});
    EXPECT_THROW((void)compensate(three, IncrementAlgorithm::FourSample), Error);
    EXPECT_THROW((void)compensate(three, IncrementAlgorithm::OneSample), Error);
    EXPECT_THROW((void)compensate({}, IncrementAlgorithm::OneSamplePlusPrevious), Error);
}

}  // namespace
}  // namespace schuler::ins
