#include "schuler/ahrs/calibration.h"

#include "schuler/core/units.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <algorithm>
#include <bitset>
#include <cmath>

namespace schuler::ahrs {
namespace {

using Vector9 = Eigen::Matrix<double, 9, 1>;

constexpr std::size_t least_directions = 12;
constexpr double largest_axis_ratio = 3.0;

/// Which of the 26 neighbours of a cube's centre a direction points to.
std::size_t direction_of(const Eigen::Vector3d& v) {
    const Eigen::Vector3d u = v.normalized();
    std::size_t index = 0;
    constexpr double edge = 0.38;  // sine of half the angle between the classes
    for (int i = 0; i < 3; ++i) index = index * 3 + (u(i) > edge ? 2U : u(i) < -edge ? 0U : 1U);
    return index;
}

/// Quadric x'Ax + 2 b'x = 1 in scaled coordinates around `centre`.
std::optional<EllipsoidFit> fit_once(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& centre, double scale) {
    Eigen::Matrix<double, 9, 9> N = Eigen::Matrix<double, 9, 9>::Zero();
    Vector9 right = Vector9::Zero();
    for (const Eigen::Vector3d& p : points) {
        const Eigen::Vector3d u = (p - centre) / scale;
        Vector9 row;
        row << u.cwiseAbs2(), 2.0 * u.x() * u.y(), 2.0 * u.x() * u.z(), 2.0 * u.y() * u.z(), 2.0 * u;
        N.noalias() += row * row.transpose();
        right += row;
    }
    const auto solver = N.colPivHouseholderQr();
    if (solver.rank() < 9) return std::nullopt;
    const Vector9 s = solver.solve(right);
    Eigen::Matrix3d A;
    A << s(0), s(3), s(4), s(3), s(1), s(5), s(4), s(5), s(2);
    const Eigen::Vector3d b = s.tail<3>();
    const Eigen::Vector3d offset = -A.colPivHouseholderQr().solve(b);
    const double level = 1.0 + offset.dot(A * offset);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(A / level);
    const Eigen::Vector3d d = eigen.eigenvalues();
    if (!(d.minCoeff() > 0.0) || d.maxCoeff() > largest_axis_ratio * largest_axis_ratio * d.minCoeff()) return std::nullopt;
    EllipsoidFit fit;
    fit.offset = centre + scale * offset;
    fit.gain = eigen.eigenvectors() * d.cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose() / scale;  // to size one
    return fit;
}

}  // namespace

std::optional<EllipsoidFit> fit_ellipsoid(std::span<const Eigen::Vector3d> readings, double size) {
    std::vector<Eigen::Vector3d> points;
    for (const Eigen::Vector3d& r : readings) {
        if (r.allFinite()) points.push_back(r);
    }
    if (points.size() < least_directions) return std::nullopt;
    Eigen::Vector3d low = points.front(), high = points.front();
    for (const Eigen::Vector3d& p : points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const Eigen::Vector3d centre = 0.5 * (low + high);
    const double scale = 0.5 * (high - low).maxCoeff();
    if (!(scale > 0.0)) return std::nullopt;
    auto fit = fit_once(points, centre, scale);
    if (!fit) return std::nullopt;
    constexpr double outlier = 0.15;  // of the size
    std::erase_if(points, [&](const Eigen::Vector3d& p) { return std::abs(fit->apply(p).norm() - 1.0) > outlier; });
    std::bitset<27> seen;
    for (const Eigen::Vector3d& p : points) seen.set(direction_of(fit->apply(p)));
    if (seen.count() < least_directions) return std::nullopt;
    fit = fit_once(points, centre, scale);
    if (!fit) return std::nullopt;
    double mean = 0.0, square = 0.0;
    for (const Eigen::Vector3d& p : points) {
        const double e = fit->apply(p).norm() - 1.0;
        mean += (p - fit->offset).norm() / static_cast<double>(points.size());
        square += e * e / static_cast<double>(points.size());
    }
    fit->size = size > 0.0 ? size : mean;
    fit->gain *= fit->size;
    fit->residual = std::sqrt(square) * fit->size;
    fit->samples = points.size();
    return fit;
}

std::vector<Eigen::Vector3d> still_forces(std::span<const ImuSample> imu) {
    constexpr double stretch = 0.5, quiet_rate = 1.0 * units::deg_per_s, quiet_force = 0.15;
    std::vector<Eigen::Vector3d> out;
    std::size_t begin = 0;
    while (begin < imu.size()) {
        std::size_t end = begin;
        Eigen::Vector3d force = Eigen::Vector3d::Zero(), rate = Eigen::Vector3d::Zero();
        double force2 = 0.0, rate2 = 0.0;
        while (end < imu.size() && (imu[end].time - imu[begin].time).seconds() < stretch) {
            force += imu[end].accel;
            rate += imu[end].gyro;
            force2 += imu[end].accel.squaredNorm();
            rate2 += imu[end].gyro.squaredNorm();
            ++end;
        }
        const double n = static_cast<double>(end - begin);
        force /= n;
        rate /= n;
        constexpr double enough = 5.0;
        if (n >= enough && force2 / n - force.squaredNorm() < quiet_force * quiet_force &&
            rate2 / n - rate.squaredNorm() < quiet_rate * quiet_rate) {
            out.push_back(force);
        }
        begin = end;
    }
    return out;
}

}  // namespace schuler::ahrs
