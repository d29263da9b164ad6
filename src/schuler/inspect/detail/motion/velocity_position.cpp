// Velocity compared with position of one receiver: which column is older.
#include "schuler/inspect/detail/motion/motion_fit.h"

#include <algorithm>
#include <cmath>

namespace schuler::inspect::detail {
namespace {

// Integral of the piecewise-linear velocity from the first epoch to t.
class VelocityIntegral {
public:
    explicit VelocityIntegral(const GnssSeries& gnss) : gnss_(gnss) {
        sum_.push_back(Eigen::Vector3d::Zero());
        for (std::size_t k = 1; k < gnss.size(); ++k) {
            sum_.push_back(sum_.back() + 0.5 * (gnss.t[k] - gnss.t[k - 1]) * (gnss.v[k] + gnss.v[k - 1]));
        }
    }
    [[nodiscard]] Eigen::Vector3d at(double t) const {
        const std::size_t k = std::min(index_before(gnss_.t, t), gnss_.size() - 2);
        const double dt = t - gnss_.t[k];
        const double share = dt / (gnss_.t[k + 1] - gnss_.t[k]);
        return sum_[k] + dt * (gnss_.v[k] + 0.5 * share * (gnss_.v[k + 1] - gnss_.v[k]));
    }

private:
    const GnssSeries& gnss_;
    std::vector<Eigen::Vector3d> sum_;
};

}  // namespace

Agreement velocity_behind_position(const GnssSeries& gnss, bool down) {
    if (!gnss.has_velocity() || gnss.size() < 40 || gnss.step > 1.5) return {};
    const VelocityIntegral integral(gnss);
    // Displacements over about half a second: shorter ones are mostly position noise.
    const std::size_t span = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(0.5 / gnss.step)));
    constexpr double stretch = 15.0;
    const double last_lag = first_lag + lag_step * (lag_count - 1);
    std::vector<std::vector<double>> curves;
    std::vector<double> curve(lag_count, 0.0);
    const double least_motion = down ? 0.08 : 0.2;  // m/s, root mean square change over a span
    double motion = 0.0, stretch_start = gnss.t.front();
    std::size_t rows = 0;
    const auto close = [&](double now) {
        const double lowest = *std::min_element(curve.begin(), curve.end());
        if (rows >= 10 && motion > least_motion * least_motion * static_cast<double>(rows)) {
            const double unit = std::max(lowest / static_cast<double>(rows), 1e-4);
            for (double& v : curve) v /= unit;
            curves.push_back(curve);
        }
        std::fill(curve.begin(), curve.end(), 0.0);
        motion = 0.0;
        rows = 0;
        stretch_start = now;
    };
    for (std::size_t k = 0; k + span < gnss.size(); ++k) {
        const double a = gnss.t[k], b = gnss.t[k + span];
        if (a - stretch_start > stretch) close(a);
        if (b - a > 1.5 * gnss.step * static_cast<double>(span) + 0.1) continue;
        if (a + first_lag < gnss.t.front() || b + last_lag > gnss.t.back()) continue;
        const Eigen::Vector3d moved = gnss.p[k + span] - gnss.p[k];
        const Eigen::Vector3d change = gnss.v[k + span] - gnss.v[k];
        motion += down ? change.z() * change.z() : change.head<2>().squaredNorm();
        ++rows;
        for (int i = 0; i < lag_count; ++i) {
            const double lag = first_lag + lag_step * i;
            const Eigen::Vector3d miss = (moved - integral.at(b + lag) + integral.at(a + lag)) / (b - a);
            curve[static_cast<std::size_t>(i)] += down ? miss.z() * miss.z() : miss.head<2>().squaredNorm();
        }
    }
    close(gnss.t.back());
    return agree(first_lag, lag_step, curves);
}

}  // namespace schuler::inspect::detail
