#include "schuler/solution/course.h"

#include "schuler/core/units.h"
#include "schuler/filter/states/model.h"
#include "schuler/filter/stream/event_maker.h"
#include "schuler/math/rotation.h"
#include "schuler/settings/config/config.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::solution {
namespace {

using units::deg;

/// Fixes twice a second of a body that moves at a speed and turns slowly.
LoadedDataset moving(double speed, fusion::VehicleKind kind) {
    LoadedDataset data;
    data.config.filter.vehicle = kind;
    Geodetic at{0.9, 0.5, 10.0};
    for (int i = 0; i < 240; ++i) {
        GnssFix fix;
        fix.time = Time::from_seconds(100.0 + 0.5 * i);
        fix.position = at;
        fix.std_position = Eigen::Vector3d::Constant(1.0);
        fix.fix = FixType::Autonomous;
        data.recording.gnss.push_back(fix);
        const double course = 1.0 + 0.002 * i;
        at = earth::moved_by_ned(data.config.filter.earth, at,
                                 0.5 * speed * Eigen::Vector3d(std::cos(course), std::sin(course), 0.0));
    }
    data.origin = data.recording.gnss.front().time;
    return data;
}

TEST(Course, IsTheHeadingOfAShipWithinItsLeeway) {
    LoadedDataset data = moving(6.0, fusion::VehicleKind::Ship);
    use_course(data);
    const auto& headings = data.recording.heading;
    ASSERT_EQ(headings.size(), 14U);  // chords of 8 s in 119.5 s
    for (const HeadingSample& h : headings) {
        const double t = (h.time - data.origin).seconds();
        EXPECT_NEAR(math::wrap_pi(h.heading - (1.0 + 0.004 * t)), 0.0, 2e-3);  // a chord has the direction of its middle
        EXPECT_NEAR(h.std, std::hypot(4.0 * deg, std::sqrt(2.0) / 48.0), 1e-3);
    }
    EXPECT_TRUE(data.config.filter.heading.by_course);
    EXPECT_NEAR(data.config.filter.heading.offset_std, std::hypot(8.0 * deg, 0.5 / 6.0), 1e-3);
}

TEST(Course, IsNotUsedOtherwise) {
    for (const auto& [speed, kind] : {std::pair{6.0, fusion::VehicleKind::Car}, std::pair{6.0, fusion::VehicleKind::Hand},
                                      std::pair{0.5, fusion::VehicleKind::Ship}}) {
        LoadedDataset data = moving(speed, kind);
        use_course(data);
        EXPECT_TRUE(data.recording.heading.empty());
        EXPECT_FALSE(data.config.filter.heading.by_course);
    }
    LoadedDataset without = moving(6.0, fusion::VehicleKind::Ship);
    without.config.leeway = 0.0;
    use_course(without);
    EXPECT_TRUE(without.recording.heading.empty());
    LoadedDataset compass = moving(6.0, fusion::VehicleKind::Ship);
    compass.recording.heading.push_back({compass.origin, 0.3, 0.01});
    use_course(compass);
    EXPECT_EQ(compass.recording.heading.size(), 1U);
    EXPECT_FALSE(compass.config.filter.heading.by_course);
}

TEST(Course, ContraryVelocitiesAreNone) {
    LoadedDataset data = moving(6.0, fusion::VehicleKind::Ship);
    for (GnssFix& fix : data.recording.gnss) fix.velocity_n = Eigen::Vector3d(6.0 * std::cos(2.5), 6.0 * std::sin(2.5), 0.0);
    use_course(data);
    EXPECT_TRUE(data.recording.heading.empty());  // the track turns from 1.0 to 1.5 rad
}

TEST(Course, TheReportedHeadingHasItsLeeway) {
    fusion::Settings settings;
    settings.heading.offset_std = 0.1;
    for (const bool by_course : {false, true}) {
        settings.heading.by_course = by_course;
        filter::Sensors sensors{};
        sensors.heading = true;
        const filter::InertialModel model = filter::make_model(settings, filter::layout_with(settings, sensors));
        filter::InertialFilter<filter::GeographicFrame> f(model);
        NavState somewhere;
        somewhere.position = {0.9, 0.5, 10.0};
        f.set_nav(somewhere);
        const filter::Matrix9 P = filter::reported_covariance(model, f, filter::Matrix9::Zero());
        EXPECT_NEAR(P(8, 8), by_course ? 0.01 : 0.0, 1e-12);
        EXPECT_EQ(P.block(0, 0, 8, 8).norm(), 0.0);
    }
}

TEST(Course, IsWithheldWithTheFixesItIsMadeOf) {
    fusion::Settings settings;
    settings.outages = {{20.0, 10.0}};
    settings.heading.by_course = true;
    const filter::EventMaker maker(settings, Time::from_seconds(100.0));
    const auto due = [&](double t) { return maker.is_due(HeadingSample{Time::from_seconds(100.0 + t), 1.0, 0.1}); };
    EXPECT_TRUE(due(12.9));
    EXPECT_FALSE(due(14.0));  // its later fix
    EXPECT_FALSE(due(25.0));
    EXPECT_FALSE(due(36.0));  // its earlier one
    EXPECT_TRUE(due(37.1));
    settings.heading.by_course = false;
    EXPECT_TRUE(due(25.0));
}

}  // namespace
}  // namespace schuler::solution
