#include "schuler/analysis/separation.h"

#include "schuler/math/rotation.h"

#include <cmath>

namespace schuler::analysis {

namespace {

using Eigen::Vector3d;

Vector3d together(const Vector3d& a, const Vector3d& b) { return (a.cwiseAbs2() + b.cwiseAbs2()).cwiseSqrt(); }

struct Count {
    double squares = 0.0;
    std::size_t inside = 0, all = 0;

    void add(double difference, double sigma) {
        squares += difference * difference;
        inside += std::abs(difference) <= 3.0 * sigma ? 1 : 0;
        ++all;
    }
    [[nodiscard]] SeparationSpread spread() const {
        if (all == 0) return {};
        const auto n = static_cast<double>(all);
        return {std::sqrt(squares / n), static_cast<double>(inside) / n};
    }
};

}  // namespace

std::vector<SeparationRow> separation(const earth::Earth& earth, std::span<const SolutionRow> forward,
                                      std::span<const SolutionRow> backward) {
    std::vector<SeparationRow> out;
    std::size_t i = 0;
    for (const SolutionRow& b : backward) {
        while (i < forward.size() && forward[i].time < b.time) ++i;
        if (i == forward.size()) break;
        const SolutionRow& f = forward[i];
        if (f.time != b.time) continue;
        SeparationRow row;
        row.time = b.time;
        row.position = earth::ned_difference(earth, f.position, b.position);
        row.velocity = f.v_eb_n - b.v_eb_n;
        row.rpy = (f.rpy - b.rpy).unaryExpr([](double angle) { return math::wrap_pi(angle); });
        row.std_position = together(f.std_position, b.std_position);
        row.std_velocity = together(f.std_velocity, b.std_velocity);
        row.std_rpy = together(f.std_rpy, b.std_rpy);
        out.push_back(row);
    }
    return out;
}

SeparationSummary summarise(std::span<const SeparationRow> rows, Time from, Time to) {
    Count north, east, up, heading;
    for (const SeparationRow& r : rows) {
        if (r.time < from || r.time > to) continue;
        north.add(r.position.x(), r.std_position.x());
        east.add(r.position.y(), r.std_position.y());
        up.add(r.position.z(), r.std_position.z());
        heading.add(r.rpy.z(), r.std_rpy.z());
    }
    return {north.all, north.spread(), east.spread(), up.spread(), heading.spread()};
}

}  // namespace schuler::analysis
