#include "schuler/ahrs/magnetometer_axes.h"

#include "schuler/ahrs/field_turns.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::ahrs {
namespace {

using Eigen::Matrix3d;

/// Mean component of the field opposite to the specific force, T: positive downwards.
double downward(std::span<const ImuSample> imu, std::span<const MagSample> mag, const Matrix3d& C) {
    double sum = 0.0;
    std::size_t i = 0;
    for (const MagSample& s : mag) {
        while (i + 1 < imu.size() && imu[i + 1].time <= s.time) ++i;
        const double size = imu[i].accel.norm();
        if (size > 0.0 && std::isfinite(size) && s.field_b.allFinite()) sum -= imu[i].accel.dot(C * s.field_b) / size;
    }
    return sum;
}

}  // namespace

MagnetometerAxes recognise_axes(std::span<const ImuSample> imu, std::span<const MagSample> mag, double field_down) {
    MagnetometerAxes out;
    if (imu.size() < 2 || mag.size() < 2) return out;
    const FieldTurns turns(Turning(imu), reading_pairs(mag));
    if (!turns.enough()) return out;
    double best = std::numeric_limits<double>::infinity(), second = best, given = best;
    Matrix3d C = Matrix3d::Identity();
    for (const Matrix3d& candidate : axes_candidates()) {
        const double left = turns.unexplained(candidate).left;
        if (candidate.isIdentity()) given = left;
        if (left < best) {
            second = best;
            best = left;
            C = candidate;
        } else {
            second = std::min(second, left);
        }
    }
    out.as_given = 1.0 - given / turns.changes();
    out.explained = out.as_given;
    if (!turns.clearly_worse(second, best) || best > unconvincing * turns.changes()) return out;
    const bool known = std::isfinite(field_down);
    if (C.isIdentity() && !known) return out;  // all three axes reversed, or south of the equator
    const bool down = downward(imu, mag, C) > 0.0;
    out.C_bs = down == (!known || field_down > 0.0) ? C : Matrix3d(-C);
    out.swapped = !out.C_bs.isIdentity();
    out.sign_assumed = out.swapped && !known;
    out.explained = 1.0 - best / turns.changes();
    return out;
}

std::string axes_text(const Matrix3d& C_bs) {
    constexpr std::array names{'x', 'y', 'z'};
    std::string out;
    for (std::size_t r = 0; r < 3; ++r) {
        Eigen::Index c = 0;
        C_bs.row(static_cast<Eigen::Index>(r)).cwiseAbs().maxCoeff(&c);
        if (r > 0) out += ", ";
        out += names[r];
        out += C_bs(static_cast<Eigen::Index>(r), c) < 0.0 ? " = -" : " = ";
        out += names[static_cast<std::size_t>(c)];
    }
    return out;
}

}  // namespace schuler::ahrs
