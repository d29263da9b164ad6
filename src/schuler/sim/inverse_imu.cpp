#include "schuler/sim/inverse_imu.h"

#include "schuler/math/rotation.h"

#include <array>
#include <cmath>

namespace schuler::sim {

Eigen::Vector3d body_rate(const Eigen::Vector3d& rpy, const Eigen::Vector3d& rpy_rate) {
    const double sr = std::sin(rpy.x()), cr = std::cos(rpy.x());
    const double sp = std::sin(rpy.y()), cp = std::cos(rpy.y());
    return {rpy_rate.x() - sp * rpy_rate.z(), cr * rpy_rate.y() + sr * cp * rpy_rate.z(),
            -sr * rpy_rate.y() + cr * cp * rpy_rate.z()};
}

InertialInput inertial_input(const earth::Earth& earth, const Kinematics& k) {
    const earth::EarthTerms terms = earth::terms_at(earth, k.position, k.v_eb_n);
    const Eigen::Matrix3d C_bn = math::dcm_from_rpy(k.rpy).transpose();
    const Eigen::Vector3d w_in_n = terms.w_ie_n + terms.w_en_n;
    const Eigen::Vector3d coriolis_rate = w_in_n + terms.w_ie_n;
    const Eigen::Vector3d f_n = k.dv_eb_n + coriolis_rate.cross(k.v_eb_n) - terms.g_n;
    return {body_rate(k.rpy, k.rpy_rate) + C_bn * w_in_n, C_bn * f_n};
}

ExactIncrement exact_increment(const earth::Earth& earth, const TruthPath& path, double from, double to) {
    // Abramowitz and Stegun, table 25.4, n = 4.
    constexpr std::array<double, 2> node{0.339981043584856264802665759103, 0.861136311594052575223946488893};
    constexpr std::array<double, 2> weight{0.652145154862546142626936050778, 0.347854845137453857373063949222};
    const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
    ExactIncrement sum{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    for (std::size_t i = 0; i < node.size(); ++i) {
        for (const double side : {-1.0, 1.0}) {
            const InertialInput input = inertial_input(earth, path.at(middle + side * half * node[i]));
            sum.dtheta += half * weight[i] * input.w_ib_b;
            sum.dv += half * weight[i] * input.f_b;
        }
    }
    return sum;
}

}  // namespace schuler::sim
