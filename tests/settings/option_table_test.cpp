#include "schuler/core/units.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/toml_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>

namespace schuler::settings {
namespace {

Config parsed(const std::string& text) {
    return config_from(config_table().read(parse_toml(text, "dataset.toml"), "dataset.toml"));
}

std::string complaint_of(const std::string& text) {
    try {
        (void)parsed(text);
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::Input);
        return e.what();
    }
    return "no error";
}

/// A file in which the key stands alone with a value that would do if the key were known.
std::string file_with(const std::string& key) {
    const auto dot = key.rfind('.');
    if (dot == std::string::npos) return key + " = 1\n";
    return "[" + key.substr(0, dot) + "]\n" + key.substr(dot + 1) + " = 1\n";
}

TEST(OptionTable, EveryMisspeltKeyIsRejectedWithTheRightSuggestion) {
    std::mt19937 random(7);
    const std::vector<std::string> keys = config_table().keys();
    ASSERT_GT(keys.size(), 100u);
    for (const std::string& key : keys) {
        // swap two unlike neighbours somewhere in the name, and separately drop one letter
        const std::size_t begin = key.rfind('.') == std::string::npos ? 0 : key.rfind('.') + 1;
        std::vector<std::size_t> places;
        for (std::size_t i = begin; i + 1 < key.size(); ++i) {
            if (key[i] != key[i + 1]) places.push_back(i);
        }
        const std::size_t at = places[random() % places.size()];
        std::string swapped = key, dropped = key;
        std::swap(swapped[at], swapped[at + 1]);
        dropped.erase(at, 1);
        for (const std::string& bad : {swapped, dropped}) {
            if (config_table().find(bad) != nullptr) continue;
            const std::string message = complaint_of(file_with(bad));
            EXPECT_NE(message.find("dataset.toml:" + std::string(begin > 0 ? "2" : "1") + ": " + bad + ": unknown key"),
                      std::string::npos)
                << message;
            // two keys can be equally near to a misspelt one (std_vn, std_ve without their last letter; loop, loose for looe): either
            const std::size_t hint = message.find("did you mean ");
            ASSERT_NE(hint, std::string::npos) << message;
            std::string offered = message.substr(hint + 13, message.size() - hint - 14);
            if (offered == key || bad == swapped) {
                EXPECT_EQ(offered, key) << message;
            } else {
                const auto [there, here] = std::ranges::mismatch(offered, bad);  // one letter lacks or is another
                const std::string rest(there + 1, offered.end());
                EXPECT_TRUE(rest == std::string(here, bad.end()) || rest == std::string(here + 1, bad.end())) << message;
            }
        }
    }
}

TEST(OptionTable, NamesFileLineKeyAndMend) {
    const struct {
        const char* text;
        std::vector<const char*> parts;
    } cases[] = {
        {"[imu]\n\ngyro_bias_deg_h = \"3\"\n", {"dataset.toml:3: imu.gyro_bias_deg_h: is text", "number from 0 to"}},
        {"[imu]\ngyro_bias_deg_h = -1\n", {"dataset.toml:2", "-1 is out of range", "from 0 to"}},
        {"[imu]\ngyro_bias_deg_h = nan\n", {"out of range"}},
        {"[imu]\nkind = \"rate\"\n", {"unknown value \"rate\"", "\"rates\" or \"increments\""}},
        {"[imu]\naxes = \"fld\"\n", {"left-handed"}},
        {"[imu]\naxes = \"ffd\"\n", {"dataset.toml:2: imu.axes: ", "perpendicular"}},
        {"[imu]\ngrade = \"tactcal\"\n", {"unknown value \"tactcal\"", "tactical"}},
        {"[imu]\nmounting_deg = [0, 1]\n", {"three angles", "estimate"}},
        {"[gnss]\nlever_arm_m = [0, 0, 5000]\n", {"5000 is out of range", "-100 to 100"}},
        {"[gnss]\nlever_arm_m = [0, 0]\n", {"has 2 numbers"}},
        {"[mag]\nheading_deviation_deg = -1\n", {"dataset.toml:2", "-1 is out of range", "from 0 to 90"}},
        {"[gnss]\nlatency_s = \"guess\"\n", {"is not a latency"}},
        {"[gnss]\nfix_codes = { 1 = \"fixed\" }\n", {"unknown fix type \"fixed\"", "rtk_fixed"}},
        {"[time]\ndate = 2025-13-01\n", {"dataset.toml:2", "TOML"}},
        {"[time]\ndate = \"yesterday\"\n", {"is not a date"}},
        {"[filter]\nscheme = \"deeper\"\n", {"unknown value", "\"deep\""}},
        {"imu = 3\n", {"expected a section", "[imu]"}},
        {"[imu\n", {"dataset.toml:1", "not valid TOML"}},
        {"[imu]\nfile = \"a.csv\"\nfile = \"b.csv\"\n", {"dataset.toml:3", "not valid TOML"}},
        {"[[outage]]\nstart_s = 3\n", {"lacks start_s or duration_s"}},
        {"[[outage]]\nstart_s = 3\nduration_s = -2\n", {"not a positive number"}},
        {"[imu]\nscale = { gyro_x_rad_s = 0 }\n", {"not a usable factor"}},
    };
    for (const auto& c : cases) {
        const std::string message = complaint_of(c.text);
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        for (const char* part : c.parts) EXPECT_NE(message.find(part), std::string::npos) << c.text << " -> " << message;
    }
}

TEST(OptionTable, UnitsReachTheSettings) {
    const Config c = parsed(
        "[vehicle]\nkind = \"car\"\n[imu]\naxes = \"flu\"\ngrade = \"mems\"\ngyro_noise_deg_sqrt_h = 0.3\naccel_bias_mg = 2.0\n"
        "mounting_deg = [1, -2, 180]\n[gnss]\nlatency_s = 0.25\nheight = \"msl\"\nfix_codes = { 1 = \"rtk_fixed\" }\n"
        "columns = { height_m = \"height_msl_m\" }\n[initial]\nheading_deg = 90\n");
    EXPECT_NEAR(c.filter.imu.errors.gyro_noise, 0.3 * M_PI / 180 / 60, 1e-18);  // 0.3 deg/sqrt(h) = 8.7266e-5 rad/sqrt(s)
    EXPECT_NEAR(c.filter.imu.errors.accel_bias, 0.0196133, 1e-12);
    EXPECT_NEAR(c.filter.imu.mounting_rpy.z(), M_PI, 1e-15);
    EXPECT_EQ(c.filter.imu.C_bs, Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix());
    EXPECT_EQ(c.filter.gnss.latency, 0.25);
    EXPECT_EQ(c.filter.gnss.height, fusion::HeightKind::Msl);
    EXPECT_EQ(c.fix_codes.at("1"), "rtk_fixed");
    EXPECT_EQ(c.gnss.columns.at("height_m"), "height_msl_m");
    EXPECT_TRUE(c.filter.constraints.nonholonomic);
    EXPECT_NEAR(c.filter.initial.rpy.z(), M_PI / 2, 1e-15);
    EXPECT_TRUE(std::isnan(c.filter.initial.rpy.x()));
}

TEST(OptionTable, GradeComesBeforeTheNumbersThatRefineItWhateverTheirOrder) {
    const Config c = parsed("[imu]\ngyro_bias_deg_h = 7\ngrade = \"navigation\"\n");
    EXPECT_NEAR(c.filter.imu.errors.gyro_bias, 7 * M_PI / 180 / 3600, 1e-15);
    EXPECT_NEAR(c.filter.imu.errors.accel_bias, 1e-5 * 9.80665, 1e-12);
    // a grade of a later layer speaks for all numbers of the earlier ones
    const SettingList base = config_table().read(parse_toml("[imu]\ngyro_bias_deg_h = 7\n", "a"), "a");
    const Config d = config_from(overlaid(base, {setting_from_text("imu.grade=navigation")}));
    EXPECT_NEAR(d.filter.imu.errors.gyro_bias, 0.003 * M_PI / 180 / 3600, 1e-15);
    // likewise an oscillator; in one layer its coefficients refine it
    const SettingList clock = config_table().read(parse_toml("[ranges]\nclock = \"tcxo\"\nclock_h0_s = 1e-21\n", "a"), "a");
    EXPECT_EQ(config_from(clock).filter.ranging.errors.clock.h0, 1e-21);
    EXPECT_EQ(config_from(clock).filter.ranging.errors.clock.h_minus2, sensor::tcxo.h_minus2);
    const Config e = config_from(overlaid(clock, {setting_from_text("ranges.clock=ocxo")}));
    EXPECT_EQ(e.filter.ranging.errors.clock.h0, sensor::ocxo.h0);
    EXPECT_EQ(e.filter.ranging.errors.clock.h_minus2, sensor::ocxo.h_minus2);
}

TEST(OptionTable, APresetOfALaterLayerSpeaksForItsStates) {
    const SettingList base = config_table().read(parse_toml("[filter]\nscale_factors = true\nmisalignments = true\n", "a"), "a");
    const auto with = [&](const std::string& more) { return config_from(overlaid(base, {setting_from_text(more)})).filter; };
    EXPECT_TRUE(config_from(base).filter.scale_factors);
    for (const char* preset : {"ins15", "complex22"}) {
        EXPECT_FALSE(with(std::string("filter.preset=") + preset).scale_factors) << preset;
        EXPECT_FALSE(with(std::string("filter.preset=") + preset).misalignments) << preset;
    }
    EXPECT_TRUE(with("filter.preset=ins21").scale_factors);
    // in one layer what is given by itself refines it
    EXPECT_TRUE(
        config_from(overlaid(base, {setting_from_text("filter.preset=ins15"), setting_from_text("filter.scale_factors=true")}))
            .filter.scale_factors);
    // a coupling by its name leaves the states alone
    EXPECT_EQ(with("filter.preset=tight").coupling, fusion::Coupling::Tight);
    EXPECT_EQ(with("filter.preset=aggressive").loose_kind, fusion::LooseKind::Aggressive);
    EXPECT_TRUE(with("filter.preset=tight").scale_factors);
}

// `simulate` writes a scheme into every dataset.toml.
TEST(OptionTable, APresetOfALaterLayerSpeaksForItsCoupling) {
    const SettingList base = config_table().read(parse_toml("[filter]\nscheme = \"loose\"\nloose = \"aggressive\"\n", "a"), "a");
    const auto with = [&](const char* more) { return config_from(overlaid(base, {setting_from_text(more)})); };
    EXPECT_EQ(with("filter.preset=tight").scheme, Scheme::Tight);
    EXPECT_EQ(with("filter.preset=gnss").scheme, Scheme::Gnss);
    EXPECT_EQ(with("filter.preset=loose").filter.loose_kind, fusion::LooseKind::Standard);
    EXPECT_EQ(with("filter.preset=ins15").filter.loose_kind, fusion::LooseKind::Aggressive);
    const SettingList tight = config_table().read(parse_toml("[filter]\npreset = \"tight\"\n", "a"), "a");
    EXPECT_EQ(config_from(overlaid(tight, {setting_from_text("filter.scheme=separate")})).scheme, Scheme::Separate);
}

TEST(OptionTable, AUnitWithoutNoiseMayRepeatItself) {
    EXPECT_TRUE(config_from({setting_from_text("imu.grade=perfect")}).filter.imu.noiseless);
    EXPECT_FALSE(config_from({setting_from_text("imu.grade=navigation")}).filter.imu.noiseless);
}

TEST(OptionTable, WhatWasUsedReadsBackTheSame) {
    std::mt19937_64 random(3);
    for (int run = 0; run < 50; ++run) {
        // every plain number gets an arbitrary value inside its range
        SettingList settings;
        for (const OptionSpec& spec : config_table().specs()) {
            const double low = std::isfinite(spec.low) ? spec.low : -1e3, high = std::isfinite(spec.high) ? spec.high : 1e3;
            std::uniform_real_distribution<double> inside(low, high);
            if (spec.shape == Shape::Number) settings.push_back({spec.key, {inside(random)}, {}});
            if (spec.shape == Shape::Numbers && spec.length == 3) {
                settings.push_back({spec.key, {ValueList{{inside(random)}, {inside(random)}, {inside(random)}}}, {}});
            }
        }
        settings.push_back(setting_from_text("imu.grade=mems"));
        settings.push_back(setting_from_text("gnss.fix_codes={ 5 = \"autonomous\", \"rtk 1\" = \"rtk_fixed\" }"));
        settings.push_back(setting_from_text("run.start_s=abs:12.5"));
        settings.push_back({"outage",
                            {ValueList{{ValueTable{{"start_s", {50.0}}, {"duration_s", {15.0}}}},
                                       {ValueTable{{"start_s", {std::string("abs:1e5")}}, {"duration_s", {1.0}}}}}},
                            {}});
        const Config first = config_from(settings);
        const std::string text = to_toml(config_table().used(first), config_table().specs(), true);
        const Config second = parsed(text);
        EXPECT_EQ(to_toml(config_table().used(second), config_table().specs(), true), text);
        EXPECT_EQ(first.filter.imu.errors.gyro_noise, second.filter.imu.errors.gyro_noise);  // to the last bit
        EXPECT_EQ(first.filter.initial.rpy, second.filter.initial.rpy);
        EXPECT_EQ(first.filter.initial.gyro_bias, second.filter.initial.gyro_bias);
        EXPECT_EQ(first.filter.mag.bias_std, second.filter.mag.bias_std);
        EXPECT_EQ(first.filter.mag.deviation_std, second.filter.mag.deviation_std);
        ASSERT_EQ(second.run.outages.size(), 2u);
        EXPECT_TRUE(second.run.outages[1].absolute);
        EXPECT_EQ(second.run.outages[1].start, 1e5);
    }
}

TEST(OptionTable, DeviationOfTheMagneticHeadingIsInDegrees) {
    EXPECT_DOUBLE_EQ(parsed("[mag]\nheading_deviation_deg = 4\n").filter.mag.deviation_std, 4.0 * units::deg);
    EXPECT_EQ(parsed("[mag]\nheading_deviation_deg = 0\n").filter.mag.deviation_std, 0.0);
}

TEST(OptionTable, NumbersOfTheBarometerAndTheMagnetometerAreFittedUnlessGiven) {
    using fusion::BaroSettings;
    using fusion::MagSettings;
    const Config bare = parsed("");
    EXPECT_TRUE(bare.filter.baro.fit_std && bare.filter.baro.fit_bias_walk && bare.filter.mag.fit_heading_std);
    EXPECT_FALSE(parsed("[baro]\nwhite_m = 1\n").filter.baro.fit_std);
    EXPECT_FALSE(parsed("[baro]\nbias_walk_m = 0.1\n").filter.baro.fit_bias_walk);
    const std::pair<const char*, bool MagSettings::*> keys[] = {{"heading_std_deg", &MagSettings::fit_heading_std},
                                                                {"heading_bias_walk_deg", &MagSettings::fit_bias_walk},
                                                                {"heading_deviation_deg", &MagSettings::fit_deviation},
                                                                {"heading_disturbance_deg", &MagSettings::fit_disturbance}};
    for (const auto& [key, fitted] : keys) {
        const Config given = parsed("[mag]\n" + std::string(key) + " = 2\n");
        for (const auto& [other, member] : keys) EXPECT_EQ(given.filter.mag.*member, other != key) << key << ", " << other;
    }
}

TEST(OptionTable, DefaultsAreInsideTheirOwnRanges) {
    const SettingList defaults = config_table().used(Config{});
    EXPECT_GT(defaults.size(), 60u);
    EXPECT_NO_THROW((void)config_from(defaults));
    for (const OptionSpec& spec : config_table().specs()) {
        EXPECT_FALSE(spec.help.empty()) << spec.key;
        EXPECT_EQ(spec.help.find('\n'), std::string::npos) << spec.key;
    }
}

TEST(OptionTable, NumbersForPeopleAreShort) {
    EXPECT_EQ(shown({0.5729577951308232}), "0.572958");
    EXPECT_EQ(shown({50.00000000000001}), "50.0");
    EXPECT_EQ(shown({55.8114694}), "55.8114694");  // as it was set
    EXPECT_EQ(shown({7.292115e-05}), "7.292115e-05");
    EXPECT_EQ(shown({ValueList{{1.7188733853924696}, {std::string("x")}, {true}}}), "[1.71887, \"x\", true]");
    EXPECT_EQ(shown({std::int64_t{1234567890123456}}), "1234567890123456");
    EXPECT_EQ(to_toml({0.5729577951308232}), "0.5729577951308232");  // a file repeats the run
}

TEST(OptionTable, GradesMayBeSpeltInCapitalsAndWithHyphens) {
    for (const char* name : {"hg9900", "HG9900", "HG-9900", "hg_9900"})
        EXPECT_NEAR(parsed(std::string("[imu]\ngrade = \"") + name + "\"\n").filter.imu.errors.gyro_bias,
                    0.003 * M_PI / 180 / 3600, 1e-15)
            << name;
    EXPECT_NE(complaint_of("[imu]\ngrade = \"hg990\"\n").find("\"hg9900\""), std::string::npos);
    EXPECT_NE(complaint_of("[output]\nfiles = [\"SUMMARY\"]\n").find("unknown value"),
              std::string::npos);  // other choices are exact
}

TEST(CommandLine, OutagesAndTimes) {
    const auto spans = outages_from_text("50:15,abs:413219.5:20");
    ASSERT_EQ(spans.size(), 2u);
    EXPECT_EQ(spans[0].start, 50.0);
    EXPECT_FALSE(spans[0].absolute);
    EXPECT_EQ(spans[1].start, 413219.5);
    EXPECT_EQ(spans[1].duration, 20.0);
    EXPECT_TRUE(spans[1].absolute);
    for (const char* bad :
         {"", "50", "50:", ":5", "50:0", "50:-3", "a:b", "50:15,", "50:15;60:15", "nan:3", "abs:5", "1e400:2"}) {
        EXPECT_THROW((void)outages_from_text(bad), Error) << bad;
    }
    EXPECT_THROW((void)run_time_from_text("abs:", "--start"), Error);
    EXPECT_THROW((void)setting_from_text("imu.grade"), Error);
    EXPECT_THROW((void)setting_from_text("imu=3"), Error);
    EXPECT_THROW((void)setting_from_text("imu.gradd=mems"), Error);
}

TEST(Axes, ColumnsAreTheSensorAxesInForwardRightDown) {
    Eigen::Matrix3d fur;
    fur << 1, 0, 0, 0, 0, 1, 0, -1, 0;  // x forward, y up, z right
    EXPECT_EQ(axes_from_text("fur"), fur);
    EXPECT_EQ(axes_from_text("x=backward, y=right, z=up"), Eigen::Vector3d(-1, 1, -1).asDiagonal().toDenseMatrix());
    for (const char* bad : {"", "frr", "fru", "x=forward", "x=forward, y=sideways, z=up", "fr"})
        EXPECT_THROW((void)axes_from_text(bad), Error) << bad;
}

}  // namespace
}  // namespace schuler::settings
