// Rows of ranges and range rates against differences, against the worked example of math.md 5.3, and light time against iteration.
#include "schuler/core/units.h"
#include "schuler/filter/measurement/range.h"
#include "schuler/ins/state_error.h"
#include "schuler/math/rotation.h"
#include "support/draws.h"
#include "support/perturbation.h"

#include <gtest/gtest.h>

#include <random>

namespace schuler::filter {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using schuler::test::LinearModel;

using units::deg;
const earth::Earth wgs84{};

struct RangePoint {
    NavState nav;
    Vector3d w_ib_b, lever_b;
    Ecef transmitter;
    Vector3d velocity;
    std::string name;
};

/// range and rate for an error dx of position, velocity, attitude, gyro bias and lever arm.
VectorXd computed(const RangePoint& p, const VectorXd& dx) {
    const NavState nav = ins::perturbed(wgs84, p.nav, dx.head<9>());
    // a gyro bias estimated too large makes the rate too small
    const Vector3d w = p.w_ib_b - dx.segment<3>(9);
    const RangeRows m =
        range_rows(antenna_of(wgs84, nav, nav.q_nb.toRotationMatrix(), w, p.lever_b + dx.tail<3>()), p.transmitter, p.velocity);
    return Eigen::Vector2d(m.range, m.rate);
}

MatrixXd analytic(const RangePoint& p) {
    const RangeRows m =
        range_rows(antenna_of(wgs84, p.nav, p.nav.q_nb.toRotationMatrix(), p.w_ib_b, p.lever_b), p.transmitter, p.velocity);
    MatrixXd J = MatrixXd::Zero(2, 15);
    J.row(0).segment<3>(0) = m.range_by_position;
    J.row(0).segment<3>(6) = m.range_by_attitude;
    J.row(1).segment<3>(0) = m.rate_by_position;
    J.row(1).segment<3>(3) = m.rate_by_velocity;
    J.row(1).segment<3>(6) = m.rate_by_attitude;
    J.row(1).segment<3>(9) = m.rate_by_gyro_bias;
    J.row(0).segment<3>(12) = m.range_by_lever_arm;
    J.row(1).segment<3>(12) = m.rate_by_lever_arm;
    return J;
}

std::vector<RangePoint> points() {
    std::mt19937_64 generator(7);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const auto vector = [&](double size) { return Vector3d(size * test::draw3(unit, generator)); };
    std::vector<RangePoint> out;
    for (int k = 0; k < 8; ++k) {
        RangePoint p;
        p.nav.position = {75.0 * deg * unit(generator), 3.0 * unit(generator), 5000.0 + 5000.0 * unit(generator)};
        p.nav.v_eb_n = vector(200.0);
        p.nav.q_nb = math::quaternion_from_rotation_vector(vector(1.5));
        p.w_ib_b = vector(0.3);
        p.lever_b = vector(3.0);
        const Ecef place = earth::ecef_from_geodetic(wgs84.ellipsoid, p.nav.position);
        const bool satellite = k % 2 == 0;
        const Vector3d out_n{unit(generator), unit(generator), -1.0};
        const Vector3d out_e = earth::C_en(p.nav.position.lat, p.nav.position.lon) * out_n;
        p.transmitter.r = place.r + (satellite ? 21e6 * out_e.normalized() : Vector3d(vector(60e3)));
        p.velocity = satellite ? vector(2500.0) : Vector3d(Vector3d::Zero());
        p.name = (satellite ? "satellite " : "station ") + std::to_string(k);
        out.push_back(p);
    }
    return out;
}

SCHULER_JACOBIAN(range_rows, "filter.range_rows") {
    std::vector<LinearModel> models;
    for (const RangePoint& p : points()) {
        LinearModel m;
        m.where = p.name;
        m.analytic = analytic(p);
        m.output = [p](const VectorXd& dx) { return computed(p, dx); };
        m.step = VectorXd::Ones(15);
        m.step.head<3>().setConstant(10.0);
        m.step.segment<3>(6).setConstant(1e-3);
        m.step.segment<3>(9).setConstant(1e-3);
        // neglected: light time's change (1e-6), the lever arm's turn with the local level (|l|/R), rounding of 2e7 m over the step
        m.tolerance = schuler::test::tolerance_of(m.analytic, 2e-6, VectorXd::Ones(2), VectorXd::Zero(15));
        m.tolerance.row(0).head<3>().setConstant(3e-6);
        m.tolerance.row(0).segment<3>(3).setConstant(1e-12);
        m.tolerance.row(0).segment<3>(6).setConstant(2e-5);
        m.tolerance.row(0).segment<3>(9).setConstant(1e-12);
        m.tolerance.row(1).head<3>() = (3e-9 + 5e-6 * m.analytic.row(1).head<3>().cwiseAbs().array()).matrix();
        m.tolerance.row(1).segment<3>(3).setConstant(5e-6);
        m.tolerance.row(1).segment<3>(6).setConstant(2e-5);
        m.tolerance.row(1).segment<3>(9).setConstant(1e-5);
        m.tolerance.row(0).segment<3>(12).setConstant(5e-6);
        m.tolerance.row(1).segment<3>(12).setConstant(5e-6);
        models.push_back(m);
    }
    return models;
}

/// paper_D.example of the reference: computed with 45 digits.
TEST(RangeRows, AgreeWithTheWorkedExample) {
    NavState nav;
    nav.position = {52.3 * deg, 104.3 * deg, 10'000.0};
    nav.v_eb_n = {180, -140, 3};
    nav.q_nb = math::quaternion_from_rpy(Vector3d(12, 2.5, 322.1) * deg);
    const auto antenna = antenna_of(wgs84, nav, nav.q_nb.toRotationMatrix(), {0.004, -0.003, 0.017}, {2, 0.5, -3});
    EXPECT_LT((antenna.r_e - Vector3d(-966931.090204, 3793422.89965, 5031201.68299)).norm(), 2e-5);
    EXPECT_LT((antenna.v_e - Vector3d(171.268642575, -105.245048834, 107.704352926)).norm(), 1e-6);
    const RangeRows s = range_rows(antenna, {{-9150000, 17800000, 17411000}}, {-1530, -2060, 1302});
    EXPECT_NEAR(s.range, 20407529.7832259 - 1500.0, 1e-6);
    EXPECT_NEAR(s.rate, 68.5426652899 - 3.5, 1e-6);
    EXPECT_LT((s.range_by_position - Vector3d(0.233637825483, -0.219043831922, 0.947329491888)).norm(), 3e-6);
    EXPECT_LT((s.range_by_attitude - Vector3d(0.897575618905, 2.72996916964, 0.40986298375)).norm(), 5e-6);
    EXPECT_LT((s.rate_by_position - Vector3d(-6.70889598304e-05, -0.00012299959184, -8.83686929131e-07)).norm(), 6e-9);
    EXPECT_LT((s.rate_by_gyro_bias - Vector3d(-0.985672990123, 2.72276896847, -0.203320498671)).norm(), 2e-5);
    const Ecef station = earth::ecef_from_geodetic(wgs84.ellipsoid, {53.1 * deg, 103.4 * deg, 450.0});
    const RangeRows g = range_rows(antenna, station, Vector3d::Zero());
    EXPECT_NEAR(g.range, 109840.96440612 - 1500.0 - 7.0, 1e-6);
    EXPECT_NEAR(g.rate, -223.243858613 - 3.5, 1e-6);
    EXPECT_LT((g.rate_by_position - Vector3d(-6.77599368179e-05, -0.000122334149745, -0.00017431203288)).norm(), 6e-9);
}

}  // namespace
}  // namespace schuler::filter
