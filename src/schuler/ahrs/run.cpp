#include "schuler/ahrs/run.h"

#include "schuler/ahrs/dcm_filter.h"
#include "schuler/ahrs/mekf.h"
#include "schuler/ahrs/offline.h"
#include "schuler/ahrs/quaternion_filter.h"
#include "schuler/ahrs/rest_bias.h"
#include "schuler/ahrs/resting_rate.h"
#include "schuler/core/error.h"

#include <algorithm>
#include <optional>

namespace schuler::ahrs {
namespace {

/// One of paper B's filters with the same sample checks as the mekf.
template <class Filter>
RunResult run_vector_filter(std::span<const ImuSample> imu, std::span<const MagSample> mag, const RunSettings& settings,
                            Filter filter) {
    RunResult out;
    out.rows.reserve(imu.size());
    const GuardSettings& g = settings.mekf.guard;
    InstrumentGuard gyro(g.gyro_range, g.stuck_after), accel(g.accel_range, g.stuck_after), field(g.field_range, g.stuck_after);
    RestBias rest(settings.mekf.rest);
    UsualStep usual;
    Eigen::Vector3d rate = Eigen::Vector3d::Zero();
    std::size_t m = 0;
    for (std::size_t i = 1; i < imu.size(); ++i) {
        const double dt = (imu[i].time - imu[i - 1].time).seconds();
        const bool rate_known = gyro.usable(imu[i].gyro, out.counters.gyro),
                   force_known = accel.usable(imu[i].accel, out.counters.accel);
        if (rate_known) rate = imu[i].gyro;
        const bool gap = dt > 0.0 && usual.exceeded_by(dt, g.gap_factor);
        if (gap || dt > g.longest_step) ++out.counters.gaps;
        if (rate_known && force_known && dt > 0.0 && dt <= g.longest_step) rest.feed(dt, imu[i].gyro, imu[i].accel);
        filter.propagate(std::min(dt, g.longest_step), rate - rest.bias());
        if (force_known) filter.accelerometer(imu[i].accel);
        for (; m < mag.size() && mag[m].time <= imu[i].time; ++m) {
            if (field.usable(mag[m].field_b, out.counters.field) && !settings.mekf.six_axis) filter.magnetometer(mag[m].field_b);
        }
        Eigen::Quaterniond q_nb;
        if constexpr (requires { filter.q_nb(); }) {
            q_nb = filter.q_nb();
        } else {
            q_nb = Eigen::Quaterniond(filter.C_nb());
        }
        out.rows.push_back({imu[i].time, q_nb, filter.covariance_phi().diagonal().cwiseMax(0.0).cwiseSqrt(), rest.bias()});
    }
    return out;
}

RunResult run_mekf(std::span<const ImuSample> imu, std::span<const MagSample> mag, std::span<const SpeedSample> speed,
                   const MekfSettings& settings) {
    RunResult out;
    out.rows.reserve(imu.size());
    Mekf filter(settings);
    std::size_t m = 0, v = 0;
    for (std::size_t i = 1; i < imu.size(); ++i) {
        for (; v < speed.size() && speed[v].time <= imu[i].time; ++v) filter.forward_speed(speed[v].speed, speed[v].std);
        filter.step((imu[i].time - imu[i - 1].time).seconds(), imu[i].gyro, imu[i].accel);
        for (; m < mag.size() && mag[m].time <= imu[i].time; ++m) filter.magnetometer(mag[m].field_b);
        if (filter.started()) out.rows.push_back({imu[i].time, filter.q_nb(), filter.std_phi(), filter.gyro_bias()});
    }
    out.counters = filter.counters();
    const HeadingChannel& h = filter.heading();
    out.field = {h.hard_iron(), h.horizontal_field(), h.vertical_field(), h.delay()};
    return out;
}

RunResult run_unbiased(std::span<const ImuSample> imu, std::span<const MagSample> mag, std::span<const SpeedSample> speed,
                       const RunSettings& settings) {
    VectorFilterSettings vector = settings.vector;
    switch (settings.filter) {
        case FilterKind::Dcm: return run_vector_filter(imu, mag, settings, DcmFilter(vector));
        case FilterKind::QuaternionCoupled:
            vector.separation = Separation::None;
            return run_vector_filter(imu, mag, settings, QuaternionFilter(vector));
        case FilterKind::QuaternionPrinted:
            vector.separation = Separation::Printed;
            return run_vector_filter(imu, mag, settings, QuaternionFilter(vector));
        case FilterKind::Quaternion: return run_vector_filter(imu, mag, settings, QuaternionFilter(vector));
        case FilterKind::Mekf: break;
    }
    return settings.offline ? run_offline(imu, mag, speed, settings.mekf) : run_mekf(imu, mag, speed, settings.mekf);
}

}  // namespace

RunResult run(std::span<const ImuSample> imu, std::span<const MagSample> mag, std::span<const SpeedSample> speed,
              const RunSettings& settings) {
    if (imu.size() < 2) throw input_error("the IMU log has fewer than two samples", {}, "check it with `schuler inspect`");
    const std::optional<Eigen::Vector3d> bias = resting_rate(imu, mag, settings.mekf.rest);
    if (!bias) return run_unbiased(imu, mag, speed, settings);
    std::vector<ImuSample> without(imu.begin(), imu.end());
    for (ImuSample& s : without) s.gyro -= *bias;
    RunResult out = run_unbiased(without, mag, speed, settings);
    for (AttitudeRow& row : out.rows) row.gyro_bias += *bias;
    out.resting_rate = *bias;
    return out;
}

}  // namespace schuler::ahrs
