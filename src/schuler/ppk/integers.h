// From real-valued ambiguities with their covariance to whole numbers that can be believed, and what they do to the position.
#pragma once

#include "schuler/gnss/satellite.h"
#include "schuler/ppk/settings.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <vector>

namespace schuler::ppk {

/// A state that is a whole number of cycles against another of its group (system and carrier).
struct WholeState {
    gnss::SatelliteId id;
    int group = 0;
    Eigen::Index state = 0;  ///< its place in the filter, m
    double wavelength = 0;   ///< or half of it
    bool halves = false;
    double elevation = 0;
    double repeated =
        0;  ///< m^2, variance of errors that many epochs have in common and the filter has averaged away all the same
    bool trusted = false;  ///< it was among the integers that held last
};

/// The first `states` of the filter once integers hold.
struct IntegerFix {
    Eigen::VectorXd correction;  ///< to add to them
    Eigen::MatrixXd covariance;
    double ratio = 0;
    double success = 0;
    int count = 0;                     ///< integers that hold
    int ambiguities = 0;               ///< double differences that could have
    std::vector<Eigen::Index> states;  ///< that took part
    std::vector<Eigen::Index> broken;  ///< that are no whole number by the others: half cycles, or an error of their own
};

/// What the search said, whether or not it was believed.
struct IntegerTrial {
    double ratio = 0, success = 0;
    std::optional<IntegerFix> fix;
};

/// Double differences against each group's highest satellite, decorrelated; of these as many as can be fixed with the wanted success rate
/// (partial fixing [Teunissen1999]), and they hold if the second best integers are far enough behind the best and the best no farther from
/// the float than its covariance allows. Otherwise once more with those alone that held last, and without the lowest satellites, a few times.
[[nodiscard]] IntegerTrial fix_integers(const Eigen::VectorXd& x, const Eigen::MatrixXd& P, std::span<const WholeState> whole,
                                        Eigen::Index states, const IntegerSettings& settings);

}  // namespace schuler::ppk
