// Which combinations of the model's states are observable: rank of the observability matrix of a moving system.
#pragma once

#include "schuler/core/position.h"
#include "schuler/core/units.h"
#include "schuler/earth/earth.h"

#include <Eigen/Core>

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace schuler::gravimetry {

/// A steady motion. By default a great circle: radius vector, body and specific force rotate together at a constant rate about an
/// axis fixed in the Earth, as in the reference numbers of math.md section 4; the heading may change in addition. The disturbance
/// is constant in Earth-fixed axes, as in the paper.
struct ObservedMotion {
    Geodetic start{55.8114694 * units::deg, 37.4998612 * units::deg, 164.15};  ///< [PaperE]
    Eigen::Vector3d v_eb_n = Eigen::Vector3d::Zero();                          ///< m/s
    Eigen::Vector3d rpy = {0.0, 0.0, 45.0 * units::deg};                       ///< at the start, rad
    double heading_rate = 0.0;                                                 ///< rad/s
    double random_rate = 0.0;  ///< mu of the random part, 1/s; 0: a second constant, as in the paper's count of states
    int degree = 0;            ///< of the polynomial along the track for the systematic part: 0 (constant), 1 or 2
    bool rhumb = false;        ///< instead, constant velocity north, east, down and heading relative to north over the ellipsoid
    bool frozen = false;       ///< F held constant: the result of a test that ignores the motion of the model
    bool centrifugal = false;  ///< include the gradient of the centrifugal acceleration (0.35 % of the point mass's)
};

/// An observable combination: a state plus multiples of states not observable on their own.
struct SeenCombination {
    std::string state;
    std::vector<std::pair<std::string, double>> with;  ///< coefficients in SI units
};

struct Observability {
    static constexpr int most = 33;
    int states = 27;  ///< of the model: three more for each degree of the polynomial
    int rank = 0;
    /// Pivots of the elimination with complete pivoting, in the order found, down to the rank; states are scaled by time 1/w0,
    /// velocity g/w0, length g/w0^2, acceleration g, so a pivot is relative to the effect of gravity itself in 13 minutes;
    /// derivatives of the disturbance are scaled by g over powers of that length.
    std::vector<double> pivots;
    double next = 0.0;  ///< largest remaining element: of rounding (below 1e-40), or below the tolerance
    std::vector<SeenCombination> combinations;
};

/// Observability matrix N_0 = H, N_{k+1} = N_k F + dN_k/dt up to k = 32, of position and velocity fixes, with the derivatives of
/// F along the motion (math.md section 4; point-mass gravitation, as in [PaperE]). Computed with 50 decimal digits: a pivot below
/// 1e-30 is zero, so the rank is that of exact arithmetic as long as the printed gap is wide. `tolerance`: pivots below it are
/// not counted (0: all are). @throws Error(Input) that names the invalid value.
[[nodiscard]] Observability observability(const earth::Earth& earth, const ObservedMotion& motion, double tolerance = 0.0);

/// Names of the states, in the order of the model: position_x ... random_z, slope_x ... curvature_z.
[[nodiscard]] std::array<std::string, Observability::most> state_names();

}  // namespace schuler::gravimetry
