#include "schuler/gnss/phase_velocity.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/detail/least_squares.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace schuler::gnss {

std::vector<PhaseDifferences::Phase> PhaseDifferences::phases(std::span<const SignalObservation> observations, Time tag,
                                                              const GlonassChannels& channels,
                                                              const SinglePointSolution& solution) const {
    RangeSettings single = ranges_;
    if (single.ionosphere == IonosphereModel::Dual) single.ionosphere = IonosphereModel::None;
    std::vector<Range> ranges;
    prepare_ranges(observations, tag, source_, channels, single, ranges);
    std::vector<Phase> out;
    for (const Range& r : ranges) {
        const auto use = std::ranges::find(solution.satellites, r.satellite, &SatelliteUse::satellite);
        const auto o = std::ranges::find_if(
            observations, [&](const SignalObservation& x) { return x.satellite == r.satellite && x.signal == r.signal; });
        if (use == solution.satellites.end() || !use->used || o == observations.end() || !std::isfinite(o->phase)) continue;
        // r.pseudorange includes code, group delay and satellite clock: the clock part is its difference from the code
        const auto t = source_.at(r.satellite, r.signal, r.transmit);
        if (!t) continue;
        const double metres = o->phase * speed_of_light / r.frequency + speed_of_light * t->state.clock;
        out.push_back({r.satellite, r.signal, metres, (o->loss_of_lock & 1U) != 0, use->direction.elevation, r});
    }
    return out;
}

std::optional<PhaseVelocity> PhaseDifferences::update(std::span<const SignalObservation> observations, Time tag,
                                                      const GlonassChannels& channels, const SinglePointSolution& solution) {
    if (solution.status != SinglePointStatus::Solved) {
        before_.clear();
        return std::nullopt;
    }
    const std::vector<Phase> now = phases(observations, tag, channels, solution);
    const std::vector<Phase> before = std::exchange(before_, now);
    const Time time_before = std::exchange(time_before_, tag);
    const double interval = (tag - time_before).seconds();
    if (before.empty() || interval <= 0.0 || interval > settings_.longest_interval) return std::nullopt;

    /// A satellite seen in both epochs: growth of its range beyond its own motion.
    struct Difference {
        Eigen::Vector3d line_of_sight;
        double grown, sigma;
        bool use;
    };
    const Geodetic geodetic = earth::geodetic_from_ecef(earth::wgs84, solution.position);
    RangeSettings without = ranges_;
    without.ionosphere = IonosphereModel::None;
    std::vector<Difference> differences;
    PhaseVelocity out{};
    for (const Phase& p : now) {
        const auto old =
            std::ranges::find_if(before, [&](const Phase& x) { return x.satellite == p.satellite && x.signal == p.signal; });
        if (old == before.end()) continue;
        if (p.lost) {
            ++out.slips;
            continue;
        }
        const ModelledRange here = model_range(p.range, solution.position, geodetic, nullptr, without);
        const ModelledRange then = model_range(old->range, solution.position, geodetic, nullptr, without);
        const double sigma = settings_.phase_sigma / std::sqrt(std::max(std::sin(p.elevation), 0.1));
        differences.push_back({then.line_of_sight, p.metres - old->metres - (here.range - then.range), sigma, true});
    }
    const auto residual = [](const Difference& d, const detail::Estimate& x) {
        return std::abs(d.grown - d.line_of_sight.dot(x.head<3>()) - x[3]);
    };
    // least absolute residuals first, so that several simultaneous slips do not mask each other
    detail::Estimate robust = detail::Estimate::Zero();
    for (int i = 0; i < 15; ++i) {
        detail::NormalEquations normal;
        for (const Difference& d : differences)
            normal.add(d.line_of_sight, 0, d.grown,
                       1.0 / (d.sigma * (i == 0 ? d.sigma : std::max(d.sigma, residual(d, robust)))));
        const auto x = normal.solve();
        if (!x) return std::nullopt;
        robust = *x;
    }
    for (Difference& d : differences) {
        d.use = residual(d, robust) <= settings_.slip * d.sigma;
        out.slips += d.use ? 0 : 1;
    }
    for (;;) {
        detail::NormalEquations normal;
        for (const Difference& d : differences) {
            if (d.use) normal.add(d.line_of_sight, 0, d.grown, 1.0 / (d.sigma * d.sigma));
        }
        const auto count = std::ranges::count(differences, true, &Difference::use);
        const auto x = normal.solve();
        const auto covariance = normal.covariance();
        if (count < 4 || !x || !covariance) return std::nullopt;
        Difference* worst = nullptr;
        double largest = settings_.slip;
        for (Difference& d : differences) {
            const double sigmas = residual(d, *x) / d.sigma;
            if (!d.use || sigmas <= largest) continue;
            largest = sigmas;
            worst = &d;
        }
        if (worst == nullptr) {
            out.velocity = x->head<3>() / interval;
            out.covariance = *covariance / (interval * interval);
            out.interval = interval;
            out.used = static_cast<int>(count);
            return out;
        }
        // without redundancy a slipped phase cannot be identified
        if (count < 6) return std::nullopt;
        worst->use = false;
        ++out.slips;
    }
}

}  // namespace schuler::gnss
