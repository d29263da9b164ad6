// From real-valued ambiguities with their covariance to validated integers, and their effect on the position.
#pragma once

#include "schuler/gnss/satellite.h"
#include "schuler/ppk/settings.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <vector>

namespace schuler::ppk {

/// A state that is an integer number of cycles relative to another of its group (system and carrier).
struct WholeState {
    gnss::SatelliteId id;
    int group = 0;
    Eigen::Index state = 0;  ///< its index in the filter, m
    double wavelength = 0;   ///< or half of it
    bool halves = false;
    double elevation = 0;
    double repeated =
        0;  ///< m^2, variance of errors common to many epochs, which the filter has averaged down as if it were white noise
    bool trusted = false;  ///< it was among the integers of the last valid fix
};

/// The first `states` of the filter after fixing integers.
struct IntegerFix {
    Eigen::VectorXd correction;  ///< to be added to them
    Eigen::MatrixXd covariance;
    double ratio = 0;
    double success = 0;
    int count = 0;                     ///< number of fixed integers
    int ambiguities = 0;               ///< number of double differences available for fixing
    std::vector<Eigen::Index> states;  ///< that took part
    std::vector<Eigen::Index> broken;  ///< not integers according to the others: half cycles, or an individual error
};

/// Result of the search, whether or not accepted.
struct IntegerTrial {
    double ratio = 0, success = 0;
    std::optional<IntegerFix> fix;
};

/// Double differences relative to each group's highest satellite, decorrelated; as many as can be fixed with the required success rate
/// (partial fixing [Teunissen1999]). Accepted if the second best integers are sufficiently worse than the best and the best are within
/// the covariance of the float solution. Otherwise retried with those of the last valid fix alone, and without the lowest satellites.
[[nodiscard]] IntegerTrial fix_integers(const Eigen::VectorXd& x, const Eigen::MatrixXd& P, std::span<const WholeState> whole,
                                        Eigen::Index states, const IntegerSettings& settings);

}  // namespace schuler::ppk
