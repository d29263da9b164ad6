// How true the sigmas of free inertial navigation are on one log: windows in which fixes are withheld, the sigmas that the filter stated
// in them, and by how much the noise of the inertial unit would have had to be larger. No file and no filter is known here.
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
    bool good = true;    ///< it was not refused
    bool moving = true;  ///< the vehicle moved
};

/// Which fixes to withhold. Even and odd windows are withheld in runs of their own, so that between two windows of a run lies at least
/// three times their length.
struct CheckWindows {
    double length = 0.0;                  ///< s; NaN without windows
    std::vector<fusion::Outage> windows;  ///< in order
    std::string why_none;                 ///< empty: there are windows
};

/// Windows between `from` and `to` of the longest of 60, 15 and 5 s of which there are eight at least, or else of 5 s, four at least:
/// with fixes all through, most of them good, and apart from the user's outages. At rest standing still is known and little grows: where there
/// are as many windows most of which is in motion, only those are taken.
[[nodiscard]] CheckWindows check_windows(std::span<const CheckFix> fixes, double from, double to,
                                         std::span<const fusion::Outage> outages);

/// How the vehicle moved.
enum class Regime { Rest, Straight, Turning };
inline constexpr std::size_t regimes = 3;
[[nodiscard]] const char* name_of(Regime regime);

/// A withheld fix against the filter, north, east, down; components that were not compared have sigma 0.
struct WithheldEpoch {
    std::size_t window = 0;
    double since = 0.0;  ///< s after the window's start
    Regime regime = Regime::Straight;
    Eigen::Vector3d error = Eigen::Vector3d::Zero();        ///< estimate minus fix, m
    Eigen::Vector3d sigma = Eigen::Vector3d::Zero();        ///< one sigma of that difference: the filter's own and the fix's, m
    Eigen::Vector3d sigma_state = Eigen::Vector3d::Zero();  ///< the filter's own part, m
};

/// Counts of epochs by what became of them.
struct Inside {
    std::size_t epochs = 0, inside = 0;

    void add(bool is_inside);
    [[nodiscard]] double share() const;  ///< NaN of nothing
};

/// Horizontal error and its stated sigma, RMS over the windows.
struct GrowthPoint {
    double since = 0.0;               ///< s, mean
    double error = 0.0, sigma = 0.0;  ///< m
    std::size_t epochs = 0;
};

/// What windows show. An epoch is inside where every component is within three sigma, a window where north and east are at all epochs.
struct Coverage {
    Inside epochs, windows;
    Inside horizontal, vertical;  ///< epochs by what of them is within three sigma
    Inside held;                  ///< windows: nine epochs of ten are inside horizontally. The fixes' own
                                  ///< noise puts a few epochs of many outside
    double end_rms = std::numeric_limits<double>::quiet_NaN();    ///< m, horizontal error of the windows' last fixes
    double sigma_rms = std::numeric_limits<double>::quiet_NaN();  ///< m, stated sigma of it
    std::vector<GrowthPoint> growth;                              ///< some points over the length of a window
    std::array<Inside, regimes> by_regime;
};

/// Epochs in order of windows and time. `length`: of the windows, s.
[[nodiscard]] Coverage coverage_of(std::span<const WithheldEpoch> epochs, double length);

/// Required share of epochs inside three sigma: Gaussian errors of three components have 99.2 %.
inline constexpr double wanted_coverage = 0.98;

/// Factors of the noise and bias wander of gyros and accelerometers.
struct NoiseScale {
    static constexpr double most = 10.0;

    double gyro = 1.0, accel = 1.0;
    bool apart = false;  ///< the growth of the errors separates them

    [[nodiscard]] bool is_one() const { return gyro == 1.0 && accel == 1.0; }
    /// One after the other, within `most`, as a settings file has it.
    [[nodiscard]] NoiseScale times(const NoiseScale& more) const;
    /// The larger of each.
    [[nodiscard]] NoiseScale or_larger(const NoiseScale& other) const;
};

/// Whether this coverage is sufficient: in the epochs, and at most one window in twenty lost.
[[nodiscard]] bool covers(const Coverage& coverage);

/// The noise that is missing: with it the sigmas have the size of the errors, and wanted_coverage of these epochs would have been inside.
/// Of what the likelihood allows the upper end of two sigma is taken: few windows are a weak witness of small errors.
/// After loss, velocity errors driven by the accelerometers grow as t^3 in variance, tilt driven by the gyros as t^5 [Groves2013];
/// both parts are fitted to the growth of the filter's own variance, and a factor for each to the errors, by maximum likelihood. One
/// common factor is kept unless two explain the errors much better. The noise is larger than the growth in question: what the states
/// are known to at loss follows the noise with a power of 3/4 (velocity by positions) to 5/6 (tilt by positions) only, what comes after
/// it with 1.
/// `axes`: north and east, or all three where nothing but the inertial unit carries the height.
[[nodiscard]] NoiseScale missing_noise(std::span<const WithheldEpoch> epochs, int axes = 2);

}  // namespace schuler::solution
