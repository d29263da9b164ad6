#include "schuler/ahrs/offline.h"

#include "schuler/ahrs/mekf.h"
#include "schuler/math/rotation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace schuler::ahrs {
namespace {

/// A sample of the forward pass: the strapdown state and its block.
struct Strapdown {
    std::size_t sample;  ///< of the IMU log
    Eigen::Quaterniond q_wb;
    Eigen::Vector3d rate_b;
    std::size_t block;
    float along;  ///< 0 to 1 through the block
};

/// Error of a channel's estimate (estimate minus smoothed) before and after each block's updates.
struct Smoothed2 {
    Eigen::Vector2d before, after;
    Eigen::Vector2d std;
    Eigen::Matrix<double, 2, 3> of_accel_bias;  ///< rad per sigma of the accelerometer bias
    bool levelled = false;                      ///< independent of the previous block
};
struct Smoothed1 {
    double heading = 0.0, std = 0.0;
};

struct Forward {
    std::vector<Strapdown> strapdown;
    std::vector<TiltRecord> tilt;
    std::vector<Eigen::Vector2d> tilt_correction;
    std::vector<Eigen::Vector3d> bias;
    Counters counters;
};

Forward forward_pass(std::span<const ImuSample> imu, std::span<const SpeedSample> speed, const MekfSettings& settings) {
    Forward f;
    MekfSettings level = settings;
    level.six_axis = true;
    Mekf filter(level);
    f.strapdown.reserve(imu.size());
    std::size_t v = 0, first = 0;
    TiltRecord record;
    for (std::size_t i = 1; i < imu.size(); ++i) {
        for (; v < speed.size() && speed[v].time <= imu[i].time; ++v) filter.forward_speed(speed[v].speed, speed[v].std);
        // the strapdown of this sample is required before the block's updates
        const int restarts = filter.tilt().restarts();
        const bool closed = filter.step((imu[i].time - imu[i - 1].time).seconds(), imu[i].gyro, imu[i].accel, &record);
        if (filter.tilt().restarts() != restarts && !f.tilt.empty()) {
            // a gap: the part before it belongs to the previous block
            constexpr float nearly_the_end = 0.999F;
            const std::size_t previous = f.tilt.size() - 1;
            for (; first < f.strapdown.size(); ++first) {
                f.strapdown[first].block = previous;
                f.strapdown[first].along = nearly_the_end;
            }
        }
        if (!filter.started()) continue;
        const Eigen::Quaterniond q = closed ? filter.tilt().q_before() : filter.tilt().q_wb();
        f.strapdown.push_back({i, q, filter.tilt().rate_b(), f.tilt.size(), 0.0F});
        if (!closed) continue;
        const auto n = static_cast<float>(f.strapdown.size() - first);
        for (std::size_t k = first; k < f.strapdown.size(); ++k) f.strapdown[k].along = static_cast<float>(k - first + 1) / n;
        if (record.block.levelled) {
            // the records of the block before it was levelled
            for (std::size_t k = first; k + 1 < f.strapdown.size(); ++k)
                f.strapdown[k].q_wb = record.block.level * f.strapdown[k].q_wb;
        }
        first = f.strapdown.size();
        f.tilt.push_back(record);
        f.tilt_correction.push_back(filter.tilt().tilt_correction());
        f.bias.push_back(filter.gyro_bias());
    }
    f.counters = filter.counters();
    return f;
}

/// The smoothed estimate is linear in the innovations, and so is its sensitivity to the accelerometer bias: adjoint variables of the
/// derivatives beside those of the innovations themselves.
std::vector<Smoothed2> smooth_tilt(const Forward& f, const TiltSettings& settings) {
    std::vector<Smoothed2> out(f.tilt.size());
    estim::Adjoint<tilt_states> adjoint;
    AccelBiasEffect effect = AccelBiasEffect::Zero();
    for (std::size_t k = f.tilt.size(); k-- > 0;) {
        const TiltRecord& r = f.tilt[k];
        out[k].after = -(r.P_tilt * adjoint.lambda);
        out[k].levelled = r.block.levelled;
        out[k].before = out[k].after + f.tilt_correction[k];
        out[k].of_accel_bias = r.block.tilt_of_accel_bias + settings.accel_bias_std * r.P_tilt * effect;
        for (int i = 0; i < 2; ++i) {
            const TiltVector p = r.P_tilt.row(i).transpose();
            out[k].std(i) =
                std::sqrt(std::max(0.0, p(i) - p.dot(adjoint.Lambda * p)) + out[k].of_accel_bias.row(i).squaredNorm());
        }
        for (int u = r.count; u-- > 0;) {
            const auto i = static_cast<std::size_t>(u);
            const estim::ScalarUpdate<tilt_states>& update = r.updates[i];
            const Eigen::RowVector3d undone = update.k.transpose() * effect + r.from_accel_bias[i] / update.s;
            effect.noalias() -= update.h * undone;
            adjoint.undo(update);
        }
        const TiltTransition phi(r.block, settings.gravity);
        phi.propagate_back(adjoint);
        const Eigen::Matrix<double, TiltState::changing, 3> changing = effect.topRows<TiltState::changing>();
        effect.noalias() += phi.rows.transpose() * changing;
    }
    return out;
}

/// A forward pass of the heading channel over the smoothed tilt: its state at the end of each block, and its updates.
struct HeadingPass {
    std::vector<Eigen::Vector2d> path;  ///< T, the level field
    std::vector<FreeTurn> free;         ///< heading uncertainty from the gyro alone
    std::size_t started = 0;            ///< the first block with a field
    std::vector<HeadingRecord> updates;
};

/// Residual of a measurement for the smoothed states.
double left_of(const estim::ScalarUpdate<heading_states>& u, const HeadingVector& lambda) {
    return u.s * (1.0 - u.h.dot(u.k)) * (u.k.dot(lambda) + u.innovation / u.s);
}

/// Heading error of `estimate` from the `error` of its components; rad.
double heading_error(const Eigen::Vector2d& estimate, const Eigen::Vector2d& error) {
    return math::wrap_pi(heading_of(estimate) - heading_of(estimate - error));
}

/// One sigma of the heading of `level_field` with covariance P, rad; at most that of an unknown one.
double heading_std(const Eigen::Vector2d& level_field, const Eigen::Matrix2d& P) {
    const double size2 = level_field.squaredNorm(), unknown = std::numbers::pi / std::sqrt(3.0);
    const Eigen::Vector2d across(-level_field.y(), level_field.x());
    return size2 > 0.0 ? std::min(unknown, std::sqrt(std::max(0.0, across.dot(P * across))) / size2) : unknown;
}

/// Smoothed heading at the end of each block; the error varies linearly between updates, but not across a new levelling. `left`:
/// mean square residual of the field at each update, relative to the expected one; NaN if there was none.
std::vector<Smoothed1> smooth_heading(const HeadingPass& pass, const HeadingSettings& settings, std::vector<double>& left) {
    const std::vector<Eigen::Vector2d>& path = pass.path;
    std::vector<Smoothed1> out(path.size());
    left.assign(pass.updates.size(), std::numeric_limits<double>::quiet_NaN());
    estim::Adjoint<heading_states> adjoint;
    std::size_t next = path.size();  // block of the update after this one
    double next_before = 0.0;
    // of the blocks from `from` until that update: the error goes from `after` to `next_before`
    const auto between = [&](std::size_t from, double after, double std) {
        const double change = math::wrap_pi(next_before - after);
        const bool levelled = next < path.size() && pass.free[next].levellings > (from > 0 ? pass.free[from - 1].levellings : 0);
        for (std::size_t b = from; b < next; ++b) {
            const double along =
                next < path.size() ? static_cast<double>(b + 1 - from) / static_cast<double>(next - from + 1) : 0.0;
            double error = after + along * change, sigma = std;
            if (levelled) {  // the error after the last levelling is that of the next update, before the first that of the last
                const bool is_after = pass.free[b].levellings == pass.free[next].levellings;
                error = is_after ? next_before : after;
                sigma = std::max(is_after ? out[next].std : std,
                                 is_after || from == 0 ? 0.0 : pass.free[b].std_since(pass.free[from - 1]));
            }
            out[b] = {heading_of(path[b]) + settings.declination - error, sigma};
        }
    };
    for (std::size_t k = pass.updates.size(); k-- > 0;) {
        const HeadingRecord& r = pass.updates[k];
        const Eigen::Vector2d error_after = -(r.P_level.transpose() * adjoint.lambda), error_before = error_after + r.correction;
        const Eigen::Vector2d smoothed = r.path - error_before;
        const double after = heading_error(r.path - r.correction, error_after), before = heading_error(r.path, error_before);
        const double std = heading_std(smoothed, r.P_level.topRows<2>() - r.P_level.transpose() * adjoint.Lambda * r.P_level);
        if (next == path.size()) next_before = after;
        between(r.block + 1, after, std);
        out[r.block] = {heading_of(smoothed) + settings.declination, std};
        next = r.block;
        next_before = before;
        double square = 0.0;
        for (int u = r.count; u-- > 0;) {
            const auto& update = r.updates[static_cast<std::size_t>(u)];
            if (r.field && u >= r.count - 3) square += std::pow(left_of(update, adjoint.lambda) / settings.field_noise, 2) / 3.0;
            adjoint.undo(update);
        }
        if (r.field) left[k] = square;
        // F = I + E A, E the first columns of the identity
        constexpr int n = HeadingState::turning;
        const TurningRows& A = r.transition;
        const TurningRows rows = adjoint.Lambda.topRows<n>();
        const Eigen::Matrix<double, n, n> corner = rows.leftCols<n>();
        adjoint.Lambda.noalias() += A.transpose() * (rows + corner * A);
        adjoint.Lambda.noalias() += rows.transpose() * A;
        const Eigen::Matrix<double, n, 1> lambda = adjoint.lambda.head<n>();
        adjoint.lambda.noalias() += A.transpose() * lambda;
        adjoint.Lambda = (0.5 * (adjoint.Lambda + adjoint.Lambda.transpose())).eval();
    }
    between(0, next_before, next < path.size() ? out[next].std : 0.0);
    if (pass.updates.empty()) {  // six axes: the heading is that of the gyro
        for (std::size_t b = 0; b < out.size(); ++b) out[b].std = pass.free[b].std_since({});
    } else {  // before the first field it is that of the gyro, backward from there
        for (std::size_t b = 0; b < pass.started; ++b)
            out[b].std = std::hypot(out[b].std, pass.free[pass.started].std_since(pass.free[b]));
    }
    for (Smoothed1& s : out) s.std = std::min(s.std, std::numbers::pi / std::sqrt(3.0));
    return out;
}

/// Disturbance of the field at each update: its residual there, and in the recent past and near future.
std::vector<double> disturbances(const std::vector<double>& left, const HeadingSettings& settings) {
    const double gain = settings.block / (settings.block + settings.adaptation_time);
    std::vector<double> out(left.size(), std::numeric_limits<double>::quiet_NaN()), lately(left.size(), 1.0);
    double level = 1.0;
    for (std::size_t k = 0; k < left.size(); ++k) {
        if (std::isfinite(left[k])) level += gain * (left[k] - level);
        lately[k] = level;
    }
    level = 1.0;
    for (std::size_t k = left.size(); k-- > 0;) {
        if (!std::isfinite(left[k])) continue;
        level += gain * (left[k] - level);
        out[k] = std::max({1.0, left[k], 0.5 * (lately[k] + level)});
    }
    return out;
}

/// q_wb minus the smoothed error, which varies linearly within the block.
Eigen::Quaterniond smoothed_q_wb(const Strapdown& s, const std::vector<Smoothed2>& tilt) {
    if (s.block >= tilt.size()) {
        const Eigen::Vector2d e = tilt.empty() ? Eigen::Vector2d::Zero() : tilt.back().after;
        return math::quaternion_from_rotation_vector({e.x(), e.y(), 0.0}) * s.q_wb;
    }
    const Eigen::Vector2d begin = s.block > 0 && !tilt[s.block].levelled ? tilt[s.block - 1].after : tilt[s.block].before;
    const Eigen::Vector2d e = begin + static_cast<double>(s.along) * (tilt[s.block].before - begin);
    return math::quaternion_from_rotation_vector({e.x(), e.y(), 0.0}) * s.q_wb;
}

}  // namespace

RunResult run_offline(std::span<const ImuSample> imu, std::span<const MagSample> mag, std::span<const SpeedSample> speed,
                      const MekfSettings& settings) {
    const Forward f = forward_pass(imu, speed, settings);
    const std::vector<Smoothed2> tilt = smooth_tilt(f, settings.tilt);

    // weight of a field sample: from the innovation at first, then from the residual of the smoothed states
    constexpr int passes = 3;
    RunResult out;
    HeadingPass pass;
    std::vector<Smoothed1> turn;
    std::vector<double> disturbed;
    // there may be a magnet on the sensor: the first pass assumes one, the others the magnitude found so far
    HeadingSettings expected = settings.heading;
    expected.hard_iron_std = std::max(expected.hard_iron_std, expected.magnet_std);
    HeadingChannel heading(expected, settings.tilt, settings.six_axis);
    for (int i = 0; i < passes; ++i) {
        out.counters = f.counters;
        InstrumentGuard guard(settings.guard.field_range, settings.guard.stuck_after);
        heading = HeadingChannel(expected, settings.tilt, settings.six_axis);
        double shown = 0.0;
        pass.path.clear();
        pass.free.clear();
        pass.started = 0;
        pass.updates.clear();
        std::size_t m = 0;
        for (const Strapdown& s : f.strapdown) {
            const Eigen::Matrix3d C_wb = smoothed_q_wb(s, tilt).toRotationMatrix();
            if (s.block < f.tilt.size() && s.along >= 1.0F) {
                HeadingRecord record;
                record.block = s.block;
                if (pass.updates.size() < disturbed.size()) record.disturbance = disturbed[pass.updates.size()];
                heading.close(f.tilt[s.block].block, f.bias[s.block], out.counters, &record);
                pass.path.push_back(record.path);
                pass.free.push_back(heading.free_turn());
                if (!heading.started()) ++pass.started;
                if (record.active) {
                    pass.updates.push_back(record);
                    shown = std::max(shown, heading.hard_iron().cwiseAbs().maxCoeff() - 2.0 * heading.hard_iron_std());
                }
            }
            for (; m < mag.size() && mag[m].time <= imu[s.sample].time; ++m) {
                if (guard.usable(mag[m].field_b, out.counters.field) && !settings.six_axis)
                    heading.gather(C_wb, s.rate_b, mag[m].field_b);
            }
        }
        // w does not rotate by itself: the first observed field is also valid before
        if (!settings.six_axis && pass.started < pass.path.size())
            std::fill_n(pass.path.begin(), pass.started, pass.path[pass.started]);
        std::vector<double> left;
        turn = smooth_heading(pass, settings.heading, left);
        if (pass.updates.empty()) break;
        disturbed = disturbances(left, settings.heading);
        expected.hard_iron_std = std::max(settings.heading.hard_iron_std, shown);
    }
    out.field = {heading.hard_iron(), heading.horizontal_field(), heading.vertical_field(), heading.delay()};

    out.rows.reserve(f.strapdown.size());
    const std::size_t blocks = pass.path.size();
    for (const Strapdown& s : f.strapdown) {
        const std::size_t b = std::min(s.block, blocks > 0 ? blocks - 1 : 0);
        double angle = 0.0, heading_std = 0.0;
        Eigen::Vector2d tilt_std = Eigen::Vector2d::Zero();
        if (blocks > 0) {
            const double end = turn[b].heading, begin = b > 0 && !tilt[b].levelled ? turn[b - 1].heading : end;
            angle = s.block < blocks ? begin + static_cast<double>(s.along) * math::wrap_pi(end - begin) : end;
            heading_std = turn[b].std;
            if (!pass.updates.empty() && pass.path[b].norm() > 0.0)
                heading_std =
                    std::min(std::numbers::pi / std::sqrt(3.0),
                             std::hypot(heading_std,
                                        heading_of_tilt(pass.path[b], heading.vertical_field(), tilt[b].of_accel_bias).norm()));
            tilt_std = tilt[b].std;
        }
        const Eigen::Quaterniond q_nw(std::cos(0.5 * angle), 0.0, 0.0, std::sin(0.5 * angle));
        const double c = std::cos(angle), sn = std::sin(angle);
        const Eigen::Vector3d std(std::hypot(c * tilt_std.x(), sn * tilt_std.y()),
                                  std::hypot(sn * tilt_std.x(), c * tilt_std.y()), heading_std);
        const Eigen::Vector3d& bias =
            f.bias.empty() ? Eigen::Vector3d::Zero().eval() : f.bias[std::min(s.block, f.bias.size() - 1)];
        out.rows.push_back({imu[s.sample].time, q_nw * smoothed_q_wb(s, tilt), std, bias});
    }
    return out;
}

}  // namespace schuler::ahrs
