// Realism of the sigmas of free inertial navigation on one log: windows in which fixes are withheld, the sigmas stated by the
// filter in them, and the required increase of the noise of the inertial unit. Independent of files and filters.
#pragma once

#include "schuler/fusion/settings.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace schuler::solution {

/// A fix of the undisturbed run; t: s after the origin of the command line's times.
struct CheckFix {
    double t = 0.0;
    bool good = true;    ///< it was not rejected
    bool moving = true;  ///< the vehicle moved
};

/// A fix whose sigma (m, horizontal; NaN: not known) is ten times the usual one and 30 m or more would confirm any solution: no good one.
void leave_out_vague(std::vector<CheckFix>& fixes, const std::vector<double>& sigmas);

/// The fixes to withhold. Even and odd windows are withheld in separate runs, so that the distance between two windows of a run
/// is at least three times their length.
struct CheckWindows {
    double length = 0.0;                  ///< s; NaN without windows
    std::vector<fusion::Outage> windows;  ///< in order
    std::string why_none;                 ///< reason for their absence; empty: there are windows
};

/// Windows between `from` and `to` of the longest of 60, 15 and 5 s that gives at least eight, or else of 5 s, at least four:
/// with fixes throughout, most of them good, and separate from the user's outages. At rest, standstill is detected and errors
/// hardly grow: if there are as many windows mostly in motion, only those are used.
[[nodiscard]] CheckWindows check_windows(std::span<const CheckFix> fixes, double from, double to,
                                         std::span<const fusion::Outage> outages);

/// Type of vehicle motion.
enum class Regime { Rest, Straight, Turning };
inline constexpr std::size_t regimes = 3;
[[nodiscard]] const char* name_of(Regime regime);

/// A withheld fix compared with the filter, north, east, down; components that were not compared have sigma 0.
struct WithheldEpoch {
    std::size_t window = 0;
    double since = 0.0;  ///< s after the window's start
    Regime regime = Regime::Straight;
    Eigen::Vector3d error = Eigen::Vector3d::Zero();        ///< estimate minus fix, m
    Eigen::Vector3d sigma = Eigen::Vector3d::Zero();        ///< one sigma of that difference: filter and fix, m
    Eigen::Vector3d sigma_state = Eigen::Vector3d::Zero();  ///< contribution of the filter, m
};

/// Number of epochs by result.
struct Inside {
    std::size_t epochs = 0, inside = 0;

    void add(bool is_inside);
    [[nodiscard]] double share() const;  ///< NaN if empty
};

/// Horizontal error and its stated sigma, RMS over the windows.
struct GrowthPoint {
    double since = 0.0;               ///< s, mean
    double error = 0.0, sigma = 0.0;  ///< m
    std::size_t epochs = 0;
};

/// Results of the windows. An epoch is inside if every component is within three sigma, a window if north and east are at all epochs.
struct Coverage {
    Inside epochs, windows;
    Inside horizontal, vertical;  ///< epochs by the part within three sigma
    Inside held;                  ///< windows: nine of ten epochs are inside horizontally. The noise of the
                                  ///< fixes places a few of many epochs outside
    double end_rms = std::numeric_limits<double>::quiet_NaN();    ///< m, horizontal error at the last fixes of the windows
    double sigma_rms = std::numeric_limits<double>::quiet_NaN();  ///< m, its stated sigma
    std::vector<GrowthPoint> growth;                              ///< some points over the length of a window
    std::array<Inside, regimes> by_regime;
};

/// Epochs in order of windows and time. `length`: of the windows, s.
[[nodiscard]] Coverage coverage_of(std::span<const WithheldEpoch> epochs, double length);

/// Required fraction of epochs inside three sigma: 99.2 % for Gaussian errors of three components.
inline constexpr double wanted_coverage = 0.98;

/// Factors on the noise and bias random walk of gyros and accelerometers.
struct NoiseScale {
    static constexpr double most = 10.0;

    double gyro = 1.0, accel = 1.0;
    bool apart = false;  ///< the growth of the errors separates them

    [[nodiscard]] bool is_one() const { return gyro == 1.0 && accel == 1.0; }
    /// The product, limited to `most`, with the digits of a settings file.
    [[nodiscard]] NoiseScale times(const NoiseScale& more) const;
    /// The larger of each factor.
    [[nodiscard]] NoiseScale or_larger(const NoiseScale& other) const;
};

/// The epochs inside in the axes that depend on the inertial noise: north and east, or all three (see missing_noise).
[[nodiscard]] const Inside& inside_of(const Coverage& coverage, int axes);
/// True if this coverage is sufficient: in the epochs, and with at most one window in twenty lost.
[[nodiscard]] bool covers(const Coverage& coverage, int axes = 3);

/// The same windows before and after an increase of the noise.
struct Increase {
    const Coverage &before, &after;
    int axes = 3;  ///< those that it concerns

    /// In the share of epochs and of windows.
    [[nodiscard]] double gain() const;
    /// The errors at the ends of the windows grow by this factor or more, or are no longer finite.
    [[nodiscard]] bool worsens(double factor) const;
};

/// Whether an increase of the noise is adopted, judged by the windows that did not determine it and by all. Noise that does not
/// improve the sigmas of the judging windows was not missing; if they were already covered, for example with a single manoeuvre
/// in the other windows, it is adopted if it improves all and still covers these. Noise with which the errors of either grow by
/// half is not adopted: a filter may diverge with it in a manoeuvre that only the other windows contain. The judging windows alone
/// are few, so where the sigmas cover them the limit is three, beyond chance.
[[nodiscard]] bool was_missing(const Increase& judges, const Increase& all);

/// The missing noise: with it the sigmas match the errors, and wanted_coverage of these epochs would have been inside. The upper
/// two-sigma limit of the likelihood is used, because few windows are weak evidence of small errors. After loss, velocity errors
/// driven by the accelerometers grow as t^3 in variance, tilt driven by the gyros as t^5 [Groves2013]; both parts are fitted to
/// the growth of the filter's own variance, and a factor for each to the errors, by maximum likelihood. One common factor is
/// used unless two explain the errors much better. The noise factor is larger than that of the growth itself: the initial
/// uncertainty of the states at loss varies only with a power of 3/4 (velocity from positions) to 5/6 (tilt from positions) of
/// the noise, the subsequent growth with 1. `axes`: north and east, or all three if the height depends on the inertial unit
/// alone.
[[nodiscard]] NoiseScale missing_noise(std::span<const WithheldEpoch> epochs, int axes = 2);

}  // namespace schuler::solution
