#include "schuler/inspect/detail/motion/mounting.h"

#include "schuler/core/units.h"
#include "schuler/math/rotation.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::inspect::detail {
namespace {

constexpr double concentrated = 8.0 * units::deg;  // one sigma of the travel about one direction: a vehicle with a forward axis
constexpr int enough_epochs = 30;

std::string word_for(const Eigen::Vector3d& body_direction) {
    static constexpr std::array<std::array<const char*, 2>, 3> words{
        {{"forward", "backward"}, {"right", "left"}, {"down", "up"}}};
    int axis = 0;
    body_direction.cwiseAbs().maxCoeff(&axis);
    return words[static_cast<std::size_t>(axis)][body_direction(axis) > 0 ? 0 : 1];
}

std::string axes_text(const Eigen::Matrix3d& C_bs) {
    const std::string x = word_for(C_bs.col(0)), y = word_for(C_bs.col(1)), z = word_for(C_bs.col(2));
    const std::string letters{x[0], y[0], z[0]};
    if (letters == "frd" || letters == "flu" || letters == "fur") return letters;
    return "x=" + x + ", y=" + y + ", z=" + z;
}

// The signed permutation of determinant +1 nearest to a rotation (largest trace of the product).
Eigen::Matrix3d nearest_axes(const Eigen::Matrix3d& C) {
    Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
    double best_trace = -4.0;
    for (int x = 0; x < 6; ++x) {
        for (int y = 0; y < 6; ++y) {
            if (x / 2 == y / 2) continue;
            Eigen::Matrix3d P;
            P.col(0) = Eigen::Vector3d::Unit(x / 2) * (x % 2 ? -1.0 : 1.0);
            P.col(1) = Eigen::Vector3d::Unit(y / 2) * (y % 2 ? -1.0 : 1.0);
            P.col(2) = P.col(0).cross(P.col(1));
            const double trace = (P.transpose() * C).trace();
            if (trace > best_trace + 1e-9) {
                best_trace = trace;
                best = P;
            }
        }
    }
    return best;
}

// Rows are the body's forward, right and down directions in sensor axes.
Eigen::Matrix3d C_bs_from(const Eigen::Vector3d& forward_s, const Eigen::Vector3d& down_s) {
    const Eigen::Vector3d forward = forward_s.normalized();
    const Eigen::Vector3d down = (down_s - forward * forward.dot(down_s)).normalized();
    Eigen::Matrix3d C_bs;
    C_bs.row(0) = forward.transpose();
    C_bs.row(1) = down.cross(forward).transpose();
    C_bs.row(2) = down.transpose();
    return C_bs;
}

// Assumed forward if only the vertical is known: the sensor's x, or its z if x is vertical.
Eigen::Matrix3d supposed_axes(const Eigen::Vector3d& down_s) {
    int axis = 0;
    down_s.cwiseAbs().maxCoeff(&axis);
    const Eigen::Vector3d down = Eigen::Vector3d::Unit(axis) * (down_s(axis) > 0 ? 1.0 : -1.0);
    return C_bs_from(Eigen::Vector3d::Unit(axis == 0 ? 2 : 0), down);
}

Eigen::Matrix3d attitude_of(const ReferenceSample& sample) { return math::dcm_from_rpy(sample.rpy); }

/// Roll, pitch, yaw with yaw from -180 to 180 deg.
Eigen::Vector3d signed_rpy(const Eigen::Matrix3d& C) {
    Eigen::Vector3d rpy = math::rpy_from_dcm(C);
    rpy.z() = math::wrap_pi(rpy.z());
    return rpy;
}

}  // namespace

Travel travel_of(const MotionFit& fit) {
    Travel travel;
    travel.epochs = static_cast<int>(fit.pointings.size());
    if (fit.pointings.empty()) return travel;
    Eigen::Vector3d forward = Eigen::Vector3d::Zero(), down = Eigen::Vector3d::Zero();
    for (const Pointing& p : fit.pointings) {
        forward += p.travel_s / travel.epochs;
        down += p.down_s / travel.epochs;
    }
    travel.concentration = forward.norm();
    travel.forward_s = forward.normalized();
    travel.down_s = down.normalized();
    double spread = 0.0;
    std::vector<double> tilts, slopes;
    for (const Pointing& p : fit.pointings) {
        spread += std::pow(std::acos(std::clamp(p.travel_s.dot(travel.forward_s), -1.0, 1.0)), 2) / travel.epochs;
        tilts.push_back(std::acos(std::clamp(p.down_s.dot(travel.down_s), -1.0, 1.0)));
        slopes.push_back(std::abs(std::asin(std::clamp(p.travel_s.dot(p.down_s), -1.0, 1.0))));
    }
    travel.spread = std::sqrt(spread);
    travel.tilt95 = quantile(std::move(tilts), 0.95);
    travel.slope95 = quantile(std::move(slopes), 0.95);
    return travel;
}

AttitudeAgreement attitude_agreement(const ImuSeries& imu, const Eigen::Vector3d& gyro_bias,
                                     const std::vector<ReferenceSample>& reference, Time origin) {
    AttitudeAgreement result;
    Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
    double seen = 0.0, logged = 0.0;
    std::size_t i = 0;
    const ReferenceSample* before = nullptr;
    double t_before = 0.0;
    for (const ReferenceSample& sample : reference) {
        if (!sample.rpy.allFinite()) continue;
        const double t = (sample.time - origin).seconds();
        if (before != nullptr && t - t_before < 0.08) continue;
        if (before != nullptr && t - t_before < 0.5) {
            const Eigen::Matrix3d turn = attitude_of(*before).transpose() * attitude_of(sample);
            const Eigen::Vector3d rate = math::rotation_vector_from_quaternion(Eigen::Quaterniond(turn)) / (t - t_before);
            while (i < imu.size() && imu.t[i] <= t_before) ++i;
            Eigen::Vector3d w = Eigen::Vector3d::Zero();
            int n = 0;
            for (; i < imu.size() && imu.t[i] <= t; ++i, ++n) w += imu.w[i] - gyro_bias;
            if (n > 0 && rate.norm() < 10.0) {
                w /= n;
                cross += rate * w.transpose();
                seen += w.squaredNorm();
                logged += rate.squaredNorm();
                ++result.steps;
            }
        }
        before = &sample;
        t_before = t;
    }
    if (result.steps < 50 || seen <= 0.0 || logged <= 0.0) return result;
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d UV = svd.matrixU() * svd.matrixV().transpose();
    const Eigen::Vector3d handed(1, 1, UV.determinant() > 0 ? 1.0 : -1.0);
    result.C_bs = svd.matrixU() * handed.asDiagonal() * svd.matrixV().transpose();
    result.correlation = (result.C_bs.transpose() * cross).trace() / std::sqrt(seen * logged);
    // Two axes must have rotated to determine the third.
    result.found = result.correlation > 0.6 && svd.singularValues()(1) > 0.02 * svd.singularValues()(0);
    return result;
}

Mounting mounting_of(const Eigen::Vector3d& specific_force, bool at_rest, const Travel& travel,
                     const AttitudeAgreement& attitude) {
    Mounting m;
    if (!(specific_force.norm() > 1.0)) return m;
    const Eigen::Vector3d down_s = -specific_force.normalized();
    m.found = true;
    m.vertical_angle = std::acos(std::clamp(down_s.cwiseAbs().maxCoeff(), 0.0, 1.0));
    const double vertical_sure = m.vertical_angle < 25.0 * units::deg ? (at_rest ? 1.0 : 0.9) : 0.6;
    if (travel.epochs >= enough_epochs && travel.spread < concentrated) {
        // Banking and slopes average out in the mean vertical of the travel; used if the rest position is not more accurate.
        const Eigen::Matrix3d C_bs = C_bs_from(travel.forward_s, travel.down_s);
        m.C_bs = nearest_axes(C_bs);
        const Eigen::Matrix3d rest = C_bs * m.C_bs.transpose();  // named axes to body: C_b_from_mounted
        m.C_total = C_bs;
        m.full = true;
        m.rest_rpy = signed_rpy(rest);
        m.forward_from = ForwardFrom::Travel;
        m.forward_spread = travel.spread;
        m.epochs = travel.epochs;
        const double angle = Eigen::AngleAxisd(rest).angle();
        m.confidence = vertical_sure * (angle < 30.0 * units::deg ? 0.98 : 0.7);
    } else if (attitude.found) {
        m.C_bs = nearest_axes(attitude.C_bs);
        m.C_total = attitude.C_bs;
        m.full = true;
        m.forward_from = ForwardFrom::AttitudeLog;
        m.epochs = attitude.steps;
        const Eigen::Vector3d down_by_log = m.C_bs.row(2).transpose();
        m.confidence = down_by_log.dot(down_s) > 0.8 ? 0.9 : 0.4;
    } else {
        m.C_bs = supposed_axes(down_s);
        m.confidence = 0.5 * vertical_sure;
    }
    m.axes = axes_text(m.C_bs);
    return m;
}

void take_axes(Mounting& m, const Eigen::Matrix3d& C_bs, const std::string& text) {
    m.C_bs = C_bs;
    m.axes = text;
    if (m.full) m.rest_rpy = signed_rpy(m.C_total * C_bs.transpose());
}

}  // namespace schuler::inspect::detail
