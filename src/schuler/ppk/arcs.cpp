#include "schuler/ppk/arcs.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/math/quantile.h"

#include <Eigen/Cholesky>

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
    double modelled = 0;  ///< m: range minus satellite clock
    double doppler = not_given;
    bool half_cycle = false, jumped = false;
};

/// A phase continued from the previous epoch.
struct Step {
    TrackedSatellite* satellite;
    std::size_t slot;
    double grown;  ///< m, growth beyond the satellite's motion and the approximate positions
    Eigen::Vector3d towards;
    double sigma;
    double by_doppler;  ///< m, growth beyond the mean Doppler; NaN
    bool use = true;
};

using Unknowns = Eigen::Vector4d;

double residual(const Step& s, const Unknowns& x) { return s.grown - s.towards.dot(x.head<3>()) - x[3]; }

/// Displacement and clock step with the least absolute residuals: several simultaneous slips do not mask each other.
std::optional<Unknowns> robust_step(const std::vector<Step>& steps) {
    Unknowns x = Unknowns::Zero();
    for (int i = 0; i < 12; ++i) {
        Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
        Unknowns right = Unknowns::Zero();
        for (const Step& s : steps) {
            Unknowns row;
            row << s.towards, 1.0;
            const double w = 1.0 / (s.sigma * (i == 0 ? s.sigma : std::max(s.sigma, std::abs(residual(s, x)))));
            information += w * row * row.transpose();
            right += w * s.grown * row;
        }
        const Eigen::LDLT<Eigen::Matrix4d> factor(information);
        if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 1e-9 * factor.vectorD().maxCoeff()))
            return std::nullopt;
        const Unknowns next = factor.solve(right);
        if (!next.allFinite()) return std::nullopt;
        const bool settled = i > 0 && (next - x).norm() < 1e-4;
        x = next;
        if (settled) break;
    }
    return x;
}

class Numbering {
public:
    Numbering(bool at_rest, const ArcSettings& settings, double interval)
        : at_rest_(at_rest),
          settings_(settings),
          gap_(std::max(settings.longest_gap, 1.5 * interval)),
          before_(gnss::satellite_count) {}

    void epoch(TrackedEpoch& e) {
        const Geodetic geodetic = earth::geodetic_from_ecef(earth::wgs84, e.position);
        steps_.clear();
        for (TrackedSatellite& s : e.satellites) {
            const Line line = line_to(s, e.position, geodetic);
            const double modelled = line.range - s.clock;
            for (std::size_t k = 0; k < most_signals; ++k) {
                if (!std::isfinite(s.signals[k].phase)) continue;
                continue_or_begin(e, s, k, modelled, line.towards);
            }
            compare_carriers(e, s);
        }
        std::erase_if(steps_, [](const Step& s) { return !s.use; });
        compare_steps((e.tag - time_).seconds());
        for (TrackedSatellite& s : e.satellites) remember(e, s);
        time_ = e.tag;
    }

    ArcCounts counts;

private:
    Before& before(const TrackedSatellite& s, std::size_t k) { return before_[gnss::index_of(s.id)][k]; }
    [[nodiscard]] double sigma(const TrackedSatellite& s, std::size_t k) const {
        return settings_.phase_sigma * gnss::noise_factor(s.direction.elevation, s.signals[k].cn0);
    }
    /// Possible drift of a phase relative to the model in this time: satellite clock and atmosphere.
    [[nodiscard]] static double drift(double seconds) { return 0.02 + 0.002 * std::abs(seconds); }

    void begin(TrackedSatellite& s, std::size_t k, bool jumped) {
        s.signals[k].arc = ++last_arc_;
        s.signals[k].jumped = jumped;
        for (Step& step : steps_)
            if (step.satellite == &s && step.slot == k) step.use = false;
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
            if (b.time == time_)
                steps_.push_back({&s, k, now.phase - b.phase - (modelled - b.modelled), towards, sigma(s, k), by_doppler});
        }
        modelled_now_[gnss::index_of(s.id)] = modelled;
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
        if (steps_.empty()) return;
        std::optional<Unknowns> x;
        std::size_t satellites = 0;
        const TrackedSatellite* last = nullptr;
        for (const Step& s : steps_) {
            satellites += s.satellite != last ? 1 : 0;
            last = s.satellite;
        }
        if (at_rest_) {
            x = Unknowns::Zero();
            (*x)[3] = median_of([](const Step& s) { return s.grown; });
        } else if (constexpr std::size_t enough = 6; satellites >= enough) {
            x = robust_step(steps_);
        }
        if (x) {
            for (Step& s : steps_) {
                if (std::abs(residual(s, *x)) <= drift(dt) + 6.0 * s.sigma) continue;
                begin(*s.satellite, s.slot, true);
                ++counts.unexplained;
            }
            return;
        }
        compare_with_doppler(dt);
    }

    void compare_with_doppler(double dt) {
        constexpr double longest = 1.5;  // s, over which a mean of two Dopplers approximates a vehicle's displacement
        std::erase_if(steps_, [](const Step& s) { return !std::isfinite(s.by_doppler); });
        if (steps_.size() < 2 || std::abs(dt) > longest) return;
        const double clock = median_of([](const Step& s) { return s.by_doppler; });
        for (const Step& s : steps_) {
            const TrackedSignal& now = s.satellite->signals[s.slot];
            const double doppler = settings_.doppler_sigma * s.sigma / settings_.phase_sigma * std::abs(dt);
            if (std::abs(s.by_doppler - clock) <= 0.7 * now.wavelength + 5.0 * doppler) continue;
            begin(*s.satellite, s.slot, true);
            ++counts.unexplained;
        }
    }

    template <class Of>
    double median_of(Of of) const {
        std::vector<double> values;
        for (const Step& s : steps_) values.push_back(of(s));
        return math::median(std::move(values));
    }

    void remember(const TrackedEpoch& e, const TrackedSatellite& s) {
        for (std::size_t k = 0; k < most_signals; ++k) {
            const TrackedSignal& now = s.signals[k];
            if (now.arc == 0) continue;
            before(s, k) = {e.tag,       now.arc,        now.phase, modelled_now_[gnss::index_of(s.id)],
                            now.doppler, now.half_cycle, now.jumped};
        }
    }

    bool at_rest_;
    ArcSettings settings_;
    double gap_;
    std::vector<std::array<Before, most_signals>> before_;
    std::array<double, gnss::satellite_count> modelled_now_{};
    std::vector<Step> steps_;
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

ArcCounts number_arcs(std::vector<TrackedEpoch>& epochs, bool at_rest, const ArcSettings& settings) {
    Numbering numbering(at_rest, settings, usual_interval(epochs));
    for (TrackedEpoch& e : epochs) numbering.epoch(e);
    return numbering.counts;
}

}  // namespace schuler::ppk
