// Evidence from the innovations of consecutive refused fixes about which is wrong, the receiver or the navigation.
#pragma once

#include "schuler/core/time.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <optional>

namespace schuler::filter {

/// Shape of the innovations of a run. An inertial error appears first as an acceleration: its innovations grow at an increasing
/// rate. A receiver jumps (constant from the first fix on) or drifts away (uniform).
enum class RunShape {
    Short,  ///< too few fixes to decide
    Constant,
    Uniform,  ///< growing at a constant rate
    Growing,  ///< growing at an increasing rate
    Erratic   ///< not consistent with each other
};

/// Consecutive refused fixes of one channel. Plain and copyable; of a long run, evenly spaced samples are kept.
class RefusedRun {
public:
    /// innovation: estimate minus measured, north, east, down, zero if unused; sigma: the largest of the measurement's own.
    void add(Time time, const Eigen::Vector3d& innovation, double sigma);
    void clear() { *this = {}; }

    [[nodiscard]] int count() const { return count_; }
    [[nodiscard]] Time since() const { return samples_[0].time; }
    /// s from the first to the last.
    [[nodiscard]] double span() const { return count_ > 0 ? (last_.time - samples_[0].time).seconds() : 0.0; }
    [[nodiscard]] const Eigen::Vector3d& latest() const { return last_.innovation; }
    [[nodiscard]] Eigen::Vector3d mean() const;
    /// Change per second, by least squares; zero for a single one.
    [[nodiscard]] Eigen::Vector3d rate() const;
    [[nodiscard]] double sigma() const { return sigma_; }
    /// drift: one sigma of the rate at which the estimate may drift.
    [[nodiscard]] RunShape shape(double drift) const;

    /// Passes its parts to `a(...)`, to be written or read.
    template <class Archive>
    void archive(Archive& a) {
        for (Sample& s : samples_) a(s.time, s.innovation);
        a(kept_, every_, count_, sigma_, last_.time, last_.innovation);
    }

private:
    struct Sample {
        Time time{};
        Eigen::Vector3d innovation = Eigen::Vector3d::Zero();
    };
    struct Line {
        Eigen::Vector3d mean, rate;
    };
    [[nodiscard]] Line line(std::size_t first, std::size_t end) const;

    std::array<Sample, 16> samples_{};
    std::size_t kept_ = 0;
    int every_ = 1;  ///< decimation: one of this number is kept
    int count_ = 0;
    double sigma_ = 0.0;
    Sample last_{};
};

/// s without a used position, after which the next fix is the first after an interruption.
inline constexpr double interruption = 5.0;
/// Of a difference between two hypotheses, as an error beside the covariance: undecided, it is 2.5 sigma.
inline constexpr double undecided_part = 0.4;

/// A receiver whose positions moved from one level to another between two fixes without the inertial unit sensing it. The shape
/// of the track does not show which level is right: the evidence for each is how long it was held. Plain and copyable.
struct FixLevels {
    bool two = false;
    bool at_other = false;                            ///< the last fix was at the other level
    Eigen::Vector3d other = Eigen::Vector3d::Zero();  ///< innovation of fixes there: this level minus that one, NED, m
    double here = 0.0, there = 0.0;                   ///< s for which fixes confirmed each level
    double unsure = 0.0;                              ///< m, one sigma of `other`; 0: about as well known as by a fix
    int used = 0;                                     ///< fixes of the other level
    bool anew = false;                                ///< there was an interruption, with this first fix after it:
    Eigen::Vector3d anew_innovation = Eigen::Vector3d::Zero(), anew_sigma = Eigen::Vector3d::Zero();  ///< m, NED; sigma 0: unused
    double here_anew = 0.0;  ///< s, part of `here` since then

    /// Registers the first fix after an interruption: innovation and its predicted sigma.
    void interrupted(const Eigen::Vector3d& innovation, const Eigen::Vector3d& sigma);
    /// Counts a fix `dt` seconds after the previous one; widely spaced fixes confirm no more than `most` seconds.
    void confirm(bool other_one, double dt, double most = 5.0);
    /// Variance of the offset that the next fix of the other level has in addition, m^2. The offset is the same in all of them: with
    /// a variance that grows with the square of their number they never give more information about the position than there was at the jump.
    [[nodiscard]] double shared_variance() const { return unsure * unsure * (1.0 + used) * (1.0 + used); }
    /// Registers a jump by `innovation`, of the given sigma, that was held for `held` s. `settled`: the current level was held by
    /// fixes until then. If the first fix after an interruption would have been about as likely at the other level, what confirmed
    /// this one before the interruption does not count, and counts for the other one if that would have been far likelier.
    void jumped(const Eigen::Vector3d& innovation, double sigma, double held, bool settled);
    /// True if the other level has more evidence; the caller then moves there and calls swap().
    [[nodiscard]] bool prefers_other() const { return two && there > here; }
    void swap();
    /// One sigma, NED, of the ambiguity between the levels.
    [[nodiscard]] Eigen::Vector3d spread() const;
};

/// History of a receiver's channel.
struct FixChannel {
    RefusedRun run;
    FixLevels levels;            ///< of positions
    std::optional<Time> fitted;  ///< the last one used
    Eigen::Vector3d fitted_innovation = Eigen::Vector3d::Zero();
    double fitted_sigma = 0.0;                      ///< the largest sigma of that measurement itself
    int fits = 0;                                   ///< consecutive used fixes
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();  ///< of the innovations of these fixes

    /// Registers a used fix at `time`.
    void fit(Time time, const Eigen::Vector3d& innovation, double sigma);
    /// True if the run began suddenly: the previous fix agreed far better.
    [[nodiscard]] bool began_at_once() const;
};

}  // namespace schuler::filter
