#include "schuler/sim/faults.h"

#include <algorithm>

namespace schuler::sim {

namespace {

bool active(const Fault& f, double t) { return t >= f.start - 1e-9 && t < f.start + f.duration - 1e-9; }

}  // namespace

ChannelFaults::ChannelFaults(const Scenario& scenario, Channel channel) : random_(scenario.seed, "faults") {
    for (Fault f : scenario.faults) {
        if (f.channel != channel) continue;
        f.direction.normalize();
        faults_.push_back(f);
    }
}

Eigen::Vector3d ChannelFaults::offset(double t) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Fault& f : faults_) {
        if (!active(f, t)) continue;
        if (f.kind == FaultKind::Step) sum += f.size * f.direction;
        if (f.kind == FaultKind::Ramp || f.kind == FaultKind::Drift) sum += f.size * (t - f.start) * f.direction;
        if (f.kind == FaultKind::Noise) sum += f.size * random_.normal3();
    }
    return sum;
}

Eigen::Vector3d ChannelFaults::velocity_offset(double t) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Fault& f : faults_)
        if (active(f, t) && (f.kind == FaultKind::Drift || f.kind == FaultKind::Velocity)) sum += f.size * f.direction;
    return sum;
}

Eigen::Vector3d ChannelFaults::sensor_offset(FaultKind kind, double t) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Fault& f : faults_)
        if (active(f, t) && f.kind == kind) sum += f.size * f.direction;
    return sum;
}

bool ChannelFaults::any(FaultKind kind, double t) const {
    return std::ranges::any_of(faults_, [&](const Fault& f) { return f.kind == kind && active(f, t); });
}

}  // namespace schuler::sim
