// Rows of every measurement and of the propagation, with every optional state present, against differences of what they linearise.
#include "schuler/core/units.h"
#include "schuler/filter/measurement/body_velocity.h"
#include "schuler/filter/measurement/constraint.h"
#include "schuler/filter/measurement/environment.h"
#include "schuler/filter/measurement/gauge.h"
#include "schuler/filter/measurement/gnss.h"
#include "schuler/filter/measurement/odometer.h"
#include "schuler/filter/update/pass.h"
#include "schuler/ins/state_error.h"
#include "schuler/math/rotation.h"
#include "support/draws.h"
#include "support/perturbation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace schuler::filter {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using schuler::test::LinearModel;
using schuler::test::tolerance_of;

constexpr int N = 49;

Layout full_layout() {
    Layout L;
    L.gyro_scale = L.add("gyro_scale", "1", 3);
    L.accel_scale = L.add("accel_scale", "1", 3);
    L.mounting = L.add("mounting", "rad", 2);
    L.axle = L.add("axle", "m", 1);
    L.lever_arm = L.add("lever_arm", "m", 3);
    L.baro_bias = L.add("baro_bias", "m", 1);
    L.mag_bias = L.add("mag_heading_offset", "rad", 1);
    L.hard_iron = L.add("mag_hard_iron", "1", 3);
    L.mag_disturbance = L.add("mag_disturbance", "rad", 1);
    L.gnss_position = L.add("gnss_position_error", "m", 3);
    L.gnss_velocity = L.add("gnss_velocity_error", "m/s", 3);
    L.gnss_latency = L.add("gnss_latency_error", "s", 1);
    L.gnss_velocity_latency = L.add("gnss_velocity_latency_error", "s", 1);
    L.odometer_scale = L.add("odometer_scale", "1", 1);
    L.heading_offset = L.add("heading_offset", "rad", 1);
    L.gauge_level = L.add("gauge_level", "m", 3);
    L.gauges = 3;
    L.log_scale = L.add("log_scale", "1", 1);
    L.log_misalignment = L.add("log_misalignment", "rad", 2);
    return L;
}

/// The rows of a measurement, one below the other.
MatrixXd dense_rows(const Measurement& m) {
    MatrixXd H(m.dof, N);
    for (int i = 0; i < m.dof; ++i)
        for (int j = 0; j < N; ++j) H(i, j) = m.rows[static_cast<std::size_t>(i)](j);
    return H;
}

/// A value of each state's own size, for perturbations: m, m/s, rad, ...
VectorXd sizes(double position, double velocity, double attitude) {
    const Layout L = full_layout();
    VectorXd s = VectorXd::Ones(N);
    s.head<3>().setConstant(position);
    s.segment<3>(3).setConstant(velocity);
    s.segment<3>(6).setConstant(attitude);
    s.segment<3>(Layout::gyro_bias).setConstant(1e-4);
    s.segment<3>(Layout::accel_bias).setConstant(1e-2);
    s.segment<3>(L.gyro_scale).setConstant(1e-3);
    s.segment<3>(L.accel_scale).setConstant(1e-3);
    s.segment<2>(L.mounting).setConstant(1e-3);
    s.segment<3>(L.lever_arm).setConstant(0.1);
    s(L.axle) = 0.1;
    s(L.mag_bias) = s(L.mag_disturbance) = s(L.gnss_latency) = s(L.gnss_velocity_latency) = s(L.odometer_scale) =
        s(L.heading_offset) = 1e-3;
    s.segment<3>(L.hard_iron).setConstant(1e-3);
    s(L.log_scale) = s(L.log_misalignment) = s(L.log_misalignment + 1) = 1e-3;
    return s;
}

struct Point {
    Estimate truth;
    Vector3d f_b;  ///< m/s^2, while propagating
    std::string name;
};

std::vector<Point> random_points(int count) {
    std::mt19937_64 generator(20250301);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const auto vector = [&](double size) { return Vector3d(size * test::draw3(unit, generator)); };
    std::vector<Point> points;
    for (int k = 0; k < count; ++k) {
        Point p;
        Estimate& e = p.truth;
        e.layout = full_layout();
        e.nav.position = {80.0 * units::deg * unit(generator), 3.0 * unit(generator), 4000.0 + 4500.0 * unit(generator)};
        e.nav.v_eb_n = vector(40.0);
        e.nav.q_nb = math::quaternion_from_rotation_vector(vector(1.8));
        e.C_nb = e.nav.q_nb.toRotationMatrix();
        e.w_ib_b = vector(0.3);
        e.parameters.setZero(N);
        e.parameters.segment<3>(Layout::gyro_bias) = vector(1e-3);
        e.parameters.segment<3>(Layout::accel_bias) = vector(0.05);
        e.parameters.segment<2>(e.layout.mounting) = vector(0.1).head<2>();
        e.parameters(e.layout.axle) = 2.0 * unit(generator);
        e.parameters.segment<3>(e.layout.lever_arm) = vector(2.0);
        e.parameters(e.layout.baro_bias) = 20.0 * unit(generator);
        e.parameters(e.layout.mag_bias) = unit(generator);
        e.parameters(e.layout.mag_disturbance) = 0.2 * unit(generator);
        e.parameters.segment<3>(e.layout.hard_iron) = vector(0.3);
        e.parameters.segment<3>(e.layout.gnss_position) = vector(2.0);
        e.parameters.segment<3>(e.layout.gnss_velocity) = vector(0.1);
        e.parameters(e.layout.gnss_latency) = 0.05 * unit(generator);
        e.parameters(e.layout.gnss_velocity_latency) = 0.05 * unit(generator);
        e.parameters(e.layout.odometer_scale) = 0.02 * unit(generator);
        e.parameters(e.layout.heading_offset) = unit(generator);
        e.parameters.segment<3>(e.layout.gauge_level) = Vector3d(30.0, -20.0, 5.0);
        e.parameters.segment<3>(e.layout.log_scale) = Vector3d(-0.015, 0.01, 0.03);
        p.f_b = e.C_nb.transpose() * (Vector3d(0.0, 0.0, -9.8) + vector(5.0));
        p.name = "point " + std::to_string(k);
        points.push_back(p);
    }
    return points;
}

/// The estimate with error dx: states by their convention; the corrected rate errs by minus the error of the gyro bias.
Estimate erring(const Estimate& truth, const VectorXd& dx) {
    Estimate e = truth;
    e.nav = ins::perturbed(truth.earth, truth.nav, dx.head<9>());
    e.C_nb = e.nav.q_nb.toRotationMatrix();
    e.w_ib_b = truth.w_ib_b - dx.segment<3>(Layout::gyro_bias);
    e.parameters.segment(9, N - 9) += dx.tail(N - 9);
    return e;
}

/// A measurement, a function of the estimate, at a point. attitude_floor: what the rows leave out on purpose for an attitude error,
/// per radian.
template <class Function>
LinearModel model_at(const Point& p, Function function, double attitude_floor = 1e-9) {
    const Measurement m = function(p.truth);
    EXPECT_GT(m.dof, 0) << p.name;
    const MatrixXd H = dense_rows(m);
    const auto output = [function, truth = p.truth](const VectorXd& dx) {
        const Measurement at = function(erring(truth, dx));
        return VectorXd(at.innovation.head(at.dof));
    };
    // Metres per metre: the radii of parallels some metres apart differ by 1e-5 near the poles.
    VectorXd column = VectorXd::Constant(N, 1e-8);
    column.head<3>().setConstant(1e-5);
    column.segment<3>(6).setConstant(attitude_floor);
    return {p.name, H, output, sizes(10.0, 0.1, 1e-3), tolerance_of(H, 1e-7, VectorXd::Ones(m.dof), column)};
}

template <class Function>
std::vector<LinearModel> models_of(Function function, double attitude_floor = 1e-9) {
    std::vector<LinearModel> models;
    for (const Point& p : random_points(12)) models.push_back(model_at(p, function, attitude_floor));
    return models;
}

const Vector3d unused_arm = Vector3d::Constant(777.0);  // the lever arm is a state here
const Vector3d variance(0.1, 0.2, 0.3);

Geodetic near_to(const Estimate& e) { return earth::moved_by_ned(e.earth, e.nav.position, Vector3d(3.0, -2.0, 1.0)); }

// The Earth's rate turned by an attitude error is left out of the rate of the lever arm: 7e-5 rad/s times the arm (below 3.5 m), in a
// position times the latency (below 0.05 s).
constexpr double earth_rate = 7.3e-5 * 3.5;

SCHULER_JACOBIAN(gnss_position, "filter.gnss_position") {
    std::vector<LinearModel> models;
    for (const Components use : {Components{}, Components{true, true, false}, Components{false, false, true}}) {
        std::vector<Geodetic> measured;
        for (const Point& p : random_points(12)) measured.push_back(near_to(p.truth));
        std::size_t k = 0;
        for (const Point& p : random_points(12)) {
            const Geodetic fix = measured[k];
            std::vector<LinearModel> all = models_of(
                [fix, use](const Estimate& e) { return gnss_position(e, fix, variance, unused_arm, use); }, 0.05 * earth_rate);
            models.push_back(all[k]);
            models.back().where = p.name;
            ++k;
        }
    }
    return models;
}

SCHULER_JACOBIAN(gnss_velocity, "filter.gnss_velocity") {
    return models_of([](const Estimate& e) { return gnss_velocity(e, Vector3d(1.0, 2.0, 3.0), variance, unused_arm, -1, {}); },
                     earth_rate);
}

SCHULER_JACOBIAN(baro_height, "filter.baro_height") {
    return models_of([](const Estimate& e) { return baro_height(e, 90.0, 1.0); });
}

SCHULER_JACOBIAN(magnetic_azimuth, "filter.magnetic_azimuth") {
    // A field that points north and down at the truth, seen in the body.
    std::vector<LinearModel> models;
    for (const Point& p : random_points(12)) {
        const Vector3d field_b = p.truth.C_nb.transpose() * Vector3d(20.0, 3.0, 40.0);
        models.push_back(model_at(p, [field_b](const Estimate& e) { return magnetic_azimuth(e, field_b, 0.1, 0.01); }));
    }
    return models;
}

SCHULER_JACOBIAN(zero_velocity, "filter.zero_velocity") {
    return models_of([](const Estimate& e) { return zero_velocity(e, 0.01); });
}

SCHULER_JACOBIAN(zero_rate, "filter.zero_rate") {
    return models_of([](const Estimate& e) { return zero_rate(e, Vector3d(1e-3, 2e-3, 3e-3), 1e-6); }, 1e-10);
}

SCHULER_JACOBIAN(nonholonomic, "filter.nonholonomic") {  // the Earth's rate as in gnss_velocity, at the axle (below 2 m)
    return models_of([](const Estimate& e) { return nonholonomic(e, 0.1, 0.2); }, 7.3e-5 * 2.0);
}

SCHULER_JACOBIAN(odometer_speed, "filter.odometer_speed") {
    return models_of([](const Estimate& e) { return odometer_speed(e, 3.0, 0.01); }, 7.3e-5 * 2.0);
}

SCHULER_JACOBIAN(heading_of_body, "filter.heading_of_body") {
    return models_of([](const Estimate& e) { return heading_of_body(e, 1.0, 0.01); });
}

const std::array<Vector3d, 3> gauge_arms{Vector3d(0.0, 0.0, 1.0), Vector3d(40.0, 1.0, 2.0), Vector3d(-10.0, 8.0, 2.0)};

SCHULER_JACOBIAN(gauge_heights, "filter.gauge_heights") {  // the turn of the vertical over a lever arm is left out
    return models_of([](const Estimate& e) { return gauge_heights(e, {100.0, 120.0, 90.0}, 0.01, gauge_arms); });
}

SCHULER_JACOBIAN(body_velocity, "filter.body_velocity") {
    return models_of([](const Estimate& e) { return body_velocity(e, {5.0, 1.0, 0.0}, 0.01, {12.0, -1.0, 3.0}); });
}

TEST(Measurements, VariancesGoWithTheirComponents) {
    const Estimate e = random_points(1)[0].truth;
    EXPECT_EQ(gnss_position(e, near_to(e), variance, unused_arm, {}).variance, variance);
    const Measurement down = gnss_position(e, near_to(e), variance, unused_arm, {false, false, true});
    EXPECT_EQ(down.dof, 1);
    EXPECT_EQ(down.variance(0), variance.z());
    const Measurement wheels = nonholonomic(e, 0.1, 0.2);
    EXPECT_EQ(wheels.dof, 2);
    EXPECT_DOUBLE_EQ(wheels.variance(0), 0.01);
    EXPECT_DOUBLE_EQ(wheels.variance(1), 0.04);
    // A field that is almost vertical points nowhere.
    EXPECT_EQ(magnetic_azimuth(e, e.C_nb.transpose() * Vector3d(1.0, 1.0, 40.0), 0.0, 0.01).dof, 0);
}

// Innovations are zero for perfect measurements, made by other formulas: in the Earth-fixed frame, with a turning antenna.
TEST(Measurements, PerfectMeasurementsHaveNoInnovation) {
    for (const Point& p : random_points(20)) {
        Estimate e = p.truth;
        e.layout.gnss_position = e.layout.gnss_velocity = e.layout.gnss_latency = -1;
        const NavStateEcef s = ins::to_ecef(e.earth, e.nav);
        const Matrix3d C_eb = s.q_eb.toRotationMatrix();
        const Vector3d arm = e.parameters.segment<3>(e.layout.lever_arm);
        const Vector3d w_ie_e(0.0, 0.0, e.earth.ellipsoid.w_ie);
        const Vector3d v_antenna = s.v_eb_e + C_eb * e.w_ib_b.cross(arm) - w_ie_e.cross(C_eb * arm);
        const Vector3d v_n = e.C_nb * C_eb.transpose() * v_antenna;
        NavStateEcef antenna = s;
        antenna.position.r += C_eb * arm;
        const Geodetic fix = ins::to_geographic(e.earth, antenna).position;
        EXPECT_LT(gnss_position(e, fix, variance, unused_arm, {}).innovation.norm(), 2e-5) << p.name;
        EXPECT_LT(gnss_velocity(e, v_n, variance, unused_arm, -1, {}).innovation.norm(), 1e-9) << p.name;
        // Without the state, the given lever arm counts.
        e.layout.lever_arm = -1;
        EXPECT_LT(gnss_position(e, fix, variance, arm, {}).innovation.norm(), 2e-5);
        EXPECT_LT(gnss_velocity(e, v_n, variance, arm, -1, {}).innovation.norm(), 1e-9);

        const Vector3d w_ie_b = C_eb.transpose() * w_ie_e, gyro_bias = e.parameters.segment<3>(Layout::gyro_bias);
        EXPECT_LT(zero_rate(e, w_ie_b + gyro_bias, 1.0).innovation.norm(), 1e-12);
        EXPECT_NEAR(baro_height(e, e.nav.position.h + e.parameters(e.layout.baro_bias), 1.0).innovation(0), 0.0, 1e-12);
        // declination less the magnetometer's errors
        const double azimuth = 0.3 - e.parameters(e.layout.mag_bias) - e.parameters(e.layout.mag_disturbance);
        const Vector3d field(std::cos(azimuth), std::sin(azimuth), 1.5);
        const Vector3d iron = e.parameters.segment<3>(e.layout.hard_iron);  // of a field whose horizontal part is 1
        EXPECT_NEAR(magnetic_azimuth(e, e.C_nb.transpose() * field + iron, 0.3, 1.0).innovation(0), 0.0, 1e-12);

        // A wheel rolls forward where the axle is: v of the IMU = v_axle forward + w x (axle to IMU).
        const Matrix3d C_bv = body_from_vehicle(e.parameters(e.layout.mounting), e.parameters(e.layout.mounting + 1));
        const Vector3d ahead(e.parameters(e.layout.axle), 0.0, 0.0);
        e.nav.v_eb_n = e.C_nb * (C_bv * Vector3d(17.0, 0.0, 0.0) + (e.w_ib_b - w_ie_b).cross(ahead));
        EXPECT_LT(nonholonomic(e, 1.0, 1.0).innovation.norm(), 1e-7) << p.name;
        const double shown = 17.0 * (1.0 + e.parameters(e.layout.odometer_scale));
        EXPECT_NEAR(odometer_speed(e, shown, 1.0).innovation(0), 0.0, 1e-7) << p.name;
        const Vector3d forward = e.C_nb.col(0);
        const double heading = std::atan2(forward.y(), forward.x()) + e.parameters(e.layout.heading_offset);
        EXPECT_NEAR(heading_of_body(e, heading, 1.0).innovation(0), 0.0, 1e-12);
    }
}

TEST(Measurements, GaugesAndLogShowWhatTheyShould) {
    Estimate e = random_points(1)[0].truth;
    const auto& L = e.layout;
    // A gauge that is not there leaves no row; the others say the height of their places, counted from the level of each.
    const Vector3d there(e.nav.position.h - (e.C_nb * gauge_arms[0]).z() + e.parameters(L.gauge_level), not_given,
                         e.nav.position.h - (e.C_nb * gauge_arms[2]).z() + e.parameters(L.gauge_level + 2));
    const Measurement m = gauge_heights(e, there, 0.01, gauge_arms);
    ASSERT_EQ(m.dof, 2);
    EXPECT_LT(m.innovation.norm(), 1e-9);
    EXPECT_EQ(m.rows[1](L.gauge_level + 2), 1.0);
    // Straight ahead at 10 m/s, 1 % too much, seen 0.02 rad to the left by a log that is turned to the right.
    e.nav.q_nb.setIdentity();
    e.C_nb.setIdentity();
    e.nav.v_eb_n = {10.0, 0.0, 0.0};
    e.parameters.segment<3>(L.log_scale) = Vector3d(0.01, 0.0, 0.02);
    e.w_ib_b =
        earth::terms_at(e.earth, e.nav.position, e.nav.v_eb_n).w_ie_n;  // no turn against the Earth: the arm does not matter
    EXPECT_LT(body_velocity(e, {10.1, 0.202, 0.0}, 0.01, {12.0, -1.0, 3.0}).innovation.norm(), 1e-9);
}

InertialModel model_of(const Estimate& e) {
    sensor::ImuErrorModel errors;
    errors.gyro_noise = 1e-3, errors.accel_noise = 2e-3;
    errors.gyro_bias = 1e-4, errors.gyro_bias_time = 300.0;    // first-order process
    errors.accel_bias = 1e-2, errors.accel_bias_time = 100.0;  // with a turn-on part: a random walk
    errors.accel_turn_on_bias = 0.1;
    return {e.earth, e.layout, errors};
}

template <class Frame>
InertialFilter<Frame> filter_at(const Estimate& e) {
    InertialFilter<Frame> f(model_of(e));
    f.set_nav(Frame::from_geographic(e.earth, e.nav));
    f.parameters.head(N) = e.parameters;  // a filter has room for a multiple of four
    f.w_ib_b = e.w_ib_b;
    return f;
}

NavState perturbed(const earth::Earth& earth, const NavState& s, const Vector9& dx) { return ins::perturbed(earth, s, dx); }
NavStateEcef perturbed(const earth::Earth&, const NavStateEcef& s, const Vector9& dx) { return ins::perturbed(s, dx); }

Vector3d attitude_error(const Eigen::Quaterniond& estimate, const Eigen::Quaterniond& truth) {
    return -math::rotation_vector_from_quaternion(estimate * truth.conjugate());
}
Vector9 error_between(const earth::Earth& earth, const NavState& estimate, const NavState& truth) {
    const Eigen::Vector3d position = -earth::ned_difference(earth, truth.position, estimate.position);
    const Eigen::Vector3d attitude = attitude_error(estimate.q_nb, truth.q_nb);
    Vector9 x;
    x.segment<3>(0) = position;
    x.segment<3>(3) = estimate.v_eb_n - truth.v_eb_n;
    x.segment<3>(6) = attitude;
    return x;
}
Vector9 error_between(const earth::Earth&, const NavStateEcef& estimate, const NavStateEcef& truth) {
    const Eigen::Vector3d attitude = attitude_error(estimate.q_eb, truth.q_eb);
    Vector9 x;
    x.segment<3>(0) = estimate.position.r - truth.position.r;
    x.segment<3>(3) = estimate.v_eb_e - truth.v_eb_e;
    x.segment<3>(6) = attitude;
    return x;
}

/// g(0) from g(h), g(h/2), g(h/4), error of order h^3.
template <class Function>
auto extrapolated(Function g) {
    const double h = 0.2;
    return ((8.0 * g(0.25 * h) - 6.0 * g(0.5 * h) + g(h)) / 3.0).eval();
}

/// Growth of the errors in a vanishing step, by the transition and by stepping two filters that differ by dx.
template <class Frame>
std::vector<LinearModel> transition_models() {
    std::vector<LinearModel> models;
    for (const Point& p : random_points(10)) {
        Estimate truth = p.truth;
        truth.w_ib_b *= 0.1;
        InertialModel model = model_of(truth);
        model.gyro_psd = 0.0;  // a known rate: nothing is withheld from the column of the lever arm
        const auto raw = [p, truth](double dt) {
            return ImuIncrement{Time::from_seconds(dt), dt, dt * (truth.w_ib_b + truth.parameters.segment<3>(Layout::gyro_bias)),
                                dt * (p.f_b + truth.parameters.segment<3>(Layout::accel_bias))};
        };
        const MatrixXd F = extrapolated([&](double dt) {
            InertialFilter<Frame> f = filter_at<Frame>(truth);
            estim::Transition phi;
            f.propagate(model, raw(dt), {});
            (void)f.propagate_covariance(model, phi);
            MatrixXd dense(N, N);
            for (int i = 0; i < N; ++i) dense.col(i) = phi.times(estim::StateVector::Unit(N, i));
            return MatrixXd((dense - MatrixXd::Identity(N, N)) / dt);
        });
        const auto output = [truth, model, raw](const VectorXd& dx) {
            return VectorXd(extrapolated([&](double dt) {
                InertialFilter<Frame> t = filter_at<Frame>(truth), e = t;
                e.set_nav(perturbed(truth.earth, t.nav, dx.head<9>()));
                e.parameters.segment(9, N - 9) += dx.tail(N - 9);
                estim::Transition phi;
                for (InertialFilter<Frame>* f : {&t, &e}) {
                    f->propagate(model, raw(dt), {});
                    (void)f->propagate_covariance(model, phi);
                }
                VectorXd after(N);
                after.head<9>() = error_between(truth.earth, e.nav, t.nav);
                after.tail<N - 9>() = (e.parameters - t.parameters).segment(9, N - 9);
                return VectorXd((after - dx) / dt);
            }));
        };
        const VectorXd step = sizes(1e3, 1.0, 1e-3);
        VectorXd row = VectorXd::Constant(N, 1e-12);
        row.head<3>().setConstant(1e-7);
        row.segment<3>(3).setConstant(3e-8);
        models.push_back({p.name, F, output, step, tolerance_of(F, 3e-6, row, step.cwiseInverse())});
    }
    return models;
}

SCHULER_JACOBIAN(propagation_geographic, "filter.propagation_geographic") { return transition_models<GeographicFrame>(); }
SCHULER_JACOBIAN(propagation_ecef, "filter.propagation_ecef") { return transition_models<EarthFixedFrame>(); }

// Rows in the filter's own errors, whatever they are.
template <class Frame, class Function>
std::vector<LinearModel> mapped_models(Function function, double attitude_floor) {
    std::vector<LinearModel> models;
    for (const Point& p : random_points(10)) {
        const Estimate truth = p.truth;
        const InertialModel model = model_of(truth);
        const InertialFilter<Frame> f = filter_at<Frame>(truth);
        const Measurement m = f.to_own(model, function(truth, f.estimate(model)));
        const MatrixXd H = dense_rows(m);
        const auto output = [function, truth, model, f](const VectorXd& dx) {
            InertialFilter<Frame> e = f;
            e.set_nav(perturbed(truth.earth, f.nav, dx.head<9>()));
            e.parameters.segment(9, N - 9) += dx.tail(N - 9);
            e.w_ib_b -= dx.segment<3>(Layout::gyro_bias);
            const Measurement at = function(truth, e.estimate(model));
            return VectorXd(at.innovation.head(at.dof));
        };
        VectorXd column = VectorXd::Constant(N, 1e-8);
        column.head<3>().setConstant(1e-5);
        column.segment<3>(6).setConstant(attitude_floor);
        models.push_back({p.name, H, output, sizes(10.0, 0.1, 1e-3), tolerance_of(H, 1e-6, VectorXd::Ones(m.dof), column)});
    }
    return models;
}

SCHULER_JACOBIAN(ecef_position, "filter.gnss_position_ecef") {
    return mapped_models<EarthFixedFrame>(
        [](const Estimate& at, const Estimate& e) { return gnss_position(e, near_to(at), variance, unused_arm, {}); },
        0.05 * earth_rate);
}
SCHULER_JACOBIAN(ecef_velocity, "filter.gnss_velocity_ecef") {
    return mapped_models<EarthFixedFrame>(
        [](const Estimate&, const Estimate& e) {
            return gnss_velocity(e, {1.0, 2.0, 3.0}, variance, unused_arm, e.layout.gnss_velocity_latency, {});
        },
        3e-4);
}
SCHULER_JACOBIAN(ecef_nonholonomic, "filter.nonholonomic_ecef") {
    return mapped_models<EarthFixedFrame>([](const Estimate&, const Estimate& e) { return nonholonomic(e, 0.1, 0.2); }, 3e-4);
}

// Biases: a first-order process keeps its variance, a random walk has 2 sigma^2 / time per second; white noise per step.
TEST(Propagation, NoiseOfTheStates) {
    const Estimate e = random_points(1)[0].truth;
    const InertialModel model = model_of(e);
    InertialFilter<GeographicFrame> f = filter_at<GeographicFrame>(e);
    estim::Transition phi;
    const double dt = 0.02;
    const BridgeNoise bridge{3e-6, 5e-6};
    f.propagate(model, {Time{}, dt, Vector3d::Zero(), Vector3d::Zero()}, bridge);
    ASSERT_TRUE(f.propagate_covariance(model, phi));
    EXPECT_FALSE(f.propagate_covariance(model, phi));
    // the biases' walks reach attitude and velocity in the third order of the step
    const double gyro_walk = 2e-8 / 300.0 * dt * dt * dt / 3.0, accel_walk = 2e-4 / 100.0 * dt * dt * dt / 3.0;
    const double decay = std::exp(-2.0 * dt / 300.0);
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(f.P(3 + i, 3 + i), (4e-6 + 5e-6) * dt + accel_walk, 1e-13);  // and what tilt makes of the bias
        EXPECT_NEAR(f.P(6 + i, 6 + i), (1e-6 + 3e-6) * dt + gyro_walk, 1e-20);
        EXPECT_NEAR(f.P(9 + i, 9 + i), 1e-8 * (1.0 - decay), 1e-18);
        EXPECT_NEAR(f.P(12 + i, 12 + i), 2.0 * 1e-4 / 100.0 * dt, 1e-18);
        EXPECT_NEAR(phi.diagonal(9 + i), std::sqrt(decay), 1e-15);
        EXPECT_EQ(phi.diagonal(12 + i), 1.0);
    }
    EXPECT_EQ(VectorXd(f.P.diagonal().tail(N - 15)), VectorXd(VectorXd::Zero(N - 15)));
}

}  // namespace
}  // namespace schuler::filter
