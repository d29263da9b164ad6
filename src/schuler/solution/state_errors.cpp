#include "schuler/solution/state_errors.h"

#include "schuler/core/units.h"
#include "schuler/earth/enu.h"
#include "schuler/math/rotation.h"
#include "schuler/math/steep_attitude.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
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

StateErrors nothing_at(Time time) {
    StateErrors e;
    e.time = time;
    e.error.fill(not_given3());
    e.nees.fill(nan);
    return e;
}

/// NaN without a sigma.
double normalised(const Vector3d& error, const Vector3d& sigma) {
    const double square = error.cwiseQuotient(sigma).squaredNorm();
    return std::isfinite(square) ? square : nan;
}

/// Position, velocity and attitude of an error row.
StateErrors navigation_errors(const analysis::ErrorRow& row, const ReferenceSample* reference) {
    StateErrors e = nothing_at(row.time);
    e.error[0] = row.position;
    e.error[1] = row.velocity;
    if (reference != nullptr)
        e.error[2] = earth::enu_from_ned(math::attitude_error_from_phi(reference->rpy).partialPivLu().solve(row.rpy));
    e.nees[0] = normalised(row.position, row.std_position);
    e.nees[1] = normalised(row.velocity, row.std_velocity);
    e.nees[2] = normalised(row.rpy, row.std_rpy);
    return e;
}

/// Blocks of the parameters that have a true value, with their indices in state_block_names().
class ParameterErrors {
public:
    explicit ParameterErrors(const std::vector<fusion::LayoutBlock>& blocks) : blocks_(blocks) {}

    void add(StateErrors& e, const fusion::ParameterRow& row, const HiddenTruth& truth) const {
        if (const sim::SensorTruth* t = at(truth.sensors, row.time)) {
            add(e, 3, "gyro_bias", row, t->gyro_bias, false);
            add(e, 4, "accel_bias", row, t->accel_bias, false);
        }
        if (const sim::GnssTruth* t = at(truth.gnss, row.time)) {
            add(e, 5, "gnss_position_error", row, t->position, true);
            add(e, 6, "gnss_velocity_error", row, t->velocity, true);
        }
        if (const sim::BaroTruth* t = at(truth.baro, row.time)) add(e, 7, "baro_bias", row, Vector3d(t->bias, 0.0, 0.0), false);
    }

private:
    void add(StateErrors& e, std::size_t k, std::string_view name, const fusion::ParameterRow& row, const Vector3d& value,
             bool level) const {
        const auto block = std::ranges::find(blocks_, name, &fusion::LayoutBlock::name);
        if (block == blocks_.end()) return;
        const auto first = static_cast<std::size_t>(block->offset - fusion::Layout::navigation);
        Vector3d error = Vector3d::Zero(), sigma = Vector3d::Ones();
        for (int i = 0; i < block->size; ++i) {
            error[i] = row.value[first + static_cast<std::size_t>(i)] - value[i];
            sigma[i] = row.std[first + static_cast<std::size_t>(i)];
        }
        e.nees[k] = normalised(error, sigma);
        e.error[k] = level ? earth::enu_from_ned(error) : error;
    }

    const std::vector<fusion::LayoutBlock>& blocks_;
};

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

std::vector<StateErrors> state_errors_by_sigmas(const fusion::Trajectory& trajectory,
                                                const std::vector<fusion::LayoutBlock>& blocks,
                                                const std::vector<analysis::ErrorRow>& errors,
                                                const std::vector<ReferenceSample>& reference, const HiddenTruth& truth) {
    std::vector<StateErrors> out;
    if (trajectory.parameters.empty()) {
        for (const analysis::ErrorRow& e : errors) out.push_back(navigation_errors(e, at(reference, e.time)));
        return out;
    }
    const ParameterErrors parameters(blocks);
    for (const fusion::ParameterRow& row : trajectory.parameters) {
        const analysis::ErrorRow* e = at(errors, row.time);
        if (e == nullptr) continue;
        out.push_back(navigation_errors(*e, at(reference, e->time)));
        parameters.add(out.back(), row, truth);
    }
    return out;
}

}  // namespace schuler::solution
