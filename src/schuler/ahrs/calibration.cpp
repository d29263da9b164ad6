#include "schuler/ahrs/calibration.h"

#include "schuler/core/units.h"
#include "schuler/math/quantile.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace schuler::ahrs {
namespace {

using Parameters = Eigen::Matrix<double, ellipsoid_parameters, 1>;
using Information = Eigen::Matrix<double, ellipsoid_parameters, ellipsoid_parameters>;

constexpr int iterations = 20;
constexpr double outlier = 2.5;  // sigma, beyond which a reading is down-weighted

Parameters parameters_of(const EllipsoidFit& f) {
    Parameters p;
    p << f.offset, f.gain(0, 0), f.gain(1, 1), f.gain(2, 2), f.gain(0, 1), f.gain(0, 2), f.gain(1, 2);
    return p;
}

void set(EllipsoidFit& f, const Parameters& p) {
    f.offset = p.head<3>();
    f.gain << p(3), p(6), p(7), p(6), p(4), p(8), p(7), p(8), p(5);
}

/// Offset and radius of the sphere through the readings, the offset pulled to zero by the prior: |m|^2 = 2 m.o + (R^2 - o.o).
std::optional<std::pair<Eigen::Vector3d, double>> sphere(const std::vector<Eigen::Vector3d>& points,
                                                         const EllipsoidPrior& prior) {
    double scale2 = 0.0;
    for (const Eigen::Vector3d& p : points) scale2 += p.squaredNorm() / static_cast<double>(points.size());
    if (!(scale2 > 0.0)) return std::nullopt;
    Eigen::Matrix4d N = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    // |m|^2 has the noise 2 |m| sigma
    const double weight = 1.0 / (4.0 * scale2 * prior.noise * prior.noise * prior.alike);
    for (const Eigen::Vector3d& p : points) {
        const Eigen::Vector4d row(2.0 * p.x(), 2.0 * p.y(), 2.0 * p.z(), 1.0);
        N.noalias() += weight * row * row.transpose();
        right += weight * p.squaredNorm() * row;
    }
    N.diagonal().head<3>().array() += 1.0 / (prior.offset_std * prior.offset_std);
    const auto solver = N.colPivHouseholderQr();
    const Eigen::Vector4d x = solver.solve(right);
    const double radius2 = x(3) + x.head<3>().squaredNorm();
    if (!x.allFinite() || !(radius2 > 0.0)) return std::nullopt;
    return std::pair(Eigen::Vector3d(x.head<3>()), std::sqrt(radius2));
}

}  // namespace

double EllipsoidFit::offset_std() const {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance.topLeftCorner<3, 3>());
    return std::sqrt(std::max(0.0, eigen.eigenvalues().maxCoeff()));
}

SizeError size_error(const EllipsoidFit& f, const Eigen::Vector3d& measured) {
    const Eigen::Vector3d shifted = measured - f.offset, calibrated = f.gain * shifted;
    const double norm = calibrated.norm();
    const Eigen::Vector3d u = norm > 0.0 ? (calibrated / norm).eval() : Eigen::Vector3d::Zero().eval();
    SizeError e;
    e.error = norm - f.size;
    e.H.head<3>() = -u.transpose() * f.gain;
    e.H.segment<3>(3) = u.cwiseProduct(shifted).transpose();
    e.H(6) = u.x() * shifted.y() + u.y() * shifted.x();
    e.H(7) = u.x() * shifted.z() + u.z() * shifted.x();
    e.H(8) = u.y() * shifted.z() + u.z() * shifted.y();
    return e;
}

std::optional<EllipsoidFit> fit_ellipsoid(std::span<const Eigen::Vector3d> readings, double size, const EllipsoidPrior& prior) {
    std::vector<Eigen::Vector3d> points;
    for (const Eigen::Vector3d& r : readings) {
        if (r.allFinite()) points.push_back(r);
    }
    constexpr std::size_t least = 4;
    if (points.size() < least) return std::nullopt;
    const auto begin = sphere(points, prior);
    if (!begin) return std::nullopt;
    EllipsoidFit fit;
    fit.samples = points.size();
    fit.offset = begin->first;
    fit.size = size > 0.0 ? size : begin->second;
    Parameters mean = Parameters::Zero();
    mean.segment<3>(3).setOnes();
    Parameters prior_information = Parameters::Constant(1.0 / (prior.gain_std * prior.gain_std));
    prior_information.head<3>().setConstant(1.0 / (prior.offset_std * prior.offset_std));
    double noise = prior.noise;
    for (int i = 0; i < iterations; ++i) {
        Information N = prior_information.asDiagonal();
        Parameters right = prior_information.cwiseProduct(mean - parameters_of(fit));
        std::vector<double> errors;
        for (const Eigen::Vector3d& p : points) {
            const SizeError e = size_error(fit, p);
            errors.push_back(std::abs(e.error));
            const double weight =
                std::min(1.0, outlier * noise / std::max(errors.back(), 1e-12 * fit.size)) / (noise * noise * prior.alike);
            N.noalias() += weight * e.H.transpose() * e.H;
            right -= weight * e.error * e.H.transpose();
        }
        const Eigen::LDLT<Information> solver(N);
        const Parameters step = solver.solve(right);
        if (!step.allFinite()) return std::nullopt;
        set(fit, parameters_of(fit) + step);
        fit.covariance = solver.solve(Information::Identity());
        // normal: the median of the absolute value is 0.6745 sigma
        noise = std::max(prior.noise, math::median(std::move(errors)) / 0.6745);
        fit.residual = noise;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(fit.gain);
    if (!(eigen.eigenvalues().minCoeff() > 0.0)) return std::nullopt;
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
