// Observability along a path against what is known of inertial navigation (Groves, Principles of GNSS, Inertial, and Multisensor
// Integrated Navigation Systems, 14.2.1): at rest a level accelerometer bias cannot be told from a tilt, nor an east gyro bias from a heading
// error; turns and changes of speed separate them.
#include "schuler/study/covariance/path_observability.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/settings/toml_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

namespace schuler::study {
namespace {

using Eigen::Vector3d;

PathObservability along(const std::string& trajectory, const std::string& more = "") {
    const std::string text =
        "duration_s = 300\n[trajectory]\nstart = { lat_deg = 45, lon_deg = 10, height_m = 500 }\n" + trajectory +
        "\n[imu]\nrate_hz = 50\ngrade = \"navigation\"\n[gnss]\nrate_hz = 1\n"
        "[filter]\ninitial_error = { level_deg = 0.1, heading_deg = 1, position_m = 1, velocity_m_s = 0.1 }\nscale_factors = false\nmisalignments = false\n" +
        more;
    return path_observability(
        settings::scenario_from(settings::scenario_table().read(settings::parse_toml(text, "s.toml"), "s.toml")), {}, 10.0);
}

Eigen::Index index_of(const PathObservability& p, const char* name) {
    const auto it = std::ranges::find(p.names, name, &StateName::name);
    if (it == p.names.end()) throw std::runtime_error(std::string("no state ") + name);
    return it - p.names.begin();
}
const Observed& of(const PathObservability& p, const char* name) { return p.states[static_cast<std::size_t>(index_of(p, name))]; }

constexpr double latitude = 45.0 * units::deg;

constexpr const char* at_rest = "type = \"static\"\nheading_deg = 0\n";
constexpr const char* in_turns = "type = \"racetrack\"\nspeed_m_s = 60\n";

TEST(PathObservability, RestLeavesTheClassicalPairs) {
    const PathObservability p = along(at_rest);
    // Together they make the specific force that is measured: each alone keeps what the other may be.
    EXPECT_GT(of(p, "accel_bias_x").left, 0.9);
    EXPECT_GT(of(p, "accel_bias_y").left, 0.9);
    EXPECT_LT(of(p, "accel_bias_z").left, 0.3);
    EXPECT_LT(of(p, "attitude_north").left, 0.3);
    // Gyrocompassing: the heading is as good as the gyro that points east, which stays as uncertain as it was.
    const double east_bias = p.start(index_of(p, "gyro_bias_y")), level_rate = 7.292115e-5 * std::cos(latitude);
    const double heading = of(p, "attitude_down").left * p.start(index_of(p, "attitude_down"));
    EXPECT_GT(heading, east_bias / level_rate);
    EXPECT_LT(heading, 1.5 * east_bias / level_rate);  // the noise of five minutes comes on top
    EXPECT_GT(of(p, "gyro_bias_y").left, 0.9);
    EXPECT_LT(of(p, "gyro_bias_x").left, 0.9);
    EXPECT_EQ(of(p, "attitude_north").manoeuvre(), Manoeuvre::Rest);
    EXPECT_DOUBLE_EQ(of(p, "attitude_north").shares[static_cast<std::size_t>(Manoeuvre::Turn)], 0.0);
}

TEST(PathObservability, TurnsSeparateThem) {
    const PathObservability p = along(in_turns);
    for (const char* name : {"accel_bias_x", "accel_bias_y", "attitude_down"}) {
        EXPECT_LT(of(p, name).left, 0.5) << name;
        EXPECT_EQ(of(p, name).manoeuvre(), Manoeuvre::Turn) << name;
        EXPECT_GT(of(p, name).half_s, 1.0) << name;
        EXPECT_EQ(of(p, name).shares[static_cast<std::size_t>(Manoeuvre::Rest)], 0.0) << "it never rests";
    }
}

TEST(PathObservability, SharesAddUpAndCombinationsAreUncorrelated) {
    const PathObservability p = along(in_turns);
    ASSERT_EQ(p.combinations.size(), p.names.size());
    for (const auto* list : {&p.states, &p.combinations})
        for (const Observed& o : *list) {
            if (o.left > 0.999) continue;
            EXPECT_NEAR(std::accumulate(o.shares.begin(), o.shares.end(), 0.0), 1.0, 1e-9);
            EXPECT_NEAR(std::inner_product(o.weights.begin(), o.weights.end(), o.weights.begin(), 0.0), 1.0, 1e-9);
        }
    EXPECT_TRUE(std::ranges::is_sorted(p.combinations, {}, &Observed::left));
    EXPECT_EQ(p.refused, 0U);
}

TEST(PathObservability, KnowsManoeuvres) {
    EXPECT_EQ(manoeuvre_of({0.0, 0.0, 0.0}, Vector3d::Zero(), 0.0), Manoeuvre::Rest);
    EXPECT_EQ(manoeuvre_of({10.0, 0.0, 0.0}, Vector3d::Zero(), 0.0), Manoeuvre::Straight);
    EXPECT_EQ(manoeuvre_of({10.0, 0.0, -2.0}, Vector3d::Zero(), 0.0), Manoeuvre::Climb);
    EXPECT_EQ(manoeuvre_of({10.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}, 0.0), Manoeuvre::SpeedChange);
    EXPECT_EQ(manoeuvre_of({10.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 0.0), Manoeuvre::Turn);
    EXPECT_EQ(manoeuvre_of({0.0, 0.0, 0.0}, Vector3d::Zero(), 5.0 * units::deg), Manoeuvre::Turn);
}

TEST(PathObservability, IsThatOfTheSameMeasurementsInAnyScheme) {
    const PathObservability loose = along(in_turns), separate = along(in_turns, "scheme = \"separate\"\n");
    EXPECT_EQ(loose.scheme, "");
    EXPECT_EQ(separate.scheme, "loose");
    EXPECT_EQ(of(separate, "accel_bias_x").left, of(loose, "accel_bias_x").left);
    try {
        (void)along(in_turns, "scheme = \"gnss\"\n");
        FAIL() << "there is no filter";
    } catch (const Error& e) {
        EXPECT_EQ(e.place().key, "filter.scheme");
    }
}

}  // namespace
}  // namespace schuler::study
