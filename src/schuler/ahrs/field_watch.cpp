#include "schuler/ahrs/field_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace schuler::ahrs {
namespace {

constexpr double clearly = 3.0;          // logarithm of the odds: 20 to 1
constexpr double better = 1.0;           // the same, of one hypothesis relative to the other
constexpr double told_apart = 0.5;       // rad of rotation, without which a magnet and a new place cannot be separated
constexpr double disturbed_long = 10.0;  // s, after which a magnet may have been attached or removed
constexpr double longest = 120.0;        // s after which a later magnet would have been detected, and a tie is accepted

HeadingSettings with_magnet(HeadingSettings settings) {
    settings.hard_iron_std = std::max(settings.hard_iron_std, settings.magnet_std);
    return settings;
}

}  // namespace

FieldWatch::FieldWatch(const HeadingSettings& settings, const TiltSettings& tilt, bool six_axis) : settings_(settings) {
    if (!six_axis) magnet_.emplace(with_magnet(settings), tilt, six_axis);
}

void FieldWatch::share(const HeadingChannel& heading) {
    if (magnet_) magnet_->share_samples(heading);
    if (place_) place_->share_samples(heading);
}

void FieldWatch::close(HeadingChannel& heading, const Block& block, const Eigen::Vector3d& bias, Counters& counters) {
    if (!heading.started()) {
        if (magnet_) magnet_->close(block, bias, counters);
        return;
    }
    age_ += block.duration;
    if (!(block.rest_time > 0.0)) turned_ += block.turned;
    if (!magnet_) {
        if (heading.disturbed_for() < disturbed_long || age_ < disturbed_long) return;
        magnet_ = place_ = heading;
        magnet_->doubt_iron(std::max(settings_.magnet_std, heading.unexplained()));
        place_->doubt_place(heading.unexplained());
        begin_ = heading.evidence();
        age_ = turned_ = 0.0;
        return;
    }
    Counters unheard;
    const double own = heading.evidence() - begin_;
    magnet_->close(block, bias, unheard);
    const double magnet = magnet_->evidence() - own;
    double place = -std::numeric_limits<double>::infinity();
    if (place_) {
        place_->close(block, bias, unheard);
        place = place_->evidence() - own;
    }
    if (std::max(magnet, place) > clearly) {
        if (std::abs(magnet - place) < better || (place_ && turned_ < told_apart)) {
            if (age_ < longest) return;
            // a change occurred whose cause is unknown: both are possible
            heading.doubt_iron(std::max(settings_.magnet_std, heading.unexplained()));
            heading.doubt_place(heading.unexplained());
            ++counters.recoveries;
        } else {
            heading.adopt(magnet > place ? *magnet_ : *place_);
            ++(magnet > place ? counters.magnets : counters.recoveries);
        }
    } else if (magnet_->hard_iron_std() > settings_.hard_iron_std && age_ < longest) {
        return;  // undecided: insufficient rotation
    }
    place_.reset();
    magnet_.reset();
    age_ = 0.0;
}

}  // namespace schuler::ahrs
