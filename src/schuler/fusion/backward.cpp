#include "schuler/fusion/backward.h"

#include "schuler/core/units.h"
#include "schuler/filter/outputs.h"
#include "schuler/filter/update/reversed.h"
#include "schuler/math/rotation.h"

#include <algorithm>
#include <array>
#include <utility>

namespace schuler::fusion {

namespace {

constexpr double opening = 10.0;                       ///< times the forward filter's last sigmas
constexpr double widest_attitude = 20.0 * units::deg;  ///< ... but within the range of a linear filter
constexpr Duration spacing{100'000'000};               ///< of the rows

Start start_at(const SolutionRow& row, const SensorErrorRow& errors, const Start& start, double std_mounting) {
    Start out;
    out.nav = {filter::reversed(row.time), row.position, -row.v_eb_n, math::quaternion_from_rpy(row.rpy)};
    out.std_position = opening * row.std_position;
    out.std_velocity = opening * row.std_velocity;
    out.std_rpy = (opening * row.std_rpy).cwiseMin(row.std_rpy.cwiseMax(widest_attitude));
    out.gyro_bias = -errors.gyro_bias;
    out.accel_bias = errors.accel_bias;
    out.std_gyro_bias = (opening * errors.std_gyro_bias).cwiseMin(errors.std_gyro_bias.cwiseMax(start.std_gyro_bias));
    out.std_accel_bias = (opening * errors.std_accel_bias).cwiseMin(errors.std_accel_bias.cwiseMax(start.std_accel_bias));
    out.std_mounting = std_mounting;
    out.undecided_heading = start.undecided_heading;
    return out;
}

/// Rows of the instants, in the time of the log.
template <class Frame>
struct BackwardRows : PassObserver<Frame> {
    explicit BackwardRows(const InertialModel& model_) : model(model_) {}
    void instant(const FilterRun<Frame>& run, std::size_t) override {
        NavState nav = run.filter.geographic(model);
        nav.time = filter::reversed(nav.time);
        nav.v_eb_n = -nav.v_eb_n;
        rows.push_back(solution_row(nav, run.covariance(model)));
    }
    const InertialModel& model;
    std::vector<SolutionRow> rows;
};

template <class Frame>
std::vector<SolutionRow> run_in(const RunData& data, const Settings& settings, const Start& start) {
    const InertialModel model = make_model(settings, make_layout(settings, *data.recording));
    const Pass<Frame> pass(model, data, settings, Rivalry::Contest);
    FilterRun<Frame> run = first_step<Frame>(model, data, settings, start);
    run.next_output = Time{INT64_MAX};
    BackwardRows<Frame> out(model);
    out.rows.reserve(data.instants.size());
    pass.advance(run, data.imu.increments.size() - 1, out);
    std::ranges::reverse(out.rows);
    return std::move(out.rows);
}

}  // namespace

std::vector<SolutionRow> run_backward(const RunData& data, const Settings& settings, const Start& start,
                                      const Trajectory& forward) {
    const std::vector<ImuIncrement>& increments = data.imu.increments;
    const auto inertial = [&](const SolutionRow& r) {
        return r.time <= increments.back().time && r.rpy.allFinite() && r.std_rpy.allFinite();
    };
    const auto end = std::find_if(forward.rows.rbegin(), forward.rows.rend(), inertial);
    if (end == forward.rows.rend() || forward.sensor_errors.empty()) return {};
    const auto after = std::ranges::upper_bound(increments, end->time, {}, &ImuIncrement::time);
    const auto last = static_cast<std::size_t>(after - increments.begin());  // after the last one
    if (last <= start.increment) return {};

    const Settings back = filter::reversed(settings);
    filter::ReversedData whole = filter::reversed(data, start.increment, last - 1);
    RunData& run = whole.data;
    for (auto row = end; row != forward.rows.rend(); ++row)
        if (run.instants.empty() || filter::reversed(row->time) - run.instants.back() >= spacing)
            run.instants.push_back(filter::reversed(row->time));
    const Start from = start_at(*end, forward.sensor_errors.back(), start, settings.imu.mounting_std);
    return settings.mechanization == Mechanization::Ecef ? run_in<EarthFixedFrame>(run, back, from)
                                                         : run_in<GeographicFrame>(run, back, from);
}

}  // namespace schuler::fusion
