#include "schuler/analysis/turn_agreement.h"

#include <Eigen/Geometry>

#include <cmath>

namespace schuler::analysis {
namespace {

constexpr double stretch = 0.1;  // s; a quarter turn within it shortens the chord by only a tenth
constexpr double longest = 0.2;  // s; a longer interval is a gap in the log

/// Mean of consecutive samples and their mean time, s.
struct TimedMean {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double time = 0.0, n = 0.0;

    void add(double t, const Eigen::Vector3d& v) {
        sum += v;
        time += t;
        n += 1.0;
    }
    [[nodiscard]] Eigen::Vector3d value() const { return sum / n; }
    [[nodiscard]] double at() const { return time / n; }
};

}  // namespace

TurnAgreement turn_agreement(std::span<const ImuSample> imu, std::size_t count, const std::function<Time(std::size_t)>& time,
                             const std::function<Eigen::Vector3d(std::size_t)>& vector) {
    double cross = 0.0, expected2 = 0.0, measured2 = 0.0;
    std::size_t g = 0;
    TimedMean before;
    for (std::size_t k = 0; k < count;) {
        TimedMean now;
        const Time begin = time(k);
        for (; k < count && (time(k) - begin).seconds() < stretch; ++k) {
            if (vector(k).allFinite()) now.add((time(k) - imu.front().time).seconds(), vector(k));
        }
        if (now.n > 0.0 && before.n > 0.0 && now.at() - before.at() < longest) {
            TimedMean rate;
            for (; g < imu.size() && (imu[g].time - imu.front().time).seconds() <= now.at(); ++g) {
                if (imu[g].gyro.allFinite() && (imu[g].time - imu.front().time).seconds() > before.at())
                    rate.add(0.0, imu[g].gyro);
            }
            const Eigen::Vector3d a = before.value(), b = now.value(), middle = 0.5 * (a + b);
            if (rate.n > 0.0 && middle.norm() > 0.0) {
                const double size = middle.norm();
                const Eigen::Vector3d expected = -rate.value().cross(middle) / size * (now.at() - before.at());
                const Eigen::Vector3d measured = (b - a) / size;
                cross += expected.dot(measured);
                expected2 += expected.squaredNorm();
                measured2 += measured.squaredNorm();
            }
        }
        if (now.n > 0.0) before = now;
    }
    TurnAgreement out;
    out.turned = std::sqrt(measured2);
    if (expected2 > 0.0 && measured2 > 0.0) {
        out.factor = cross / expected2;
        out.correlation = cross / std::sqrt(expected2 * measured2);
    }
    return out;
}

}  // namespace schuler::analysis
