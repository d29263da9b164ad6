#include "schuler/gnss/single_point.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/detail/least_squares.h"
#include "schuler/math/chi_square.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <utility>

namespace schuler::gnss {
namespace {

constexpr double smallest_radius = 6.2e6;  ///< m: below, an atmosphere model is not applicable
constexpr double gross_error = 300.0;      ///< m, larger than the model error of any valid pseudorange
constexpr int most_iterations = 12;

using detail::Estimate;
using detail::NormalEquations;

/// One epoch to be solved. Columns of the normal equations: position 0 to 2, then a clock for each system present.
class Epoch {
public:
    Epoch(std::span<const Range> ranges, const BroadcastIonosphere* ionosphere, const SinglePointSettings& settings)
        : ranges_(ranges), ionosphere_(ionosphere), settings_(&settings), usable_(ranges.size(), true), models_(ranges.size()) {}

    /// Position without atmosphere starting at the Earth's centre; weights 1/|residual| approach the solution of least absolute
    /// residuals. Marks gross errors.
    bool start() {
        std::vector<double> weights(ranges_.size(), 1.0);
        bool converged = false;
        for (int i = 0; i < 30 && !converged; ++i) {
            const auto step = step_from(weights, false);
            if (!step) return false;
            if (i > 6) converged = step->head<3>().norm() < 1.0;
            constexpr double least = 10.0;
            for (std::size_t k = 0; k < ranges_.size(); ++k) {
                if (i > 4) weights[k] = 1.0 / std::max(std::abs(residual(k)), least);
            }
        }
        if (position_.norm() < smallest_radius || position_.norm() > 5e7) return false;
        for (std::size_t k = 0; k < ranges_.size(); ++k) {
            if (std::abs(residual(k)) > gross_error) usable_[k] = false;
        }
        return true;
    }

    /// Full model, mask and weights. False if it does not converge or there are too few.
    bool refine() {
        for (int i = 0; i < most_iterations; ++i) {
            mask();
            if (used() < unknowns()) return false;
            const auto step = step_from({}, true);
            if (!step) return false;
            if (step->head<3>().norm() < 1e-4) return finish();
        }
        return false;
    }

    [[nodiscard]] int used() const {
        return static_cast<int>(std::ranges::count_if(indices(), [&](std::size_t k) { return in_use(k); }));
    }
    [[nodiscard]] int unknowns() const {
        std::array<bool, clock_count> present{};
        for (std::size_t k = 0; k < ranges_.size(); ++k) {
            if (in_use(k)) present[clock_of(ranges_[k].satellite.system)] = true;
        }
        return 3 + static_cast<int>(std::ranges::count(present, true));
    }
    [[nodiscard]] bool in_use(std::size_t k) const { return usable_[k] && (masked_.empty() || !masked_[k]); }
    [[nodiscard]] bool excluded(std::size_t k) const { return !usable_[k]; }
    void exclude(std::size_t k) { usable_[k] = false; }
    [[nodiscard]] double statistic() const { return statistic_; }
    [[nodiscard]] const Eigen::Vector3d& position() const { return position_; }
    [[nodiscard]] const std::array<double, clock_count>& clock() const { return clock_; }
    [[nodiscard]] const Eigen::Matrix3d& covariance() const { return covariance_; }
    /// Gain of the weighted least squares at the last step for a range [Groves2013:9.4.1].
    [[nodiscard]] Eigen::Vector3d gain(std::size_t k) const {
        if (!in_use(k)) return Eigen::Vector3d::Zero();
        return inverse_ * NormalEquations::row_of(models_[k].line_of_sight, clock_of(ranges_[k].satellite.system)) /
               models_[k].variance;
    }
    [[nodiscard]] double pdop() const { return pdop_; }
    /// Covariance of the position error from errors of the atmosphere models common to all directions, in proportion to the
    /// modelled delays: the white part of a range's variance averages out over the satellites, this does not.
    [[nodiscard]] Eigen::Matrix3d air_covariance() const {
        RangeSettings ionosphere = settings_->ranges, troposphere = settings_->ranges;
        ionosphere.troposphere = TroposphereModel::None;
        troposphere.ionosphere = IonosphereModel::None;
        const Geodetic here = earth::geodetic_from_ecef(earth::wgs84, {position_});
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        for (const RangeSettings& part : {ionosphere, troposphere}) {
            Eigen::Vector3d moved = Eigen::Vector3d::Zero();
            for (std::size_t k = 0; k < ranges_.size(); ++k) {
                const Range& r = ranges_[k];
                if (!in_use(k) || r.slow > 0.0) continue;  // the models' residual is included in a given slow error
                const AtmosphericDelay air =
                    atmospheric_delay(r.transmit, r.satellite.system, r.frequency, here, models_[k].direction, ionosphere_, part);
                moved += std::sqrt(air.variance) * gain(k);
            }
            sum += moved * moved.transpose();
        }
        return sum;
    }
    /// Covariance of the position error from satellites with faults like those excluded, but below the detection threshold.
    [[nodiscard]] Eigen::Matrix3d unseen_covariance(std::size_t left_out) const {
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        const double in = used(), redundancy = in - unknowns();
        if (left_out == 0 || redundancy < 1.0) return sum;
        const double share = static_cast<double>(left_out) / (static_cast<double>(left_out) + in);
        const double seen =
            math::chi_square_quantile(1.0 - settings_->false_alarm, 1.0) * in / redundancy;  // squared, in sigmas of a range
        for (std::size_t k = 0; k < ranges_.size(); ++k)
            if (in_use(k)) sum += share * seen * models_[k].variance * gain(k) * gain(k).transpose();
        return sum;
    }
    [[nodiscard]] const ModelledRange& model(std::size_t k) const { return models_[k]; }
    [[nodiscard]] double residual(std::size_t k) const {
        return ranges_[k].pseudorange - models_[k].range - clock_[clock_of(ranges_[k].satellite.system)];
    }

private:
    [[nodiscard]] std::vector<std::size_t> indices() const {
        std::vector<std::size_t> all(ranges_.size());
        for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
        return all;
    }

    void evaluate(bool full) {
        RangeSettings settings = settings_->ranges;
        if (!full) {
            settings.ionosphere = IonosphereModel::None;
            settings.troposphere = TroposphereModel::None;
        }
        const Geodetic geodetic =
            position_.norm() > smallest_radius ? earth::geodetic_from_ecef(earth::wgs84, {position_}) : Geodetic{};
        for (std::size_t k = 0; k < ranges_.size(); ++k)
            models_[k] = model_range(ranges_[k], {position_}, geodetic, ionosphere_, settings);
    }

    void mask() {
        evaluate(true);
        masked_.assign(ranges_.size(), false);
        for (std::size_t k = 0; k < ranges_.size(); ++k)
            masked_[k] = models_[k].direction.elevation < settings_->ranges.elevation_mask;
    }

    /// One Gauss-Newton step; empty weights: those of the model.
    std::optional<Estimate> step_from(std::span<const double> weights, bool full) {
        evaluate(full);
        NormalEquations normal;
        for (std::size_t k = 0; k < ranges_.size(); ++k) {
            if (!in_use(k)) continue;
            const double w = weights.empty() ? 1.0 / models_[k].variance : weights[k];
            normal.add(models_[k].line_of_sight, clock_of(ranges_[k].satellite.system), residual(k), w);
        }
        const auto step = normal.solve();
        if (!step) return std::nullopt;
        position_ += step->head<3>();
        for (std::size_t c = 0; c < clock_count; ++c) clock_[c] += (*step)[static_cast<Eigen::Index>(3 + c)];
        evaluate(full);
        return step;
    }

    bool finish() {
        NormalEquations weighted, plain;
        statistic_ = 0.0;
        for (std::size_t k = 0; k < ranges_.size(); ++k) {
            if (!in_use(k)) continue;
            const std::size_t c = clock_of(ranges_[k].satellite.system);
            weighted.add(models_[k].line_of_sight, c, residual(k), 1.0 / models_[k].variance);
            plain.add(models_[k].line_of_sight, c, 0.0, 1.0);
            statistic_ += residual(k) * residual(k) / models_[k].variance;
        }
        const auto inverse = weighted.inverse_rows();
        const auto dop = plain.covariance();
        if (!inverse || !dop) return false;
        inverse_ = *inverse;
        covariance_ = inverse_.leftCols<3>();
        pdop_ = std::sqrt(dop->trace());
        return true;
    }

    std::span<const Range> ranges_;
    const BroadcastIonosphere* ionosphere_;
    const SinglePointSettings* settings_;
    std::vector<bool> usable_, masked_;
    std::vector<ModelledRange> models_;
    Eigen::Vector3d position_ = Eigen::Vector3d::Zero();
    std::array<double, clock_count> clock_{};
    Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
    NormalEquations::Rows inverse_ = NormalEquations::Rows::Zero();
    double statistic_ = 0.0, pdop_ = 0.0;
};

/// True if enough satellites agree to call the others faulty: a few agree by chance if enough may be excluded.
bool is_outvoted(const Epoch& e, std::size_t count) {
    constexpr int beyond_chance = 4;
    int out = 0;
    for (std::size_t k = 0; k < count; ++k) out += e.excluded(k) ? 1 : 0;
    return e.used() - e.unknowns() >= std::min(out, beyond_chance);
}

bool is_consistent(const Epoch& e, double false_alarm) {
    const int redundancy = e.used() - e.unknowns();
    return redundancy <= 0 || e.statistic() <= math::chi_square_quantile(1.0 - false_alarm, redundancy);
}

/// Excludes satellites until the residuals are consistent. False if that is not possible. `undecided`: if another exclusion would
/// also have made the rest consistent, the scatter of those positions about the chosen one.
bool excluded_until_consistent(Epoch& epoch, std::size_t count, double false_alarm, Eigen::Matrix3d& undecided) {
    while (!is_consistent(epoch, false_alarm)) {
        // with one satellite more than unknowns a fault can be detected but not identified
        if (epoch.used() - epoch.unknowns() < 2) return false;
        std::optional<Epoch> best;
        std::vector<Eigen::Vector3d> others;  // consistent positions
        for (std::size_t k = 0; k < count; ++k) {
            if (!epoch.in_use(k)) continue;
            Epoch trial = epoch;
            trial.exclude(k);
            if (!trial.refine()) continue;
            if (is_consistent(trial, false_alarm)) others.push_back(trial.position());
            if (!best || trial.statistic() < best->statistic()) best.emplace(trial);
        }
        if (!best) return false;
        epoch = *best;
        undecided.setZero();
        for (const Eigen::Vector3d& other : others) {
            const Eigen::Vector3d apart = other - epoch.position();
            undecided += apart * apart.transpose();
        }
    }
    std::size_t left_out = 0;
    for (std::size_t k = 0; k < count; ++k) left_out += epoch.excluded(k) ? 1U : 0U;
    undecided += epoch.unseen_covariance(left_out);
    return is_outvoted(epoch, count);
}

/// Velocity and clock drift from Doppler. Dopplers that deviate by more than five sigma are excluded, one after the other.
void solve_velocity(std::span<const Range> ranges, const Epoch& epoch, const SinglePointSettings& settings,
                    SinglePointSolution& out) {
    std::vector<bool> use(ranges.size());
    for (std::size_t k = 0; k < ranges.size(); ++k) use[k] = epoch.in_use(k) && std::isfinite(ranges[k].range_rate);
    const Ecef position{epoch.position()};
    const auto sigma = [&](std::size_t k) {
        return range_rate_sigma(ranges[k], epoch.model(k).direction.elevation, settings.ranges);
    };
    for (;;) {
        Eigen::Vector3d v = Eigen::Vector3d::Zero();
        double drift = 0.0;
        const auto residual = [&](std::size_t k) {
            return ranges[k].range_rate - model_range_rate(ranges[k], position, v) - drift;
        };
        std::optional<Eigen::Matrix3d> covariance;
        for (int i = 0; i < 3; ++i) {
            NormalEquations normal;
            for (std::size_t k = 0; k < ranges.size(); ++k) {
                if (use[k]) normal.add(epoch.model(k).line_of_sight, 0, residual(k), 1.0 / (sigma(k) * sigma(k)));
            }
            const auto step = normal.solve();
            covariance = normal.covariance();
            if (!step || !covariance) return;
            v += step->head<3>();
            drift += (*step)[3];
        }
        std::size_t worst = ranges.size();
        double largest = 5.0;
        for (std::size_t k = 0; k < ranges.size(); ++k) {
            if (!use[k] || std::abs(residual(k)) / sigma(k) <= largest) continue;
            largest = std::abs(residual(k)) / sigma(k);
            worst = k;
        }
        if (!settings.raim || worst == ranges.size() || std::ranges::count(use, true) <= 5) {
            out.velocity = v;
            out.velocity_covariance = *covariance;
            out.drift = drift;
            return;
        }
        use[worst] = false;
    }
}

}  // namespace

std::string_view name_of(SinglePointStatus status) {
    switch (status) {
        case SinglePointStatus::Solved: return "solved";
        case SinglePointStatus::TooFew: return "too few satellites";
        case SinglePointStatus::WeakGeometry: return "weak geometry";
        default: return "inconsistent ranges";
    }
}

int SinglePointSolution::used() const { return static_cast<int>(std::ranges::count(satellites, true, &SatelliteUse::used)); }
int SinglePointSolution::excluded() const {
    return static_cast<int>(std::ranges::count(satellites, true, &SatelliteUse::excluded));
}

double SinglePointSolution::intersystem_bias(std::size_t c) const {
    const auto reference = std::ranges::find_if(clock, [](double x) { return std::isfinite(x); });
    return reference == clock.end() ? not_given : clock[c] - *reference;
}

SinglePoint::SinglePoint(const SatelliteSource& source, std::optional<BroadcastIonosphere> ionosphere,
                         const SinglePointSettings& settings)
    : source_(source), ionosphere_(std::move(ionosphere)), settings_(settings) {}

SinglePointSolution SinglePoint::solve(std::span<const SignalObservation> observations, Time tag,
                                       const GlonassChannels& channels) {
    prepare_ranges(observations, tag, source_, channels, settings_.ranges, ranges_);
    return solve_prepared(tag);
}

SinglePointSolution SinglePoint::solve(std::vector<Range> ranges, Time tag) {
    ranges_ = std::move(ranges);
    return solve_prepared(tag);
}

SinglePointSolution SinglePoint::solve_prepared(Time tag) {
    SinglePointSolution out;
    out.time = tag;
    Epoch epoch(ranges_, ionosphere_ ? &*ionosphere_ : nullptr, settings_);
    if (epoch.used() < epoch.unknowns() || !epoch.start()) return out;
    if (!epoch.refine()) {
        out.status = epoch.used() < epoch.unknowns() ? SinglePointStatus::TooFew : SinglePointStatus::WeakGeometry;
        return out;
    }
    Eigen::Matrix3d undecided = Eigen::Matrix3d::Zero();
    const bool consistent = !settings_.raim || excluded_until_consistent(epoch, ranges_.size(), settings_.false_alarm, undecided);
    out.position.r = epoch.position();
    const Eigen::Matrix3d air = epoch.air_covariance();
    out.covariance = epoch.covariance() + air + undecided;
    out.slow_covariance = air + undecided;
    out.statistic = epoch.statistic();
    out.redundancy = epoch.used() - epoch.unknowns();
    out.pdop = epoch.pdop();
    for (std::size_t k = 0; k < ranges_.size(); ++k) {
        const bool used = epoch.in_use(k);
        const Eigen::Vector3d gain = epoch.gain(k);
        const double slow = epoch.model(k).slow_variance;
        out.satellites.push_back({ranges_[k].satellite, ranges_[k].signal, epoch.model(k).direction, epoch.residual(k), used,
                                  epoch.excluded(k), gain, slow});
        out.slow_covariance += slow * gain * gain.transpose();
        if (used) {
            const std::size_t c = clock_of(ranges_[k].satellite.system);
            out.clock[c] = epoch.clock()[c];
        }
    }
    const auto reference = std::ranges::find_if(out.clock, [](double x) { return std::isfinite(x); });
    out.time = tag - Duration::from_seconds(*reference / speed_of_light);
    out.status = !consistent                         ? SinglePointStatus::Inconsistent
                 : out.pdop > settings_.largest_pdop ? SinglePointStatus::WeakGeometry
                                                     : SinglePointStatus::Solved;
    if (out.status == SinglePointStatus::Solved) solve_velocity(ranges_, epoch, settings_, out);
    return out;
}

std::optional<KlobucharCoefficients> klobuchar_of(const Navigation& navigation) {
    for (const System system : {System::Gps, System::Qzss, System::Navic}) {
        const auto& found = navigation.klobuchar[static_cast<std::size_t>(system)];
        if (found) return found;
    }
    return std::nullopt;
}

}  // namespace schuler::gnss
