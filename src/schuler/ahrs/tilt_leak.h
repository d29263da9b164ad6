// Propagation of the tilt error into the heading. The dip of the field converts a tilt error about north into a heading error
// larger by tan(dip); the heading filter averages it. Its white measurement noise cannot represent this, because the tilt error
// is correlated, so this part is kept separately: a variance to be added to the filter's own, and its covariance with the tilt.
// Neither is used for gains: the channels remain separate.
#pragma once

namespace schuler::ahrs {

struct TiltLeak {
    double variance = 0.0;    ///< rad^2, of the heading error caused by the tilt
    double covariance = 0.0;  ///< rad^2, of that with the tilt error about north (phi, both)

    /// The tilt error was corrected and grew again: the fraction `keep` of the old error remains.
    void tilt_step(double keep) { covariance *= keep; }
    /// The heading error (about down) moved by `gain` towards tan_dip times the tilt error about north, whose variance is given.
    void heading_step(double gain, double tan_dip, double tilt_variance) {
        const double stay = 1.0 - gain, in = gain * tan_dip;
        variance = stay * stay * variance + 2.0 * stay * in * covariance + in * in * tilt_variance;
        covariance = stay * covariance + in * tilt_variance;
    }
};

}  // namespace schuler::ahrs
