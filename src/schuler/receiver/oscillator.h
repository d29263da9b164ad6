// The receiver's reference oscillator: frequency noise and acceleration sensitivity.
#pragma once

#include "schuler/math/random.h"

#include <Eigen/Core>

#include <array>

namespace schuler::receiver {

/// Spectrum of the fractional frequency S_y(f) = h0 + h_1 / f + h_2 / f^2 [IEEE1139:3.1], one-sided.
struct OscillatorSettings {
    double h0 = 2e-21;                                        ///< s, white frequency noise
    double h_1 = 1e-22;                                       ///< flicker of frequency
    double h_2 = 2e-20;                                       ///< Hz, random walk of frequency
    double frequency_std = 0.0;                               ///< initial fractional offset, one sigma
    Eigen::Vector3d g_sensitivity = Eigen::Vector3d::Zero();  ///< fractional frequency per m/s^2 of specific force, b axes

    /// Throws Error(Input) that names the setting.
    void check() const;
};

/// A good temperature-compensated and an oven-controlled oscillator [Brown2012:9.3]; offsets of 1 ppm and 0.01 ppm, 1e-9 and
/// 1e-10 per g on each axis.
[[nodiscard]] OscillatorSettings tcxo();
[[nodiscard]] OscillatorSettings ocxo();

/// Clock offset (s) and drift starting from zero. White frequency noise is a random walk of phase; random walk of frequency is
/// exact for any step; flicker is a sum of first-order Gauss-Markov frequencies a decade apart in time constant, from 0.01 s to
/// 10 000 s, which reproduces the Allan deviation of flicker within 5 % from 0.1 s to 1000 s.
class Oscillator {
public:
    Oscillator(const OscillatorSettings& settings, math::Random& random);

    /// Advances `dt` s under the specific force `f_b` (m/s^2).
    void step(double dt, const Eigen::Vector3d& f_b, math::Random& random);

    [[nodiscard]] double offset() const { return offset_; }  ///< s; times the speed of light it is added to every pseudorange
    [[nodiscard]] double drift() const { return drift_; }    ///< mean fractional frequency over the last step

private:
    static constexpr std::size_t decades = 7;
    /// One part of the flicker over a step: retained state, new noise, and the contribution of both to the phase.
    struct Transition {
        double kept, noise, phase_from_state, phase_shared, phase_own;
    };
    void prepare(double dt);

    OscillatorSettings settings_;
    double offset_ = 0.0, drift_ = 0.0;
    double walk_ = 0.0;
    std::array<double, decades> flicker_{};
    double flicker_std_ = 0.0;                       ///< of each part
    std::array<Transition, decades> transitions_{};  ///< for steps of prepared_ s
    double prepared_ = 0.0;
};

}  // namespace schuler::receiver
