// The heading at the start as a mixture: trials around the compass, each a smoother of its own over the first minutes.
#pragma once

#include "schuler/fusion/run_pass.h"

#include <optional>

namespace schuler::fusion {

/// What an instrument says of the heading at the start, rad.
struct HeadingWitness {
    double heading = 0.0, std = 0.0;
    bool by_mag = false;  ///< by the magnetometer; otherwise by a sensor of the heading
};

/// What all trials together know.
struct HeadingSearch {
    StartEstimate best;    ///< of the most probable trial
    double heading = 0.0;  ///< mean of the mixture, rad
    double std = 0.0;      ///< of the mixture, with the spread of the trials that are not refuted, rad
    bool decided = false;  ///< one heading is left
    Time until{};          ///< end of the stretch that was looked at
};

/// A level that holds for trials, and how well.
struct Level {
    Eigen::Vector3d f_b = Eigen::Vector3d::Zero();  ///< mean specific force in body axes of the start, m/s^2
    Eigen::Vector3d f_n = Eigen::Vector3d::Zero();  ///< the same in NED by the receiver, m/s^2
    double std = 0.0;                               ///< rad
};

/// Tries headings all around the compass over 15 s, a minute, four and sixteen minutes from `motion` on, until one is left: a sum of Gaussians
/// whose terms, alike at first, are all but a uniform heading. Those refuted are not tried longer. Likelihoods are tempered: errors of
/// a receiver hang together, and a linearised filter that errs by tens of degrees is a coarse judge. `start` gives everything but the
/// attitude.
[[nodiscard]] HeadingSearch search_heading(const RunData& data, const Settings& settings, const Start& start, const Level& level,
                                           Time motion, const std::optional<HeadingWitness>& witness);

/// The level of a body that moves: its gyros carry the specific forces of some seconds, as long as their bias allows, to the axes of the
/// start, where roll, pitch and waves average out; the receiver's mean acceleration of the same time is taken off. Nothing where the
/// receiver's fixes do not tell it.
[[nodiscard]] std::optional<Level> carried_level(const RunData& data, const Settings& settings, const Start& start);

}  // namespace schuler::fusion
