#include "schuler/ppk/baseline_filter.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/estim/block_update.h"
#include "schuler/math/chi_square.h"
#include "schuler/math/quantile.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace schuler::ppk {
namespace {

constexpr double unknown_ambiguity = 30.0;   ///< m, one sigma beyond what code less phase says

int group_of(const Difference& d) { return static_cast<int>(d.id.system) * 256 + static_cast<int>(d.band); }

/// Rows and columns that stay.
void keep(Eigen::VectorXd& x, Eigen::MatrixXd& P, const std::vector<Eigen::Index>& states) {
    const auto n = static_cast<Eigen::Index>(states.size());
    Eigen::VectorXd x_new(n);
    Eigen::MatrixXd P_new(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
        x_new[j] = x[states[static_cast<std::size_t>(j)]];
        for (Eigen::Index i = 0; i < n; ++i) P_new(i, j) = P(states[static_cast<std::size_t>(i)], states[static_cast<std::size_t>(j)]);
    }
    x = std::move(x_new);
    P = std::move(P_new);
}

}  // namespace

BaselineFilter::BaselineFilter(const Settings& settings, const SignalPlan& plan, const BaseStation& station, bool estimate_ionosphere)
    : settings_(settings), plan_(plan), station_(station), ionosphere_(estimate_ionosphere) {}

void BaselineFilter::begin_at(const TrackedEpoch& rover) {
    if (!begun_) {
        x_ = Eigen::VectorXd::Zero(leading);
        P_ = Eigen::MatrixXd::Zero(leading, leading);
        entries_.clear();
        code_.clear();
    }
    constexpr double beyond_single = 10.0, speed = 100.0;   // m, m/s
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
    P_(6, 6) = std::pow(left.zenith_least + left.zenith_gradient * length, 2) + std::pow(left.zenith_height * (here.h - station_.geodetic().h), 2);
}

void BaselineFilter::predict(double dt) {
    const double span = std::abs(dt);
    // velocity moves the position; F P F' by columns and rows
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
        const double decay = std::exp(-span / settings_.left.ionosphere_time), sigma = settings_.left.ionosphere_disturbed * baseline_;
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
        for (const Difference& d : differences_)   // another arc of the same phase
            if (!e.ionosphere && d.id == e.id && d.slot == e.slot) stays = stays && d.rover_arc == e.rover_arc && d.base_arc == e.base_arc;
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
    // of each group: ambiguities less what phase and code say now, which clocks that jump in one of them change
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
    std::vector<std::pair<double, double>> fresh;   // value and variance
    for (std::size_t k = 0; k < differences_.size(); ++k) {
        const Difference& d = differences_[k];
        if (ambiguity_[k] < 0) {
            ambiguity_[k] = size + static_cast<Eigen::Index>(fresh.size());
            fresh.emplace_back(first_ambiguity(d), unknown_ambiguity * unknown_ambiguity);
            entries_.push_back({false, d.id, d.slot, d.rover_arc, d.base_arc, rover.tag});
        }
        if (!ionosphere_ || delay_[k] >= 0) continue;
        if (k > 0 && differences_[k - 1].id == d.id) {   // those of one satellite stand side by side
            delay_[k] = delay_[k - 1];
            continue;
        }
        const double sigma = settings_.left.ionosphere_disturbed * baseline_ * shell_mapping(d.elevation);
        delay_[k] = size + static_cast<Eigen::Index>(fresh.size());
        fresh.emplace_back(0.0, sigma * sigma);
        entries_.push_back({true, d.id, 0, 0, 0, rover.tag});
    }
    if (fresh.empty()) return;
    // where the old ambiguities are gone, nothing is left of what their codes said
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
    e.trusted = e.broken = false;
    e.jumped = true;
}

/// Reflections make a satellite's code err alike for a while. Of n codes whose errors are a first-order Gauss-Markov process the first tells
/// one unit of information about the constant ambiguity and each further one (1 - rho) / (1 + rho) [Brown2012].
double BaselineFilter::code_variance(const Difference& d, Time tag) const {
    const auto last = code_.find({d.id, d.slot});
    if (last == code_.end() || !(settings_.code_correlation > 0.0)) return d.code_variance;
    const double rho = std::exp(-std::abs((tag - last->second).seconds()) / settings_.code_correlation);
    return d.code_variance * (1.0 + rho) / std::max(1.0 - rho, 1e-3);
}

BaselineFilter::Rows BaselineFilter::rows(Time tag) const {
    // the members of each group with a code, with a phase; their reference is the highest
    std::map<std::pair<int, bool>, std::vector<std::size_t>> groups;
    for (std::size_t k = 0; k < differences_.size(); ++k) {
        const int group = group_of(differences_[k]);
        groups[{group, true}].push_back(k);
        if (std::isfinite(differences_[k].code) && !code_out_[k]) groups[{group, false}].push_back(k);
    }
    Rows out;
    std::vector<double> noise, reference_noise;
    std::vector<std::size_t> first;   // row at which the group of a row begins
    for (const auto& [key, members] : groups) {
        const bool phase = key.second;
        const auto variance = [&](std::size_t k) {
            const Difference& d = differences_[k];
            return phase ? d.phase_variance : code_variance(d, tag);
        };
        const std::size_t reference = *std::ranges::max_element(members, {}, [&](std::size_t k) { return differences_[k].elevation; });
        const std::size_t begin = out.of.size();
        for (const std::size_t k : members) {
            if (k == reference) continue;
            out.of.push_back({k, reference, phase});
            noise.push_back(variance(k));
            reference_noise.push_back(variance(reference));
            first.push_back(begin);
        }
    }
    const auto m = static_cast<Eigen::Index>(out.of.size());
    out.H = Eigen::MatrixXd::Zero(m, x_.size());
    out.R = Eigen::MatrixXd::Zero(m, m);
    out.z.resize(m);
    for (Eigen::Index i = 0; i < m; ++i) {
        const auto r = static_cast<std::size_t>(i);
        const RowOf& row = out.of[r];
        const Difference &d = differences_[row.of], &o = differences_[row.reference];
        out.H.row(i).head<3>() = (d.towards - o.towards).transpose();
        out.H(i, 6) = d.mapping - o.mapping;
        const double sign = row.phase ? -1.0 : 1.0;
        if (ionosphere_) {
            out.H(i, delay_[row.of]) += sign * d.factor;
            out.H(i, delay_[row.reference]) -= sign * o.factor;
        }
        double modelled = out.H(i, 6) * x_[6];
        if (ionosphere_) modelled += sign * (d.factor * x_[delay_[row.of]] - o.factor * x_[delay_[row.reference]]);
        if (row.phase) {
            out.H(i, ambiguity_[row.of]) = 1.0;
            out.H(i, ambiguity_[row.reference]) = -1.0;
            modelled += x_[ambiguity_[row.of]] - x_[ambiguity_[row.reference]];
        }
        out.z[i] = (row.phase ? d.phase - o.phase : d.code - o.code) - modelled;
        out.R(i, i) = noise[r] + reference_noise[r];
        for (auto j = static_cast<Eigen::Index>(first[r]); j < i; ++j) out.R(i, j) = out.R(j, i) = reference_noise[r];
    }
    return out;
}

bool BaselineFilter::update(Time tag, EpochSolution& out) {
    code_out_.assign(differences_.size(), false);
    const std::size_t most = 2 + differences_.size() / 4;   // beyond so many it is not single measurements that are wrong
    for (std::size_t trial = 0; trial <= most; ++trial) {
        const Rows r = rows(tag);
        if (r.of.size() < 3) return false;
        const estim::BlockUpdate block(P_, r.H, r.z, r.R);
        if (!block.valid()) return false;
        const auto dof = static_cast<double>(r.of.size());
        if (block.statistic() <= math::chi_square_quantile(1.0 - settings_.false_alarm, dof)) {
            x_ += block.error();
            block.apply(P_);
            for (std::size_t k = 0; k < differences_.size(); ++k)
                if (std::isfinite(differences_[k].code) && !code_out_[k]) code_[{differences_[k].id, differences_[k].slot}] = tag;
            return true;
        }
        // which one measurement would explain it best
        double largest = 0.0;
        std::size_t worst = 0;
        bool is_phase = false;
        for (std::size_t k = 0; k < differences_.size(); ++k) {
            for (const bool phase : {false, true}) {
                Eigen::VectorXd c = Eigen::VectorXd::Zero(r.z.size());
                bool any = false;
                for (std::size_t i = 0; i < r.of.size(); ++i) {
                    if (r.of[i].phase != phase || (r.of[i].of != k && r.of[i].reference != k)) continue;
                    c[static_cast<Eigen::Index>(i)] = r.of[i].of == k ? 1.0 : -1.0;
                    any = true;
                }
                const double size = any ? std::abs(block.standardised(c)) : 0.0;
                if (!(size > largest)) continue;
                largest = size;
                worst = k;
                is_phase = phase;
            }
        }
        ++out.rejected;
        if (is_phase)
            restart(worst);
        else
            code_out_[worst] = true;
    }
    return false;
}

void BaselineFilter::use_velocity(const TrackedEpoch& rover) {
    if (settings_.motion == Motion::Static || !rover.placed || !rover.single.velocity.allFinite()) return;
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(3, x_.size());
    H.block<3, 3>(0, 3).setIdentity();
    const Eigen::VectorXd z = rover.single.velocity - x_.segment<3>(3);
    const estim::BlockUpdate block(P_, H, z, rover.single.velocity_covariance);
    constexpr double gate = 25.9;   // chi-square of three, 1e-5
    if (!block.valid() || block.statistic() > gate) return;
    x_ += block.error();
    block.apply(P_);
}

void BaselineFilter::use_integers(EpochSolution& out) {
    std::vector<WholeState> whole;
    for (std::size_t k = 0; k < differences_.size(); ++k) {
        const Difference& d = differences_[k];
        const Entry& e = entry_of(k);
        const bool halves = d.halves || e.jumped;
        if (d.whole && !e.broken)
            whole.push_back({d.id, group_of(d), ambiguity_[k], (halves ? 0.5 : 1.0) * d.wavelength, halves, d.elevation, d.repeated, e.trusted});
    }
    const IntegerTrial trial = fix_integers(x_, P_, whole, 6, settings_.integers);
    out.ratio = trial.ratio;
    out.success = trial.success;
    if (!trial.fix) return;
    for (Entry& e : entries_) e.trusted = false;
    for (const Eigen::Index state : trial.fix->states) entries_[static_cast<std::size_t>(state - leading)].trusted = true;
    for (const Eigen::Index state : trial.fix->broken) entries_[static_cast<std::size_t>(state - leading)].broken = true;
    out.position.r += trial.fix->correction.head<3>();
    out.covariance = trial.fix->covariance.topLeftCorner<3, 3>();
    out.velocity += trial.fix->correction.segment<3>(3);
    out.velocity_covariance = trial.fix->covariance.block<3, 3>(3, 3);
    out.ambiguities = trial.fix->ambiguities;
    out.fixed = trial.fix->count;
    // some combinations of integers may hold and leave the position as uncertain as it was
    constexpr double fixed_sigma = 0.05;   // m
    if (out.covariance.trace() < fixed_sigma * fixed_sigma) out.quality = Quality::Fixed;
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
    constexpr double lost = 100.0;   // m, one sigma of a coordinate: the single-point solution is better, and the model linear
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
    if (!update(rover.tag, out)) {
        begun_ = false;   // all of it is in doubt
        EpochSolution instead = single(rover);
        instead.rejected = out.rejected;
        return instead;
    }
    use_velocity(rover);
    out.quality = Quality::Float;
    out.position.r = x_.head<3>();
    out.covariance = P_.topLeftCorner<3, 3>();
    out.velocity = x_.segment<3>(3);
    out.velocity_covariance = P_.block<3, 3>(3, 3);
    if (settings_.integers.use) use_integers(out);
    return out;
}

}  // namespace schuler::ppk
