#include "schuler/ppk/arcs.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/math/quantile.h"
#include "schuler/ppk/air_delay.h"
#include "schuler/ppk/phase_steps.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace schuler::ppk {
namespace {

/// The last observation of a phase.
struct Before {
    Time time;
    int arc = 0;          ///< 0: never seen
    double phase = 0;     ///< m
    double modelled = 0;  ///< m: range minus satellite clock, with the atmosphere
    double doppler = not_given;
    bool half_cycle = false, jumped = false;
};

/// A phase continued from the previous epoch.
struct Continued {
    TrackedSatellite* satellite;
    std::size_t slot;
    PhaseStep step;
    bool use = true;
};

class Numbering {
public:
    Numbering(bool at_rest, const ArcSettings& settings, const AirModel& air, double interval)
        : at_rest_(at_rest),
          settings_(settings),
          air_(air),
          gap_(std::max(settings.longest_gap, 1.5 * interval)),
          before_(gnss::satellite_count),
          modelled_now_(gnss::satellite_count) {}

    void epoch(TrackedEpoch& e) {
        const Geodetic geodetic = earth::geodetic_from_ecef(earth::wgs84, e.position);
        continued_.clear();
        const double dt = (e.tag - time_).seconds();
        for (TrackedSatellite& s : e.satellites) {
            const Line line = line_to(s, e.position, geodetic);
            const AirDelay delay = air_delay(air_, s, geodetic, line.direction);
            for (std::size_t k = 0; k < most_signals; ++k) {
                const TrackedSignal& t = s.signals[k];
                if (!std::isfinite(t.phase)) continue;
                const double modelled =
                    line.range - s.clock + delay.troposphere - ionosphere_factor(t.wavelength) * delay.ionosphere;
                continue_or_begin(e, s, k, modelled, line.towards);
            }
            compare_carriers(e, s);
        }
        std::erase_if(continued_, [](const Continued& c) { return !c.use; });
        compare_steps(dt);
        for (TrackedSatellite& s : e.satellites) remember(e, s);
        time_ = e.tag;
    }

    ArcCounts counts;

private:
    Before& before(const TrackedSatellite& s, std::size_t k) { return before_[gnss::index_of(s.id)][k]; }
    [[nodiscard]] double sigma(const TrackedSatellite& s, std::size_t k) const {
        return settings_.phase_sigma * gnss::noise_factor(s.direction.elevation, s.signals[k].cn0);
    }
    /// Possible drift of a phase relative to the model in this time: satellite clock and what is left of the atmosphere.
    [[nodiscard]] static double drift(double seconds) { return 0.02 + 0.002 * std::abs(seconds); }

    void begin(TrackedSatellite& s, std::size_t k, bool jumped) {
        s.signals[k].arc = ++last_arc_;
        s.signals[k].jumped = jumped;
        for (Continued& c : continued_)
            if (c.satellite == &s && c.slot == k) c.use = false;
    }

    void continue_or_begin(const TrackedEpoch& e, TrackedSatellite& s, std::size_t k, double modelled,
                           const Eigen::Vector3d& towards) {
        TrackedSignal& now = s.signals[k];
        Before& b = before(s, k);
        const double dt = (e.tag - b.time).seconds();
        const bool gap = b.arc != 0 && dt > gap_, told = b.arc != 0 && (now.lost || now.half_cycle != b.half_cycle);
        now.arc = b.arc;
        now.jumped = b.jumped;
        if (b.arc == 0 || gap || told) {
            begin(s, k, false);
            counts.gaps += gap ? 1 : 0;
            counts.told += told && !gap ? 1 : 0;
        } else {
            const double by_doppler = now.phase - b.phase - 0.5 * (now.doppler + b.doppler) * dt;
            const double grown = now.phase - b.phase - (modelled - b.modelled), noise = sigma(s, k);
            if (b.time == time_)
                continued_.push_back({&s, k, {gnss::index_of(s.id), grown, towards, noise, drift(dt) + 6.0 * noise, by_doppler}});
        }
        modelled_now_[gnss::index_of(s.id)][k] = modelled;
    }

    /// The geometry-free combinations with the first carrier.
    void compare_carriers(const TrackedEpoch& e, TrackedSatellite& s) {
        for (std::size_t k = 1; k < most_signals; ++k) {
            const Before &first = before(s, 0), &other = before(s, k);
            const bool both = std::isfinite(s.signals[0].phase) && std::isfinite(s.signals[k].phase) && first.arc != 0 &&
                              other.arc != 0 && s.signals[0].arc == first.arc && s.signals[k].arc == other.arc &&
                              first.time == other.time;
            if (!both) continue;
            const double jump = (s.signals[0].phase - s.signals[k].phase) - (first.phase - other.phase);
            // a step of the receiver's clock affects all carriers alike
            if (std::abs(jump) <= drift((e.tag - first.time).seconds()) + 6.0 * sigma(s, 0)) continue;
            begin(s, 0, true);
            begin(s, k, true);
            ++counts.geometry_free;
        }
    }

    void compare_steps(double dt) {
        if (continued_.empty()) return;
        if (at_rest_) {
            DisplacementAndClock x = DisplacementAndClock::Zero();
            x[3] = median_of([](const PhaseStep& s) { return s.grown; });
            for (const Continued& c : continued_)
                if (!(std::abs(residual(c.step, x)) <= c.step.tolerance)) slipped(c);
            return;
        }
        std::vector<PhaseStep> steps;
        std::size_t satellites = 0;
        for (const Continued& c : continued_) {
            satellites += steps.empty() || steps.back().satellite != c.step.satellite ? 1 : 0;
            steps.push_back(c.step);
        }
        constexpr std::size_t enough = 6;
        const auto unbroken = satellites >= enough ? continuity_.kept(steps, dt) : std::nullopt;
        if (!unbroken) return compare_with_doppler(dt);
        for (std::size_t i = 0; i < steps.size(); ++i)
            if ((*unbroken)[i] == 0) slipped(continued_[i]);
    }

    void slipped(const Continued& c) {
        begin(*c.satellite, c.slot, true);
        ++counts.unexplained;
    }

    void compare_with_doppler(double dt) {
        constexpr double longest = 1.5;  // s, over which a mean of two Dopplers approximates a vehicle's displacement
        std::erase_if(continued_, [](const Continued& c) { return !std::isfinite(c.step.by_doppler); });
        if (continued_.size() < 2 || std::abs(dt) > longest) return;
        const double clock = median_of([](const PhaseStep& s) { return s.by_doppler; });
        for (const Continued& c : continued_) {
            const double doppler = settings_.doppler_sigma * c.step.sigma / settings_.phase_sigma * std::abs(dt);
            if (std::abs(c.step.by_doppler - clock) > 0.7 * c.satellite->signals[c.slot].wavelength + 5.0 * doppler) slipped(c);
        }
    }

    template <class Of>
    double median_of(Of of) const {
        std::vector<double> values;
        for (const Continued& c : continued_) values.push_back(of(c.step));
        return math::median(std::move(values));
    }

    void remember(const TrackedEpoch& e, const TrackedSatellite& s) {
        for (std::size_t k = 0; k < most_signals; ++k) {
            const TrackedSignal& now = s.signals[k];
            if (now.arc == 0) continue;
            before(s, k) = {e.tag,       now.arc,        now.phase, modelled_now_[gnss::index_of(s.id)][k],
                            now.doppler, now.half_cycle, now.jumped};
        }
    }

    bool at_rest_;
    ArcSettings settings_;
    AirModel air_;
    double gap_;
    std::vector<std::array<Before, most_signals>> before_;
    std::vector<std::array<double, most_signals>> modelled_now_;
    std::vector<Continued> continued_;
    PhaseContinuity continuity_;
    Time time_;
    int last_arc_ = 0;
};

/// Median of the first intervals.
double usual_interval(const std::vector<TrackedEpoch>& epochs) {
    std::vector<double> intervals;
    for (std::size_t i = 1; i < std::min<std::size_t>(epochs.size(), 200); ++i)
        intervals.push_back((epochs[i].tag - epochs[i - 1].tag).seconds());
    return intervals.empty() ? 1.0 : math::median(std::move(intervals));
}

}  // namespace

ArcCounts number_arcs(std::vector<TrackedEpoch>& epochs, bool at_rest, const ArcSettings& settings, const AirModel& air) {
    Numbering numbering(at_rest, settings, air, usual_interval(epochs));
    for (TrackedEpoch& e : epochs) numbering.epoch(e);
    return numbering.counts;
}

}  // namespace schuler::ppk
