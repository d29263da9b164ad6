#include "schuler/fusion/mounting.h"

#include "schuler/core/units.h"
#include "schuler/fusion/tuning/trial.h"
#include "schuler/math/quantile.h"
#include "schuler/math/rotation.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace schuler::fusion {

using Eigen::Vector3d;

MountingEstimate estimate_mounting(const RunData& all, const Settings& settings, const Start& start) {
    const RunData data = gnss_only(all);
    Settings trial = trial_settings(settings);
    trial.output_rate = 5.0;
    PassOptions options;
    options.rivalry = Rivalry::None;
    options.last_increment = increment_at(data, start.nav.time + Duration::from_seconds(900.0));
    const Result run = run_pass(data, trial, start, options);
    std::vector<Vector3d> forward;
    std::vector<double> weight;  // from the heading sigma: the direction in the body is as accurate as the attitude
    Vector3d down = Vector3d::Zero();
    for (const SolutionRow& row : run.forward.rows) {
        const Eigen::Matrix3d C_nb = math::dcm_from_rpy(row.rpy);
        down += C_nb.row(2).transpose();
        const double speed = row.v_eb_n.norm();
        if (speed < 4.0 || row.std_rpy.z() > 5.0 * units::deg || row.std_velocity.maxCoeff() > 0.5) continue;
        forward.emplace_back(C_nb.transpose() * row.v_eb_n / speed);
        weight.push_back(1.0 / (row.std_rpy.z() * row.std_rpy.z()));
    }
    MountingEstimate estimate;
    if (forward.size() < 50) return estimate;
    // Median direction first, then the mean of its neighbourhood: reversing and sliding are excluded.
    Vector3d axis;
    for (int i = 0; i < 3; ++i) {
        std::vector<double> x;
        for (const Vector3d& f : forward) x.push_back(f(i));
        axis(i) = math::median(std::move(x));
    }
    axis.normalize();
    Vector3d sum = Vector3d::Zero();
    double n = 0.0, spread = 0.0, total = 0.0, attitude = 0.0;
    for (std::size_t i = 0; i < forward.size(); ++i) {
        if (forward[i].dot(axis) < std::cos(10.0 * units::deg)) continue;
        sum += weight[i] * forward[i];
        spread += weight[i] * (forward[i] - axis).squaredNorm();
        total += weight[i];
        attitude += std::sqrt(weight[i]);
        n += 1.0;
    }
    // Wheels roll along their axis, occasionally backwards; a vehicle able to move sideways shows it only if it rarely does so.
    const double least = settings.vehicle == VehicleKind::Car ? 0.5 : 0.8;
    if (n < least * static_cast<double>(forward.size())) return estimate;
    const Vector3d x = sum.normalized();
    const Vector3d z = (down - down.dot(x) * x).normalized();
    estimate.C_vb << x.transpose(), z.cross(x).transpose(), z.transpose();
    // Attitude errors of the rows are almost the same error: the weighted mean of their sigmas bounds the sigma of the mean.
    const double std = std::hypot(std::sqrt(spread / total / std::max(1.0, n / 25.0)), attitude / total);
    estimate.std_rpy = Vector3d(2.0 * units::deg, std, std);
    estimate.found = true;
    return estimate;
}

}  // namespace schuler::fusion
