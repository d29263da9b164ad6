// Consecutive refused fixes may be due to the receiver or the navigation. Two hypotheses run in parallel until the data decide,
// and the reported uncertainty covers both: members of Pass.

#include "schuler/core/units.h"
#include "schuler/earth/earth.h"
#include "schuler/filter/update/pass.h"
#include "schuler/math/rotation.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <utility>

namespace schuler::filter {

namespace {

using Eigen::Vector3d;

/// An accelerating error, or one explained by the log, requires few fixes for acceptance; an ambiguous one the user's number.
constexpr int few_fixes = 4, explained_fixes = 2;
constexpr double few_seconds = 3.0;
/// The effect of lever arm, latency and heading on the first metres of a motion is not a jump of the receiver, m.
constexpr double least_jump = 1.0;

/// u u^T of the vertical u in the axes of the filter's attitude errors; the geocentric one is sufficient.
Eigen::Matrix3d down_axis(const InertialFilter<GeographicFrame>&) { return Vector3d::UnitZ() * Eigen::RowVector3d::UnitZ(); }
Eigen::Matrix3d down_axis(const InertialFilter<EarthFixedFrame>& f) {
    const Vector3d up = f.nav.position.r.normalized();
    return up * up.transpose();
}

/// The components of a measurement in their places: north, east, down.
Vector3d in_place(const Vector3d& packed, std::uint8_t components) {
    if (components == 7) return packed;
    Vector3d out = Vector3d::Zero();
    for (int axis = 0, used = 0; axis < 3; ++axis)
        if ((components >> axis & 1) != 0) out(axis) = packed(used++);
    return out;
}

Vector3d packed(const Vector3d& ned, std::uint8_t components) {
    Vector3d out = Vector3d::Zero();
    for (int axis = 0, used = 0; axis < 3; ++axis)
        if ((components >> axis & 1) != 0) out(used++) = ned(axis);
    return out;
}

/// Difference of two states: position (m), velocity (m/s), attitude (rad), north, east, down.
Vector9 difference(const earth::Earth& earth, const NavState& a, const NavState& b) {
    Vector9 d;
    d.head<3>() = earth::ned_difference(earth, a.position, b.position);
    d.segment<3>(3) = a.v_eb_n - b.v_eb_n;
    const Eigen::AngleAxisd turn(b.q_nb * a.q_nb.conjugate());
    d.tail<3>() = turn.angle() * turn.axis();
    return d;
}

/// Combines the channels that currently refuse their fixes.
template <class Frame>
Opening opening_of(const FilterRun<Frame>& run) {
    Opening o;
    o.bias_jump = 1.0;
    for (std::size_t k = 0; k < run.fixes.size(); ++k) {
        const FixChannel& c = run.fixes[k];
        if (c.run.count() == 0) continue;
        if (k % 2 == 0) {
            o.position += c.run.latest();  // horizontal and vertical, if those are two channels
            o.rate += c.run.rate();
        } else {
            o.velocity += c.run.latest();
        }
        if (c.fitted) o.span = std::max(o.span, (run.filter.time() - *c.fitted).seconds());
    }
    return o;
}

Alert alert_of(const Opening& o, Time time, IntegrityTest test) {
    if (o.position.isZero()) return {time, MeasurementKind::GnssVelocity, test, o.velocity.norm()};
    return {time, MeasurementKind::GnssPosition, test, o.position.norm()};
}

bool in_use(const FixChannel& c) { return c.fitted || c.run.count() > 0; }

/// Channel of the vertical axis of the positions (`first` 0) or velocities (1): its own if its latency differs.
template <class Frame>
const FixChannel& vertical_channel(const FilterRun<Frame>& run, std::size_t first) {
    return in_use(run.fixes[first + 2]) ? run.fixes[first + 2] : run.fixes[first];
}

/// True if the test holds for all channels of the positions (`first` 0) or velocities (1) that measure these axes.
template <class Frame, class Test>
bool all_channels(const FilterRun<Frame>& run, std::size_t first, bool vertical_only, Test&& test) {
    return (vertical_only || test(run.fixes[first])) && test(vertical_channel(run, first));
}

/// True if refused positions move relative to velocities that agree, in the axes that both measure.
template <class Frame>
bool wander(const FilterRun<Frame>& run) {
    const auto moves = [](const FixChannel& position, const FixChannel& velocity, int axis, int axes) {
        if (position.run.count() <= 1 || velocity.fits < few_fixes) return false;
        const Vector3d relative = position.run.rate() - velocity.sum / velocity.fits;
        return relative.segment(axis, axes).norm() > 4.0 * velocity.fitted_sigma;
    };
    return moves(run.fixes[0], run.fixes[1], 0, 2) || moves(vertical_channel(run, 0), vertical_channel(run, 1), 2, 1);
}

/// What of an estimated error of the receiver may as well be one of the solution: nothing up to two sigma of what the model allows, from
/// three on all of it.
double beyond_model(double estimate, double sigma) {
    return sigma > 0.0 ? estimate * std::clamp(std::abs(estimate) / sigma - 2.0, 0.0, 1.0) : 0.0;
}

template <class Frame>
double speed_sigma(const InertialFilter<Frame>& filter) {
    return std::sqrt(filter.P.diagonal().template segment<3>(Layout::velocity).maxCoeff());
}

}  // namespace

template <class Frame>
Matrix9 FilterRun<Frame>::undecided(const InertialModel& model) const {
    Matrix9 P = Matrix9::Zero();
    // A heading sensor that is always refused leaves two suspects: it and the heading.
    const double heading = std::hypot(undecided_heading, undecided_part * refused_heading);
    P(Layout::attitude + 2, Layout::attitude + 2) = heading * heading;
    if (heading > 0.0 && model.eccentric())
        turn_about_antenna(filter.geographic(model).q_nb * filter.lever_arm(model), P.template bottomRightCorner<3, 3>(), P);
    if (!ranges.watch.without.empty()) {
        const Matrix9 T = filter.to_local_level(model);
        P += T * ranges.watch.undecided() * T.transpose();
    }
    if (!rival.empty() && !rival.front().explained) {
        const Rival<Frame>& other = rival.front();
        const Vector9 d = undecided_part * difference(model.earth, other.run.filter.geographic(model), filter.geographic(model));
        P += d * d.transpose();
    }
    // Positions that contradict the solution end in the receiver's slow error. The covariance assumes a receiver of the model: where its
    // error would have to be far larger, it does not tell how the contradiction divides between that error and the solution's, nor, of
    // the horizontal ones, in which direction: the heading takes its part.
    if (const int slow = model.layout.gnss_position; slow >= 0) {
        const Vector3d estimate = filter.parameters.template segment<3>(slow) - filter.error.template segment<3>(slow);
        Vector3d d;
        for (int i = 0; i < 3; ++i) d(i) = undecided_part * beyond_model(estimate(i), model.gnss.correlated_position(i));
        const double horizontal = d.head<2>().squaredNorm();
        P.diagonal().template head<3>() += Vector3d(horizontal, horizontal, d.z() * d.z());
    }
    // Likewise a latency far from what was measured or told of it: an inertial unit in error leaves as much between it and the fixes.
    if (const int late = model.layout.gnss_latency; late >= 0) {
        const double estimate = filter.parameters(late) - filter.error(late);
        const double seconds = undecided_part * beyond_model(estimate, model.process[static_cast<std::size_t>(late)].sigma());
        const Vector3d d = seconds * filter.geographic(model).v_eb_n;
        P.template topLeftCorner<3, 3>() += d * d.transpose();
    }
    for (std::size_t k = 0; k < fixes.size(); ++k) {
        const FixChannel& c = fixes[k];
        const int block = k % 2 == 0 ? Layout::position : Layout::velocity;
        if (c.run.count() > 1) {
            const Vector3d d = undecided_part * c.run.latest();
            P.template block<3, 3>(block, block) += d * d.transpose();
        }
        if (!c.levels.two) continue;
        const Vector3d d = c.levels.spread();
        P.template topLeftCorner<3, 3>() += d * d.transpose();
    }
    return P;
}

template <class Frame>
bool Pass<Frame>::contests(MeasurementKind kind) const {
    return rivalry_ != Rivalry::None && is_part_of_fix(kind) && settings_.coupling != Coupling::Separate;
}

template <class Frame>
MeasurementStatus Pass<Frame>::judge(FilterRun<Frame>& run, Channel channel, MeasurementRecord& record, Measurement& local,
                                     Measurement& m, Observer& observer) const {
    FixChannel& fixes = run.fixes[channel.fix()];
    FixLevels& levels = fixes.levels;
    const double limit = data_.gates.chi_square[record.dof];
    const bool position = channel.kind == MeasurementKind::GnssPosition;
    const double since_fit = fixes.fitted ? (record.time - *fixes.fitted).seconds() : 0.0;
    double sigma = 0.0;
    for (int i = 0; i < m.dof; ++i) sigma = std::max(sigma, std::sqrt(m.variance(i)));
    const auto accept = [&](bool elsewhere) {
        if (levels.two && levels.at_other && !elsewhere)
            observer.alert({record.stamp, channel.kind, IntegrityTest::JumpBack, levels.other.norm()});
        for (int i = 0; elsewhere && i < m.dof; ++i) {
            m.variance(i) += levels.shared_variance();
            local.variance(i) += levels.shared_variance();
        }
        if (position && !levels.two && since_fit > interruption)
            levels.interrupted(in_place(record.innovation, channel.components), in_place(record.sigma, channel.components));
        else if (position) levels.confirm(elsewhere, since_fit);
        fixes.fit(record.time, in_place(record.innovation, channel.components), sigma);
        record.other_level = elsewhere;
        return MeasurementStatus::Accepted;
    };
    // Measured relative to the other level.
    const auto move = [&] {
        const Vector3d offset = packed(levels.other, channel.components);
        local.innovation -= offset;
        m.innovation -= offset;
        record.innovation -= offset;
        record.nis = m.innovation.dot(run.filter.innovation_covariance(m).inverse() * m.innovation);
    };
    if (levels.two) {
        MeasurementRecord here = record;
        const Measurement local_here = local, m_here = m;
        move();
        const bool fits_there = record.nis <= limit, fits_here = here.nis <= limit;
        if (fits_there && (levels.at_other || !fits_here)) {
            accept(true);
            if (levels.prefers_other()) {
                Vector9 to_other = Vector9::Zero();
                to_other.head<3>() = levels.other;
                StateVector dx = StateVector::Zero(run.filter.P.rows());
                dx.template head<9>() =
                    Frame::errors_are_geographic ? to_other : Vector9(run.filter.to_local_level(model_).inverse() * to_other);
                run.filter.apply(model_, dx);
                observer.alert({record.stamp, channel.kind, IntegrityTest::OtherLevel, levels.other.norm()});
                levels.swap();
            }
            return MeasurementStatus::Accepted;
        }
        record = here;
        local = local_here;
        m = m_here;
        if (fits_here) return accept(false);
    } else if (record.nis <= limit) {
        return accept(false);
    }

    fixes.run.add(record.time, in_place(record.innovation, channel.components), sigma);
    fixes.fits = 0;
    const bool suspect = run.suspect && (!fixes.fitted || *run.suspect > *fixes.fitted);
    const auto velocities = [&](auto&& test) { return all_channels(run, 1, channel.vertical_only, test); };
    if (position && !suspect && fixes.run.shape(speed_sigma(run.filter)) == RunShape::Constant) {
        const bool at_once = fixes.began_at_once(), jump = fixes.run.mean().norm() > least_jump;
        // After an interruption with refused velocities the navigation itself has drifted.
        const bool only_here = since_fit > interruption && velocities([](const FixChannel& c) { return c.run.count() == 0; });
        if (jump && (at_once || only_here || velocities([](const FixChannel& c) { return c.fits >= few_fixes; }))) {
            observer.alert({record.stamp, channel.kind, IntegrityTest::Jump, fixes.run.mean().norm()});
            // While a fix is no better than the estimate, the mean of several is the better offset.
            constexpr double much = 3.0;
            const double known = record.sigma_state.maxCoeff();
            levels.jumped(fixes.run.mean(), known > much * sigma ? known : 0.0, fixes.run.span(), at_once);
            fixes.run.clear();
            if (!run.rival.empty() && run.rival.front().challenger) run.rival.clear();
            move();
            if (record.nis > limit) return MeasurementStatus::Rejected;
            return accept(true);
        }
    }
    // A refused velocity while positions agree is a receiver error, unless the IMU log indicates otherwise.
    const bool positions_fit =
        !position && !suspect && all_channels(run, 0, channel.vertical_only, [](const FixChannel& c) { return c.fits > 0; });
    const int needed = suspect ? 1 : positions_fit ? settings_.constraints.recovery_count : 2;
    const bool long_enough = !positions_fit || fixes.run.span() >= settings_.constraints.recovery_time;
    if (rivalry_ == Rivalry::Contest && fixes.run.count() >= needed && long_enough) run.wanted = opening_of(run);
    return MeasurementStatus::Rejected;
}

namespace {

/// Processes the fixes with a rival.
template <class Frame>
struct FixCount : PassObserver<Frame> {
    Rival<Frame>& rival;
    explicit FixCount(Rival<Frame>& r) : rival(r) {}
    void measurement(const MeasurementRecord& r) override {
        if (r.kind != MeasurementKind::GnssPosition && r.kind != MeasurementKind::GnssVelocity) return;
        if (r.status == MeasurementStatus::Accepted) {
            ++rival.accepted;
            ++rival.accepted_in_row;
        } else if (r.status == MeasurementStatus::Rejected) {
            ++rival.refused;
            rival.accepted_in_row = 0;
        }
    }
};

}  // namespace

template <class Frame>
void Pass<Frame>::open(FilterRun<Frame>& run, const Opening& o) const {
    // Start time and velocity: a tilt e causes g e T, a heading error the same fraction of the speed. If attitude was lost (a gap
    // or fault of the inertial unit), the biases estimated since are wrong as well and restart. An error that arose gradually is a
    // random walk of velocity, attitude and biases through the time: the velocity must reach twice its mean.
    auto& P = run.filter.P;
    const bool gradual = o.part > 0.0;
    const double part = gradual ? o.part : 1.0;
    const double size2 = o.position.squaredNorm() * (gradual ? 4.0 : 1.0), span = std::max(1.0, o.span);
    const double faster2 = std::max({size2 / (span * span), o.rate.squaredNorm(), o.velocity.squaredNorm()});
    if (!gradual) P.diagonal().template segment<3>(Layout::position).array() += size2;
    P.diagonal().template segment<3>(Layout::velocity).array() += part * faster2;
    if (settings_.coupling == Coupling::Separate) return;  // it estimates neither attitude nor biases
    constexpr double most_tilt = 0.3, most_heading = 1.0;  // rad: beyond these the filter is not linear
    const double speed2 = std::max(1.0, run.filter.geographic(model_).v_eb_n.squaredNorm());
    const double tilt2 = std::min(most_tilt * most_tilt, faster2 / std::pow(units::g0 * span, 2));
    const double heading2 = std::min(most_heading * most_heading, faster2 / speed2);
    const Eigen::Matrix3d down = down_axis(run.filter);
    estim::add(P.template block<3, 3>(Layout::attitude, Layout::attitude),
               part * (tilt2 * (Eigen::Matrix3d::Identity() - down) + heading2 * down));
    const auto reopen = [&](int offset, double sigma) {
        P.diagonal().template segment<3>(offset).array() += part * sigma * sigma;
    };
    double rate = settings_.imu.errors.gyro_initial_bias(), force = settings_.imu.errors.accel_initial_bias();
    if (o.bias_jump > 0.0) {
        const double most_rate = 0.1 * o.bias_jump, most_force = 2.0 * o.bias_jump;  // rad/s, m/s^2
        rate = std::max(rate, std::min(most_rate, std::sqrt(tilt2 + heading2) / span));
        force = std::max(force, std::min(most_force, std::sqrt(faster2) / span));
    }
    reopen(Layout::gyro_bias, rate);
    reopen(Layout::accel_bias, force);
}

template <class Frame>
void Pass<Frame>::challenge(FilterRun<Frame>& run) const {
    Opening opening = *run.wanted;
    run.wanted.reset();
    run.rival.clear();
    opening.increment = run.increment;
    Rival<Frame>& rival = run.rival.room();
    rival.run = run;
    FilterRun<Frame>& w = rival.run;
    w.next_output = Time{INT64_MAX};
    w.challenged_by_fixes = false;
    ++w.increment;
    for (FixChannel& c : w.fixes) c.run.clear();
    open(w, opening);
    w.openings.push_back(opening);
    rival.opening = opening;
    constexpr double patience = 60.0;  // s
    const std::optional<Time>& fitted = run.fixes[opening.position.isZero() ? 1 : 0].fitted;
    rival.begin(run.filter.time(), true, run.suspect && (!fitted || *run.suspect > *fitted), patience);
    run.rival.use();
}

template <class Frame>
void Pass<Frame>::change_sides(FilterRun<Frame>& run) const {
    AtMostOne<Rival<Frame>> held = std::move(run.rival);
    Rival<Frame>& other = held.front();
    FilterRun<Frame>& winner = other.run;
    winner.next_output = run.next_output;
    winner.outputs = run.outputs;
    winner.increment = run.increment;
    winner.sides_changed = run.sides_changed + 1;
    winner.challenged_by_fixes = true;
    run.challenged_by_fixes = false;
    run.next_output = Time{INT64_MAX};
    ++run.increment;
    std::swap(run, winner);
    // If the log explains it, the case is decided. Otherwise the loser continues, and the reported uncertainty includes it.
    if (other.explained) {
        held.clear();
    } else {
        other.begin(run.filter.time(), false, false, other.patience);
        for (FixChannel& c : run.fixes) c.fits = 0;
    }
    run.rival = std::move(held);
}

template <class Frame>
void Pass<Frame>::contest(FilterRun<Frame>& run, Observer& observer) const {
    if (rivalry_ == Rivalry::Decided) {
        for (const Opening& o : openings_) {
            if (o.increment != run.increment) continue;
            propagate_covariance(run, observer);
            for (FixChannel& c : run.fixes) c.run.clear();
            open(run, o);
        }
        return;
    }
    if (!run.challenged_by_fixes) return;
    if (run.rival.empty()) {
        if (!run.wanted) return;
        propagate_covariance(run, observer);
        challenge(run);
        return;
    }
    Rival<Frame>& rival = run.rival.front();
    FixCount<Frame> count(rival);
    const int fixes_before = rival.accepted + rival.refused;
    if (!try_advance(rival.run, run.increment, count)) {
        run.diverged = rival.run.diverged;
        return;
    }
    const double age = (run.filter.time() - rival.since).seconds();
    if (rival.accepted + rival.refused == fixes_before) {
        if (!rival.challenger && age > rival.patience) run.rival.clear();
        return;
    }
    // A loser that accepts these fixes no better than the winner is replaced by a new challenger.
    const std::optional<Opening> wanted = std::exchange(run.wanted, std::nullopt);
    if (wanted && !rival.challenger && rival.accepted_in_row == 0) {
        run.wanted = wanted;
        propagate_covariance(run, observer);
        challenge(run);
        return;
    }
    const FixChannel &positions = run.fixes[0], &speeds = run.fixes[1];
    const FixChannel& main = positions.fitted || positions.run.count() > 0 ? positions : speeds;
    const bool main_refuses = std::ranges::any_of(run.fixes, [](const FixChannel& c) { return c.run.count() > 0; });
    if (rival.challenger) {
        if (!main_refuses && main.fits >= 2) {  // the receiver was wrong, and has recovered
            observer.alert(alert_of(rival.opening, run.filter.time(), IntegrityTest::Receiver));
            run.rival.clear();
            return;
        }
        // A rival that accepts the velocities and refuses all positions, or vice versa, is no better than one that refuses both.
        const bool half = rival.refused >= settings_.constraints.recovery_count && 4 * rival.refused > rival.accepted;
        if (half ||
            (rival.refused > 0 && rival.accepted_in_row == 0)) {  // it does not explain them either: possibly a bias has jumped
            const int attempts = rival.attempts + 1;
            run.rival.clear();
            if (!wanted) return;
            run.wanted = wanted;
            run.wanted->bias_jump = attempts % 2 == 0 ? std::pow(10.0, std::min(attempts / 2, 3)) : 0.0;
            propagate_covariance(run, observer);
            challenge(run);
            run.rival.front().attempts = attempts;
            return;
        }
        if (!main_refuses) return;
        // Continued agreement of the velocities shows that the positions wander by themselves.
        if (!rival.explained && wander(run)) return;
        int needed = settings_.constraints.recovery_count;
        double seconds = settings_.constraints.recovery_time;
        if (rival.explained) {
            needed = explained_fixes;
            seconds = 0.0;
        } else {
            const RunShape shape = positions.run.shape(speed_sigma(run.filter));
            if (shape == RunShape::Growing || (shape == RunShape::Constant && positions.run.mean().norm() <= least_jump)) {
                needed = few_fixes;
                seconds = few_seconds;
                rival.patience = settings_.constraints.recovery_time;
            }
        }
        if (rival.accepted_in_row >= needed && age >= seconds) {
            observer.alert(alert_of(rival.opening, run.filter.time(), IntegrityTest::Navigation));
            change_sides(run);
        }
        return;
    }
    // The loser continues: it is accepted after all if it agrees with the fixes and the winner does not.
    if (rival.accepted_in_row >= 2 && main_refuses && main.run.count() >= 2) {
        change_sides(run);
        run.rival.clear();
        return;
    }
    // Accelerating divergence is an inertial error, which decides the case.
    if (rival.run.fixes[0].run.shape(speed_sigma(rival.run.filter)) == RunShape::Growing)
        rival.patience = std::min(rival.patience, settings_.constraints.recovery_time);
    if ((rival.accepted_in_row >= 2 && !main_refuses) || age > rival.patience) run.rival.clear();
}

#define SCHULER_INSTANTIATE(Frame)                                                                                            \
    template Matrix9 FilterRun<Frame>::undecided(const InertialModel&) const;                                                 \
    template bool Pass<Frame>::contests(MeasurementKind) const;                                                               \
    template MeasurementStatus Pass<Frame>::judge(FilterRun<Frame>&, Channel, MeasurementRecord&, Measurement&, Measurement&, \
                                                  Observer&) const;                                                           \
    template void Pass<Frame>::open(FilterRun<Frame>&, const Opening&) const;                                                 \
    template void Pass<Frame>::challenge(FilterRun<Frame>&) const;                                                            \
    template void Pass<Frame>::change_sides(FilterRun<Frame>&) const;                                                         \
    template void Pass<Frame>::contest(FilterRun<Frame>&, Observer&) const;
SCHULER_INSTANTIATE(GeographicFrame)
SCHULER_INSTANTIATE(EarthFixedFrame)
#undef SCHULER_INSTANTIATE

}  // namespace schuler::filter
