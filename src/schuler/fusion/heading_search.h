// The initial heading as a mixture: trials around the compass, each with its own smoother over the first minutes.
#pragma once

#include "schuler/fusion/run_pass.h"

#include <optional>

namespace schuler::fusion {

/// Heading at the start measured by an instrument, rad.
struct HeadingWitness {
    double heading = 0.0, std = 0.0;
    bool by_mag = false;  ///< by the magnetometer; otherwise by a heading sensor
};

/// Combined result of all trials.
struct HeadingSearch {
    StartEstimate best;    ///< of the most probable trial
    double heading = 0.0;  ///< mean of the mixture, rad
    double std = 0.0;      ///< of the mixture, including the spread of the trials not rejected, rad
    bool decided = false;  ///< a single heading remains
    Time until{};          ///< end of the evaluated interval
};

/// A level estimate valid for trials, and its accuracy.
struct Level {
    Eigen::Vector3d f_b = Eigen::Vector3d::Zero();  ///< mean specific force in body axes at the start, m/s^2
    Eigen::Vector3d f_n = Eigen::Vector3d::Zero();  ///< the same in NED from the receiver, m/s^2
    double std = 0.0;                               ///< rad
};

/// One sigma of the components of a lever arm that is not given, m: that of the settings, on a ship the height of a mast.
[[nodiscard]] double unknown_lever_arm_std(const Settings& settings);

/// Tries headings all around the compass over 15 s, one, four and sixteen minutes from `motion` on, until one is left: a sum of
/// Gaussians with equal initial weights, approximating a uniform heading. Rejected trials are not continued. Likelihoods are
/// tempered: receiver errors are correlated, and a linearised filter is inaccurate for errors of tens of degrees. `start`
/// provides everything except the attitude.
[[nodiscard]] HeadingSearch search_heading(const RunData& data, const Settings& settings, const Start& start, const Level& level,
                                           Time motion, const std::optional<HeadingWitness>& witness);

/// The level of a moving body: its gyros transform the specific forces of some seconds, as long as their bias permits, to the
/// axes at the start, where roll, pitch and waves average out; the receiver's mean acceleration over the same time is subtracted.
/// Empty if the receiver's fixes do not provide it.
[[nodiscard]] std::optional<Level> carried_level(const RunData& data, const Settings& settings, const Start& start);

}  // namespace schuler::fusion
