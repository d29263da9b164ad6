#include "schuler/ppk/baseline_filter.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/math/chi_square.h"
#include "schuler/math/quantile.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace schuler::ppk {
namespace {

constexpr double unknown_ambiguity = 30.0;  ///< m, one sigma beyond code minus phase

/// Keeps the given rows and columns.
void keep(Eigen::VectorXd& x, Eigen::MatrixXd& P, const std::vector<Eigen::Index>& states) {
    const auto n = static_cast<Eigen::Index>(states.size());
    Eigen::VectorXd x_new(n);
    Eigen::MatrixXd P_new(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
        x_new[j] = x[states[static_cast<std::size_t>(j)]];
        for (Eigen::Index i = 0; i < n; ++i)
            P_new(i, j) = P(states[static_cast<std::size_t>(i)], states[static_cast<std::size_t>(j)]);
    }
    x = std::move(x_new);
    P = std::move(P_new);
}

}  // namespace

BaselineFilter::BaselineFilter(const Settings& settings, const SignalPlan& plan, const BaseStation& station,
                               bool estimate_ionosphere)
    : settings_(settings), plan_(plan), station_(station), ionosphere_(estimate_ionosphere) {}

void BaselineFilter::begin_at(const TrackedEpoch& rover) {
    if (!begun_) {
        x_ = Eigen::VectorXd::Zero(leading);
        P_ = Eigen::MatrixXd::Zero(leading, leading);
        entries_.clear();
        code_.clear();
        same_integers_ = 0;
    }
    constexpr double beyond_single = 10.0, speed = 100.0;  // m, m/s
    P_.topRows(6).setZero();
    P_.leftCols(6).setZero();
    x_.head<3>() = rover.position.r;
    P_.topLeftCorner<3, 3>() = 9.0 * rover.single.covariance + beyond_single * beyond_single * Eigen::Matrix3d::Identity();
    const bool moves = settings_.motion == Motion::Kinematic;
    x_.segment<3>(3).setZero();
    P_.block<3, 3>(3, 3) = (moves ? speed * speed : 0.0) * Eigen::Matrix3d::Identity();
    if (begun_) return;
    begun_ = true;
    if (!settings_.air.troposphere) return;
    const AirLeft& left = settings_.left;
    const double length = (rover.position.r - station_.position().r).norm();
    const Geodetic here = earth::geodetic_from_ecef(earth::wgs84, rover.position);
    P_(6, 6) = std::pow(left.zenith_least + left.zenith_gradient * length, 2) +
               std::pow(left.zenith_height * (here.h - station_.geodetic().h), 2);
}

void BaselineFilter::predict(double dt) {
    const double span = std::abs(dt);
    // position driven by velocity; F P F' by columns and rows
    if (settings_.motion == Motion::Kinematic) {
        x_.head<3>() += dt * x_.segment<3>(3);
        P_.topRows(3) += dt * P_.middleRows(3, 3);
        P_.leftCols(3) += dt * P_.middleCols(3, 3);
        const double q = settings_.acceleration * settings_.acceleration;
        const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
        P_.topLeftCorner<3, 3>() += q * span * span * span / 3.0 * I;
        P_.block<3, 3>(0, 3) += q * span * dt / 2.0 * I;
        P_.block<3, 3>(3, 0) += q * span * dt / 2.0 * I;
        P_.block<3, 3>(3, 3) += q * span * I;
    }
    if (settings_.air.troposphere) P_(6, 6) += std::pow(settings_.left.zenith_walk * std::max(baseline_, 1e3) / 1e4, 2) * span;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        const Eigen::Index k = leading + static_cast<Eigen::Index>(i);
        if (!entries_[i].ionosphere) {
            P_(k, k) += settings_.phase_walk * settings_.phase_walk * span;
            continue;
        }
        const double decay = std::exp(-span / settings_.left.ionosphere_time),
                     sigma = settings_.left.ionosphere_disturbed * baseline_;
        x_[k] *= decay;
        P_.row(k) *= decay;
        P_.col(k) *= decay;
        P_(k, k) += (1.0 - decay * decay) * sigma * sigma;
    }
}

void BaselineFilter::forget(Time tag, Time before) {
    std::vector<Eigen::Index> states(leading);
    for (Eigen::Index i = 0; i < leading; ++i) states[static_cast<std::size_t>(i)] = i;
    std::vector<Entry> left;
    const double longest = std::max(settings_.arcs.longest_gap, 1.5 * std::abs((tag - before).seconds()));
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        const Entry& e = entries_[i];
        bool stays = std::abs((tag - e.seen).seconds()) <= longest;
        for (const Difference& d : differences_)  // a new arc of the same phase
            if (!e.ionosphere && d.id == e.id && d.slot == e.slot)
                stays = stays && d.rover_arc == e.rover_arc && d.base_arc == e.base_arc;
        if (!stays) continue;
        left.push_back(e);
        states.push_back(leading + static_cast<Eigen::Index>(i));
    }
    if (left.size() == entries_.size()) return;
    entries_ = std::move(left);
    keep(x_, P_, states);
}

void BaselineFilter::settle_states(const TrackedEpoch& rover, Time before) {
    forget(rover.tag, before);
    ambiguity_.assign(differences_.size(), -1);
    delay_.assign(differences_.size(), -1);
    // for each group: ambiguities minus the current phase minus code, which are changed by clock jumps at one receiver
    std::map<int, std::vector<double>> offsets;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        Entry& e = entries_[i];
        for (std::size_t k = 0; k < differences_.size(); ++k) {
            const Difference& d = differences_[k];
            if (d.id != e.id || (!e.ionosphere && d.slot != e.slot)) continue;
            const Eigen::Index state = leading + static_cast<Eigen::Index>(i);
            (e.ionosphere ? delay_ : ambiguity_)[k] = state;
            e.seen = rover.tag;
            if (!e.ionosphere && std::isfinite(d.code)) offsets[group_of(d)].push_back(x_[state] - (d.phase - d.code));
        }
    }
    offsets_.clear();
    for (const auto& [group, values] : offsets) offsets_[group] = math::median(values);
    const Eigen::Index size = x_.size();
    std::vector<std::pair<double, double>> fresh;  // value and variance
    for (std::size_t k = 0; k < differences_.size(); ++k) {
        const Difference& d = differences_[k];
        if (ambiguity_[k] < 0) {
            ambiguity_[k] = size + static_cast<Eigen::Index>(fresh.size());
            fresh.emplace_back(first_ambiguity(d), unknown_ambiguity * unknown_ambiguity);
            entries_.push_back({false, d.id, d.slot, d.rover_arc, d.base_arc, rover.tag, {}});
        }
        if (!ionosphere_ || delay_[k] >= 0) continue;
        if (k > 0 && differences_[k - 1].id == d.id) {  // those of one satellite are adjacent
            delay_[k] = delay_[k - 1];
            continue;
        }
        const double sigma = settings_.left.ionosphere_disturbed * baseline_ * shell_mapping(d.elevation);
        delay_[k] = size + static_cast<Eigen::Index>(fresh.size());
        fresh.emplace_back(0.0, sigma * sigma);
        entries_.push_back({true, d.id, 0, 0, 0, rover.tag, {}});
    }
    if (fresh.empty()) return;
    // if most of the old ambiguities are gone, their codes carry no further information
    if (2 * fresh.size() > differences_.size()) code_.clear();
    const Eigen::Index n = size + static_cast<Eigen::Index>(fresh.size());
    x_.conservativeResize(n);
    P_.conservativeResizeLike(Eigen::MatrixXd::Zero(n, n));
    for (std::size_t i = 0; i < fresh.size(); ++i) {
        const Eigen::Index k = size + static_cast<Eigen::Index>(i);
        x_[k] = fresh[i].first;
        P_(k, k) = fresh[i].second;
    }
}

double BaselineFilter::first_ambiguity(const Difference& d) const {
    const auto offset = offsets_.find(group_of(d));
    return (std::isfinite(d.code) ? d.phase - d.code : d.phase) + (offset == offsets_.end() ? 0.0 : offset->second);
}

void BaselineFilter::restart(std::size_t difference) {
    const Eigen::Index k = ambiguity_[difference];
    x_[k] = first_ambiguity(differences_[difference]);
    P_.row(k).setZero();
    P_.col(k).setZero();
    P_(k, k) = unknown_ambiguity * unknown_ambiguity;
    Entry& e = entry_of(difference);
    e.phase.reset();
    e.trusted = e.broken = false;
    e.jumped = true;
    e.integer = not_given;
}

bool BaselineFilter::update(Time tag, double dt, EpochSolution& out) {
    code_out_.assign(differences_.size(), false);
    if (!reject_misfits(tag, out)) return false;
    judge_codes(dt);
    const Rows r = rows(tag, Weighting::Filter, x_);
    const estim::BlockUpdate block(P_, r.H, r.z, r.R);
    if (!block.valid()) return false;
    x_ += block.error();
    block.apply(P_);
    for (std::size_t k = 0; k < differences_.size(); ++k) {
        if (std::isfinite(differences_[k].code) && !code_out_[k]) code_[{differences_[k].id, differences_[k].slot}] = tag;
        entry_of(k).phase = tag;
    }
    return true;
}

void BaselineFilter::use_velocity(const TrackedEpoch& rover) {
    if (settings_.motion == Motion::Static || !rover.placed || !rover.single.velocity.allFinite()) return;
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(3, x_.size());
    H.block<3, 3>(0, 3).setIdentity();
    const Eigen::VectorXd z = rover.single.velocity - x_.segment<3>(3);
    const estim::BlockUpdate block(P_, H, z, rover.single.velocity_covariance);
    constexpr double gate = 25.9;  // chi-square of three, 1e-5
    if (!block.valid() || block.statistic() > gate) return;
    x_ += block.error();
    block.apply(P_);
}

/// The position of the epoch from its phases, with ambiguities, zenith delay and ionosphere as known: the filter's own position
/// weights phases with lasting errors only by their information about the ambiguities.
/// Returns the weighted sum of squared residuals for that position.
double BaselineFilter::place(Time tag, const Eigen::VectorXd& x, const Eigen::MatrixXd& P, EpochSolution& out) const {
    const Rows r = rows(tag, Weighting::Phases, x);
    const Eigen::Index others = x.size() - 6;
    const auto H_others = r.H.rightCols(others);
    Eigen::MatrixXd S = r.R + H_others * P.bottomRightCorner(others, others) * H_others.transpose();
    Eigen::VectorXd by_vertical(r.z.size());
    for (std::size_t i = 0; i < r.of.size(); ++i)
        by_vertical[static_cast<Eigen::Index>(i)] =
            differences_[r.of[i].reference].vertical_factor() - differences_[r.of[i].of].vertical_factor();
    S += vertical_.variance * by_vertical * by_vertical.transpose();
    const Eigen::LLT<Eigen::MatrixXd> root(S);
    if (settings_.motion == Motion::Static || r.of.size() < 4 || root.info() != Eigen::Success) {
        out.position.r = x.head<3>();
        out.covariance = P.topLeftCorner<3, 3>();
        return not_given;
    }
    const Eigen::MatrixXd A = root.matrixL().solve(r.H.leftCols<3>());
    const Eigen::VectorXd white = root.matrixL().solve(r.z);
    const Eigen::Matrix3d information =
        A.transpose() * A + P.topLeftCorner<3, 3>().inverse() * 1e-6;  // for directions not determined by phases
    out.covariance = information.inverse();
    const Eigen::Vector3d moved = out.covariance * (A.transpose() * white);
    out.position.r = linearised_.r + moved;
    return (white - A * moved).squaredNorm();
}

void BaselineFilter::use_integers(Time tag, double dt, EpochSolution& out) {
    std::vector<WholeState> whole;
    for (std::size_t k = 0; k < differences_.size(); ++k) {
        const Difference& d = differences_[k];
        const Entry& e = entry_of(k);
        const bool halves = d.halves || e.jumped;
        if (d.whole && !e.broken)
            whole.push_back({d.id, group_of(d), ambiguity_[k], (halves ? 0.5 : 1.0) * d.wavelength, halves, d.elevation,
                             d.repeated, e.trusted});
    }
    const IntegerTrial trial = fix_integers(x_, P_, whole, x_.size(), settings_.integers);
    out.ratio = trial.ratio;
    out.success = trial.success;
    if (!trial.fix || trial.fix->count < trial.fix->ambiguities) same_integers_ = 0;
    if (!trial.fix) return;
    for (Entry& e : entries_) e.trusted = false;
    for (const Eigen::Index state : trial.fix->states) entries_[static_cast<std::size_t>(state - leading)].trusted = true;
    for (const Eigen::Index state : trial.fix->broken) entries_[static_cast<std::size_t>(state - leading)].broken = true;
    const Eigen::VectorXd x = x_ + trial.fix->correction;
    const double squares = place(tag, x, trial.fix->covariance, out);
    if (trial.fix->count == trial.fix->ambiguities) {
        follow_ionosphere(x, dt);
        phase_scale_.add(phase_scale_.value() * squares, trial.fix->ambiguities - 3.0, dt);
        place(tag, x, trial.fix->covariance, out);
    }
    out.velocity += trial.fix->correction.segment<3>(3);
    out.velocity_covariance = trial.fix->covariance.block<3, 3>(3, 3);
    out.ambiguities = trial.fix->ambiguities;
    out.fixed = trial.fix->count;
    // some combinations of integers may be fixed without improving the position
    constexpr double fixed_sigma = 0.05;  // m
    if (out.covariance.trace() < fixed_sigma * fixed_sigma) out.quality = Quality::Fixed;
    if (settings_.views) look_at_signals(x, true, out);
    if (trial.fix->count == trial.fix->ambiguities) hold(*trial.fix);
}

/// Two carriers with integers show by how much the vertical delay of the ionosphere differs between the receivers: the difference of
/// their phases grows with it towards the horizon. On short baselines it is usually below the noise and no state; in a storm the
/// measurements are corrected by it.
void BaselineFilter::follow_ionosphere(const Eigen::VectorXd& x, double dt) {
    if (ionosphere_ || !settings_.air.ionosphere) return;
    struct Sums {
        double weight = 0, by = 0, z = 0, by_by = 0, by_z = 0;
    };
    std::map<std::pair<int, int>, Sums> pairs;  // carriers of one system: their ambiguities have a constant in common
    for (std::size_t k = 0; k + 1 < differences_.size(); ++k) {
        const Difference &a = differences_[k], &b = differences_[k + 1];  // those of one satellite are adjacent
        if (a.id != b.id || !entry_of(k).trusted || !entry_of(k + 1).trusted) continue;
        const double z = (a.phase - x[ambiguity_[k]]) - (b.phase - x[ambiguity_[k + 1]]),
                     by = b.vertical_factor() - a.vertical_factor(),
                     w = 1.0 / (a.phase_variance - a.left + b.phase_variance - b.left);
        Sums& s = pairs[{group_of(a), group_of(b)}];
        s.weight += w;
        s.by += w * by;
        s.z += w * z;
        s.by_by += w * by * by;
        s.by_z += w * by * z;
    }
    double information = 0.0, right = 0.0;
    for (const auto& [carriers, s] : pairs) {
        information += s.by_by - s.by * s.by / s.weight;
        right += s.by_z - s.by * s.z / s.weight;
    }
    constexpr double least = 1.0, memory = 600.0;  // 1/m^2, s
    if (information < least) return;
    Vertical& v = vertical_;
    v.weight = v.weight * std::exp(-std::abs(dt) / memory) + information;
    v.mean += (right / information - v.mean) * information / v.weight;
    // the variance of this mean: phases err alike for some time
    const double alike = 1.0 + 2.0 * settings_.phase_correlation / std::max(std::abs(dt), 1e-3);
    const double noise = std::min(alike / v.weight, 1.0 / information);
    v.value = v.mean * std::max(1.0 - noise / (v.mean * v.mean), 0.0);  // as far as it is more than noise
    v.variance = std::min(noise, v.value * v.value);
}

/// Once the same integers have been fixed for some epochs, the float solution is constrained to them: when satellites slip or
/// set, the remaining ones could not be fixed again by codes. The constraint is loose enough that phase errors do not distort it.
void BaselineFilter::hold(const IntegerFix& fix) {
    constexpr int often = 10;
    constexpr double same = 0.02, sigma = 0.01;        // m
    std::map<int, std::pair<double, double>> changes;  // smallest and largest of each group
    std::map<int, std::vector<Eigen::Index>> groups;
    for (std::size_t k = 0; k < differences_.size(); ++k) {
        Entry& e = entry_of(k);
        if (!e.trusted) continue;
        const int group = group_of(differences_[k]);
        groups[group].push_back(ambiguity_[k]);
        const double now = x_[ambiguity_[k]] + fix.correction[ambiguity_[k]], change = now - std::exchange(e.integer, now);
        if (!std::isfinite(change)) continue;
        const auto [it, fresh] = changes.try_emplace(group, change, change);
        it->second = {std::min(it->second.first, change), std::max(it->second.second, change)};
    }
    const bool changed = std::ranges::any_of(changes, [](const auto& c) { return c.second.second - c.second.first > same; });
    same_integers_ = changed || changes.empty() ? 0 : same_integers_ + 1;
    if (same_integers_ < often) return;
    Eigen::Index m = 0;
    for (const auto& [group, states] : groups) m += static_cast<Eigen::Index>(states.size()) - 1;
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(m, x_.size());
    Eigen::VectorXd z(m);
    Eigen::Index row = 0;
    for (const auto& [group, states] : groups)
        for (std::size_t i = 1; i < states.size(); ++i, ++row) {
            H(row, states[i]) = 1.0;
            H(row, states[0]) = -1.0;
            z[row] = fix.correction[states[i]] - fix.correction[states[0]];
        }
    if (m == 0) return;
    const estim::BlockUpdate block(P_, H, z, sigma * sigma * Eigen::MatrixXd::Identity(m, m));
    if (!block.valid()) return;
    x_ += block.error();
    block.apply(P_);
}

EpochSolution BaselineFilter::single(const TrackedEpoch& rover) const {
    EpochSolution out;
    out.tag = rover.tag;
    out.time = rover.time;
    if (!rover.placed) return out;
    out.quality = Quality::Single;
    out.position = rover.single.position;
    out.covariance = rover.single.covariance;
    out.velocity = rover.single.velocity;
    out.velocity_covariance = rover.single.velocity_covariance;
    out.satellites = static_cast<int>(rover.satellites.size());
    return out;
}

EpochSolution BaselineFilter::step(const TrackedEpoch& rover) {
    const auto base = station_.at(rover.tag);
    if (begun_) predict((rover.tag - tag_).seconds());
    constexpr double lost = 100.0;  // m, one sigma of a coordinate: the single-point solution is better, and the model linear
    if (!begun_ || P_.diagonal().head<3>().maxCoeff() > lost * lost) {
        if (!rover.placed) {
            begun_ = false;
            return single(rover);
        }
        begin_at(rover);
    }
    const Time before = tag_;
    tag_ = rover.tag;
    if (!base) return single(rover);
    const Ecef position{x_.head<3>()};
    linearised_ = position;
    baseline_ = (position.r - station_.position().r).norm();
    differences_ = single_differences(rover, *base, station_, plan_, position, settings_, ionosphere_);
    std::set<SatelliteId> satellites;
    for (const Difference& d : differences_) satellites.insert(d.id);
    constexpr std::size_t least = 4;
    if (satellites.size() < least) return single(rover);
    settle_states(rover, before);
    EpochSolution out;
    out.tag = rover.tag;
    out.time = rover.time;
    out.age = base->age;
    out.satellites = static_cast<int>(satellites.size());
    const double dt = (rover.tag - before).seconds();
    if (!update(rover.tag, dt, out)) {
        begun_ = false;  // the whole solution is in doubt
        EpochSolution instead = single(rover);
        instead.rejected = out.rejected;
        return instead;
    }
    use_velocity(rover);
    out.quality = Quality::Float;
    place(rover.tag, x_, P_, out);
    out.velocity = x_.segment<3>(3);
    out.velocity_covariance = P_.block<3, 3>(3, 3);
    if (settings_.views) look_at_signals(x_, false, out);
    if (settings_.integers.use) use_integers(rover.tag, dt, out);
    out.code_scale = code_scale_.value();
    out.phase_scale = phase_scale_.value();
    out.vertical_ionosphere = vertical_.value;
    out.vertical_weight = vertical_.weight;
    return out;
}

}  // namespace schuler::ppk
