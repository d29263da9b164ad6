#include "schuler/solution/state_errors.h"

#include "schuler/core/units.h"
#include "schuler/earth/enu.h"
#include "schuler/math/rotation.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <limits>

namespace schuler::solution {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The element of a time-ordered series at exactly this time (to a microsecond), or null.
template <class Series>
const typename Series::value_type* at(const Series& series, Time time) {
    constexpr std::int64_t same_instant_ns = 1'000;
    const auto it = std::ranges::lower_bound(series, time.ns - same_instant_ns, {}, [](const auto& s) { return s.time.ns; });
    return it == series.end() || it->time.ns > time.ns + same_instant_ns ? nullptr : &*it;
}

double normalised(const Vector3d& error, const Matrix3d& covariance, int dof) {
    const Eigen::LLT<Eigen::MatrixXd> factor(Eigen::MatrixXd(covariance.topLeftCorner(dof, dof)));
    if (factor.info() != Eigen::Success) return nan;
    return factor.matrixL().solve(Eigen::VectorXd(error.head(dof))).squaredNorm();
}

}  // namespace

HiddenTruth hidden_truth(const sim::SimulatedData& data, const fusion::ImuSettings& imu) {
    HiddenTruth out{data.sensor_truth, data.gnss_truth, data.baro_truth};
    const Matrix3d C_bs = math::dcm_from_rpy(imu.mounting_rpy) * imu.C_bs;
    for (sim::SensorTruth& t : out.sensors) {
        t.gyro_bias = C_bs * t.gyro_bias;
        t.accel_bias = C_bs * t.accel_bias;
    }
    return out;
}

const std::array<StateBlockName, state_blocks>& state_block_names() {
    static constexpr std::array<std::string_view, 3> level{"east", "north", "up"}, body{"x", "y", "z"};
    static constexpr std::array<StateBlockName, state_blocks> names{{{"position", level, "m", 1.0, 3},
                                                                     {"velocity", level, "m_s", 1.0, 3},
                                                                     {"attitude", level, "deg", units::deg, 3},
                                                                     {"gyro_bias", body, "deg_h", units::deg_per_hour, 3},
                                                                     {"accel_bias", body, "ug", units::ug, 3},
                                                                     {"gnss_position", level, "m", 1.0, 3},
                                                                     {"gnss_velocity", level, "m_s", 1.0, 3},
                                                                     {"baro_bias", {"up", "", ""}, "m", 1.0, 1}}};
    return names;
}

std::vector<StateErrors> state_errors(const std::vector<fusion::StateRow>& rows, const earth::Earth& earth,
                                      const std::vector<ReferenceSample>& reference, const HiddenTruth& truth) {
    std::vector<StateErrors> out;
    for (const fusion::StateRow& row : rows) {
        const ReferenceSample* r = at(reference, row.time);
        if (r == nullptr) continue;
        StateErrors e;
        e.time = row.time;
        std::size_t k = 0;
        const auto add = [&](const Vector3d& error, const Matrix3d& covariance, int dof, bool level) {
            e.error[k] = level ? earth::enu_from_ned(error) : error;
            e.nees[k++] = normalised(error, covariance, dof);
        };
        const auto add_block = [&](const fusion::StateBlock& block, const Vector3d* value, bool level) {
            if (block.dof == 0 || value == nullptr) {
                e.error[k].setConstant(nan);
                e.nees[k++] = nan;
            } else {
                add(block.value - *value, block.covariance, block.dof, level);
            }
        };
        add(earth::ned_difference(earth, row.nav.position, r->position), row.P_position, 3, true);
        add(row.nav.v_eb_n - r->velocity_n, row.P_velocity, 3, true);
        // C_est = (I - [phi x]) C
        add(-math::rotation_vector_from_quaternion(row.nav.q_nb * math::quaternion_from_rpy(r->rpy).conjugate()), row.P_attitude,
            3, true);
        const sim::SensorTruth* sensors = at(truth.sensors, row.time);
        add_block(row.gyro_bias, sensors != nullptr ? &sensors->gyro_bias : nullptr, false);
        add_block(row.accel_bias, sensors != nullptr ? &sensors->accel_bias : nullptr, false);
        const sim::GnssTruth* gnss = at(truth.gnss, row.time);
        add_block(row.gnss_position, gnss != nullptr ? &gnss->position : nullptr, true);
        add_block(row.gnss_velocity, gnss != nullptr ? &gnss->velocity : nullptr, true);
        const sim::BaroTruth* baro = at(truth.baro, row.time);
        const Vector3d bias(baro != nullptr ? baro->bias : nan, 0.0, 0.0);
        add_block(row.baro_bias, baro != nullptr ? &bias : nullptr, false);
        out.push_back(e);
    }
    return out;
}

}  // namespace schuler::solution
