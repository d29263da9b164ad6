#include "schuler/analysis/errors.h"

#include "schuler/earth/enu.h"
#include "schuler/math/rotation.h"
#include "schuler/math/steep_attitude.h"

#include <algorithm>
#include <cmath>

namespace schuler::analysis {

namespace {

SolutionRow between(const earth::Earth& earth, const SolutionRow& a, const SolutionRow& b, Time time) {
    const double dt = (b.time - a.time).seconds();
    const double s = (time - a.time).seconds() / dt;
    const Eigen::Vector3d moved = earth::ned_difference(earth, b.position, a.position);
    // Cubic Hermite basis.
    const double s2 = s * s, s3 = s2 * s;
    const Eigen::Vector3d here = (s3 - 2.0 * s2 + s) * dt * a.v_eb_n + (3.0 * s2 - 2.0 * s3) * moved + (s3 - s2) * dt * b.v_eb_n;
    SolutionRow row;
    row.time = time;
    row.position = earth::moved_by_ned(earth, a.position, here);
    row.v_eb_n = a.v_eb_n + s * (b.v_eb_n - a.v_eb_n);
    row.rpy = math::rpy_from_quaternion(math::quaternion_from_rpy(a.rpy).slerp(s, math::quaternion_from_rpy(b.rpy)));
    row.std_position = a.std_position + s * (b.std_position - a.std_position);
    row.std_velocity = a.std_velocity + s * (b.std_velocity - a.std_velocity);
    row.std_rpy = a.std_rpy + s * (b.std_rpy - a.std_rpy);
    return row;
}

}  // namespace

std::optional<SolutionRow> solution_at(const earth::Earth& earth, std::span<const SolutionRow> rows, Time time,
                                       Duration max_gap) {
    const auto after =
        std::upper_bound(rows.begin(), rows.end(), time, [](Time t, const SolutionRow& row) { return t < row.time; });
    if (after == rows.begin()) return std::nullopt;
    const SolutionRow& a = *(after - 1);
    if (a.time == time) return a;
    if (after == rows.end() || after->time - a.time > max_gap) return std::nullopt;
    return between(earth, a, *after, time);
}

ErrorRow error_between(const earth::Earth& earth, const SolutionRow& estimate, const ReferenceSample& reference,
                       const Eigen::Vector3d& lever_arm_b) {
    const bool at_imu = lever_arm_b.isZero(0.0);
    const Geodetic point = at_imu ? estimate.position
                                  : earth::moved_by_ned(earth, estimate.position, math::dcm_from_rpy(estimate.rpy) * lever_arm_b);
    ErrorRow row;
    row.time = reference.time;
    row.position = earth::enu_from_ned(earth::ned_difference(earth, point, reference.position));
    row.velocity = at_imu ? earth::enu_from_ned(estimate.v_eb_n - reference.velocity_n) : not_given3();
    const Eigen::Vector3d turned = estimate.rpy - reference.rpy;
    for (Eigen::Index i = 0; i < 3; ++i) row.rpy[i] = std::isnan(turned[i]) ? not_given : math::wrap_pi(turned[i]);
    row.std_position = earth::sigma_swapped(estimate.std_position);
    row.std_velocity = earth::sigma_swapped(estimate.std_velocity);
    if (math::is_steep(estimate.rpy) && turned.allFinite()) {  // consistent with their sigmas
        const Eigen::Vector3d turn = math::rotation_vector_from_quaternion(math::quaternion_from_rpy(estimate.rpy) *
                                                                           math::quaternion_from_rpy(reference.rpy).conjugate());
        row.rpy = math::attitude_error_from_phi(estimate.rpy) * -turn;
    }
    row.std_rpy = estimate.std_rpy;
    return row;
}

std::vector<ErrorRow> errors_against(const earth::Earth& earth, std::span<const SolutionRow> rows,
                                     std::span<const ReferenceSample> reference, const ErrorOptions& options) {
    std::vector<ErrorRow> errors;
    for (const ReferenceSample& sample : reference) {
        const std::optional<SolutionRow> estimate = solution_at(earth, rows, sample.time, options.max_gap);
        if (estimate) errors.push_back(error_between(earth, *estimate, sample, options.lever_arm_b));
    }
    return errors;
}

Spread spread_of(std::vector<double> values) {
    std::erase_if(values, [](double v) { return std::isnan(v); });
    if (values.empty()) return {};
    double square_sum = 0.0;
    for (double& v : values) {
        square_sum += v * v;
        v = std::abs(v);
    }
    const double rank = 0.95 * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(rank);
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(below);
    std::nth_element(values.begin(), nth, values.end());
    const double low = *nth;
    const double high = below + 1 < values.size() ? *std::min_element(nth + 1, values.end()) : low;
    return {std::sqrt(square_sum / static_cast<double>(values.size())), low + (rank - static_cast<double>(below)) * (high - low),
            *std::max_element(nth, values.end())};
}

ErrorSummary summarise(std::span<const ErrorRow> rows, Time settled) {
    std::vector<ErrorRow> counted;
    for (const ErrorRow& row : rows) {
        if (row.time >= settled) counted.push_back(row);
    }
    const auto spread = [&counted](const auto& component) {
        std::vector<double> values;
        values.reserve(counted.size());
        for (const ErrorRow& row : counted) values.push_back(component(row));
        return spread_of(std::move(values));
    };
    using Row = const ErrorRow&;
    ErrorSummary out;
    out.epochs = counted.size();
    out.east = spread([](Row r) { return r.position.x(); });
    out.north = spread([](Row r) { return r.position.y(); });
    out.up = spread([](Row r) { return r.position.z(); });
    out.horizontal = spread([](Row r) { return std::hypot(r.position.x(), r.position.y()); });
    out.three_d = spread([](Row r) { return r.position.norm(); });
    out.v_east = spread([](Row r) { return r.velocity.x(); });
    out.v_north = spread([](Row r) { return r.velocity.y(); });
    out.v_up = spread([](Row r) { return r.velocity.z(); });
    out.roll = spread([](Row r) { return r.rpy.x(); });
    out.pitch = spread([](Row r) { return r.rpy.y(); });
    out.heading = spread([](Row r) { return r.rpy.z(); });
    return out;
}

}  // namespace schuler::analysis
