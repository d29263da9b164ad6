#include "schuler/theory/level_dynamics.h"

#include <cmath>

namespace schuler::theory {

Matrix9 level_error_dynamics(const earth::Earth& earth, const Geodetic& position, const Eigen::Vector3d& v_enu,
                             const Eigen::Vector3d& f_enu) {
    const double s = std::sin(position.lat), c = std::cos(position.lat), t = s / c;
    const double e2 = earth.ellipsoid.e2(), W = 1.0 - e2 * s * s, u = earth.ellipsoid.w_ie;
    const double R1 = earth.ellipsoid.a / std::sqrt(W), R2 = R1 * (1.0 - e2) / W;  // prime vertical, meridian
    const double R1_lat = R1 * e2 * s * c / W, R2_lat = 3.0 * R2 * e2 * s * c / W;
    const double RN = R1 + position.h, RM = R2 + position.h;
    const double VE = v_enu(0), VN = v_enu(1), Vh = v_enu(2);
    const double lon_rate = VE / (RN * c), lat_rate = VN / RM;
    const double U = 2.0 * u + lon_rate, q = t - R1_lat / RN;
    const double w_e = -lat_rate, w_n = (u + lon_rate) * c, w_h = (u + lon_rate) * s;
    const earth::GravityGradient slope = earth::gravity_gradient(earth.gravity, position.lat, position.h);

    Matrix9 F = Matrix9::Zero();
    F(d_lon, d_lat) = lon_rate * q;
    F(d_lon, d_h) = -lon_rate / RN;
    F(d_lon, d_ve) = 1.0 / (RN * c);
    F(d_lat, d_lat) = -lat_rate * R2_lat / RM;
    F(d_lat, d_h) = -lat_rate / RM;
    F(d_lat, d_vn) = 1.0 / RM;
    F(d_h, d_vu) = 1.0;

    F(d_ve, d_lat) = (VN * c + Vh * s) * U + (VN * s - Vh * c) * lon_rate * q;
    F(d_ve, d_h) = -(VN * s - Vh * c) * lon_rate / RN;
    F(d_ve, d_ve) = (VN * s - Vh * c) / (RN * c);
    F(d_ve, d_vn) = U * s;
    F(d_ve, d_vu) = -U * c;
    F(d_ve, a_n) = -f_enu(2);
    F(d_ve, a_u) = f_enu(1);
    F(d_vn, d_lat) = -VE * c * U - VE * s * lon_rate * q + lat_rate * Vh * R2_lat / RM;
    F(d_vn, d_h) = VE * s * lon_rate / RN + lat_rate * Vh / RM;
    F(d_vn, d_ve) = -2.0 * w_h;
    F(d_vn, d_vn) = -Vh / RM;
    F(d_vn, d_vu) = -lat_rate;
    F(d_vn, a_e) = f_enu(2);
    F(d_vn, a_u) = -f_enu(0);
    F(d_vu, d_lat) = -2.0 * u * VE * s - VE * c * lon_rate * R1_lat / RN - lat_rate * lat_rate * R2_lat - slope.by_lat;
    F(d_vu, d_h) = -VE * c * lon_rate / RN - lat_rate * lat_rate - slope.by_height;
    F(d_vu, d_ve) = 2.0 * w_n;
    F(d_vu, d_vn) = 2.0 * lat_rate;
    F(d_vu, a_e) = -f_enu(1);
    F(d_vu, a_n) = f_enu(0);

    F(a_e, d_lat) = lat_rate * R2_lat / RM;
    F(a_e, d_h) = lat_rate / RM;
    F(a_e, d_vn) = -1.0 / RM;
    F(a_e, a_n) = w_h;
    F(a_e, a_u) = -w_n;
    F(a_n, d_lat) = -u * s - VE * R1_lat / (RN * RN);
    F(a_n, d_h) = -VE / (RN * RN);
    F(a_n, d_ve) = 1.0 / RN;
    F(a_n, a_e) = -w_h;
    F(a_n, a_u) = w_e;
    F(a_u, d_lat) = u * c + VE / (RN * c * c) - VE * t * R1_lat / (RN * RN);
    F(a_u, d_h) = -VE * t / (RN * RN);
    F(a_u, d_ve) = t / RN;
    F(a_u, a_e) = w_n;
    F(a_u, a_n) = -w_e;
    return F;
}

Eigen::Vector3d steady_level_force(const earth::Earth& earth, const Geodetic& position, const Eigen::Vector3d& v_enu) {
    const double s = std::sin(position.lat), c = std::cos(position.lat);
    const earth::Radii r = earth::radii(earth.ellipsoid, position.lat);
    const double U = 2.0 * earth.ellipsoid.w_ie + v_enu(0) / ((r.prime_vertical + position.h) * c);
    const double lat_rate = v_enu(1) / (r.meridian + position.h);
    return {-(v_enu(1) * s - v_enu(2) * c) * U, v_enu(0) * s * U + lat_rate * v_enu(2),
            earth::gravity_down(earth.gravity, position.lat, position.h) - v_enu(0) * c * U - lat_rate * v_enu(1)};
}

double Pendulum::frequency() const { return std::sqrt(g / R); }
double Pendulum::from_tilt(double tilt, double t) const {
    const double s = std::sin(0.5 * frequency() * t);
    return 2.0 * R * tilt * s * s;
}
double Pendulum::from_gyro(double drift, double t) const {
    const double x = frequency() * t;  // the difference of nearly equal numbers by its series
    return R * drift / frequency() * (x < 0.02 ? x * x * x / 6.0 * (1.0 - x * x / 20.0) : x - std::sin(x));
}
double Pendulum::from_velocity(double dv, double t) const { return dv * std::sin(frequency() * t) / frequency(); }
double Pendulum::from_accelerometer(double bias, double t) const { return from_tilt(bias / g, t); }

}  // namespace schuler::theory
