// F of both frames against differences of the step functions, against printed numbers, and against each other.
#include "schuler/ins/error_model.h"

#include "schuler/core/units.h"
#include "schuler/ins/state_error.h"
#include "schuler/ins/step.h"
#include "schuler/math/rotation.h"
#include "support/draws.h"
#include "support/perturbation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <tuple>
#include <vector>

namespace schuler::ins {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using schuler::test::LinearModel;
using schuler::test::tolerance_of;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

struct Point {
    earth::Earth earth;
    NavState state;
    Vector3d f_b, w_b;  ///< specific force (m/s^2) and rate (rad/s) while stepping
    std::string name;
};

std::vector<Point> random_points(int count) {
    std::mt19937_64 generator(20240611);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const auto vector = [&](double size) { return Vector3d(size * test::draw3(unit, generator)); };
    std::vector<Point> points;
    for (int k = 0; k < count; ++k) {
        Point p;
        p.earth.gravity = k % 3 == 2 ? earth::GravityModel::KfGins : earth::GravityModel::Somigliana;
        p.state.position = {80.0 * units::deg * unit(generator), 3.0 * unit(generator), 5000.0 + 5500.0 * unit(generator)};
        p.state.v_eb_n = vector(250.0);
        p.state.q_nb = math::quaternion_from_rotation_vector(vector(1.8));
        p.f_b = p.state.q_nb.conjugate() * (Vector3d(0.0, 0.0, -9.8) + vector(5.0));
        p.w_b = vector(0.02);
        p.name = "point " + std::to_string(k) + ", latitude " + std::to_string(p.state.position.lat / units::deg);
        points.push_back(p);
    }
    return points;
}

/// What sensors with bias errors (estimate minus truth) leave of force and rate over dt.
CompensatedIncrement sensed(const Point& p, double dt, const Vector3d& dbg = Vector3d::Zero(),
                            const Vector3d& dba = Vector3d::Zero()) {
    const ImuIncrement increment{Time{}, dt, dt * (p.w_b - dbg), dt * (p.f_b - dba)};
    return compensate(increment, increment);
}

Vector9 stacked(const Vector3d& position, const Vector3d& velocity, const Vector3d& attitude) {
    Vector9 x;
    x.head<3>() = position;
    x.segment<3>(3) = velocity;
    x.tail<3>() = attitude;
    return x;
}
Vector9 stacked(double position, double velocity, double attitude) {
    return stacked(Vector3d::Constant(position), Vector3d::Constant(velocity), Vector3d::Constant(attitude));
}

Vector3d attitude_error(const Eigen::Quaterniond& estimate, const Eigen::Quaterniond& truth) {
    return -math::rotation_vector_from_quaternion(estimate * truth.conjugate());
}

/// dx such that corrected(estimate, dx) is the truth.
Vector9 error_between(const earth::Earth& earth, const NavState& estimate, const NavState& truth) {
    return stacked(-earth::ned_difference(earth, truth.position, estimate.position), estimate.v_eb_n - truth.v_eb_n,
                   attitude_error(estimate.q_nb, truth.q_nb));
}
Vector9 error_between(const NavStateEcef& estimate, const NavStateEcef& truth) {
    return stacked(estimate.position.r - truth.position.r, estimate.v_eb_e - truth.v_eb_e,
                   attitude_error(estimate.q_eb, truth.q_eb));
}

/// Initial errors of 1 km, 1 m/s, 1 mrad, 1e-4 rad/s, 1e-2 m/s^2 in 15 columns.
VectorXd perturbation() {
    VectorXd step(15);
    step.head(9) = stacked(1e3, 1.0, 1e-3);
    step.segment(9, 3).setConstant(1e-4);
    step.tail(3).setConstant(1e-2);
    return step;
}

/// F with the bias columns +C (gyro) on attitude and -C (accelerometer) on velocity.
MatrixXd with_bias_columns(const ErrorDynamics& d, const Eigen::Matrix3d& C) {
    MatrixXd F = MatrixXd::Zero(9, 15);
    F.leftCols<9>() = matrix(d);
    F.block<3, 3>(6, 9) = C;
    F.block<3, 3>(3, 12) = -C;
    return F;
}

/// (error after dt - error before)/dt extrapolated to dt = 0 (error of order dt^3).
template <class After>
VectorXd growth(const VectorXd& dx, After after) {
    const double dt = 0.2;
    const auto rate = [&](double h) { return VectorXd((after(h) - dx.head(9)) / h); };
    return (8.0 * rate(0.25 * dt) - 6.0 * rate(0.5 * dt) + rate(dt)) / 3.0;
}

/// Floors a row and column: sizes below which nothing is asked, m/s, m/s^2, rad/s for a full perturbation.
MatrixXd floors(const MatrixXd& F) { return tolerance_of(F, 2e-6, stacked(1e-7, 3e-8, 1e-12), perturbation().cwiseInverse()); }

SCHULER_JACOBIAN(error_n, "ins.error_n") {
    std::vector<LinearModel> models;
    for (const Point& p : random_points(12)) {
        const Eigen::Matrix3d C = p.state.q_nb.toRotationMatrix();
        const MatrixXd F = with_bias_columns(error_n(p.earth, p.state.position, p.state.v_eb_n, C * p.f_b), C);
        const auto output = [p](const VectorXd& dx) {
            const NavState start = perturbed(p.earth, p.state, dx.head<9>());
            return growth(dx, [&](double dt) {
                const NavState estimate = step_n(p.earth, start, sensed(p, dt, dx.segment<3>(9), dx.tail<3>()));
                return VectorXd(error_between(p.earth, estimate, step_n(p.earth, p.state, sensed(p, dt))));
            });
        };
        models.push_back({p.name, F, output, perturbation(), floors(F)});
    }
    return models;
}

SCHULER_JACOBIAN(error_e, "ins.error_e") {
    std::vector<LinearModel> models;
    for (const Point& p : random_points(12)) {
        const NavStateEcef truth = to_ecef(p.earth, p.state);
        const Eigen::Matrix3d C = truth.q_eb.toRotationMatrix();
        const MatrixXd F = with_bias_columns(error_e(p.earth, truth.position, C * p.f_b), C);
        const auto output = [p, truth](const VectorXd& dx) {
            const NavStateEcef start = perturbed(truth, dx.head<9>());
            return growth(dx, [&](double dt) {
                const NavStateEcef estimate = step_e(p.earth, start, sensed(p, dt, dx.segment<3>(9), dx.tail<3>()));
                return VectorXd(error_between(estimate, step_e(p.earth, truth, sensed(p, dt))));
            });
        };
        models.push_back({p.name, F, output, perturbation(), floors(F)});
    }
    return models;
}

SCHULER_JACOBIAN(geographic_from_ecef, "ins.geographic_from_ecef_errors") {
    std::vector<LinearModel> models;
    for (const Point& p : random_points(12)) {
        const MatrixXd M = geographic_from_ecef_errors(p.earth, p.state);
        const NavStateEcef truth = to_ecef(p.earth, p.state);
        const auto output = [p, truth](const VectorXd& dx) {
            return VectorXd(error_between(p.earth, to_geographic(p.earth, perturbed(truth, dx)), p.state));
        };
        const VectorXd step = perturbation().head(9);
        models.push_back({p.name, M, output, step, tolerance_of(M, 1e-6, stacked(1e-6, 1e-9, 1e-11), step.cwiseInverse())});
    }
    return models;
}

TEST(ErrorModel, BothFramesAreOneModel) {
    // x_n = M x_e implies F_n M = M F_e + dM/dt along the trajectory.
    for (const Point& p : random_points(12)) {
        const double dt = 0.05;
        const NavState before = p.state;
        const NavState now = step_n(p.earth, before, sensed(p, dt));
        const NavState after = step_n(p.earth, now, sensed(p, dt));
        const Matrix9 M = geographic_from_ecef_errors(p.earth, now);
        const Matrix9 M_rate =
            (geographic_from_ecef_errors(p.earth, after) - geographic_from_ecef_errors(p.earth, before)) / (2.0 * dt);
        const Vector3d f_n = now.q_nb * p.f_b;
        const Eigen::Matrix3d C_en = earth::C_en(now.position.lat, now.position.lon);
        const Matrix9 F_n = matrix(error_n(p.earth, now.position, now.v_eb_n, f_n));
        const Matrix9 F_e = matrix(error_e(p.earth, to_ecef(p.earth, now).position, C_en * f_n));
        const Matrix9 misfit = F_n * M - M * F_e - M_rate;
        const Vector9 scale = stacked(1.0, 1e-3, 1e-6);  // errors that belong together: 1 m, 1 mm/s, 1e-6 rad
        const Matrix9 scaled = scale.cwiseInverse().asDiagonal() * misfit * scale.asDiagonal();
        // The smallest kept terms, such as ap, are 1e-11/1e-6 = 1e-5 here; what error_n leaves out of gravity is 3e-8.
        EXPECT_LT(scaled.cwiseAbs().maxCoeff(), 6e-8) << p.name << "\n" << scaled;
    }
}

TEST(ErrorModel, PrintedExampleOfTheTriadPaper) {
    // Verified with 45 digits: (row, column, value), all non-zero entries of the nine navigation states.
    const earth::Earth earth;
    const Geodetic position{52.3 * units::deg, 104.3 * units::deg, 10000.0};
    const Vector3d v(180.0, -140.0, 3.0);
    const Eigen::Matrix3d C = math::dcm_from_rpy(Vector3d(12.0, 2.5, 322.1) * units::deg);
    // clang-format off
    const std::vector<std::tuple<int, int, double>> nonzero{
        {0, 0, -4.69816195472e-07}, {0, 2, 2.81889717283e-05}, {0, 3, 1.0}, {1, 0, -2.82961150859e-05},
        {1, 1, -3.68493563179e-05}, {1, 2, -2.18697230129e-05}, {1, 4, 1.0}, {2, 5, 1.0}, {3, 0, 6.75104955519e-10},
        {3, 2, -6.05584563818e-10}, {3, 3, 4.69816195472e-07}, {3, 4, -5.88016296903e-05}, {3, 5, 2.81889717283e-05},
        {3, 7, 9.8801963159}, {3, 8, 1.3083943385}, {4, 0, 8.13977448414e-10}, {4, 2, -8.05885215875e-10},
        {4, 3, 8.70977447762e-05}, {4, 4, 3.68493563179e-05}, {4, 5, 6.731678704e-05}, {4, 6, -9.8801963159},
        {4, 8, -1.23297405252}, {5, 0, 5.35387963984e-09}, {5, 2, 3.06926048756e-06}, {5, 3, -5.63779434566e-05},
        {5, 4, -4.54470640272e-05}, {5, 6, -1.3083943385}, {5, 7, 1.23297405252}, {6, 0, -9.02452774812e-12},
        {6, 2, -3.41631989042e-12}, {6, 4, 1.56212307235e-07}, {6, 7, -2.94008148451e-05}, {6, 8, 2.81889717283e-05},
        {7, 0, 4.30106189954e-14}, {7, 2, -4.41454515055e-12}, {7, 3, -1.56605398491e-07}, {7, 6, 2.94008148451e-05},
        {7, 8, 2.27235320136e-05}, {8, 0, 2.16044456358e-12}, {8, 2, 4.42020142335e-12}, {8, 4, -2.02115107757e-07},
        {8, 6, -2.81889717283e-05}, {8, 7, -2.27235320136e-05}};
    // clang-format on
    const Vector3d f_n = C * Vector3d(0.6, -0.3, -10.02);
    Matrix9 F = matrix(error_n(earth, position, v, f_n));
    // The example's gravity points straight down; the program's has the north component that belongs to it, and its slope.
    const earth::EarthTerms t = earth::terms_at(earth, position, v);
    const double slope = -(0.0502828305253 + t.g_n.x()) / 6385475.91359;  // over R_M + h
    EXPECT_NEAR(slope, -7.9e-9, 1e-10);
    F(3, 2) += slope;
    for (const auto& [i, j, value] : nonzero) {
        EXPECT_NEAR(F(i, j), value, 2e-11 * std::abs(value) + 1e-20) << "(" << i << ", " << j << ")";
        F(i, j) = 0.0;
    }
    EXPECT_EQ(F.cwiseAbs().maxCoeff(), 0.0);
}

TEST(ErrorModel, PointMassLimitOfTheGravimetryPaper) {
    // math.md section 4: w0^2 (3 l l^T - I) + u0^2 diag(1, 1, 0). The flattening adds up to 1.3 % of w0^2, no more.
    const earth::Earth earth;
    for (const double lat_deg : {-90.0, -30.0, 0.0, 55.8114694, 90.0}) {
        const Ecef position = earth::ecef_from_geodetic(earth.ellipsoid, {lat_deg * units::deg, 0.65, 164.15});
        const double w02 = earth.ellipsoid.gm / std::pow(position.r.norm(), 3), u2 = std::pow(earth.ellipsoid.w_ie, 2);
        const Vector3d l = position.r.normalized();
        Eigen::Matrix3d expected = w02 * (3.0 * l * l.transpose() - Eigen::Matrix3d::Identity());
        expected(0, 0) += u2;
        expected(1, 1) += u2;
        const Eigen::Matrix3d G = error_e(earth, position, Vector3d::Zero()).vp;
        EXPECT_LT((G - expected).cwiseAbs().maxCoeff(), 0.015 * w02) << lat_deg << "\n" << G << "\n\n" << expected;
        EXPECT_LT((G - G.transpose()).cwiseAbs().maxCoeff(), 2e-5 * w02) << lat_deg;  // gravity has a potential
        EXPECT_NEAR(G.trace(), 2.0 * u2, 1e-4 * w02) << lat_deg;  // Laplace, as far as the free-air series keeps it
    }
}

TEST(ErrorModel, JacobiansAreRegistered) {
    const std::vector<std::string>& names = schuler::test::registered_jacobians();
    for (const char* name : {"ins.error_n", "ins.error_e", "ins.geographic_from_ecef_errors"}) {
        EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
    }
}

}  // namespace
}  // namespace schuler::ins
