// The filter of a survey: nominal state, covariance, and what a fix did to them.
#pragma once

#include "schuler/estim/scalar_update.h"
#include "schuler/gravimetry/settings.h"
#include "schuler/gravimetry/survey_aids.h"

#include <array>

namespace schuler::gravimetry {

/// What happened between two fixes and at the second, for the way back.
struct FixStep {
    StateMatrix Phi;
    std::array<estim::ScalarUpdate<max_states>, 6> updates;
    std::size_t used = 0;   ///< of them
    bool satellites = true; ///< of an AntennaFix
    /// Sum of the squares of the innovations by their variance: chi-square of `used` degrees of freedom.
    [[nodiscard]] double nis() const;
    Eigen::Vector3d f_e = Eigen::Vector3d::Zero();   ///< mean specific force since the fix before, m/s^2
};

/// The reference trajectory is the mechanization as it runs. In the closed loop every measurement corrects it; in the open loop
/// nothing does, and in the mixed one a measurement now and then: the estimated errors are kept beside it and carried along it.
class SurveyFilter {
public:
    SurveyFilter(const SurveySettings& settings, const NavStateEcef& start);

    /// Advances the reference trajectory by one raw increment.
    void advance(const ImuIncrement& raw);
    /// Carries the covariance to now and takes a fix of now.
    FixStep take(const AntennaFix& fix);
    /// Takes another instrument's measurement of now; the covariance is carried on as by a fix.
    FixStep take(const HeightFix& fix);
    FixStep take(const BodyVelocityFix& fix);
    FixStep take(const HeadingFix& fix);
    /// The systematic part of the disturbance may have changed by its prior.
    void open_disturbance();

    [[nodiscard]] const SurveyState& reference() const { return reference_; }
    /// The reference trajectory less the errors that are kept beside it, at the last measurement.
    [[nodiscard]] SurveyState estimate() const;
    [[nodiscard]] const StateMatrix& P() const { return P_; }

private:
    FixStep carried();
    [[nodiscard]] Eigen::Vector3d body_rate() const;
    void correct(const StateVector& dx);
    SurveySettings settings_;
    SurveyState reference_;
    StateVector error_ = StateVector::Zero();   ///< estimated, of reference_; zero in the closed loop
    StateMatrix P_;
    Time next_feedback_;                 ///< of the mixed loop
    Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();   ///< of attitude errors, to the reference that was corrected last
    ImuIncrement previous_{{}, 0.0, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    // Sums over the increments since the last fix, times dt.
    double elapsed_ = 0.0;
    Eigen::Matrix3d C_eb_sum_ = Eigen::Matrix3d::Zero();
    Eigen::Vector3d f_e_sum_ = Eigen::Vector3d::Zero();
    Ecef from_;                          ///< position at the last fix
};

}  // namespace schuler::gravimetry
