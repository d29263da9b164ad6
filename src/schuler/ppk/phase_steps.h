// Changes of carrier phases between two epochs: the displacement and clock step that explain them, and which of them it explains.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <vector>

namespace schuler::ppk {

/// Displacement of the receiver in Earth-fixed axes and step of its clock, m.
using DisplacementAndClock = Eigen::Vector4d;

/// The change of one phase since the previous epoch, and what limits it.
struct PhaseStep {
    std::size_t satellite = 0;  ///< steps of one satellite have one number, and successive ones stand together
    double grown = 0;           ///< m, growth beyond the satellite's motion and the approximate positions
    Eigen::Vector3d towards{0, 0, 0};
    double sigma = 0;       ///< m
    double tolerance = 0;   ///< m: a larger residual is not noise
    double by_doppler = 0;  ///< m, growth beyond the mean Doppler; NaN if there is none
};

[[nodiscard]] inline double residual(const PhaseStep& s, const DisplacementAndClock& x) {
    return s.grown - s.towards.dot(x.head<3>()) - x[3];
}

/// The last values of a quantity whose usual size is learnt from a log.
class UsualSize {
public:
    explicit UsualSize(std::size_t enough) : enough_(enough) {}
    void learn(double value);
    [[nodiscard]] bool known() const { return last_.size() >= enough_; }
    [[nodiscard]] double quantile(double p) const;

private:
    std::size_t enough_, next_ = 0;
    std::vector<double> last_;
};

/// Difference of the displacements of the receiver by phases and by Dopplers, m, and its size relative to the noise of a single
/// step. It consists of the noise of the Dopplers and of what their mean misses of the motion between two epochs.
struct DopplerDifference {
    double size = 0;
    double dilution = 0;
};
/// Of the steps that `which` marks. Nothing with fewer than four Dopplers.
[[nodiscard]] std::optional<DopplerDifference> doppler_difference(const std::vector<PhaseStep>& steps,
                                                                  const std::vector<char>& which);

/// Tells which phases have not slipped between two epochs: those that one displacement and clock step explain.
/// After one slip it is all satellites but one; where it could be one of several, none of these is kept. After several at once,
/// which hide each other from a fit, it is the largest set of satellites that agree, if it can be distinguished from all others: by three
/// satellites more than any set that contradicts it, or by the Dopplers. Where it cannot be distinguished, no phase is kept.
class PhaseContinuity {
public:
    /// Marks the steps that are kept; `dt`: s between the epochs. Nothing if the geometry does not determine a displacement.
    [[nodiscard]] std::optional<std::vector<char>> kept(const std::vector<PhaseStep>& steps, double dt);

private:
    [[nodiscard]] std::optional<bool> usual(const DopplerDifference& d) const;
    [[nodiscard]] bool impossible(const DopplerDifference& d, double dt) const;
    [[nodiscard]] std::optional<std::vector<char>> all_but_one(const std::vector<PhaseStep>& steps) const;
    [[nodiscard]] std::optional<std::vector<char>> largest_agreement(const std::vector<PhaseStep>& steps) const;

    UsualSize dopplers_{20};  ///< sizes of differences relative to their dilutions
    UsualSize noise_{8};      ///< root mean square residuals of undisturbed epochs, relative to the sigmas
};

}  // namespace schuler::ppk
