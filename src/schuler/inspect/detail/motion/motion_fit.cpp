#include "schuler/inspect/detail/motion/motion_fit.h"

#include "schuler/core/parallel.h"
#include "schuler/inspect/detail/motion/preintegration.h"
#include "schuler/math/rotation.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>

namespace schuler::inspect::detail {
namespace {

constexpr double sigma_horizontal = 0.1;        // m/s, weights of the rows relative to the priors
constexpr double sigma_down = 0.3;              // m/s: the vertical channel may have a separate lag
constexpr double sigma_accel_bias = 0.15;       // m/s^2 about the median of all windows
constexpr double sigma_gyro_bias = 0.004;       // rad/s likewise
constexpr double sigma_gyro_bias_first = 0.06;  // rad/s in the first pass: uncalibrated MEMS

constexpr int at_attitude = 0, at_velocity = 3, at_gyro = 6, at_accel = 9;
using Unknowns = Eigen::Matrix<double, 12, 1>;
using Normal = Eigen::Matrix<double, 12, 12>;
using Rows = Eigen::Matrix<double, 3, 12>;

struct Observation {
    double begin, end;  // stamps; equal for an instantaneous velocity
    Eigen::Vector3d v;
};

struct Window {
    std::vector<Observation> seen;
    std::size_t imu_first = 0, imu_last = 0;
    double origin = 0.0;  // s, zero of the model's time
    Eigen::Matrix3d C_ns0 = Eigen::Matrix3d::Identity();
    Unknowns x = Unknowns::Zero();  // v0 and biases; the attitude part stays zero
    double heading_sigma = 1e9;     // rad
    double rms = 0.0, motion = 0.0;
};

std::vector<Observation> observations(const GnssSeries& gnss, FitSource source) {
    std::vector<Observation> all;
    if (source == FitSource::Velocity) {
        if (!gnss.has_velocity()) return all;
        for (std::size_t k = 0; k < gnss.size(); ++k) all.push_back({gnss.t[k], gnss.t[k], gnss.v[k]});
    } else {
        // Over about 0.8 s: shorter displacements are mostly position noise.
        const std::size_t span = std::max<std::size_t>(1, static_cast<std::size_t>(0.8 / std::max(gnss.step, 1e-3)));
        for (std::size_t k = span; k < gnss.size(); k += span) {
            const double dt = gnss.t[k] - gnss.t[k - span];
            if (dt > 3.0 * gnss.step * static_cast<double>(span)) continue;
            all.push_back({gnss.t[k - span], gnss.t[k], (gnss.p[k] - gnss.p[k - span]) / dt});
        }
    }
    return all;
}

// Root mean square of the horizontal velocity about its mean.
double motion_of(std::span<const Observation> seen) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const Observation& o : seen) mean += o.v.head<2>() / static_cast<double>(seen.size());
    double sum = 0.0;
    for (const Observation& o : seen) sum += (o.v.head<2>() - mean).squaredNorm();
    return std::sqrt(sum / static_cast<double>(seen.size()));
}

bool covers(const ImuSeries& imu, Window& w) {
    const double last_lag = first_lag + lag_step * (lag_count - 1);
    const double from = w.seen.front().begin - last_lag, to = w.seen.back().end - first_lag;
    if (imu.size() < 10 || from < imu.t.front() || to > imu.t.back()) return false;
    w.imu_first = index_before(imu.t, from);
    w.imu_last = std::min(index_before(imu.t, to) + 1, imu.size() - 1);
    const double longest = std::max(0.3, 5.0 * imu.step);
    for (std::size_t i = w.imu_first + 1; i <= w.imu_last; ++i) {
        if (imu.t[i] - imu.t[i - 1] > longest) return false;
    }
    w.origin = imu.t[w.imu_first];
    return true;
}

std::vector<Window> windows_of(const ImuSeries& imu, std::span<const Observation> all, double least_motion,
                               double window_length) {
    std::vector<Window> windows;
    for (std::size_t first = 0; first < all.size();) {
        std::size_t last = first;
        while (last + 1 < all.size() && all[last + 1].end - all[first].begin <= window_length &&
               all[last + 1].end - all[last].end < 2.5) {
            ++last;
        }
        const std::span<const Observation> seen = all.subspan(first, last - first + 1);
        if (seen.size() >= 8 && seen.back().end - seen.front().begin > 0.6 * window_length) {
            Window w;
            w.seen.assign(seen.begin(), seen.end());
            w.motion = motion_of(seen);
            if (w.motion > least_motion && covers(imu, w)) windows.push_back(std::move(w));
        }
        first = last + 1;
    }
    return windows;
}

class WindowModel {
public:
    WindowModel(const ImuSeries& imu, const Window& w, double gravity)
        : window_(w), path_(imu, w.imu_first, w.imu_last, w.x.segment<3>(at_gyro), w.x.segment<3>(at_accel)), gravity_(gravity) {}

    // The integrals for an observation at a given lag; for displacements the mean over the interval by Simpson's rule.
    [[nodiscard]] Preintegral seen_by(const Observation& o, double lag) const {
        const double a = o.begin - lag, b = o.end - lag;
        if (b <= a) return path_.at(a);
        static constexpr double weight[] = {1.0 / 12, 4.0 / 12, 2.0 / 12, 4.0 / 12, 1.0 / 12};
        Preintegral mean = Preintegral::zero();
        for (int i = 0; i < 5; ++i) mean.add(path_.at(a + 0.25 * i * (b - a)), weight[i]);
        return mean;
    }

    // Observed minus modelled velocity, and the derivative of the model by the unknowns (attitude error in n axes, see math/).
    void row(const Observation& o, double lag, Eigen::Vector3d& residual, Rows& H) const {
        const Preintegral s = seen_by(o, lag);
        const double tau = 0.5 * (o.begin + o.end) - lag - window_.origin;
        const Eigen::Matrix3d& C = window_.C_ns0;
        const Eigen::Vector3d u_n = C * s.u;
        residual = o.v - window_.x.segment<3>(at_velocity) - u_n;
        residual.z() -= gravity_ * tau;
        H.block<3, 3>(0, at_attitude) = -math::skew(u_n);
        H.block<3, 3>(0, at_velocity).setIdentity();
        H.block<3, 3>(0, at_gyro) = C * s.u_by_gyro_bias;
        H.block<3, 3>(0, at_accel) = C * s.u_by_accel_bias;
    }
    [[nodiscard]] const PreintegratedPath& path() const { return path_; }

private:
    const Window& window_;
    PreintegratedPath path_;
    double gravity_;
};

// Attitude that best rotates the centred integrals into the centred velocities without gravity (Kabsch, Acta Cryst. A32, 1976).
void start_attitude(const WindowModel& model, Window& w, double lag, double gravity) {
    Eigen::Vector3d mean_u = Eigen::Vector3d::Zero(), mean_v = Eigen::Vector3d::Zero();
    std::vector<Eigen::Vector3d> us, vs;
    const double n = static_cast<double>(w.seen.size());
    for (const Observation& o : w.seen) {
        us.push_back(model.seen_by(o, lag).u);
        vs.push_back(o.v - Eigen::Vector3d(0, 0, gravity * (0.5 * (o.begin + o.end) - lag - w.origin)));
        mean_u += us.back() / n;
        mean_v += vs.back() / n;
    }
    Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < us.size(); ++i) cross += (vs[i] - mean_v) * (us[i] - mean_u).transpose();
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d handed(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() > 0 ? 1.0 : -1.0);
    w.C_ns0 = svd.matrixU() * handed.asDiagonal() * svd.matrixV().transpose();
    w.x.segment<3>(at_velocity) = mean_v - w.C_ns0 * mean_u;
}

struct Prior {
    Unknowns centre = Unknowns::Zero();
    Unknowns weight = Unknowns::Zero();  // 1/variance
};

struct Solution {
    Unknowns dx;
    Normal information;
};

Solution solve(const WindowModel& model, const Window& w, double lag, const Prior& prior) {
    Normal N = prior.weight.asDiagonal();
    Unknowns b = prior.weight.cwiseProduct(prior.centre - w.x);
    const Eigen::Vector3d weight(1 / (sigma_horizontal * sigma_horizontal), 1 / (sigma_horizontal * sigma_horizontal),
                                 1 / (sigma_down * sigma_down));
    Eigen::Vector3d residual;
    Rows H;
    for (const Observation& o : w.seen) {
        model.row(o, lag, residual, H);
        const Rows weighted = weight.asDiagonal() * H;
        N.noalias() += H.transpose() * weighted;
        b.noalias() += weighted.transpose() * residual;
    }
    Solution s{N.ldlt().solve(b), N};
    if (!s.dx.allFinite()) s.dx.setZero();
    return s;
}

void fit_window(const ImuSeries& imu, Window& w, double lag, const Prior& prior, double gravity) {
    w.x = prior.centre;
    for (int iteration = 0; iteration < 3; ++iteration) {
        const WindowModel model(imu, w, gravity);
        if (iteration == 0) start_attitude(model, w, lag, gravity);
        const Solution s = solve(model, w, lag, prior);
        const Eigen::Vector3d phi = s.dx.segment<3>(at_attitude);
        w.C_ns0 = math::dcm_from_rotation_vector(phi) * w.C_ns0;
        w.x.tail<9>() += s.dx.tail<9>();
        const Normal covariance = s.information.inverse();
        w.heading_sigma = std::sqrt(std::max(0.0, covariance(2, 2)));
    }
}

struct Curves {
    std::vector<double> horizontal, down;
};

// Sum of squared residuals of a straight line: the remainder of the vertical channel with free initial velocity and constant
// acceleration error.
double squares_about_line(const std::vector<double>& t, const std::vector<double>& y) {
    double n = 0, st = 0, sy = 0, stt = 0, sty = 0, syy = 0;
    for (std::size_t i = 0; i < t.size(); ++i) {
        n += 1;
        st += t[i];
        sy += y[i];
        stt += t[i] * t[i];
        sty += t[i] * y[i];
        syy += y[i] * y[i];
    }
    const double det = n * stt - st * st;
    if (det <= 0) return syy;
    const double slope = (n * sty - st * sy) / det, offset = (sy - slope * st) / n;
    return std::max(0.0, syy - slope * sty - offset * sy);
}

Curves scan(const ImuSeries& imu, const Window& w, const Prior& prior, double gravity) {
    const WindowModel model(imu, w, gravity);
    Curves curves;
    Eigen::Vector3d residual;
    Rows H;
    std::vector<double> t, down;
    for (int i = 0; i < lag_count; ++i) {
        const double lag = first_lag + lag_step * i;
        const Solution s = solve(model, w, lag, prior);
        double sum = 0.0;
        t.clear();
        down.clear();
        for (const Observation& o : w.seen) {
            model.row(o, lag, residual, H);
            t.push_back(o.end - w.origin);
            down.push_back(residual.z());
            residual -= H * s.dx;
            sum += residual.head<2>().squaredNorm();
        }
        curves.horizontal.push_back(sum);
        curves.down.push_back(squares_about_line(t, down));
    }
    // Each window is normalised by its own residual, so that one bad interval does not dominate.
    const auto normalise = [&](std::vector<double>& curve, double floor) {
        const double lowest = *std::min_element(curve.begin(), curve.end());
        const double unit =
            std::max(lowest, floor * floor * static_cast<double>(w.seen.size())) / static_cast<double>(w.seen.size());
        for (double& v : curve) v /= unit;
    };
    normalise(curves.horizontal, 0.03);
    normalise(curves.down, 0.03);
    return curves;
}

Prior prior_about(const Eigen::Vector3d& gyro_bias, const Eigen::Vector3d& accel_bias, double sigma_gyro, double sigma_accel) {
    Prior prior;
    prior.centre.segment<3>(at_gyro) = gyro_bias;
    prior.centre.segment<3>(at_accel) = accel_bias;
    prior.weight.segment<3>(at_gyro).setConstant(1.0 / (sigma_gyro * sigma_gyro));
    prior.weight.segment<3>(at_accel).setConstant(1.0 / (sigma_accel * sigma_accel));
    return prior;
}

Eigen::Vector3d median_of(const std::vector<Window>& windows, int block) {
    Eigen::Vector3d result;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> values;
        for (const Window& w : windows) values.push_back(w.x(block + axis));
        result(axis) = median(std::move(values));
    }
    return result;
}

std::vector<Pointing> pointings_of(const WindowModel& model, const Window& w, double lag) {
    std::vector<Pointing> pointings;
    for (const Observation& o : w.seen) {
        const double speed = o.v.head<2>().norm();
        if (speed < pointing_speed) continue;
        const Eigen::Matrix3d C_ns = w.C_ns0 * model.path().rotation_at(0.5 * (o.begin + o.end) - lag);
        const Eigen::Vector3d travel = C_ns.transpose() * o.v.normalized();
        pointings.push_back({0.5 * (o.begin + o.end), speed, travel, C_ns.row(2).transpose(), C_ns});
    }
    return pointings;
}

/// So many windows tell as much as more of them; they are taken from the whole log.
constexpr std::size_t most_windows = 1000;

void thin_out(std::vector<Window>& windows) {
    if (windows.size() <= most_windows) return;
    for (std::size_t i = 1; i < most_windows; ++i)
        if (const std::size_t from = i * windows.size() / most_windows; from != i) windows[i] = std::move(windows[from]);
    windows.resize(most_windows);
}

/// work(k) for each window, by all cores: windows know nothing of each other.
void for_each_window(const std::vector<Window>& windows, const std::function<void(std::size_t)>& work) {
    constexpr std::size_t few = 8;  // less time than starting threads
    for_each_run(windows.size(), windows.size() < few ? 1 : 0, work, {});
}

}  // namespace

double lag_by_gain(const MotionFit& fit) {
    constexpr double gain = 0.005;  // of MEMS units: 0.3 to 1 % (Groves 2013, table 4.3)
    return gain * fit.window_length / std::numbers::pi;
}

MotionFit fit_motion(const ImuSeries& imu, const GnssSeries& gnss, FitSource source, const Eigen::Vector3d& gyro_bias,
                     bool bias_known, double gravity, double window_length) {
    MotionFit fit;
    fit.window_length = window_length;
    const std::vector<Observation> all = observations(gnss, source);
    std::vector<Window> windows = windows_of(imu, all, 0.4, window_length);
    thin_out(windows);
    fit.windows = static_cast<int>(windows.size());
    if (windows.size() < 3) return fit;

    const Eigen::Vector3d none = Eigen::Vector3d::Zero();
    Prior prior =
        prior_about(gyro_bias, none, bias_known ? 2.0 * sigma_gyro_bias : sigma_gyro_bias_first, 2.0 * sigma_accel_bias);
    double lag = 0.1;
    for (int pass = 0; pass < 2; ++pass) {
        for_each_window(windows, [&](std::size_t k) { fit_window(imu, windows[k], lag, prior, gravity); });
        fit.gyro_bias = median_of(windows, at_gyro);
        fit.accel_bias = median_of(windows, at_accel);
        prior = prior_about(fit.gyro_bias, fit.accel_bias, sigma_gyro_bias, sigma_accel_bias);
        std::vector<std::vector<double>> horizontal(windows.size()), down(windows.size());
        for_each_window(windows, [&](std::size_t k) {
            Curves curves = scan(imu, windows[k], prior, gravity);
            horizontal[k] = std::move(curves.horizontal);
            down[k] = std::move(curves.down);
        });
        fit.curves.clear();
        for (std::size_t k = 0; k < windows.size(); ++k)
            fit.curves.push_back({0.5 * (windows[k].seen.front().begin + windows[k].seen.back().end), horizontal[k]});
        fit.horizontal = agree(first_lag, lag_step, horizontal);
        fit.down = agree(first_lag, lag_step, down);
        if (fit.horizontal.found) lag = fit.horizontal.at;
    }
    std::vector<std::vector<Pointing>> pointings(windows.size());
    for_each_window(windows, [&](std::size_t k) {
        Window& w = windows[k];
        fit_window(imu, w, lag, prior, gravity);
        const WindowModel model(imu, w, gravity);
        Eigen::Vector3d residual;
        Rows H;
        double sum = 0.0;
        for (const Observation& o : w.seen) {
            model.row(o, lag, residual, H);
            sum += residual.head<2>().squaredNorm();
        }
        w.rms = std::sqrt(sum / static_cast<double>(w.seen.size()));
        // The row sigma is an assumption: the residuals correct the heading uncertainty.
        if (w.heading_sigma * std::max(0.3, w.rms / sigma_horizontal) < 0.05) pointings[k] = pointings_of(model, w, lag);
    });
    std::vector<double> rms, motion;
    for (const Window& w : windows) {
        rms.push_back(w.rms);
        motion.push_back(w.motion);
    }
    for (const std::vector<Pointing>& p : pointings) fit.pointings.insert(fit.pointings.end(), p.begin(), p.end());
    fit.rms = median(std::move(rms));
    fit.motion = median(std::move(motion));
    return fit;
}

}  // namespace schuler::inspect::detail
