// What fixes that are refused in a row say of who is wrong, the receiver or the navigation, as far as their innovations tell.
#pragma once

#include "schuler/core/time.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <optional>

namespace schuler::filter {

/// How the innovations of a run go on. An inertial error shows first as an acceleration: its innovations grow, and faster and faster. A
/// receiver jumps (constant from the first one on) or is dragged away (uniform).
enum class RunShape {
    Short,  ///< not enough of them to tell
    Constant,
    Uniform,  ///< growing at one rate
    Growing,  ///< ... at an increasing one
    Erratic   ///< they do not agree with each other
};

/// Fixes of one channel refused in a row. Plain and copyable; of a long run evenly spread samples are kept.
class RefusedRun {
public:
    /// innovation: estimate minus measured, north, east, down, zero where unused; sigma: the largest one of the measurement's own.
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
    /// drift: one sigma of the speed with which the estimate may move away by itself.
    [[nodiscard]] RunShape shape(double drift) const;

    /// Hands its parts to `a(...)`, to be written or read.
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
    int every_ = 1;  ///< one of so many is kept
    int count_ = 0;
    double sigma_ = 0.0;
    Sample last_{};
};

/// A receiver whose positions moved from one level to another between two fixes, without the inertial unit having felt it. Which of
/// the two is right the shape of the track does not tell: what speaks for each is for how long it was held. Plain and copyable.
struct FixLevels {
    bool two = false;
    bool at_other = false;                            ///< the last fix was at the other level
    Eigen::Vector3d other = Eigen::Vector3d::Zero();  ///< innovation of the fixes there: our level less that one, NED, m
    double here = 0.0, there = 0.0;                   ///< s for which fixes confirmed each

    /// Counts a fix `dt` seconds after the one before; fixes apart from each other confirm no more than `most` seconds.
    void confirm(bool other_one, double dt, double most = 5.0);
    /// A jump by `innovation` that was held for `held` s. `settled`: whether our level was held until then by fixes; after an
    /// interruption what was confirmed before it counts for little.
    void jumped(const Eigen::Vector3d& innovation, double held, bool settled);
    /// Whether the other level is the better founded one; then the caller moves there and calls swap().
    [[nodiscard]] bool prefers_other() const { return two && there > here; }
    void swap();
    /// One sigma, NED, of not knowing which level is right.
    [[nodiscard]] Eigen::Vector3d spread() const;
};

/// What is remembered of a receiver's channel.
struct FixChannel {
    RefusedRun run;
    FixLevels levels;            ///< of positions
    std::optional<Time> fitted;  ///< the last one that was used
    Eigen::Vector3d fitted_innovation = Eigen::Vector3d::Zero();
    double fitted_sigma = 0.0;                      ///< the largest one of that measurement's own
    int fits = 0;                                   ///< used ones in a row
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();  ///< of the innovations of those

    /// A fix at `time` that is used.
    void fit(Time time, const Eigen::Vector3d& innovation, double sigma);
    /// Whether the run began at once: the fix before fitted, by far better.
    [[nodiscard]] bool began_at_once() const;
};

}  // namespace schuler::filter
