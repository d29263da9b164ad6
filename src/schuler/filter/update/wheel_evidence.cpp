#include "schuler/filter/update/wheel_evidence.h"

#include <numbers>

namespace schuler::filter {

void WheelEvidence::add(const Eigen::Vector3d& v_b, double turn, double interval) {
    if (verdict != Verdict::Open) return;
    const double side = v_b.y() / v_b.x(), down = v_b.z() / v_b.x();
    ++n;
    turned += std::abs(turn) * interval;
    const double d_side = side - mean_side, d_down = down - mean_down;
    mean_side += d_side / n;
    mean_down += d_down / n;
    m2_side += d_side * (side - mean_side);
    m2_down += d_down * (down - mean_down);
    // An aircraft also keeps its angles of attack and drift on a straight leg: only turns are significant.
    if (n * interval < 60.0 || turned < 0.5 * std::numbers::pi) return;
    constexpr double limit = 0.02;  // rad
    const bool rolls = std_side() < limit && std_down() < limit && std::abs(mean_side) < 0.5 && std::abs(mean_down) < 0.5;
    verdict = rolls ? Verdict::Wheels : Verdict::NoWheels;
}

}  // namespace schuler::filter
