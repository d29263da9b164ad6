// An aircraft that flies straight and whose heading is unknown: the smoother, which replays the run with other outputs.
#include "fusion/car_drive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace schuler::fusion {
namespace {

using namespace testing;

TEST(UnknownHeading, LeavesTheSmootherSigmasBelowThoseOfTheFilter) {
    Drive d;
    d.scenario = town_drive(5, 2.0, 180.0);
    d.scenario.path = sim::GreatCirclePath{{50.4 * deg, 30.5 * deg, 150.0}, 1.3, 8.0};
    d.scenario.gnss.white_position = {0.02, 0.02, 0.04};
    d.recording = sim::simulate(d.scenario).recording;
    for (GnssFix& f : d.recording.gnss) f.std_position = {0.02, 0.02, 0.04};
    d.settings = settings_of(d.scenario);
    d.settings.vehicle = VehicleKind::Air;
    d.settings.output_rate = 7.0;  // outputs that are no whole intervals of the covariance
    d.settings.outages = {{60.0, 15.0}, {110.0, 15.0}};
    give_start(d.settings, d.recording, 5);
    d.settings.initial.std_rpy.z() = 0.8;
    d.settings.smooth = true;
    const Result r = fuse(d.recording, d.settings);
    ASSERT_EQ(r.smoothed.rows.size(), r.forward.rows.size());
    ASSERT_GT(r.forward.rows.back().std_rpy.z(), 0.3);  // straight motion tells no heading
    for (std::size_t i = 0; i < r.smoothed.rows.size(); ++i) {
        const SolutionRow &s = r.smoothed.rows[i], &f = r.forward.rows[i];
        for (int k = 0; k < 3; ++k) {
            ASSERT_GT(s.std_position(k), 1e-3) << i;
            ASSERT_GT(s.std_velocity(k), 1e-5) << i;
            ASSERT_LT(s.std_position(k), 1.001 * f.std_position(k)) << i;
        }
    }
}

}  // namespace
}  // namespace schuler::fusion
