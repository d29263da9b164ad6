// Errors of a strapdown INS moving along the equator at constant speed and height: paper C's linear system (10) and its closed
// solution (22), corrected (docs/theory.md) and written without its singularity at v = -u R.
#pragma once

#include "schuler/earth/ellipsoid.h"

#include <Eigen/Core>

#include <array>
#include <complex>

namespace schuler::theory {

/// The Earth of paper C, section 1, as a value: gravity g_eo (1 + delta sin^2 lat) a^2/(a + H)^2.
struct PaperCEarth {
    double u = earth::paper_c.w_ie;   ///< rotation, rad/s
    double a = earth::paper_c.a;      ///< semi-major axis, m
    double e2 = earth::paper_c.e2();  ///< first eccentricity squared; sections 4 and 5 of the paper use 0
    double g_eo = 9.78049;            ///< m/s^2
    double delta = 5.317e-3;
};

/// Errors (estimate minus truth) in the paper's order: velocity north, up, east (m/s), height (m), latitude, longitude (rad).
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
enum EquatorError { vn = 0, vh = 1, ve = 2, height = 3, lat = 4, lon = 5 };

/// The constants of (17), corrected: math.md 1.2.
struct EquatorConstants {
    double R;                         ///< a + H, m
    double g;                         ///< m/s^2
    double a_h;                       ///< specific force, up, m/s^2: changes sign at the limiting speeds
    double w_n;                       ///< rate of the local level about north, u + v/R, rad/s
    double k;                         ///< 2 u + v/R, rad/s
    double a24;                       ///< 1/s^2
    double omega;                     ///< frequency of the north channel, sqrt(g/R), rad/s
    std::complex<double> rho1, rho2;  ///< squared roots of the east-vertical channel, 1/s^2; Re rho1 >= Re rho2
    double beta3;                     ///< growing root, 1/s; NaN beyond a limiting speed
    double mu;                        ///< frequency of the east-vertical channel, rad/s; NaN beyond a limiting speed
};

/// Speeds of zero specific force: only between them does the east-vertical channel have two real and two imaginary roots.
struct SpeedLimits {
    double east, west;  ///< m/s, both positive
};
/// -u R + sqrt(u^2 R^2 + g R) and u R + sqrt(...), R = a + height. The paper uses the eastern one for both directions.
/// @throws Error(Input) as EquatorFlight does.
[[nodiscard]] SpeedLimits speed_limits(double height, const PaperCEarth& earth = {});

/// A constant flight along the equator. The Earth is a sphere here (e2 and delta have no effect).
class EquatorFlight {
public:
    /// speed: relative to the Earth, positive east, m/s; height in m. Speeds below 1e5 m/s, heights from -500 m to 1e8 m.
    /// @throws Error(Input) with key speed or height.
    EquatorFlight(double speed, double height, const PaperCEarth& earth = {});

    [[nodiscard]] double speed() const { return speed_; }
    [[nodiscard]] double height() const { return height_; }
    [[nodiscard]] const EquatorConstants& constants() const { return c_; }
    /// Between the limiting speeds, where the paper's form of the solution is valid.
    [[nodiscard]] bool within_limits() const { return within_; }
    /// All six roots, 1/s: north channel +-i omega, then +-sqrt(rho1), +-sqrt(rho2).
    [[nodiscard]] std::array<std::complex<double>, 6> roots() const;

    /// A of (10), per second.
    [[nodiscard]] Matrix6 dynamics() const;
    /// P(t) of (22): errors at t from errors at 0. Between the limiting speeds each element has a relative error of 1e-12 up to
    /// 7200 s, and structural zeros are exactly zero, including v = -u R. Beyond the limits the same form with complex roots,
    /// 1e-9. Not finite if beta3 t exceeds 700.
    [[nodiscard]] Matrix6 transition(double t) const;

    /// The part x(t) = A sin(w t + eps) of each error, w = omega for vn and lat, mu for the others.
    struct Oscillation {
        Vector6 amplitude;  ///< positive; NaN in vh, ve, height, lon beyond a limiting speed
        Vector6 phase;      ///< (-pi, pi]; NaN if the amplitude is zero
    };
    /// (18) and (19), positive amplitude and atan2: math.md 1.5.
    [[nodiscard]] Oscillation oscillation(const Vector6& initial) const;
    /// C_1 to C_6 of (16). C_3 to C_6 are NaN beyond a limiting speed.
    [[nodiscard]] Vector6 integration_constants(const Vector6& initial) const;

private:
    double speed_, height_;
    EquatorConstants c_;
    bool within_;
};

/// Errors due to a misaligned start: the second term of (23) with b of (8), corrected (math.md 1.7). l: the matrix lambda_ij =
/// dC^T C of the paper in inertial axes (pole, meridian, east of it); longitude: mu0 + lambda0, of the start of the flight in
/// those axes (rad). North velocity and latitude in closed form, the others by quadrature (1e-12 relative).
[[nodiscard]] Vector6 forced_by_misalignment(const EquatorFlight& flight, const Eigen::Matrix3d& l, double longitude, double t);

/// lambda_ij of a small rotation error of the computed attitude, C_est = (I - [e x]) C, e in inertial axes (rad): [e x].
[[nodiscard]] Eigen::Matrix3d misalignment_matrix(const Eigen::Vector3d& e);

}  // namespace schuler::theory
