#include "schuler/gnss/epoch_view.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/math/chi_square.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <utility>

namespace schuler::gnss {
namespace {

/// Rows of the geometry: three components of the line of sight, one column for each clock present.
struct Geometry {
    Eigen::MatrixXd rows;
    Eigen::VectorXd weights;

    explicit Geometry(std::span<const UsedRange> ranges) {
        std::array<Eigen::Index, clock_count> column{};
        column.fill(-1);
        Eigen::Index columns = 3;
        for (std::size_t c = 0; c < clock_count; ++c)
            if (std::ranges::any_of(ranges, [c](const UsedRange& r) { return r.clock == c; })) column[c] = columns++;
        const auto n = static_cast<Eigen::Index>(ranges.size());
        rows = Eigen::MatrixXd::Zero(n, columns);
        weights.resize(n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const UsedRange& r = ranges[static_cast<std::size_t>(i)];
            rows.row(i).head<3>() = r.line_of_sight.transpose();
            rows(i, column[r.clock]) = 1.0;
            weights[i] = 1.0 / r.variance;
        }
    }
    [[nodiscard]] Eigen::Index redundancy() const { return rows.rows() - rows.cols(); }
    /// Inverse of the normal equations; empty if they are singular.
    [[nodiscard]] static std::optional<Eigen::MatrixXd> inverse(const Eigen::MatrixXd& information) {
        const Eigen::LDLT<Eigen::MatrixXd> factor(information);
        constexpr double smallest = 1e-10;  // relative to the largest pivot
        const bool good = factor.info() == Eigen::Success && factor.vectorD().minCoeff() > smallest * factor.vectorD().maxCoeff();
        if (!good) return std::nullopt;
        return factor.solve(Eigen::MatrixXd::Identity(information.rows(), information.cols()));
    }
};

Fate fate_of(const SatelliteUse& u, SinglePointStatus status) {
    if (u.excluded) return Fate::Faulty;
    if (!u.used) return Fate::BelowMask;
    return status == SinglePointStatus::Solved ? Fate::Used : Fate::NoSolution;
}

}  // namespace

std::string_view name_of(Fate fate) {
    constexpr std::array<std::string_view, fate_count> names{"used",       "system off", "no signal",  "no ephemeris",
                                                             "below mask", "faulty",     "no solution"};
    return names[static_cast<std::size_t>(fate)];
}

Dilution dilution_of(std::span<const UsedRange> ranges) {
    const Geometry g(ranges);
    if (g.redundancy() < 0) return {};
    const auto cofactor = Geometry::inverse(g.rows.transpose() * g.rows);
    if (!cofactor) return {};
    const Eigen::VectorXd q = cofactor->diagonal();
    return {std::sqrt(q.sum()), std::sqrt(q.head<3>().sum()), std::sqrt(q[0] + q[1]), std::sqrt(q[2]), std::sqrt(q[3])};
}

ProtectionLevels protection_of(std::span<const UsedRange> ranges, double false_alarm, double missed_detection) {
    const Geometry g(ranges);
    if (g.redundancy() < 1) return {};
    const auto covariance = Geometry::inverse(g.rows.transpose() * g.weights.asDiagonal() * g.rows);
    if (!covariance) return {};
    const Eigen::MatrixXd gain =
        *covariance * g.rows.transpose() * g.weights.asDiagonal();  // position and clock errors per metre of error of each range
    double horizontal = 0.0, vertical = 0.0;
    for (Eigen::Index i = 0; i < g.rows.rows(); ++i) {
        // the fraction of a fault in this range visible in the residuals; a fault fully absorbed by the position is undetectable
        const double shown = 1.0 - g.rows.row(i).dot(gain.col(i));
        constexpr double nothing = 1e-9;
        if (shown < nothing) return {};
        const double slope = 1.0 / std::sqrt(g.weights[i] * shown);
        horizontal = std::max(horizontal, slope * gain.col(i).head<2>().norm());
        vertical = std::max(vertical, slope * std::abs(gain(2, i)));
    }
    const double threshold = std::sqrt(math::chi_square_quantile(1.0 - false_alarm, static_cast<double>(g.redundancy())));
    const double sigmas =
        std::sqrt(math::chi_square_quantile(1.0 - 2.0 * missed_detection, 1.0));  // one side of a normal distribution
    const Eigen::Matrix2d level = covariance->topLeftCorner<2, 2>();
    const double largest =
        0.5 * (level.trace() + std::hypot(level(0, 0) - level(1, 1), 2.0 * level(0, 1)));  // of the error ellipse, m^2
    return {horizontal * threshold + sigmas * std::sqrt(largest), vertical * threshold + sigmas * std::sqrt((*covariance)(2, 2))};
}

EpochViewer::EpochViewer(const SatelliteSource& source, std::optional<BroadcastIonosphere> ionosphere,
                         const SinglePointSettings& settings, double missed_detection)
    : source_(source),
      ionosphere_(std::move(ionosphere)),
      settings_(settings),
      missed_detection_(missed_detection),
      solver_(source, ionosphere_, settings) {}

EpochView EpochViewer::view(std::span<const SignalObservation> observations, Time tag, const GlonassChannels& channels) {
    std::vector<Range> ranges;
    prepare_ranges(observations, tag, source_, channels, settings_.ranges, ranges);
    EpochView out = view(ranges, tag);
    // tracked signals that did not become a range
    for (std::size_t first = 0, last = 0; first < observations.size(); first = last) {
        const SignalObservation& o = observations[first];
        double strongest = not_given;
        for (; last < observations.size() && observations[last].satellite == o.satellite; ++last)
            strongest = std::isfinite(strongest) ? std::max(strongest, observations[last].cn0) : observations[last].cn0;
        if (std::ranges::find(ranges, o.satellite, &Range::satellite) != ranges.end()) continue;
        SatelliteView& v = out.satellites.emplace_back();
        v.satellite = o.satellite;
        v.signal = o.signal;
        v.cn0 = strongest;
        const auto sent = source_.at(o.satellite, o.signal, tag - Duration::from_seconds(0.075));  // light time of medium orbits
        v.fate = !settings_.ranges.systems[static_cast<std::size_t>(o.satellite.system)] ? Fate::SystemOff
                 : sent                                                                  ? Fate::NoSignal
                                                                                         : Fate::NoEphemeris;
        if (!sent || !out.solution.position.r.allFinite() || out.solution.satellites.empty()) continue;
        v.direction = direction_to(sent->state.position, out.solution.position,
                                   earth::geodetic_from_ecef(earth::wgs84, out.solution.position));
    }
    std::ranges::stable_sort(out.satellites, {}, &SatelliteView::satellite);
    return out;
}

EpochView EpochViewer::view(std::vector<Range> ranges, Time tag) {
    EpochView out;
    out.tag = tag;
    out.solution = solver_.solve(ranges, tag);
    const SinglePointSolution& s = out.solution;
    const bool placed = s.satellites.size() == ranges.size() && !ranges.empty();
    const Geodetic here = placed ? earth::geodetic_from_ecef(earth::wgs84, s.position) : Geodetic{};
    const Eigen::Matrix3d C_ne = earth::C_en(here.lat, here.lon).transpose();
    std::vector<UsedRange> used;
    for (std::size_t k = 0; k < ranges.size(); ++k) {
        const Range& r = ranges[k];
        SatelliteView& v = out.satellites.emplace_back();
        v.satellite = r.satellite;
        v.signal = r.signal;
        v.cn0 = r.cn0;
        if (!placed) continue;
        const ModelledRange m = model_range(r, s.position, here, ionosphere_ ? &*ionosphere_ : nullptr, settings_.ranges);
        const SatelliteUse& u = s.satellites[k];
        v.direction = u.direction;
        v.fate = fate_of(u, s.status);
        v.residual = u.residual;
        v.sigma = std::sqrt(m.variance);
        if (s.velocity.allFinite() && std::isfinite(r.range_rate)) {
            v.rate_residual = r.range_rate - model_range_rate(r, s.position, s.velocity) - s.drift;
            v.rate_sigma = range_rate_sigma(r, u.direction.elevation, settings_.ranges);
        }
        if (u.used) used.push_back({C_ne * m.line_of_sight, clock_of(r.satellite.system), m.variance});
    }
    if (placed) out.dilution = dilution_of(used);
    if (s.status == SinglePointStatus::Solved) out.protection = protection_of(used, settings_.false_alarm, missed_detection_);
    return out;
}

}  // namespace schuler::gnss
