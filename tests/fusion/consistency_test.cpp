// Does the filter, and the smoother, say truly how good it is? Monte Carlo over seeds against chi-square bounds.
#include "fusion/car_drive.h"

#include "schuler/math/chi_square.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;
using namespace testing;

constexpr int seeds = 16;
constexpr double from = 20.0, to = 195.0;  // s of the scenario

/// Mean over seeds and epochs of the squared standardised errors of three components each.
struct Nees {
    double position = 0.0, velocity = 0.0, attitude = 0.0;
};

struct Campaign {
    Nees forward, smoothed;
    Rms forward_rms, smoothed_rms;
};

void add(Nees& nees, const std::vector<analysis::ErrorRow>& rows) {
    double n = 0.0;
    Vector3d sum = Vector3d::Zero();
    for (const analysis::ErrorRow& e : rows) {
        const double t = e.time.seconds() - 1000.0;
        if (t < from || t > to) continue;
        sum += Vector3d(e.position.cwiseQuotient(e.std_position).squaredNorm(),
                        e.velocity.cwiseQuotient(e.std_velocity).squaredNorm(), e.rpy.cwiseQuotient(e.std_rpy).squaredNorm());
        n += 1.0;
    }
    ASSERT_GT(n, 1000.0);
    nees.position += sum(0) / n / seeds;
    nees.velocity += sum(1) / n / seeds;
    nees.attitude += sum(2) / n / seeds;
}

void add(Rms& total, const Rms& r) {
    total.position += r.position / seeds;
    total.velocity += r.velocity / seeds;
    total.heading += r.heading / seeds;
}

const Campaign& campaign() {
    static const Campaign done = [] {
        Campaign c;
        for (std::uint64_t seed = 100; seed < 100 + seeds; ++seed) {
            const sim::Scenario scenario = town_drive(seed);
            const Recording recording = sim::simulate(scenario).recording;
            Settings f = settings_of(scenario);
            give_start(f, recording, seed);
            f.smooth = true;
            f.constraints.zero_velocity = false;  // a pseudo-measurement has no noise of its own to be judged by
            const Result r = fuse(recording, f);
            const auto forward = errors(f, r.forward.rows, recording), smoothed = errors(f, r.smoothed.rows, recording);
            add(c.forward, forward);
            add(c.smoothed, smoothed);
            add(c.forward_rms, rms(forward, from));
            add(c.smoothed_rms, rms(smoothed, from));
        }
        return c;
    }();
    return done;
}

/// Bounds of the mean of 3 components over the seeds, 1 in 10 000 outside. A run of 175 s is worth some independent epochs: that
/// many explain how the means of single runs scatter (measured once over these seeds).
void expect_consistent(const Nees& n, double position_worth, double velocity_worth, double attitude_worth) {
    const auto check = [](double value, double worth, const char* what) {
        const double dof = 3.0 * seeds * worth;
        EXPECT_GT(value, 3.0 * math::chi_square_quantile(5e-5, dof) / dof) << what;
        EXPECT_LT(value, 3.0 * math::chi_square_quantile(1.0 - 5e-5, dof) / dof) << what;
    };
    check(n.position, position_worth, "position");
    check(n.velocity, velocity_worth, "velocity");
    check(n.attitude, attitude_worth, "attitude");
}

TEST(Consistency, ForwardFilterMatchesItsCovariance) { expect_consistent(campaign().forward, 5.0, 16.0, 7.0); }

TEST(Consistency, SmootherMatchesItsCovariance) { expect_consistent(campaign().smoothed, 3.7, 5.5, 1.5); }

TEST(Consistency, SmoothingPays) {
    const Campaign& c = campaign();
    EXPECT_LT(c.smoothed_rms.position, 0.75 * c.forward_rms.position);
    EXPECT_LT(c.smoothed_rms.velocity, 0.75 * c.forward_rms.velocity);
    EXPECT_LT(c.smoothed_rms.heading, 0.75 * c.forward_rms.heading);
}

/// Mean attitude NEES over some drives whose gyros and accelerometers have scale errors and misaligned axes.
double attitude_nees(bool with_states) {
    Nees mean;
    for (std::uint64_t seed = 300; seed < 300 + 8; ++seed) {
        sim::Scenario scenario = town_drive(seed);
        sensor::ImuErrorModel& imu = scenario.imu.errors;
        imu.gyro_noise = 0.02 * units::deg_per_sqrt_hour;
        imu.gyro_scale = imu.accel_scale = 2e-3;
        imu.gyro_misalignment = imu.accel_misalignment = 2e-3;
        const Recording recording = sim::simulate(scenario).recording;
        Settings f = settings_of(scenario);
        give_start(f, recording, seed);
        f.constraints.zero_velocity = false;
        f.scale_factors = f.misalignments = with_states;
        add(mean, errors(f, fuse(recording, f).forward.rows, recording));
    }
    return mean.attitude * seeds / 8;
}

TEST(Consistency, ScaleErrorsAndMisalignmentsAreStatesOrWouldLie) {
    const double with = attitude_nees(true), without = attitude_nees(false);
    EXPECT_GT(with, 1.7);
    EXPECT_LT(with, 4.8);
    EXPECT_GT(without, 6.0);  // not more, for fixes that are refused open the covariance
}

}  // namespace
}  // namespace schuler::fusion
