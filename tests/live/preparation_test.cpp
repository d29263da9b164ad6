// What a sample is made into before the navigator gets it.
#include "schuler/live/station.h"

#include "schuler/settings/config/config.h"

#include <gtest/gtest.h>

namespace schuler::live {
namespace {

/// The field that the filter sees of what a magnetometer says, after the unit's own axes.
Eigen::Vector3d seen_by_the_filter(const std::string& imu_axes, const std::string& mag_axes, const Eigen::Vector3d& said) {
    LiveSettings settings;
    settings.config.filter.imu.C_bs = settings::axes_from_text(imu_axes);
    settings.config.mag_axes = mag_axes;
    Sample sample = MagSample{Time{}, said};
    const Station station{.input = Input(endpoint_from("stdin", Direction::In, "source"), [](const std::string&) {}),
                          .decoder = nullptr};
    Preparation{settings}(sample, station, Time{});
    return settings.config.filter.imu.C_bs * std::get<MagSample>(sample).field_b;
}

TEST(LivePreparation, AMagnetometerIsTurnedByItsOwnAxesOnce) {
    const Eigen::Vector3d field(1.0, 2.0, 3.0);  // right, forward, up
    const Eigen::Vector3d body(2.0, 1.0, -3.0);  // forward, right, down
    EXPECT_LT((seen_by_the_filter("rfu", "", field) - body).norm(), 1e-12);
    EXPECT_LT((seen_by_the_filter("frd", "rfu", field) - body).norm(), 1e-12);
    EXPECT_LT((seen_by_the_filter("flu", "rfu", field) - body).norm(), 1e-12);
    EXPECT_LT((seen_by_the_filter("frd", "", body) - body).norm(), 1e-12);
}

}  // namespace
}  // namespace schuler::live
