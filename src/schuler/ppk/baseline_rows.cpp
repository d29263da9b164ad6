// Part of the baseline filter: its measurement rows, and measurements that do not fit.
#include "schuler/math/chi_square.h"
#include "schuler/math/quantile.h"
#include "schuler/ppk/baseline_filter.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <utility>

namespace schuler::ppk {

double lasting(double apart, double correlation) {
    if (!(correlation > 0.0)) return 1.0;
    const double rho = std::exp(-std::abs(apart) / correlation);
    return (1.0 + rho) / std::max(1.0 - rho, 1e-3);
}

double BaselineFilter::lasting_code(const Difference& d, Time tag) const {
    const auto last = code_.find({d.id, d.slot});
    return last == code_.end() ? 1.0 : lasting((tag - last->second).seconds(), settings_.code_correlation);
}

double BaselineFilter::lasting_phase(std::size_t difference, Time tag) const {
    const auto& last = entry_of(difference).phase;
    return last ? lasting((tag - *last).seconds(), settings_.phase_correlation) : 1.0;
}

BaselineFilter::Rows BaselineFilter::rows(Time tag, Weighting weighting, const Eigen::VectorXd& x) const {
    // the members of each group with a code, with a phase; their reference is the highest satellite
    std::map<std::pair<int, bool>, std::vector<std::size_t>> groups;
    for (std::size_t k = 0; k < differences_.size(); ++k) {
        const int group = group_of(differences_[k]);
        groups[{group, true}].push_back(k);
        if (weighting != Weighting::Phases && std::isfinite(differences_[k].code) && !code_out_[k])
            groups[{group, false}].push_back(k);
    }
    Rows out;
    std::vector<double> noise, reference_noise;
    std::vector<std::size_t> first;  // first row of the group of a row
    for (const auto& [key, members] : groups) {
        const bool phase = key.second;
        const auto variance = [&](std::size_t k) {
            const Difference& d = differences_[k];
            const bool lasts = weighting == Weighting::Filter;
            if (phase) return phase_scale_.value() * d.phase_variance * (lasts ? lasting_phase(k, tag) : 1.0);
            return code_scale_.value() * d.code_variance * (lasts ? lasting_code(d, tag) : 1.0);
        };
        const std::size_t reference =
            *std::ranges::max_element(members, {}, [&](std::size_t k) { return differences_[k].elevation; });
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
    out.H = Eigen::MatrixXd::Zero(m, x.size());
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
        double modelled = out.H(i, 6) * x[6] + sign * (d.vertical_factor() - o.vertical_factor()) * vertical_.value;
        if (ionosphere_) modelled += sign * (d.factor * x[delay_[row.of]] - o.factor * x[delay_[row.reference]]);
        if (row.phase) {
            out.H(i, ambiguity_[row.of]) = 1.0;
            out.H(i, ambiguity_[row.reference]) = -1.0;
            modelled += x[ambiguity_[row.of]] - x[ambiguity_[row.reference]];
        }
        out.z[i] = (row.phase ? d.phase - o.phase : d.code - o.code) - modelled;
        out.R(i, i) = noise[r] + reference_noise[r];
        for (auto j = static_cast<Eigen::Index>(first[r]); j < i; ++j) out.R(i, j) = out.R(j, i) = reference_noise[r];
    }
    return out;
}

/// Residuals of each signal for the epoch's position and the states.
void BaselineFilter::look_at_signals(const Eigen::VectorXd& x, bool integers, EpochSolution& out) const {
    out.signals.clear();
    std::map<int, std::vector<double>> codes, phases;
    const Eigen::Vector3d moved = out.position.r - linearised_.r;
    for (std::size_t k = 0; k < differences_.size(); ++k) {
        const Difference& d = differences_[k];
        const Entry& e = entries_[static_cast<std::size_t>(ambiguity_[k] - leading)];
        const double common = d.towards.dot(moved) + d.mapping * x[6],
                     ionosphere = ionosphere_ ? d.factor * x[delay_[k]] : d.vertical_factor() * vertical_.value;
        SignalView v{d.id,
                     d.band,
                     d.elevation,
                     d.code - common - ionosphere,
                     d.phase - common + ionosphere - x[ambiguity_[k]],
                     std::sqrt(code_scale_.value() * d.code_variance),
                     std::sqrt(phase_scale_.value() * d.phase_variance),
                     std::isfinite(d.code) && !code_out_[k],
                     integers && e.trusted,
                     d.rover_arc,
                     d.base_arc};
        if (v.code_used) codes[group_of(d)].push_back(v.code);
        phases[group_of(d)].push_back(v.phase);
        out.signals.push_back(v);
    }
    for (std::size_t k = 0; k < differences_.size(); ++k) {
        const int group = group_of(differences_[k]);
        out.signals[k].phase -= math::median(phases[group]);
        out.signals[k].code -= codes[group].empty() ? 0.0 : math::median(codes[group]);
    }
}

BaselineFilter::Suspect BaselineFilter::worst(const estim::BlockUpdate& block, const Rows& rows) const {
    Suspect out;
    for (std::size_t k = 0; k < differences_.size(); ++k) {
        for (const bool phase : {false, true}) {
            Eigen::VectorXd c = Eigen::VectorXd::Zero(rows.z.size());  // effect of an error of this one on the double differences
            bool any = false;
            for (std::size_t i = 0; i < rows.of.size(); ++i) {
                if (rows.of[i].phase != phase || (rows.of[i].of != k && rows.of[i].reference != k)) continue;
                c[static_cast<Eigen::Index>(i)] = rows.of[i].of == k ? 1.0 : -1.0;
                any = true;
            }
            const double size = any ? std::abs(block.standardised(c)) : 0.0;
            if (size > out.size) out = {k, phase, size};
        }
    }
    return out;
}

/// A code that departs within its arc has low weight, as correlated codes do, and would be detected late: codes are therefore
/// tested with the error of a single one.
bool BaselineFilter::reject_misfits(Time tag, EpochSolution& out) {
    constexpr double single = 4.7;                         // sigmas, of any of fifty at 1e-4
    const std::size_t most = 2 + differences_.size() / 3;  // beyond this number the fault is not in single measurements
    for (std::size_t trial = 0; trial <= most; ++trial) {
        const Rows r = rows(tag, Weighting::Single, x_);
        if (r.of.size() < 3) return false;
        const estim::BlockUpdate block(P_, r.H, r.z, r.R);
        if (!block.valid()) return false;
        const Suspect suspect = worst(block, r);
        const bool fits =
            block.statistic() <= math::chi_square_quantile(1.0 - settings_.false_alarm, static_cast<double>(r.of.size()));
        if (fits && suspect.size < single) return true;
        ++out.rejected;
        if (suspect.phase) restart(suspect.difference);
        else code_out_[suspect.difference] = true;
    }
    return false;
}

void BaselineFilter::Scale::add(double squares, double dof, double dt) {
    constexpr double enough = 3.0, memory = 120.0;  // degrees of freedom, s
    if (dof < enough || !std::isfinite(squares)) return;
    weight_ = weight_ * std::exp(-std::abs(dt) / memory) + dof;
    mean_ += (squares / dof - mean_) * dof / weight_;
    // reduced only as far as this few, correlated squares can prove
    const double proven = mean_ * (1.0 + 2.0 * std::sqrt(2.0 / dof));
    value_ = std::max({mean_, least_, std::min(proven, 1.0)});
}

/// Increase of the variance of codes over the assumed value, from their mutual disagreement within an epoch after solving for a
/// position, over some minutes.
void BaselineFilter::judge_codes(double dt) {
    std::map<int, std::vector<std::size_t>> groups;
    for (std::size_t k = 0; k < differences_.size(); ++k)
        if (std::isfinite(differences_[k].code) && !code_out_[k]) groups[group_of(differences_[k])].push_back(k);
    // weighted least squares with a clock for each group, whose part of the normal equations is eliminated
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double squares = 0.0, dof = -3.0;
    for (const auto& [group, members] : groups) {
        double weights = 0.0, code = 0.0;
        Eigen::Vector3d towards = Eigen::Vector3d::Zero();
        for (const std::size_t k : members) {
            const Difference& d = differences_[k];
            const double w = 1.0 / d.code_variance,
                         z = d.code - d.mapping * x_[6] - (ionosphere_ ? d.factor * x_[delay_[k]] : 0.0);
            weights += w;
            code += w * z;
            towards += w * d.towards;
            information += w * d.towards * d.towards.transpose();
            right += w * z * d.towards;
            squares += w * z * z;
        }
        information -= towards * towards.transpose() / weights;
        right -= towards * code / weights;
        squares -= code * code / weights;
        dof += static_cast<double>(members.size()) - 1.0;
    }
    code_scale_.add(squares - right.dot(information.ldlt().solve(right)), dof, dt);
}

}  // namespace schuler::ppk
