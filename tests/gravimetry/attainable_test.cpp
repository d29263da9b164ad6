// Covariance analysis of paper E's scenario against an independent one (reference numbers of math.md section 4), which held F of the
// start: here a survey that does not move. Along the moving track the model sees more, see the last test.
#include "schuler/gravimetry/attainable.h"

#include "schuler/core/units.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace schuler::gravimetry {
namespace {

using Eigen::Vector3d;

struct Expected {
    int t;
    double attitude_arcsec[3], velocity[3], position[3], disturbance[3], gyro_deg_h[3];  // east, north, up
};

SurveySettings papers_settings(double gnss_position, double heading_sigma) {
    SurveySettings s;
    const double gyro = 0.01 * units::deg_per_hour;
    s.noise = {gyro * gyro, 1e-12};
    s.prior.attitude_n = {1e-4, 1e-4, heading_sigma};
    s.prior.gyro_bias = gyro;
    s.prior.gnss_position_n.setConstant(gnss_position);
    s.disturbance.axes = DisturbanceAxes::EarthFixed;  // the paper's
    return s;
}

LevelSurvey papers_survey(double v, double gnss_position) {
    return {{55.8114694 * units::deg, 37.4998612 * units::deg, 164.15}, {v, v, 0.0}, 45.0 * units::deg, gnss_position, 0.05};
}

void expect_history(double gnss_position, double heading_sigma, const std::vector<Expected>& expected) {
    const LevelSurvey survey = papers_survey(0.0, gnss_position);
    std::vector<int> times;
    for (const Expected& e : expected) times.push_back(e.t);
    const std::vector<Attained> found = attainable(papers_settings(gnss_position, heading_sigma), survey, times);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const Expected& e = expected[i];
        const auto near = [&](const char* what, const Vector3d& ned, const double(&enu)[3], double unit) {
            const double values[3] = {ned(1) / unit, ned(0) / unit, ned(2) / unit};
            for (int k = 0; k < 3; ++k)
                EXPECT_NEAR(values[k], enu[k], 0.01 * enu[k]) << what << " " << k << " at " << e.t << " s";
        };
        near("attitude", found[i].attitude_n, e.attitude_arcsec, units::arcsec);
        near("velocity", found[i].velocity_n, e.velocity, 1.0);
        near("position", found[i].position_n, e.position, 1.0);
        near("disturbance", found[i].disturbance_n, e.disturbance, 1.0);
        near("gyro", found[i].gyro_bias_n, e.gyro_deg_h, units::deg_per_hour);
    }
}

TEST(Attainable, PapersScenarioWithCarrierPhase) {
    expect_history(0.05, 1e-4,
                   // clang-format off
                   {{60, {2.3298, 2.3296, 20.635}, {1.45302e-3, 1.45309e-3, 1.31629e-3}, {0.053345, 0.053345, 0.053037},
                     {9.94863e-5, 9.94863e-5, 4.27394e-5}, {9.9844e-3, 9.9844e-3, 0.01}},
                    {300, {2.0954, 2.0954, 20.771}, {3.62174e-4, 3.62231e-4, 1.34171e-4}, {0.051330, 0.051330, 0.050738},
                     {9.94773e-5, 9.94772e-5, 1.33359e-6}, {1.32313e-3, 1.02595e-3, 9.99927e-3}},
                    {3600, {2.0929, 2.0929, 24.873}, {2.67399e-4, 2.73609e-4, 1.96445e-5}, {0.051032, 0.051049, 0.050178},
                     {9.94772e-5, 9.94741e-5, 1.01201e-6}, {9.14102e-4, 2.12593e-4, 3.90826e-3}}});
    // clang-format on
}

TEST(Attainable, PapersScenarioWithDifferentialCorrections) {
    expect_history(1.0, 1e-3,
                   // clang-format off
                   {{60, {5.7286, 5.7201, 206.24}, {1.18671e-2, 1.18688e-2, 7.03256e-3}, {1.03017, 1.03017, 1.02178},
                     {9.95197e-5, 9.95197e-5, 9.35389e-5}, {9.99819e-3, 9.99819e-3, 0.01}},
                    {600, {2.1240, 2.1240, 158.12}, {2.19207e-3, 2.19770e-3, 9.39042e-4}, {1.00709, 1.00710, 1.00193},
                     {9.94806e-5, 9.94775e-5, 4.41957e-6}, {6.49672e-3, 1.24973e-3, 9.99842e-3}},
                    {3600, {2.0982, 2.0973, 158.05}, {1.18996e-3, 1.26633e-3, 1.41529e-4}, {1.00264, 1.00297, 0.996666},
                     {9.94804e-5, 9.94744e-5, 3.23586e-6}, {6.45907e-3, 2.19376e-4, 4.39740e-3}}});
    // clang-format on
}

TEST(Attainable, AnHourAtOneMetreASecond) {
    // The level of the vertical disturbance: accelerometer error and receiver error (2 w0^2 a metre), nothing less. What is constant
    // in Earth-fixed axes turns against the vertical along the way, so carrier phase begins to tell a horizontal disturbance from
    // tilt: 8.6e-5 m/s^2 of the 1.0e-4 it began with.
    const double w0_squared = 1.54670373e-6;
    for (const double gnss_position : {0.05, 1.0}) {
        const Attained after =
            attainable(papers_settings(gnss_position, 1e-4), papers_survey(1.0, gnss_position), {3600}).front();
        const double limit = std::hypot(1e-6, 2.0 * w0_squared * gnss_position);
        EXPECT_GT(after.disturbance_n.z(), 0.99 * limit);
        EXPECT_LT(after.disturbance_n.z(), 1.01 * limit);
        EXPECT_LT(after.attitude_n.head<2>().maxCoeff(), 2.11 * units::arcsec);
        EXPECT_GT(after.disturbance_n.head<2>().minCoeff(), 8e-5);
    }
}

TEST(Attainable, AHorizontalDisturbanceThatIsConstantAgainstNorthIsTilt) {
    // It leans the vertical by a constant angle, and so does a level error: an hour's way does not tell one from the other.
    SurveySettings settings = papers_settings(0.05, 1e-4);
    settings.disturbance.axes = DisturbanceAxes::LocalLevel;
    const Attained after = attainable(settings, papers_survey(1.0, 0.05), {3600}).front();
    EXPECT_GT(after.disturbance_n.head<2>().minCoeff(), 9.9e-5);
    EXPECT_LT(after.disturbance_n.z(), 1.02e-6);
}

}  // namespace
}  // namespace schuler::gravimetry
