#include "schuler/ahrs/magnet_watch.h"

#include <algorithm>

namespace schuler::ahrs {
namespace {

constexpr double clearly = 3.0;                  // logarithm of the odds: 20 to 1
constexpr double disturbed_long = 10.0;          // s, after which a magnet may have come or gone
constexpr double longest = 120.0;                // s after which a magnet that came later would have shown

HeadingSettings with_magnet(HeadingSettings settings) {
    settings.hard_iron_std = std::max(settings.hard_iron_std, settings.magnet_std);
    return settings;
}

}  // namespace

MagnetWatch::MagnetWatch(const HeadingSettings& settings, const TiltSettings& tilt, bool six_axis) : settings_(settings) {
    if (!six_axis) magnet_.emplace(with_magnet(settings), tilt, six_axis);
}

void MagnetWatch::share(const HeadingChannel& heading) {
    if (magnet_) magnet_->share_samples(heading);
}

void MagnetWatch::close(HeadingChannel& heading, const Block& block, const Eigen::Vector3d& bias, Counters& counters) {
    if (!heading.started()) {
        if (magnet_) magnet_->close(block, bias, counters);
        return;
    }
    age_ += block.duration;
    if (!magnet_) {
        if (heading.disturbed_for() < disturbed_long || age_ < disturbed_long) return;
        magnet_ = heading;
        magnet_->doubt_iron(std::max(settings_.magnet_std, heading.unexplained()));
        begin_ = heading.evidence();
        age_ = 0.0;
        return;
    }
    Counters unheard;
    magnet_->close(block, bias, unheard);
    const double ahead = magnet_->evidence() - (heading.evidence() - begin_);
    if (ahead > clearly) {
        heading.adopt(*magnet_);
        ++counters.magnets;
    } else if (magnet_->hard_iron_std() > settings_.hard_iron_std && age_ < longest) {
        return;                                  // undecided: it has not turned enough
    }
    magnet_.reset();
    age_ = 0.0;
}

}  // namespace schuler::ahrs
