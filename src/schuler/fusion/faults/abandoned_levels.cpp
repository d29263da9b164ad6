#include "schuler/fusion/faults/abandoned_levels.h"

#include "schuler/filter/integrity/refused_fixes.h"

#include <algorithm>
#include <optional>

namespace schuler::fusion {
namespace {

using filter::AidKind;
using filter::AidRecord;
using filter::AidStatus;
using filter::IntegrityTest;

}  // namespace

std::vector<AbandonedLevel> abandoned_levels(const filter::Result& forward) {
    constexpr double interruption = 5.0;  // s
    std::vector<AbandonedLevel> out;
    std::optional<AbandonedLevel> now;  // the level since the last interruption, up to its first jump
    std::optional<Time> before;
    AidRecord first{};
    bool jumped = false, possible = false;
    int given_up = 0;
    Eigen::Vector3d refused = Eigen::Vector3d::Zero();  // last innovation: this level minus the other
    const auto close = [&] {
        if (now && given_up == 1 && possible) out.push_back(*now);
        given_up = 0;
        jumped = possible = false;
    };
    auto alert = forward.alerts.begin();
    for (const AidRecord& fix : forward.aids) {
        if (fix.kind != AidKind::GnssPosition) continue;
        const bool used = fix.status == AidStatus::Accepted;
        if (used && (!before || (fix.stamp - *before).seconds() > interruption)) {
            close();
            now = AbandonedLevel{fix.stamp, fix.stamp, 0.0};
            first = fix;
            if (!before) first.sigma.setZero();  // nothing was known
        }
        for (; alert != forward.alerts.end() && alert->time <= fix.stamp; ++alert) {
            if (alert->kind != AidKind::GnssPosition) continue;
            if (alert->test == IntegrityTest::Jump && now && !jumped) {
                now->size = alert->size;
                jumped = true;
                possible = filter::favours_first(first.innovation, refused, first.sigma) < filter::decisive_levels;
            }
            given_up += alert->test == IntegrityTest::OtherLevel ? 1 : 0;
        }
        if (fix.status == AidStatus::Rejected) refused = fix.innovation;
        if (!used) continue;
        before = fix.stamp;
        if (now && !jumped) now->last = fix.stamp;
    }
    close();
    return out;
}

std::size_t withhold(std::vector<filter::Event>& events, const std::vector<AbandonedLevel>& levels) {
    std::size_t n = 0;
    for (filter::Event& e : events) {
        if (e.kind != AidKind::GnssPosition || e.withheld) continue;
        e.withheld =
            std::ranges::any_of(levels, [&](const AbandonedLevel& l) { return e.stamp >= l.first && e.stamp <= l.last; });
        n += e.withheld ? 1 : 0;
    }
    return n;
}

}  // namespace schuler::fusion
