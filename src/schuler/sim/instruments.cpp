#include "schuler/sim/instruments.h"

#include "schuler/core/error.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/detail/require.h"
#include "schuler/sim/receivers.h"

#include <cmath>

namespace schuler::sim {

namespace {

using Eigen::Vector3d;

using detail::require;

bool size(double x) { return std::isfinite(x) && x >= 0.0; }
bool is_rate(double x) { return size(x) && x <= 1000.0; }

void check(const InstrumentErrors& e) {
    require(is_rate(e.gauges.rate), "gauges.rate_hz", "is not a rate", "give Hz, or 0 for none");
    require(size(e.gauges.white) && size(e.gauges.bias), "gauges", "a sigma is negative or not a number", "give metres");
    require(!e.gauges.lever_arms_b.empty() && e.gauges.lever_arms_b.size() <= 3, "gauges.lever_arms_m",
            "are not one to three places", "give [[forward, right, down], ...] in metres");
    require(is_rate(e.log.rate), "log.rate_hz", "is not a rate", "give Hz, or 0 for none");
    require(size(e.log.white) && size(e.log.scale) && size(e.log.misalignment), "log", "a sigma is negative or not a number",
            "give one sigma");
    require(is_rate(e.compass.rate), "compass.rate_hz", "is not a rate", "give Hz, or 0 for none");
    require(size(e.compass.white) && size(e.compass.bias), "compass", "a sigma is negative or not a number", "give degrees");
}

/// Calls sample(t, kinematics) at every epoch of an instrument.
template <class Sample>
void at_epochs(double rate_hz, double duration, const TruthPath& path, Sample sample) {
    if (!(rate_hz > 0.0)) return;
    const auto count = static_cast<std::size_t>(std::floor(duration * rate_hz + 1e-6)) + 1;
    for (std::size_t k = 0; k < count; ++k) {
        const double t = static_cast<double>(k) / rate_hz;
        sample(t, path.at(t));
    }
}

}  // namespace

InstrumentLogs simulate_instruments(const InstrumentErrors& e, const earth::Earth& earth, const TruthPath& path, double duration,
                                    Time origin, std::uint64_t seed) {
    check(e);
    InstrumentLogs out;
    math::Random constant(seed, "aids.constant"), gauge(seed, "aids.gauges"), log(seed, "aids.log"),
        compass(seed, "aids.compass");
    const auto stamp = [origin](double t) { return origin + Duration::from_seconds(t); };
    const Vector3d bias = e.gauges.bias * constant.normal3();
    at_epochs(e.gauges.rate, duration, path, [&](double t, const Kinematics& k) {
        GaugeSample sample{stamp(t)};
        const Vector3d white = e.gauges.white * gauge.normal3();
        for (std::size_t i = 0; i < e.gauges.lever_arms_b.size(); ++i) {
            const auto axis = static_cast<Eigen::Index>(i);
            sample.height(axis) = point_motion(earth, k, e.gauges.lever_arms_b[i]).position.h + bias(axis) + white(axis);
        }
        out.gauges.push_back(sample);
    });
    const double gain = 1.0 + e.log.scale * constant.normal();
    const double about_y = e.log.misalignment * constant.normal(), about_z = e.log.misalignment * constant.normal();
    const Vector3d turned(0.0, about_y, about_z);
    at_epochs(e.log.rate, duration, path, [&](double t, const Kinematics& k) {
        const PointMotion point = point_motion(earth, k, e.log.lever_arm_b);
        const Vector3d v_b = math::dcm_from_rpy(k.rpy).transpose() * point.v_n;
        out.velocities.push_back({stamp(t), gain * (v_b + turned.cross(v_b)) + e.log.white * log.normal3()});
    });
    const double deviation = e.compass.bias * constant.normal();
    at_epochs(e.compass.rate, duration, path, [&](double t, const Kinematics& k) {
        out.headings.push_back({stamp(t), math::wrap_2pi(k.rpy.z() + deviation + e.compass.white * compass.normal())});
    });
    return out;
}

}  // namespace schuler::sim
