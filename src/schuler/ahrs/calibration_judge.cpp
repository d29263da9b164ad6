// Evaluation of a calibration with held-out parts of a log.
#include "schuler/ahrs/calibration.h"
#include "schuler/core/units.h"
#include "schuler/math/rotation.h"

#include <Eigen/Geometry>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace schuler::ahrs {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int parts = 4;                     // interleaved parts of the log: intervals 0, 4, 8, ... are part 0
constexpr double stretch = 8.0;              // s
constexpr std::size_t pieces = 8;            // consecutive parts, in each of which a calibration must be valid
constexpr double worse_piece = 1.2;          // of the mean square there
constexpr double least_turning = 0.1e-6;     // T, below which it is irrelevant
constexpr double clear_gain = 0.9;           // a quantity has improved if its mean square has fallen to this fraction
constexpr double largest_offset_std = 1e-6;  // T; the filters themselves determine a hard iron of about 2 uT
constexpr double tolerated = 1.02;           // and is not worse below this

/// One magnetometer reading with the corresponding gyro and accelerometer data.
struct Reading {
    Vector3d field, next;  // T; `next` about 0.2 s later
    Matrix3d turn;         // C of the later body axes from these, by the gyro
    Vector3d down;         // opposite to the specific force; zero if that is not gravity alone
    int part = 0;
};

std::vector<Reading> readings_of(std::span<const ImuSample> imu, std::span<const MagSample> mag) {
    constexpr double interval = 0.2, longest = 0.5, not_gravity = 0.3;
    std::vector<Reading> out;
    std::vector<double> norms;
    std::size_t i = 0, first = 0;
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    Vector3d force = Vector3d::Zero();
    for (std::size_t m = 1; m < mag.size(); ++m) {
        for (; i + 1 < imu.size() && imu[i + 1].time <= mag[m].time; ++i) {
            if (imu[i + 1].time <= mag[first].time) continue;
            const double dt = (imu[i + 1].time - std::max(imu[i].time, mag[first].time)).seconds();
            q = q * math::quaternion_from_rotation_vector(imu[i + 1].gyro * dt);
            force += q * imu[i + 1].accel * dt;  // in the axes of the first reading
        }
        const double span = (mag[m].time - mag[first].time).seconds();
        if (span < interval) continue;
        const Vector3d mean = force / span;
        if (span < longest && q.coeffs().allFinite() && mean.allFinite() && mag[first].field_b.allFinite() &&
            mag[m].field_b.allFinite()) {
            Reading r{mag[first].field_b, mag[m].field_b, q.conjugate().toRotationMatrix(), Vector3d::Zero()};
            if (std::abs(mean.norm() - 9.8) < not_gravity) r.down = -mean.normalized();
            r.part = static_cast<int>((mag[first].time - mag.front().time).seconds() / stretch) % parts;
            out.push_back(r);
        }
        first = m;
        q.setIdentity();
        force.setZero();
    }
    return out;
}

/// Mean squares over readings, each relative to the magnitude of the field.
struct Disagreement {
    double size = 0.0, dip = 0.0, turning = 0.0;
};

template <class Calibrated>
void add(Disagreement& d, const std::vector<Reading>& readings, int part, Calibrated calibrated) {
    double sizes = 0.0, dips = 0.0, n = 0.0, level = 0.0, all = 0.0;
    for (const Reading& r : readings) {
        const Vector3d f = calibrated(r.field);
        sizes += f.norm();
        all += 1.0;
        if (r.down.isZero()) continue;
        dips += f.dot(r.down);
        level += 1.0;
    }
    if (all == 0.0) return;
    const double size = sizes / all, dip = level > 0.0 ? dips / level : 0.0;
    Disagreement sum;
    double dipped = 0.0;
    for (const Reading& r : readings) {
        if (r.part != part) continue;
        const Vector3d f = calibrated(r.field), later = calibrated(r.next);
        sum.size += std::pow(f.norm() / size - 1.0, 2);
        sum.turning += (later - r.turn * f).squaredNorm() / (size * size);
        n += 1.0;
        if (r.down.isZero()) continue;
        sum.dip += std::pow((f.dot(r.down) - dip) / size, 2);
        dipped += 1.0;
    }
    if (n > 0.0) {
        d.size += sum.size / n;
        d.turning += sum.turning / n;
    }
    if (dipped > 0.0) d.dip += sum.dip / dipped;
}

/// Mean square difference (T^2) between the rotation of the field and the gyro's, in each of several consecutive parts of the
/// log; NaN where there are few readings.
template <class Calibrated>
std::array<double, pieces> turning_by_pieces(const std::vector<Reading>& readings, Calibrated calibrated) {
    constexpr double enough = 10.0;
    std::array<double, pieces> sum{}, n{};
    for (std::size_t i = 0; i < readings.size(); ++i) {
        const std::size_t piece = i * pieces / readings.size();
        const Vector3d f = calibrated(readings[i].field);
        sum[piece] += (calibrated(readings[i].next) - readings[i].turn * f).squaredNorm();
        n[piece] += 1.0;
    }
    for (std::size_t k = 0; k < pieces; ++k) sum[k] = n[k] < enough ? std::nan("") : sum[k] / n[k];
    return sum;
}

std::vector<Vector3d> fields_without(const std::vector<Reading>& readings, int part) {
    std::vector<Vector3d> out;
    for (const Reading& r : readings) {
        if (r.part != part) out.push_back(r.field);
    }
    return out;
}

/// Readings of one attitude: directions within 20 deg of the first.
std::vector<std::vector<Vector3d>> attitudes_of(const std::vector<Vector3d>& forces) {
    constexpr double same = 0.94;  // cosine
    std::vector<std::vector<Vector3d>> out;
    for (const Vector3d& f : forces) {
        if (!f.allFinite() || f.isZero()) continue;
        const auto found =
            std::ranges::find_if(out, [&](const auto& a) { return a.front().normalized().dot(f.normalized()) > same; });
        if (found == out.end()) {
            out.push_back({f});
        } else {
            found->push_back(f);
        }
    }
    return out;
}

}  // namespace

JudgedCalibration judge_magnetometer(std::span<const ImuSample> imu, std::span<const MagSample> mag, double size) {
    JudgedCalibration out;
    const std::vector<Reading> readings = readings_of(imu, mag);
    EllipsoidPrior prior;
    prior.offset_std = 50e-6;
    prior.gain_std = 0.05;
    prior.noise = 0.5e-6;
    prior.alike = 10.0;  // 2 s: the duration of local disturbances
    Disagreement before, after;
    for (int part = 0; part < parts; ++part) {
        const auto fit = fit_ellipsoid(fields_without(readings, part), size, prior);
        if (!fit) {
            out.reason = "too few readings, or not on an ellipsoid";
            return out;
        }
        add(before, readings, part, [](const Vector3d& f) { return f; });
        add(after, readings, part, [&](const Vector3d& f) { return fit->apply(f); });
    }
    struct Quantity {
        const char* name;
        double before, after;
    };
    const std::array quantities{Quantity{"the field's size", before.size, after.size}, Quantity{"its dip", before.dip, after.dip},
                                Quantity{"its turning against the gyro's", before.turning, after.turning}};
    std::string shown;
    const char* worse = nullptr;
    bool better = false;
    for (const Quantity& q : quantities) {
        const double root = 100.0 / std::sqrt(static_cast<double>(parts));
        shown += fmt::format("{}{} {:.2f} to {:.2f} %", shown.empty() ? "" : ", ", q.name, root * std::sqrt(q.before),
                             root * std::sqrt(q.after));
        if (q.after > tolerated * q.before) worse = q.name;
        better = better || q.after < clear_gain * q.before;
    }
    out.reason = fmt::format("held-out parts, RMS: {}", shown);
    if (worse != nullptr) {
        out.reason += fmt::format("; {} got worse", worse);
        return out;
    }
    if (!better) {
        out.reason += "; nothing got better";
        return out;
    }
    const std::vector<Vector3d> all = fields_without(readings, -1);
    const auto fit = fit_ellipsoid(all, size, prior);
    if (fit && fit->offset_std() > largest_offset_std) {
        out.reason += fmt::format("; but the readings show the hard iron only to {:.1f} uT, {:.1f} are needed",
                                  fit->offset_std() / units::microtesla, largest_offset_std / units::microtesla);
        return out;
    }
    if (!fit) return out;
    // a temporary magnet is present in one part of the log only; the noise of a weak instrument increases with its gain
    const double gain = fit->gain.trace() / 3.0;
    const auto as_given = turning_by_pieces(readings, [gain](const Vector3d& f) -> Vector3d { return gain * f; });
    const auto calibrated = turning_by_pieces(readings, [&](const Vector3d& f) { return fit->apply(f); });
    for (std::size_t k = 0; k < pieces; ++k) {
        if (!(calibrated[k] > worse_piece * as_given[k] + least_turning * least_turning)) continue;
        out.reason +=
            fmt::format("; but in piece {} of {} of the log the turning got worse, {:.2f} to {:.2f} uT: did a magnet come or go?",
                        k + 1, pieces, std::sqrt(as_given[k]) / units::microtesla, std::sqrt(calibrated[k]) / units::microtesla);
        return out;
    }
    out.fit = fit;
    return out;
}

JudgedCalibration judge_accelerometer(std::span<const ImuSample> imu, double gravity) {
    constexpr std::size_t least_attitudes = 5;
    JudgedCalibration out;
    const auto attitudes = attitudes_of(still_forces(imu));
    if (attitudes.size() < least_attitudes) {
        out.reason = fmt::format("it rested in {} attitudes, {} are needed", attitudes.size(), least_attitudes);
        return out;
    }
    EllipsoidPrior prior;
    prior.offset_std = 0.1;
    prior.gain_std = 0.005;
    prior.noise = 0.01;
    // one reading per attitude, so that a long rest does not dominate: mean direction and mean magnitude
    std::vector<Vector3d> means;
    for (const auto& a : attitudes) {
        Vector3d sum = Vector3d::Zero();
        double size = 0.0;
        for (const Vector3d& f : a) {
            sum += f;
            size += f.norm() / static_cast<double>(a.size());
        }
        means.push_back(size * sum.normalized());
    }
    double before = 0.0, after = 0.0;
    for (std::size_t k = 0; k < means.size(); ++k) {
        std::vector<Vector3d> others = means;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
        const auto fit = fit_ellipsoid(others, gravity, prior);
        if (!fit) {
            out.reason = "the readings at rest do not lie on an ellipsoid";
            return out;
        }
        before += std::pow(means[k].norm() - gravity, 2);
        after += std::pow(fit->apply(means[k]).norm() - gravity, 2);
    }
    const double n = static_cast<double>(means.size());
    out.reason = fmt::format("held-out attitudes, {} of them: size of the force at rest off by {:.3f} to {:.3f} m/s^2 RMS",
                             means.size(), std::sqrt(before / n), std::sqrt(after / n));
    if (after > clear_gain * before || before < n * prior.noise * prior.noise) {
        out.reason += after > clear_gain * before ? "; not better" : "; no correction is needed";
        return out;
    }
    out.fit = fit_ellipsoid(means, gravity, prior);
    return out;
}

}  // namespace schuler::ahrs
