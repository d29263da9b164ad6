// One resolution for what is given and what is not, and what is written of it.
#include "schuler/settings/facts.h"
#include "schuler/core/units.h"
#include "schuler/dataset/recognise.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/dataset.h"
#include "schuler/settings/units_of_keys.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/ignored.h"
#include "schuler/solution/provenance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace schuler::solution {
namespace {

namespace fs = std::filesystem;

TEST(Facts, ValuesGoBothWays) {
    for (const FactValue& value : {FactValue(0.12), FactValue(std::string("frd")), FactValue(std::vector<double>{1.0, 2.0, 3.0}),
                                   FactValue(std::map<std::string, double>{{"accel_m_s2", 9.8}}),
                                   FactValue(std::map<std::string, std::string>{{"3", "autonomous"}}), FactValue(true)})
        EXPECT_EQ(settings::fact_value_of(settings::value_of(value)), value) << to_text(value);
}

TEST(Facts, GivenTablesAreCompletedNotReplaced) {
    const settings::SettingList found{
        {"imu.scale", settings::value_of(std::map<std::string, double>{{"accel_m_s2", 9.8}, {"gyro_rad_s", 2.0}}), {}},
        {"imu.axes", settings::value_of(std::string("flu")), {}}};
    const settings::SettingList given{{"imu.scale", settings::value_of(std::map<std::string, double>{{"gyro_rad_s", 3.0}}), {}},
                                      {"imu.axes", settings::value_of(std::string("frd")), {}}};
    const settings::Config c = settings::config_from(settings::completed(found, given));
    EXPECT_EQ(c.imu.scale.at("accel_m_s2"), 9.8);
    EXPECT_EQ(c.imu.scale.at("gyro_rad_s"), 3.0);
    EXPECT_EQ(c.axes, "frd");
}

TEST(Facts, UnitsAreThoseOfTheKeys) {
    EXPECT_EQ(settings::unit_of_key("imu.gyro_noise_deg_sqrt_h").plain, "deg/sqrt(h)");
    EXPECT_EQ(settings::unit_of_key("gnss.latency_s").plain, "s");
    EXPECT_EQ(settings::unit_of_key("gnss.default_std_velocity_m_s").plain, "m/s");
    EXPECT_EQ(settings::unit_of_key("imu.axes").plain, "");
}

TEST(Facts, WhatWasInForceLeavesNothingToFind) {
    settings::Config c;
    c.filter.imu.estimate_mounting = c.filter.imu.estimate_noise = c.filter.gnss.estimate_latency = true;
    auto settings = std::make_shared<fusion::Settings>(c.filter);
    settings->gnss.latency = 0.125;
    settings->imu.mounting_rpy = Eigen::Vector3d(1.0, 2.0, 3.0) * units::deg;
    settings->imu.errors.gyro_noise = 2e-4;
    settings->imu.found_mounting_std = 0.25 * units::deg;
    settings->baro.std = 0.7;
    fusion::Findings findings;
    findings.in_force = settings;
    take_in_force(c, findings);
    EXPECT_FALSE(c.filter.imu.estimate_mounting || c.filter.imu.estimate_noise || c.filter.gnss.estimate_latency ||
                 c.filter.gnss.estimate_std);
    const settings::Config again =
        settings::config_from(settings::config_table().used(c));  // through the words of a settings file
    EXPECT_EQ(again.filter.gnss.latency, 0.125);
    EXPECT_EQ(again.filter.imu.mounting_rpy, settings->imu.mounting_rpy);
    EXPECT_EQ(again.filter.imu.errors.gyro_noise, 2e-4);
    EXPECT_EQ(again.filter.imu.found_mounting_std, 0.25 * units::deg);
    EXPECT_EQ(again.filter.baro.std, 0.7);
    EXPECT_FALSE(again.filter.imu.estimate_noise);
}

TEST(Facts, WhatHasNoEffectIsNamed) {
    ResultBundle b;
    b.data.config = settings::config_from({settings::setting_from_text("filter.aggressive_parts=5"),
                                           settings::setting_from_text("baro.white_m=3"),
                                           settings::setting_from_text("gnss.lever_arm_m=[1,2,3]"),
                                           settings::setting_from_text("filter.feedback_attitude_deg=0.0572957795130823")});
    const std::vector<Ignored> ignored = ignored_of(b, {"filter.aggressive_parts", "baro.white_m", "gnss.lever_arm_m"});
    ASSERT_EQ(ignored.size(), 2u);
    EXPECT_EQ(ignored[0].key, "baro.white_m");
    EXPECT_EQ(ignored[1].key, "filter.aggressive_parts");
    EXPECT_FALSE(ignored[1].reason.empty());
    // a preset that is refined still has its effect, one of which nothing is left has none
    const auto named = [](const char* preset, const char* more) {
        ResultBundle with;
        with.data.config = settings::config_from({settings::setting_from_text(preset), settings::setting_from_text(more)});
        return ignored_of(with, {"filter.preset"}).size();
    };
    EXPECT_EQ(named("filter.preset=complex22", "filter.scale_factors=true"), 0u);
    EXPECT_EQ(named("filter.preset=ins21", "filter.scale_factors=true"), 0u);
    EXPECT_EQ(named("filter.preset=ins21", "filter.scale_factors=false"), 1u);
    EXPECT_EQ(named("filter.preset=gravity27", "filter.scale_factors=false"), 1u);
}

class Resolution : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) /
                  (std::string("schuler_resolution_") + testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        std::string imu = "time_s,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\n";  // in g, z up, as the names do not say
        for (int i = 0; i <= 600; ++i)
            imu += fmt::format("{:.1f},0.001,0.002,0.00{},0.01,0.02,0.99{}\n", 1000 + 0.1 * i, i % 7 + 1, i % 5);
        write("imu.csv", imu);
        std::string gnss = "time_s,lat_deg,lon_deg,height_msl_m\n";
        for (int i = 0; i <= 58; ++i) gnss += fmt::format("{}.0,50.0,10.0,300\n", 1001 + i);
        write("gnss.csv", gnss);
    }
    void TearDown() override { fs::remove_all(folder_); }
    void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }

    fs::path folder_;
};

TEST_F(Resolution, ADescriptionThatNamesTheFilesIsCompletedAsTheFolder) {
    const settings::Config bare = settings::config_from(settings::open_dataset(folder_).settings);
    write("dataset.toml", "[imu]\nfile = \"imu.csv\"\n[gnss]\nfile = \"gnss.csv\"\nlever_arm_m = [1, 2, 3]\n");
    const settings::Dataset d = settings::open_dataset(folder_);
    const settings::Config said = settings::config_from(d.settings);
    EXPECT_EQ(said.axes, bare.axes);
    EXPECT_EQ(said.axes, "flu");
    EXPECT_EQ(said.imu.scale, bare.imu.scale);
    EXPECT_EQ(said.filter.vehicle, bare.filter.vehicle);
    EXPECT_EQ(said.filter.gnss.height, fusion::HeightKind::Msl);
    EXPECT_EQ(said.filter.gnss.lever_arm_b, Eigen::Vector3d(1, 2, 3));
    EXPECT_TRUE(d.given.contains("gnss.lever_arm_m") && !d.given.contains("imu.axes"));
}

TEST_F(Resolution, ADescriptionThatNamesNothingIsTheFolder) {
    write("dataset.toml", "[gnss]\nlever_arm_m = [1, 2, 3]\n");
    const settings::Config c = settings::config_from(settings::open_dataset(folder_).settings);
    EXPECT_EQ(c.imu.file, "imu.csv");
    EXPECT_EQ(c.axes, "flu");
    EXPECT_EQ(c.filter.gnss.lever_arm_b, Eigen::Vector3d(1, 2, 3));
}

TEST_F(Resolution, TheCommandLineGivesToo) {
    const settings::Dataset d =
        settings::open_dataset(folder_, dataset::Needs::ImuAndGnss, {settings::setting_from_text("imu.axes=frd")});
    EXPECT_EQ(settings::config_from(d.settings).axes, "frd");
    EXPECT_TRUE(d.given.contains("imu.axes"));
    EXPECT_TRUE(std::ranges::any_of(d.contradictions, [](const auto& c) { return c.key == "imu.axes"; })) << "it is upside down";
}

}  // namespace
}  // namespace schuler::solution
