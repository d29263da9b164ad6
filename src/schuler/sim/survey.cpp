#include "schuler/sim/survey.h"

#include "schuler/core/error.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/inverse_imu.h"

#include <algorithm>
#include <cmath>

namespace schuler::sim {

using Eigen::Matrix3d;
using Eigen::Vector3d;

SimulatedSurvey simulate_survey(const earth::Earth& earth, const TruthPath& path, const AnomalyTrack& anomaly,
                                const SurveyInstruments& in, double duration, std::uint64_t seed) {
    const double each = in.imu_rate / in.gnss_rate;
    if (!(in.imu_rate > 0.0 && in.imu_rate <= 1000.0))
        throw input_error("must be above 0 and at most 1000", {{}, 0, 0, "imu.rate_hz"}, "give samples a second");
    if (!(each >= 1.0) || std::abs(each - std::round(each)) > 1e-9)
        throw input_error("must divide the rate of the IMU", {{}, 0, 0, "gnss.rate_hz"}, "give for example 1");
    const auto stride = static_cast<std::int64_t>(std::round(each));
    const auto samples = static_cast<std::int64_t>(std::floor(duration * in.imu_rate + 1e-9));

    SimulatedSurvey out;
    math::Random turn_on(seed, "survey constants"), gyro(seed, "survey gyro"), accel(seed, "survey accel"), fix(seed, "survey gnss");
    out.gyro_bias = in.gyro_bias * turn_on.normal3();
    out.accel_bias = in.accel_bias * turn_on.normal3();
    const Vector3d position_bias = in.gnss_position_bias * turn_on.normal3();
    const Vector3d velocity_bias = in.gnss_velocity_bias * turn_on.normal3();
    const double dt = 1.0 / in.imu_rate;
    double distance = 0.0;
    for (std::int64_t i = 0; i < samples; ++i) {
        const double from = static_cast<double>(i) * dt, to = static_cast<double>(i + 1) * dt;
        const Kinematics middle = path.at(0.5 * (from + to));
        const double step = dt * middle.v_eb_n.norm();
        const Matrix3d C_bn = math::dcm_from_rpy(middle.rpy).transpose();
        const ExactIncrement felt = exact_increment(earth, path, from, to);
        // Normal gravity is in the exact increment; the sensor feels the reaction to the rest of it too.
        const Vector3d missing = C_bn * anomaly.at(distance + 0.5 * step, 0.5 * (from + to));
        distance += step;
        out.imu.push_back({Time::from_seconds(to), dt, felt.dtheta + dt * (out.gyro_bias + in.gyro_noise * gyro.normal3()),
                           felt.dv + dt * (out.accel_bias + in.accel_noise * accel.normal3() - missing)});
        if ((i + 1) % stride != 0) continue;
        const Kinematics now = path.at(to);
        const Matrix3d C_en = earth::C_en(now.position.lat, now.position.lon);
        const Vector3d r = earth::ecef_from_geodetic(earth.ellipsoid, now.position).r + position_bias;
        const Vector3d v = C_en * now.v_eb_n + velocity_bias;
        const Vector3d noise = in.gnss_position_noise * fix.normal3();
        out.fixes.push_back({Time::from_seconds(to), r + noise, v + in.gnss_velocity_noise * fix.normal3()});
        out.truth.push_back({Time::from_seconds(to), now, anomaly.at(distance, to)});
    }
    return out;
}

}  // namespace schuler::sim
