// The natural modes of a strapdown INS's errors at any state: Schuler, Foucault, 24-hour and vertical modes, their excitation,
// and the effect of a barometric loop on the vertical one.
#pragma once

#include "schuler/theory/level_dynamics.h"

#include <complex>
#include <string>
#include <vector>

namespace schuler::theory {

/// Treatment of the height. The poles of the loops lie on a circle of 1/time_constant (Butterworth; the coupling to the
/// horizontal channels moves them by 1e-4 of that). Second order: dh' = dv_u - k1 (dh - baro), dv_u' = ... - k2 (dh - baro);
/// third order: in addition the integral of the height difference, so that a constant accelerometer error causes no height error.
enum class VerticalChannel { Fixed, Free, SecondOrder, ThirdOrder };

/// "fixed", "free", "second", "third". @throws Error(Input) that lists them.
[[nodiscard]] VerticalChannel vertical_channel_from_name(const std::string& name);

/// Constant errors of the instruments, MEASURED MINUS TRUE, in east-north-up axes of the local level.
struct ConstantErrors {
    Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< rad/s
    Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< m/s^2
    double baro = 0.0;                                ///< m
};

/// The state at which the dynamics are evaluated and frozen (exact at rest and along a parallel at constant height).
struct LevelFlight {
    earth::Earth earth;
    Geodetic position;
    Eigen::Vector3d v_enu = Eigen::Vector3d::Zero();  ///< m/s
    VerticalChannel vertical = VerticalChannel::Fixed;
    double time_constant = 100.0;  ///< of the barometer loop, s
};

/// The nine errors of level_dynamics.h and, tenth, the integral of the third-order loop (m/s^2).
using Vector10 = Eigen::Matrix<double, 10, 1>;
using Matrix10 = Eigen::Matrix<double, 10, 10>;

/// One mode: a pair of conjugate roots or a real root, and its errors.
struct Mode {
    std::string name;           ///< "Schuler, faster", "Schuler, slower", "24-hour", "vertical", "vertical loop", ...
    std::complex<double> root;  ///< 1/s, Im >= 0
    /// Amplitude at t = 0 of east, north, up error (m), velocity east, north, up (m/s), attitude about east, north, up (rad).
    Vector9 amplitude;
};

struct ModalAnalysis {
    std::vector<Mode> modes;   ///< fastest oscillation first, then the real ones
    Vector9 offset;            ///< constant part of each error (longitude: 0), units as in Mode
    Vector9 drift;             ///< part that grows linearly with time: east only, m/s; the others zero
    double foucault;           ///< half the difference of the two Schuler frequencies, rad/s; NaN if there are not two of them
    double foucault_expected;  ///< (u + v_e/((R + h) cos lat)) |sin lat|, rad/s
};

/// Errors at an instant, as in Mode.
struct ErrorsAt {
    double t;
    Vector9 errors;
};

/// @throws Error(Input) for a state at a pole (|lat| > 89.9 deg), below ground or not finite, a time constant that is not
/// positive, or a height error, vertical velocity or vertical accelerometer error with a fixed height, where it has no effect.
class LevelAnalysis {
public:
    LevelAnalysis(const LevelFlight& flight, const Vector9& initial, const ConstantErrors& constant);

    /// dx/dt = F x + d, x as Vector10 with angles; rows and columns of a fixed height are zero.
    [[nodiscard]] const Matrix10& dynamics() const { return F_; }
    [[nodiscard]] const Vector10& driving() const { return d_; }
    /// Roots, names and amplitudes. @throws Error(Computation) if the modes are not distinct.
    [[nodiscard]] ModalAnalysis modes() const;
    /// Errors at count equal intervals up to the duration, including 0: exact (matrix exponential).
    [[nodiscard]] std::vector<ErrorsAt> history(double duration, int count) const;
    /// Roots of the vertical channel alone, first without a loop, then with this one.
    [[nodiscard]] std::vector<std::complex<double>> vertical_roots(VerticalChannel channel) const;

private:
    [[nodiscard]] Vector9 in_metres(const Vector10& x) const;

    LevelFlight flight_;
    Matrix10 F_;
    Vector10 d_, x_;
    double east_, north_;  ///< metres per radian of longitude and latitude
};

}  // namespace schuler::theory
