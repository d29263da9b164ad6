#include "schuler/solution/evidence.h"

#include "schuler/core/units.h"
#include "schuler/filter/integrity/refused_fixes.h"
#include "schuler/filter/measurement/instruments.h"
#include "schuler/math/quantile.h"
#include "schuler/settings/config/config.h"
#include "schuler/solution/bundle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace schuler::solution {
namespace {

using fusion::MeasurementKind;
using fusion::MeasurementStatus;

class Evidence {
public:
    explicit Evidence(const ResultBundle& b) : b_(b) {}

    template <class... Args>
    void add(const char* id, fmt::format_string<Args...> text, Args&&... args) {
        concerns_.push_back({id, fmt::format(text, std::forward<Args>(args)...)});
    }

    void of_warnings(const WarningLog& warnings) {
        const std::vector<std::string> texts = warnings.summary();
        for (std::size_t i = 0; i < texts.size(); ++i) concerns_.push_back({warnings.topics()[i], texts[i]});
    }

    void of_solution() {
        const std::vector<SolutionRow>& rows = b_.solution().rows;
        const auto positive = [](const Eigen::Vector3d& v) { return (v.array() > 0.0).all() && v.allFinite(); };
        const bool filtered = b_.data.config.scheme != settings::Scheme::Gnss;
        const bool receiver_beside = !b_.result.receiver.rows.empty();  // its own rows have no attitude
        const auto bad = std::ranges::count_if(rows, [&](const SolutionRow& r) {
            const bool attitude = filtered && !(receiver_beside && r.rpy.array().isNaN().all());
            return !positive(r.std_position) || (filtered && !positive(r.std_velocity)) ||
                   (attitude && !(r.std_rpy.array() >= 0.0).all());
        });
        if (bad > 0) add("solution.sigma", "{} rows of the solution have a sigma that is zero or no number", bad);
        adrift(rows);
        if (!filtered || rows.empty()) return;
        latency(rows);
        const fusion::GnssSettings& g = b_.data.config.filter.gnss;
        explained_away("gnss_position_error", "slow error", "m", g.errors.correlated_position);
        explained_away("gnss_latency_error", "latency", "s", Eigen::Vector3d::Constant(g.latency_std));
        explained_away("gnss_velocity_latency_error", "velocity's latency", "s",
                       Eigen::Vector3d::Constant(g.velocity_latency_std));
        constexpr double vague = 20.0 * units::deg;
        const double heading = rows.back().std_rpy.z();
        const bool moves = std::ranges::any_of(rows, [](const SolutionRow& r) { return r.v_eb_n.head<2>().norm() > 1.0; });
        if (moves && heading > vague)
            add("solution.heading", "the heading is known to {:.0f} deg only at the end", heading / units::deg);
    }

    void of_fixes() {
        const fusion::Counters& n = b_.result.counters;
        const std::size_t met = n.gnss_accepted + n.gnss_rejected;
        if (b_.data.config.scheme == settings::Scheme::Gnss) return;
        if (met + n.gnss_withheld == 0) return add("gnss.none", "no fix gives its position");
        const double refused = met > 0 ? static_cast<double>(n.gnss_rejected) / static_cast<double>(met) : 0.0;
        constexpr double many = 0.05;
        if (refused > many && !fusion::uses_ranges(b_.data.config.filter.coupling))
            add("gnss.refused", "{} of {} fixes were refused", n.gnss_rejected, met);
        carrier_phases();
        longest_refusal();
        found_again();
        explained_refusals();
        refused_instruments();
        constexpr double long_hole = 1.0;  // s
        if (n.longest_imu_gap > long_hole) add("imu.hole", "a hole of {:.1f} s in the IMU log was bridged", n.longest_imu_gap);
    }

    /// Conclusions from refused fixes. Below a metre it is not considered a fault: the first metres of a motion have the same effect.
    void explained_refusals() {
        using fusion::IntegrityTest;
        constexpr double least = 1.0;  // m or m/s
        int excluded = 0, jumps = 0, lost = 0;
        double largest = 0.0;
        for (const fusion::Alert& a : b_.result.alerts) {
            if (a.test == IntegrityTest::Tolerance || a.test == IntegrityTest::Innovation || a.test == IntegrityTest::Slow)
                ++excluded;
            if (a.test == IntegrityTest::Jump) ++jumps, largest = std::max(largest, a.size);
            if (a.test == IntegrityTest::Navigation && a.size > least) ++lost;
        }
        if (excluded > 0) add("gnss.alert", "the receiver was taken for faulty {}", times(excluded));
        if (jumps > 0)
            add("gnss.jump", "the receiver's positions jumped {}, by {:.3g} m at most, without the IMU feeling it", times(jumps),
                largest);
        if (lost > 0) add("navigation.lost", "the navigation was restarted {}: the fixes showed it to be wrong", times(lost));
    }
    /// Ambiguities as states: what contradicted them.
    void carrier_phases() {
        std::size_t phases = 0, slipped = 0, doubted = 0;
        for (const fusion::CarrierRow& r : b_.result.forward.carriers) {
            phases += static_cast<std::size_t>(r.phases);
            slipped += static_cast<std::size_t>(r.slipped);
            doubted += r.doubted ? 1 : 0;
        }
        constexpr std::size_t rare = 200;
        if (rare * slipped > phases)
            add("base.slips.many", "{} of {} carrier phases contradicted the others: are base.phase_std_m and imu.grade right?",
                slipped, phases);
        if (doubted > 0)
            add("base.prediction", "the inertial prediction contradicted the carrier phases {}",
                times(static_cast<int>(doubted)));
    }
    static std::string times(int n) { return n == 1 ? "once" : fmt::format("{} times", n); }

    void of_self_check() {
        if (!b_.self_check) return;
        const SelfCheck& c = *b_.self_check;
        if (!c.done()) return add("self_check.none", "the sigmas could not be checked on this log: {}", c.why_not);
        Inside fixes;
        for (const FixRegime& r : c.fixes) {
            fixes.epochs += r.inside.epochs;
            fixes.inside += r.inside.inside;
        }
        constexpr double enough_fixes = 0.95, poor = 0.90;
        constexpr double contradicted = 0.75;
        if (fixes.share() < contradicted)
            add("gnss.contradicted", "only {:.1f} % of the fixes are inside three sigma of the solution", 100.0 * fixes.share());
        else if (fixes.share() < enough_fixes)
            add("gnss.outside", "{:.1f} % of the fixes are inside three sigma", 100.0 * fixes.share());
        const Coverage& worst = c.worst();
        const double share = worst.epochs.share();
        const std::size_t lost = worst.held.epochs - worst.held.inside;
        const std::string told = fmt::format(
            "{:.1f} % of {} withheld fixes{} are inside three sigma (horizontal {:.1f} %, vertical {:.1f} %; {:.3g} m at sigma {:.3g} m "
            "after {:.0f} s)",
            100.0 * share, worst.epochs.epochs, c.widened ? ", judged with wider noise," : "", 100.0 * worst.horizontal.share(),
            100.0 * worst.vertical.share(), worst.end_rms, worst.sigma_rms, c.length);
        if (share < poor && lost > 1) add("self_check.failed", "only {}", told);
        else if (share < wanted_coverage) add("self_check.low", "only {}", told);
        else if (!covers(worst))
            add("self_check.low", "{} of {} windows without fixes are outside three sigma; {}", lost, worst.held.epochs, told);
        else if (c.widened && c.tried && std::max(c.tried->gyro, c.tried->accel) >= NoiseScale::most)
            add("self_check.low", "the assumed noise was increased to its limit of {:.0f} times, which may not be enough: {}",
                NoiseScale::most, told);
        else if (worst.end_rms > 2.0 * worst.sigma_rms)
            add("self_check.growth", "errors grow twice as fast as the sigmas: {}", told);
        else add("evidence.self_check", "{}", told);
    }

    /// Simulated data: compared with the truth.
    void of_truth() {
        if (!b_.data.true_reference || b_.evaluation.errors.empty()) return;
        Inside inside, near;
        for (const analysis::ErrorRow& e : b_.evaluation.errors) {
            if (e.time < b_.evaluation.settled || !e.std_position.allFinite()) continue;
            inside.add((e.position.array().abs() <= 3.0 * e.std_position.array()).all());
            constexpr double far = 10.0, lost = 100.0;  // sigmas, m
            near.add((e.position.array().abs() <= (far * e.std_position.array()).max(lost)).all());
        }
        if (inside.epochs == 0) return;
        const double share = 100.0 * inside.share();
        if (near.share() < 0.5)
            return add("truth.lost", "it has lost the truth: {:.1f} % of the epochs are inside three sigma", share);
        if (inside.share() < 0.90)
            return add("truth.outside", "{:.1f} % of the epochs are inside three sigma of the truth", share);
        add("evidence.truth", "{:.1f} % of {} epochs are inside three sigma of the truth", share, inside.epochs);
    }

    [[nodiscard]] std::vector<Concern> take() { return std::move(concerns_); }

private:
    /// The solution continues without fixes until it is useless.
    void adrift(const std::vector<SolutionRow>& rows) {
        constexpr double useless = 100.0;  // m, one sigma
        double seconds = 0.0, worst = 0.0;
        for (std::size_t i = 1; i < rows.size(); ++i) {
            if (rows[i].time < b_.result.findings.aligned_at) continue;
            const double sigma = rows[i].std_position.head<2>().norm();
            if (!(sigma > useless)) continue;
            seconds += (rows[i].time - rows[i - 1].time).seconds();
            worst = std::max(worst, sigma);
        }
        // With fixes available, such a solution over most of a log means that they cannot be trusted.
        const bool most = rows.size() > 1 && seconds > 0.5 * (rows.back().time - rows.front().time).seconds();
        const bool fixes = b_.command == "process" && b_.result.counters.gnss_accepted > 0;
        if (seconds > 0.0)
            add(most && fixes ? "solution.useless" : "solution.adrift",
                "for {} s the position is uncertain by more than {:.0f} m, up to {:.3g} m",
                seconds < 9.5 ? fmt::format("{:.2g}", seconds) : fmt::format("{:.0f}", seconds), useless, worst);
    }

    /// Fixes with an uncertain latency shift the solution, and withheld ones cannot reveal it: the solution is at most as
    /// accurate as the latency sigma times the speed, whatever the filter's own estimate.
    void latency(const std::vector<SolutionRow>& rows) {
        const fusion::GnssSettings& g = b_.data.config.filter.gnss;
        if (fusion::uses_ranges(b_.data.config.filter.coupling) || !(g.latency_std > 0.0)) return;
        std::vector<double> ratios;
        for (const SolutionRow& r : rows) {
            const double sigma = r.std_position.head<2>().norm(), speed = r.v_eb_n.head<2>().norm();
            if (sigma > 0.0 && speed > 1.0) ratios.push_back(g.latency_std * speed / sigma);
        }
        constexpr double much = 1.5;
        if (ratios.empty()) return;
        const double ratio = math::median(std::move(ratios));
        if (ratio > much)
            add("gnss.latency",
                "the receiver's latency is known to {:.2f} s only, which at this speed is {:.1f} times the sigma of the position: give "
                "gnss.latency_s and gnss.latency_std_s",
                g.latency_std, ratio);
    }

    /// The filter explains contradictory fixes by receiver errors far beyond the assumed ones: withheld fixes, corrected for the
    /// same errors, would nevertheless agree.
    void explained_away(std::string_view block, const char* what, const char* unit, const Eigen::Vector3d& sigma) {
        const auto it = std::ranges::find(b_.result.states, block, &fusion::LayoutBlock::name);
        if (it == b_.result.states.end()) return;
        constexpr int navigation = filter::Layout::navigation;
        double most = 0.0;
        Inside inside;
        for (const fusion::ParameterRow& r : b_.result.forward.parameters) {
            double size = 0.0, ratio = 0.0;
            for (int i = 0; i < it->size; ++i) {
                const double x = std::abs(r.value[static_cast<std::size_t>(it->offset - navigation + i)]);
                size = std::max(size, x);
                ratio = std::max(ratio, x / sigma(i));
            }
            inside.add(ratio <= 3.0);
            most = std::max(most, size);
        }
        constexpr double enough = 0.95;
        if (inside.share() < enough)
            add("gnss.explained",
                "the receiver's {} is estimated at up to {:.2g} {}, beyond three sigma of what it is taken for ({:.2g} {})", what,
                most, unit, sigma.maxCoeff(), unit);
    }

    /// Good and bad fixes alternate; refusals over many seconds mean that either the receiver or the navigation was wrong.
    void longest_refusal() {
        constexpr double many = 5.0;  // s
        Time since{}, from{};
        double longest = 0.0;
        bool running = false;
        for (const fusion::MeasurementRecord& r : b_.result.measurements) {
            if (r.kind != MeasurementKind::GnssPosition || r.status == MeasurementStatus::Withheld) continue;
            if (r.status == MeasurementStatus::Accepted) {
                running = false;
                continue;
            }
            if (!running) since = r.time;
            running = true;
            if ((r.time - since).seconds() <= longest) continue;
            longest = (r.time - since).seconds();
            from = since;
        }
        if (longest > many) add("gnss.lost", "all fixes were refused for {:.0f} s from {:.0f} s on", longest, b_.relative(from));
    }

    /// Where the receiver was silent for so long that the prediction cannot test what it says afterwards, a fix that is off by as much as
    /// the prediction is accepted, for good if it stays so: the log has nothing that contradicts it.
    void found_again() {
        if (b_.data.true_reference) return;                      // the truth tells
        constexpr double sigmas = 5.0, least = 1.0, soon = 1.0;  // m, s
        const std::vector<SolutionRow>& rows = b_.solution().rows;
        std::optional<Time> last;
        int found = 0;
        double farthest = 0.0, silence = 0.0;
        Time at{};
        for (const fusion::MeasurementRecord& r : b_.result.measurements) {
            if (r.kind != MeasurementKind::GnssPosition || !(r.sigma.x() > 0.0)) continue;
            const double since = last ? (r.time - *last).seconds() : 0.0;
            last = r.time;
            if (since <= filter::interruption || r.status != MeasurementStatus::Accepted ||
                r.time < b_.result.findings.aligned_at)
                continue;
            const auto row = std::ranges::lower_bound(rows, r.time + Duration::from_seconds(soon), {}, &SolutionRow::time);
            if (row == rows.end()) break;
            const double moved = r.innovation.head<2>().norm();
            if (!(moved > std::max(least, sigmas * row->std_position.head<2>().norm()))) continue;
            ++found;
            if (moved <= farthest) continue;
            farthest = moved;
            silence = since;
            at = r.time;
        }
        if (found > 0)
            add("gnss.found_again",
                "the first fix after a silence moved the position by up to {:.3g} m ({}; at {:.0f} s, after {:.0f} s), far beyond the sigmas "
                "from then on: whether the receiver was right there does not show in this log",
                farthest, times(found), b_.relative(at), silence);
    }

    /// An instrument whose measurements are mostly refused contradicts the solution; which of the two is right, the gate does not decide.
    void refused_instruments() {
        constexpr std::size_t enough = 10;
        std::array<Inside, filter::measurement_kinds> used;
        for (const fusion::MeasurementRecord& r : b_.result.measurements)
            if (r.status != MeasurementStatus::Withheld)
                used[static_cast<std::size_t>(r.kind)].add(r.status == MeasurementStatus::Accepted);
        for (const MeasurementKind kind : filter::instrument_kinds) {
            const Inside& n = used[static_cast<std::size_t>(kind)];
            if (n.epochs >= enough && n.share() < 0.5)
                add("instrument.refused", "{} of {} measurements were refused ({}): they contradict the solution",
                    n.epochs - n.inside, n.epochs, filter::info_of(kind).name);
        }
    }

    const ResultBundle& b_;
    std::vector<Concern> concerns_;
};

}  // namespace

std::vector<Concern> evidence_of(const ResultBundle& bundle, const WarningLog& warnings) {
    Evidence evidence(bundle);
    evidence.of_warnings(warnings);
    evidence.of_solution();
    evidence.of_fixes();
    evidence.of_self_check();
    evidence.of_truth();
    return evidence.take();
}

}  // namespace schuler::solution
