// F, G and H of the gravi-inertial model against differences of the filter's own step, which has the same states as blocks; the
// disturbance processes against their correlation functions; F against the entries that math.md section 4 was checked with.
#include "schuler/gravimetry/discretize.h"

#include "schuler/core/units.h"
#include "schuler/filter/states/inertial_filter.h"
#include "schuler/ins/state_error.h"
#include "schuler/ins/step.h"
#include "schuler/math/rotation.h"
#include "support/draws.h"
#include "support/perturbation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <iterator>
#include <random>
#include <string>
#include <tuple>

namespace schuler::gravimetry {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using schuler::test::LinearModel;
using schuler::test::tolerance_of;
using Filter = filter::InertialFilter<filter::EarthFixedFrame>;

constexpr DisturbanceKind kinds[] = {DisturbanceKind::Constant,          DisturbanceKind::FirstOrder,
                                     DisturbanceKind::RampAndFirstOrder, DisturbanceKind::QuadraticAndFirstOrder,
                                     DisturbanceKind::SecondOrder,       DisturbanceKind::ThirdOrder};

/// Estimate; parameters by the indices of the gravi-inertial model.
struct State {
    NavStateEcef nav;
    StateVector parameters = StateVector::Zero();
};
State perturbed(const State& truth, const StateVector& dx) {
    State out{ins::perturbed(truth.nav, dx.head<9>()), truth.parameters};
    out.parameters.tail<max_states - accel_bias>() += dx.tail<max_states - accel_bias>();
    return out;
}

/// Pairs of blocks: the model's and the filter's.
std::vector<std::pair<int, int>> blocks_of(const filter::Layout& L) {
    std::vector<std::pair<int, int>> out{{accel_bias, filter::Layout::accel_bias}, {gyro_bias, filter::Layout::gyro_bias}};
    for (const auto& [here, there] : {std::pair{+systematic, L.gravity_constant}, std::pair{+random, L.gravity_random},
                                      std::pair{+slope, L.gravity_slope}, std::pair{+curvature, L.gravity_curvature}})
        if (there >= 0) out.emplace_back(here, there);
    return out;
}

struct Point {
    std::string name;
    earth::Earth earth;
    DisturbanceModel disturbance;
    State state;
    Vector3d w_b, f_b, lever_arm_b;

    [[nodiscard]] Motion motion() const {
        const Matrix3d C_eb = state.nav.q_eb.toRotationMatrix();
        return {state.nav.position, state.nav.v_eb_e, C_eb, C_eb * f_b};
    }
    /// The state after a step of dt of the filter under the true motion and sensor noise n = (gyro, accelerometer), measured minus true.
    [[nodiscard]] State after(const State& start, double dt, const Eigen::Matrix<double, 6, 1>& n) const {
        filter::Layout layout;
        filter::add_disturbance(disturbance, layout);
        filter::InertialModel model(earth, layout, {});
        model.disturbance = disturbance;
        Filter f(model);
        f.set_nav(start.nav);
        for (const auto& [here, there] : blocks_of(layout)) f.parameters.segment<3>(there) = start.parameters.segment<3>(here);
        const Vector3d gyro = w_b + state.parameters.segment<3>(gyro_bias) + n.head<3>();
        const Vector3d accel = f_b + state.parameters.segment<3>(accel_bias) + n.tail<3>();
        const ImuIncrement raw{start.nav.time + Duration::from_seconds(dt), dt, dt * gyro, dt * accel};
        f.previous = f.corrected(model, raw);  // the motion was the same before
        f.propagate(model, raw, {});
        State out{f.nav, start.parameters};
        for (const auto& [here, there] : blocks_of(layout)) out.parameters.segment<3>(here) = f.parameters.segment<3>(there);
        return out;
    }
};

std::vector<Point> points() {
    std::mt19937_64 generator(7);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const auto vector = [&](double size) { return Vector3d(size * schuler::test::draw3(unit, generator)); };
    std::vector<Point> out;
    for (const DisturbanceKind kind : kinds) {
        for (int k = 0; k < 2; ++k) {
            Point p;
            p.name = "kind " + std::to_string(static_cast<int>(kind)) + ", point " + std::to_string(k);
            p.disturbance = {kind, 40.0 + 30.0 * k, Vector3d(2e-4, 3e-4, 5e-4), true,
                             k == 0 ? DisturbanceAxes::LocalLevel
                                    : DisturbanceAxes::EarthFixed};  // by time: the pace is constant; along the track below
            NavState nav;
            nav.position = {1.3 * unit(generator), 3.0 * unit(generator), 2000.0};
            nav.v_eb_n = vector(80.0);
            nav.q_nb = math::quaternion_from_rotation_vector(vector(1.8));
            p.state.nav = ins::to_ecef(p.earth, nav);
            p.state.parameters.segment<3>(accel_bias) = vector(1e-3);
            p.state.parameters.segment<3>(gyro_bias) = vector(1e-4);
            p.state.parameters.segment<3>(gnss_position) = vector(1.0);
            p.state.parameters.segment<3>(systematic) = vector(5e-5);
            p.f_b = nav.q_nb.conjugate() * (Vector3d(0.0, 0.0, -9.8) + vector(3.0));
            p.w_b = vector(0.02);
            p.lever_arm_b = vector(3.0);
            if (kind != DisturbanceKind::Constant) out.push_back(p);  // the model has a random part there too, the filter none
        }
    }
    return out;
}

StateVector error_between(const State& estimate, const State& truth) {
    StateVector dx = estimate.parameters - truth.parameters;
    dx.segment<3>(position) = estimate.nav.position.r - truth.nav.position.r;
    dx.segment<3>(velocity) = estimate.nav.v_eb_e - truth.nav.v_eb_e;
    dx.segment<3>(attitude) = -math::rotation_vector_from_quaternion(estimate.nav.q_eb * truth.nav.q_eb.conjugate());
    return dx;
}

VectorXd three(std::initializer_list<double> sizes) {
    VectorXd x = VectorXd::Constant(max_states, std::data(sizes)[sizes.size() - 1]);  // the last one goes on
    Eigen::Index i = 0;
    for (const double size : sizes) x.segment<3>(3 * i++).setConstant(size);
    return x;
}
const VectorXd step = three({1e3, 1.0, 1e-3, 1e-2, 1e-4, 10.0, 1.0, 1e-2, 1e-2, 1e-4, 1e-6, 1.0});
const VectorXd floor_of_rate = three({1e-7, 3e-8, 1e-12, 1e-12, 1e-14, 1e-9, 1e-10, 1e-10, 1e-10, 1e-12, 1e-14, 1e-9});

/// (error after dt - error before)/dt, extrapolated to dt = 0.
template <class After>
StateVector growth(const StateVector& before, After after) {
    const double dt = 0.2;
    const auto rate = [&](double h) { return StateVector((after(h) - before) / h); };
    return (8.0 * rate(0.25 * dt) - 6.0 * rate(0.5 * dt) + rate(dt)) / 3.0;
}

SCHULER_JACOBIAN(gravity_dynamics, "gravimetry.gravity_error_dynamics") {
    std::vector<LinearModel> models;
    for (const Point& p : points()) {
        const MatrixXd F = gravity_error_dynamics(p.earth, p.disturbance, p.motion());
        const auto output = [p](const VectorXd& dx) -> VectorXd {
            const State start = perturbed(p.state, dx);
            const Eigen::Matrix<double, 6, 1> quiet = Eigen::Matrix<double, 6, 1>::Zero();
            return growth(dx, [&](double dt) { return error_between(p.after(start, dt, quiet), p.after(p.state, dt, quiet)); });
        };
        models.push_back({p.name, F, output, step, tolerance_of(F, 3e-6, floor_of_rate, step.cwiseInverse())});
    }
    return models;
}

SCHULER_JACOBIAN(gravity_noise, "gravimetry.gravity_noise_input") {
    // The sensors' columns. Those of the disturbance are judged by the correlation they give, below.
    std::vector<LinearModel> models;
    const VectorXd size = (VectorXd(6) << 1e-4, 1e-4, 1e-4, 1e-2, 1e-2, 1e-2).finished();
    for (const Point& p : points()) {
        const MatrixXd G = gravity_noise_input(p.earth, p.disturbance, {4.0, 9.0}, p.motion()).leftCols<6>();
        const auto output = [p](const VectorXd& w) -> VectorXd {
            Eigen::Matrix<double, 6, 1> n;
            n << 2.0 * w.head<3>(), 3.0 * w.tail<3>();
            const Eigen::Matrix<double, 6, 1> quiet = Eigen::Matrix<double, 6, 1>::Zero();
            return growth(StateVector::Zero(),
                          [&](double dt) { return error_between(p.after(p.state, dt, n), p.after(p.state, dt, quiet)); });
        };
        models.push_back({p.name, G, output, size, tolerance_of(G, 3e-6, floor_of_rate, size.cwiseInverse())});
    }
    return models;
}

SCHULER_JACOBIAN(gravity_gnss, "gravimetry.gravity_gnss_rows") {
    std::vector<LinearModel> models;
    for (const Point& p : points()) {
        const Matrix3d C_eb = p.motion().C_eb;
        const Vector3d turn_b = C_eb.transpose() * Vector3d(0.0, 0.0, p.earth.ellipsoid.w_ie);
        const MatrixXd H = gravity_gnss_rows(C_eb, p.lever_arm_b, p.w_b - turn_b);
        const auto output = [p](const VectorXd& dx) -> VectorXd {
            const State estimate = perturbed(p.state, dx);
            const Matrix3d C = estimate.nav.q_eb.toRotationMatrix();
            const Vector3d w_eb_b = p.w_b - dx.segment<3>(gyro_bias) - C.transpose() * Vector3d(0.0, 0.0, p.earth.ellipsoid.w_ie);
            Eigen::Matrix<double, 6, 1> z;
            // clang-format off
            z << estimate.nav.position.r - p.state.nav.position.r + C * p.lever_arm_b + estimate.parameters.segment<3>(gnss_position),
                estimate.nav.v_eb_e - p.state.nav.v_eb_e + C * w_eb_b.cross(p.lever_arm_b) + estimate.parameters.segment<3>(gnss_velocity);
            // clang-format on
            return z;
        };
        // The Earth's rate seen from a wrong attitude is left out of H: u |l| per radian.
        const VectorXd floor = (VectorXd(6) << 1e-8, 1e-8, 1e-8, 1e-6, 1e-6, 1e-6).finished();
        models.push_back({p.name, H, output, step, tolerance_of(H, 1e-6, floor, step.cwiseInverse())});
    }
    return models;
}

TEST(GravityModel, EntriesOfThePapersScenario) {
    // Earth-fixed specific force and w0^2 of math.md section 4 (point-mass gradient: 0.5 % of it is the Earth's flattening).
    const earth::Earth earth;
    NavState nav;
    nav.position = {55.8114694 * units::deg, 37.4998612 * units::deg, 164.15};
    nav.v_eb_n = {1.0, 1.0, 0.0};
    nav.q_nb = math::quaternion_from_rpy({0.0, 0.0, 45.0 * units::deg});
    const NavStateEcef s = ins::to_ecef(earth, nav);
    const earth::EarthTerms terms = earth::terms_at(earth, nav.position, nav.v_eb_n);
    const Vector3d f_n = (2.0 * terms.w_ie_n + terms.w_en_n).cross(nav.v_eb_n) + Vector3d(0.0, 0.0, -9.8156);
    const StateMatrix F = gravity_error_dynamics(
        earth, {DisturbanceKind::FirstOrder, 3600.0, Vector3d::Ones(), true, DisturbanceAxes::EarthFixed},
        {s.position, s.v_eb_e, s.q_eb.toRotationMatrix(), earth::C_en(nav.position.lat, nav.position.lon) * f_n});
    EXPECT_NEAR(F(velocity + 0, attitude + 1), -8.11939621608, 1e-8);
    EXPECT_NEAR(F(velocity + 1, attitude + 2), -4.37575397291, 1e-8);
    EXPECT_NEAR(F(velocity + 2, attitude + 0), -3.35746492146, 1e-8);
    EXPECT_NEAR(F(velocity + 0, velocity + 1), 0.0001458423, 1e-15);
    EXPECT_NEAR(F(random + 2, random + 2), -1.0 / 3600.0, 1e-18);
    EXPECT_NEAR(F(velocity + 0, position + 2), 1.71530742741e-06, 0.01 * 1.5e-6);
    EXPECT_NEAR(F(velocity + 2, position + 2), 1.61478452143e-06, 0.01 * 1.5e-6);
    EXPECT_EQ(F(velocity + 1, systematic + 1), 1.0);
}

const Geodetic passed{0.9, 0.4, 500.0};

/// A hundred steps of a second at 20 m/s and a hundred at 60 m/s, for disturbances run along the track. Metres.
template <class Each>
double sped_up(const DisturbanceModel& model, Each each) {
    const earth::Earth earth;
    const Ecef place = earth::ecef_from_geodetic(earth.ellipsoid, passed);
    const Matrix3d C_en = earth::C_en(passed.lat, passed.lon);
    double distance = 0.0;
    for (int second = 0; second < 200; ++second) {
        const double speed = second < 100 ? 20.0 : 60.0;
        const Motion motion{place, C_en * Vector3d(speed, 0.0, 0.0), Matrix3d::Identity(), Vector3d::Zero()};
        each(discretized(gravity_error_dynamics(earth, model, motion), gravity_noise_input(earth, model, {}, motion), 1.0));
        distance += speed;
    }
    return distance;
}

TEST(GravityModel, DisturbancesStayInTheirStationaryState) {
    // And their correlation is the closed function of the distance.
    for (const DisturbanceKind kind : {DisturbanceKind::FirstOrder, DisturbanceKind::SecondOrder, DisturbanceKind::ThirdOrder}) {
        const DisturbanceModel model{
            kind, 5000.0, Vector3d(2e-4, 3e-4, 5e-4), false,
            kind == DisturbanceKind::SecondOrder ? DisturbanceAxes::EarthFixed : DisturbanceAxes::LocalLevel};
        const Matrix3d axes = model.from_local_level(earth::C_en(passed.lat, passed.lon));
        const Matrix3d sigma = axes * model.sigma_n.cwiseAbs2().asDiagonal() * axes.transpose();
        StateMatrix P = StateMatrix::Zero(), Phi = StateMatrix::Identity();
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) P.block<3, 3>(random + 3 * i, random + 3 * j) = model.stationary()(i, j) * sigma;
        const StateMatrix before = P;
        const double distance = sped_up(model, [&](const DiscreteStep& one) {
            P = (one.Phi * P * one.Phi.transpose() + one.Q).eval();
            Phi = (one.Phi * Phi).eval();
        });
        const double x = distance / model.length;
        const double correlation = std::exp(-x) * (kind == DisturbanceKind::FirstOrder    ? 1.0
                                                   : kind == DisturbanceKind::SecondOrder ? 1.0 + x
                                                                                          : 1.0 + x + x * x / 3.0);
        const auto value = [](const StateMatrix& M) { return Matrix3d(M.block<3, 3>(random, random)); };
        EXPECT_LT((value(P) - sigma).norm(), 2e-4 * sigma.norm()) << static_cast<int>(kind);
        EXPECT_LT((value(Phi * before) - correlation * sigma).norm(), 1e-6 * sigma.norm()) << static_cast<int>(kind);
        if (kind == DisturbanceKind::ThirdOrder) {
            const Matrix3d slopes = P.block<3, 3>(slope, slope), curves = P.block<3, 3>(curvature, curvature);
            const double k2 = 1.0 / (model.length * model.length);
            EXPECT_LT((slopes - k2 / 3.0 * sigma).norm(), 1e-3 * k2 * sigma.norm());
            EXPECT_LT((curves - k2 * k2 * sigma).norm(), 1e-3 * k2 * k2 * sigma.norm());
        }
    }
}

TEST(GravityModel, PolynomialsFollowTheDistance) {
    // Value, slope and second derivative of a parabola at the place that was reached.
    const double value = 3e-4, by_metre = -2e-8;
    for (const auto& [kind, degree, by_square_metre] : {std::tuple{DisturbanceKind::RampAndFirstOrder, 1, 0.0},
                                                        std::tuple{DisturbanceKind::QuadraticAndFirstOrder, 2, 5e-12}}) {
        const DisturbanceModel model{kind, 5000.0, Vector3d::Zero()};
        StateVector x = StateVector::Zero();
        x(systematic + 2) = value;
        x(slope + 2) = by_metre;
        x(curvature + 2) = by_square_metre;
        const double s = sped_up(model, [&x](const DiscreteStep& one) { x = (one.Phi * x).eval(); });
        EXPECT_NEAR(x(systematic + 2), value + s * by_metre + 0.5 * s * s * by_square_metre, 1e-12);
        EXPECT_NEAR(x(slope + 2), by_metre + s * by_square_metre, 1e-16);
        EXPECT_EQ(states_of(model), 27 + 3 * degree);
    }
}

}  // namespace
}  // namespace schuler::gravimetry
