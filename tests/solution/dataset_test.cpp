#include "schuler/settings/dataset.h"
#include "schuler/app/commands.h"
#include "schuler/dataset/trajectory_file.h"
#include "schuler/inspect/inspect.h"
#include "schuler/io/formats.h"
#include "schuler/io/solution/solution_csv.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/kfgins_settings.h"
#include "schuler/settings/toml_file.h"
#include "schuler/solution/loaded_dataset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace schuler::solution {
namespace {

namespace fs = std::filesystem;

class DatasetTest : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) /
                  (std::string("schuler_dataset_") + testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }

    /// Ten seconds of IMU at 10 Hz and fixes at 1 Hz from t0 on.
    void write_logs(double t0 = 1000.0) const {
        std::string imu = "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n";
        for (int i = 0; i <= 100; ++i) imu += fmt::format("{:.1f},0.001,0.002,0.003,0.1,0.2,-9.8\n", t0 + 0.1 * i);
        std::string gnss = "time_s,lat_deg,lon_deg,height_m\n";
        for (int i = 0; i <= 8; ++i) gnss += fmt::format("{:.1f},50.0,10.0,{}\n", t0 + 1.0 + i, 300 + i);
        write("imu.csv", imu);
        write("gnss.csv", gnss);
    }

    [[nodiscard]] LoadedDataset load(const std::string& toml, const settings::SettingList& above = {}) const {
        write("dataset.toml", toml);
        const settings::Dataset d = settings::open_dataset(folder_);
        WarningLog warnings;
        LoadedDataset out = load_dataset(d, settings::config_from(settings::overlaid(d.settings, above)), warnings);
        warnings_ = warnings.summary();
        return out;
    }

    [[nodiscard]] std::string failure(const std::string& toml) const {
        try {
            (void)load(toml);
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), ErrorKind::Input);
            return e.what();
        }
        return "no error";
    }

    fs::path folder_;
    mutable std::vector<std::string> warnings_;
};

constexpr const char* plain = "[imu]\nfile = \"imu.csv\"\n[gnss]\nfile = \"gnss.csv\"\n";

TEST_F(DatasetTest, LoadsAndSettlesTimes) {
    write_logs();
    const LoadedDataset d = load(std::string(plain) +
                                 "[run]\nstart_s = 0.5\nstop_s = \"abs:1008\"\n[[outage]]\nstart_s = \"abs:1003\"\nduration_s = "
                                 "2\n[[outage]]\nstart_s = 4\nduration_s = 1\n");
    EXPECT_EQ(d.recording.imu.size(), 101u);
    EXPECT_EQ(d.origin, Time::from_seconds(1001.0));  // the first GNSS epoch
    EXPECT_EQ(*d.config.filter.start, Time::from_seconds(1001.5));
    EXPECT_EQ(*d.config.filter.stop, Time::from_seconds(1008.0));
    ASSERT_EQ(d.config.filter.outages.size(), 2u);
    EXPECT_DOUBLE_EQ(d.config.filter.outages[0].start, 2.0);
    EXPECT_DOUBLE_EQ(d.config.filter.outages[1].start, 4.0);
}

TEST_F(DatasetTest, APresetAboveSaysWhichStatesItSwitchesOff) {
    write_logs();
    const auto doubts_with = [&](const std::vector<const char*>& above) {
        write("dataset.toml", std::string(plain) + "[filter]\nscale_factors = true\nmisalignments = true\n");
        settings::SettingList list;
        for (const char* text : above) list.push_back(settings::setting_from_text(text));
        std::string all;
        for (const std::string& doubt : settings::open_dataset(folder_, dataset::Needs::ImuAndGnss, list).doubts)
            all += doubt + "\n";
        return all;
    };
    EXPECT_EQ(doubts_with({}).find("switches off"), std::string::npos);
    EXPECT_NE(doubts_with({"filter.preset=complex22"}).find("filter.scale_factors and filter.misalignments"), std::string::npos);
    EXPECT_NE(doubts_with({"filter.preset=ins21"}).find("switches off filter.misalignments"), std::string::npos);
    EXPECT_EQ(doubts_with({"filter.preset=tight"}).find("switches off"), std::string::npos);
    EXPECT_EQ(doubts_with({"filter.preset=ins15", "filter.scale_factors=true", "filter.misalignments=true"}).find("switches off"),
              std::string::npos);
}

TEST_F(DatasetTest, OnlyLatenciesThatWereNotGivenAreFound) {
    write_logs();
    EXPECT_TRUE(load(plain).config.filter.gnss.latency_found);
    for (const char* key : {"latency_s", "velocity_latency_s", "height_latency_s", "velocity_down_latency_s"})
        EXPECT_FALSE(load(fmt::format("{}{} = 0.1\n", plain, key)).config.filter.gnss.latency_found) << key;
}

TEST_F(DatasetTest, HeightsAboveSeaLevel) {
    write_logs();
    const LoadedDataset with = load(std::string(plain) + "height = \"msl\"\nundulation_m = 47.5\n");
    EXPECT_DOUBLE_EQ(with.recording.gnss.front().position.h, 347.5);
    EXPECT_EQ(with.config.filter.gnss.height, fusion::HeightKind::Ellipsoidal);
    const LoadedDataset without = load(std::string(plain) + "height = \"msl\"\n");
    EXPECT_DOUBLE_EQ(without.recording.gnss.front().position.h, 300.0);
    EXPECT_EQ(without.config.filter.gnss.height, fusion::HeightKind::Msl);
    ASSERT_FALSE(warnings_.empty());
    EXPECT_NE(warnings_.front().find("undulation_m"), std::string::npos);
}

TEST_F(DatasetTest, EnvironmentVariablesInPaths) {
    write_logs();
    setenv("SCHULER_TEST_FOLDER", folder_.c_str(), 1);
    const LoadedDataset d =
        load("[imu]\nfile = \"$SCHULER_TEST_FOLDER/imu.csv\"\n[gnss]\nfile = \"${SCHULER_TEST_FOLDER}/gnss.csv\"\n");
    EXPECT_EQ(d.recording.gnss.size(), 9u);
    const std::string message = failure("[imu]\nfile = \"$SCHULER_NOT_SET/imu.csv\"\n");
    EXPECT_NE(message.find("$SCHULER_NOT_SET"), std::string::npos) << message;
}

TEST_F(DatasetTest, UnusableInputsAreNamed) {
    write_logs();
    const struct {
        std::string toml;
        std::vector<const char*> parts;
    } cases[] = {
        {"[imu]\nfile = \"none.csv\"\n", {"none.csv", "no such file"}},
        {"[imu]\nfile = \".\"\n", {"directory"}},
        {"[imu]\nfile = \"gnss.csv\"\n", {"gnss.csv"}},
        {std::string(plain) + "columns = { height_m = \"altitude\" }\n", {"gnss.csv", "altitude"}},
        {std::string(plain) + "columns = { hight_m = \"height_m\" }\n", {"hight_m", "height_m"}},
        {std::string(plain) + "[run]\nstart_s = 5\nstop_s = 3\n", {"run.stop_s", "not after its start"}},
        {"[imu]\nfle = \"imu.csv\"\n", {"dataset.toml:2: imu.fle: unknown key", "imu.file"}},
    };
    for (const auto& c : cases) {
        const std::string message = failure(c.toml);
        EXPECT_EQ(message.find('\n'), std::string::npos);
        for (const char* part : c.parts) EXPECT_NE(message.find(part), std::string::npos) << c.toml << " -> " << message;
    }
    EXPECT_FALSE(load("[gnss]\nfile = \"gnss.csv\"\n").recording.imu.empty()) << "the IMU's log is in the folder";
    fs::remove(folder_ / "imu.csv");
    const std::string without = failure("[gnss]\nfile = \"gnss.csv\"\n");
    for (const char* part : {"imu.file", "no IMU file"}) EXPECT_NE(without.find(part), std::string::npos) << without;
    EXPECT_THROW((void)settings::open_dataset(folder_ / "nothing"), Error);
    fs::create_directories(folder_ / "empty");
    EXPECT_THROW((void)settings::open_dataset(folder_ / "empty"), Error);
}

TEST_F(DatasetTest, DatedFixesMeetSecondsOfTheWeek) {
    write_logs(243300.0);  // 2025-07-08 19:35:00 GPS time is second 243300 of week 2374
    write("gnss.pos",
          "% program   : test\n"
          "%  GPST                  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)  sdne(m)  sdeu(m) "
          " sdun(m) age(s)  ratio\n"
          "2025/07/08 19:35:01.000   50.000000000   10.000000000   300.0000   1  12   0.0100   0.0100   0.0200   0.0000   0.0000 "
          "  0.0000   0.00    0.0\n"
          "2025/07/08 19:35:02.000   50.000000000   10.000000000   300.0000   1  12   0.0100   0.0100   0.0200   0.0000   0.0000 "
          "  0.0000   0.00    0.0\n");
    for (const char* time : {"", "[time]\nweek = 2374\n"}) {
        const LoadedDataset d = load(std::string(time) + "[imu]\nfile = \"imu.csv\"\n[gnss]\nfile = \"gnss.pos\"\n");
        ASSERT_EQ(d.recording.gnss.size(), 2u);
        EXPECT_EQ(d.recording.gnss.front().time, Time::from_seconds(243301.0)) << time;
    }
}

TEST_F(DatasetTest, KfGinsProjectInOurWords) {
    write("imu.txt",
          "1000.005 1e-6 2e-6 3e-6 1e-3 2e-3 -0.049\n1000.010 1e-6 2e-6 3e-6 1e-3 2e-3 -0.049\n1000.015 1e-6 2e-6 3e-6 1e-3 2e-3 "
          "-0.049\n");
    write("gnss.txt", "1000.01 50.0 10.0 300.0 0.01 0.02 0.03\n");
    write("project.yaml",
          "imupath: \"imu.txt\"\ngnsspath: \"gnss.txt\"\noutputpath: \".\"\nimudatalen: 7\nimudatarate: 200\nstarttime: "
          "1000\nendtime: 1005\n"
          "initpos: [ 50.0, 10.0, 300.0 ]\ninitvel: [ 1.0, 2.0, 3.0 ]\ninitatt: [ 1.0, 2.0, 90.0 ]\ninitgyrbias: [ 0, 0, 0 "
          "]\ninitaccbias: [ 0, 0, 0 ]\n"
          "initgyrscale: [ 0, 0, 0 ]\ninitaccscale: [ 0, 0, 0 ]\ninitposstd: [ 0.05, 0.06, 0.1 ]\ninitvelstd: [ 0.05, 0.05, 0.05 "
          "]\ninitattstd: [ 0.5, 0.5, 1.5 ]\n"
          "imunoise:\n  arw: [0.24, 0.24, 0.24]\n  vrw: [0.24, 0.24, 0.24]\n  gbstd: [24.0, 24.0, 24.0]\n  abstd: [400.0, 400.0, "
          "400.0]\n  gsstd: [1000, 1000, 1000]\n"
          "  asstd: [1000, 1000, 1000]\n  corrtime: 1.0\nantlever: [ 0.136, -0.301, -0.184 ]\n");
    const settings::Dataset dataset = settings::open_dataset(folder_ / "project.yaml");
    WarningLog warnings;
    const LoadedDataset d = load_dataset(dataset, settings::config_from(dataset.settings), warnings);
    const fusion::Settings& s = d.config.filter;
    EXPECT_EQ(d.recording.imu.size(), 3u);
    ASSERT_EQ(d.recording.gnss.size(), 1u);
    EXPECT_EQ(s.imu.kind, ImuKind::Increments);
    EXPECT_EQ(s.earth.gravity, earth::GravityModel::KfGins);
    EXPECT_EQ(s.earth.ellipsoid.w_ie, 7.2921151467e-5);
    EXPECT_TRUE(s.scale_factors);
    EXPECT_FALSE(s.constraints.nonholonomic);
    EXPECT_TRUE(s.constraints.zero_velocity);
    EXPECT_NEAR(s.imu.errors.gyro_noise, 0.24 * M_PI / 180 / 60, 1e-17);
    EXPECT_NEAR(s.imu.errors.accel_noise, 0.24 / 60, 1e-16);
    EXPECT_NEAR(s.imu.errors.gyro_bias, 24 * M_PI / 180 / 3600, 1e-17);
    EXPECT_NEAR(s.imu.errors.accel_bias, 400e-5, 1e-16);
    EXPECT_NEAR(s.imu.errors.gyro_scale, 1e-3, 1e-17);
    EXPECT_EQ(s.imu.errors.gyro_bias_time, 3600.0);
    EXPECT_EQ(s.imu.errors.gyro_turn_on_bias, 0.0);
    EXPECT_EQ(s.gnss.lever_arm_b, Eigen::Vector3d(0.136, -0.301, -0.184));
    EXPECT_NEAR(s.initial.rpy.z(), M_PI / 2, 1e-15);
    EXPECT_NEAR(s.initial.std_rpy.z(), 1.5 * M_PI / 180, 1e-16);
    EXPECT_EQ(s.initial.std_position, Eigen::Vector3d(0.05, 0.06, 0.1));
    EXPECT_EQ(*s.initial.time, Time::from_seconds(1000.0));
    EXPECT_EQ(*s.start, Time::from_seconds(1000.0));
    EXPECT_EQ(*s.stop, Time::from_seconds(1005.0));
}

TEST_F(DatasetTest, ATableOfPositionsWithSigmasIsATrajectoryByItsColumns) {
    write(
        "survey.csv",
        "time_s,lat_deg,lon_deg,height_ellipsoidal_m,std_n_m,std_e_m,std_d_m\n1,50,10,300,0.1,0.1,0.2\n2,50,10,301,0.1,0.1,0.2\n");
    WarningLog warnings;
    const std::vector<SolutionRow> rows = dataset::read_trajectory(folder_ / "survey.csv", warnings).rows;
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[1].position.h, 301.0);
}

TEST_F(DatasetTest, FixesWithoutNamesAreATrajectoryAndSamplesAreNot) {
    std::string fixes, samples;
    for (int i = 0; i < 60; ++i) {
        fixes += std::to_string(100 + i) + " 30.4 114.4 20.5 0.01 0.02 0.03\n";
        samples += std::to_string(100.0 + 0.005 * i) + " 0.0 0.0 " + std::to_string(1e-6 * (i % 5)) + " 0.0 0.0 -0.049\n";
    }
    write("gnss.pos", fixes);
    write("imu.txt", samples);
    WarningLog warnings;
    const std::vector<SolutionRow> rows = dataset::read_trajectory(folder_ / "gnss.pos", warnings).rows;
    ASSERT_EQ(rows.size(), 60u);
    EXPECT_NEAR(rows[0].position.lon, 114.4 * M_PI / 180, 1e-14);
    EXPECT_EQ(rows[0].std_position.z(), 0.03);
    EXPECT_THROW((void)dataset::read_trajectory(folder_ / "imu.txt", warnings), Error);
}

TEST_F(DatasetTest, ASolutionComesBackFromMcapWhole) {
    std::vector<SolutionRow> rows;
    for (int i = 0; i < 100; ++i) {
        SolutionRow r;
        r.time = Time::from_seconds(1'391'200'000.0 + 0.1 * i);
        r.position = {0.8 + 1.25e-6 * i, 0.2, 300.0};  // 80 m/s to the north
        r.v_eb_n = {80.0, 0.5, -0.25};
        r.rpy = {0.1, -0.05, 0.02 * i};
        r.std_position = {0.1, 0.2, 0.3};
        r.std_velocity = {0.01, 0.02, 0.03};
        r.std_rpy = not_given3();
        rows.push_back(r);
    }
    io::format_named("mcap")->write(folder_ / "a.mcap", rows, "a");
    WarningLog warnings;
    const std::vector<SolutionRow> back = dataset::read_trajectory(folder_ / "a.mcap", warnings).rows;
    EXPECT_TRUE(warnings.empty());
    ASSERT_EQ(back.size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_NEAR(back[i].position.lat, rows[i].position.lat, 1e-14);
        EXPECT_NEAR((back[i].v_eb_n - rows[i].v_eb_n).norm(), 0.0, 1e-12);
        EXPECT_NEAR((back[i].rpy - rows[i].rpy).norm(), 0.0, 1e-12);
        EXPECT_NEAR((back[i].std_position - rows[i].std_position).norm(), 0.0, 1e-12);
        EXPECT_NEAR((back[i].std_velocity - rows[i].std_velocity).norm(), 0.0, 1e-12);
    }
}

std::string content_of(const std::filesystem::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
}

TEST_F(DatasetTest, DatedFormatsHaveTheDateOfTheLogWhateverItsClock) {
    const char* rows = "1714730400,48.1,11.5,500\n1714730401,48.1001,11.5,500\n";  // 2024-05-03 10:00 UTC
    write("utc.csv", std::string("time_utc_s,lat_deg,lon_deg,height_m\n") + rows);
    write("computer.csv", std::string("time_s,lat_deg,lon_deg,height_m\n") + rows);
    write("gps.csv", "time_gps_s,lat_deg,lon_deg,height_m\n1398765618,48.1,11.5,500\n1398765619,48.1001,11.5,500\n");
    const auto converted = [&](const char* in, const char* out) {
        (void)app::convert_file(folder_ / in, folder_ / out, {});
        return content_of(folder_ / out);
    };
    for (const char* in : {"utc.csv", "computer.csv", "gps.csv"})
        EXPECT_NE(converted(in, "dated.gpx").find("<time>2024-05-03T10:00:00Z"), std::string::npos) << in;
    // by way of formats that count from 1970
    for (const char* way : {"way.mcap", "way.tum"}) {
        (void)converted("utc.csv", way);
        EXPECT_NE(converted(way, "dated.gpx").find("<time>2024-05-03T10:00:00Z"), std::string::npos) << way;
    }
    // tables keep their own times
    EXPECT_NE(converted("utc.csv", "same.csv").find("\n1714730400.000,"), std::string::npos);
    // of a run before the time in which the numbers alone tell: its settings do
    std::filesystem::create_directories(folder_ / "run");
    write("run/config.toml", "[time]\nscale = \"utc\"\n");
    std::string solution(io::solution_csv_header());
    solution +=
        "\n1403636580,48.1,11.5,500" + std::string(16, ',') + "\n1403636581,48.1001,11.5,500" + std::string(16, ',') + "\n";
    write("run/solution.csv", solution);
    EXPECT_NE(converted("run/solution.csv", "dated.gpx").find("<time>2014-06-24T19:03:00Z"), std::string::npos)
        << content_of(folder_ / "dated.gpx");
}

TEST_F(DatasetTest, ASolutionIsComparedWithAReferenceOnAnotherScale) {
    const auto rows = [](double first) {
        std::string text;
        for (int i = 0; i < 20; ++i) text += fmt::format("{:.1f},48.1,11.5,{}\n", first + i, 500 + i);
        return text;
    };
    write("ours.csv", "time_gps_s,lat_deg,lon_deg,height_m\n" + rows(1398765618.0));
    write("theirs.csv", "time_utc_s,lat_deg,lon_deg,height_m\n" + rows(1714730400.0));
    const report::Outcome out = app::evaluate_files(folder_ / "ours.csv", folder_ / "theirs.csv", 0.0);
    EXPECT_NE(out.tables.find("errors at 20 epochs"), std::string::npos) << out.tables;
    write("elsewhen.csv", "time_utc_s,lat_deg,lon_deg,height_m\n" + rows(1700000000.0));
    EXPECT_THROW((void)app::evaluate_files(folder_ / "ours.csv", folder_ / "elsewhen.csv", 0.0), Error);
}

TEST_F(DatasetTest, AFolderThatIsALogItselfIsReadByItsName) {
    std::filesystem::create_directories(folder_ / "oxts/data");
    std::string times;
    for (int i = 0; i < 12; ++i) {
        times += fmt::format("2011-09-26 13:02:{:02d}.000000000\n", 20 + i);
        write(fmt::format("oxts/data/{:010d}.txt", i),
              "48.1 11.5 500 0 0 0 1 0 1 0 0 0 0 9.8 0 0 9.8 0 0 0 0 0 0 .05 .02 4 10 4 4 0\n");
    }
    write("oxts/timestamps.txt", times);
    for (const char* name : {"oxts", "oxts/"}) {
        const settings::Dataset d = settings::open_dataset(folder_ / name);
        const settings::Config config = settings::config_from(d.settings);
        WarningLog warnings;
        EXPECT_EQ(load_dataset(d, config, warnings).recording.imu.size(), 12u) << name;
        EXPECT_EQ(d.name, "oxts");
    }
}

TEST_F(DatasetTest, AnEarlierSolutionInTheFolderIsNoReference) {
    std::string solution(io::solution_csv_header());
    for (int i = 0; i < 20; ++i) solution += fmt::format("\n{},48.1,11.5,500{}", i, std::string(16, ','));
    write("solution.csv", solution + "\n");
    const inspect::InspectReport report = inspect::inspect(folder_);
    ASSERT_EQ(report.files.size(), 1u);
    EXPECT_EQ(report.files[0].kind, "solution");
    EXPECT_EQ(report.dataset_toml.find("solution.csv"), std::string::npos);
}

TEST_F(DatasetTest, ALogThatIsNotRecognisedIsNamedBeforeTheFolderForItsTables) {
    write("a.ulg", "not a log at all\n");
    try {
        (void)app::convert_file(folder_ / "a.ulg", folder_ / "tables", {});
        ADD_FAILURE() << "accepted";
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("a.ulg"), std::string::npos) << e.what();
        EXPECT_NE(std::string(e.what()).find("recognised"), std::string::npos) << e.what();
    }
}

TEST_F(DatasetTest, TrajectoriesOfTenColumnsAndBack) {
    write("truth.txt", "1.000 50.0 10.0 300.0 1.0 2.0 3.0 1.0 -2.0 350.0\n1.100 50.0 10.0 300.0 1.0 2.0 3.0 1.0 -2.0 350.0\n");
    WarningLog warnings;
    const std::vector<SolutionRow> rows = dataset::read_trajectory(folder_ / "truth.txt", warnings).rows;
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[1].time, Time::from_seconds(1.1));
    EXPECT_NEAR(rows[0].rpy.z(), 350 * M_PI / 180, 1e-14);
    EXPECT_EQ(rows[0].v_eb_n, Eigen::Vector3d(1, 2, 3));
    (void)app::convert_file(folder_ / "truth.txt", folder_ / "a.csv", {});
    (void)app::convert_file(folder_ / "a.csv", folder_ / "b.txt", {});
    const std::vector<SolutionRow> again = dataset::read_trajectory(folder_ / "b.txt", warnings).rows;
    ASSERT_EQ(again.size(), 2u);
    EXPECT_NEAR(again[0].position.lat, rows[0].position.lat, 1e-12);
    EXPECT_NEAR(again[0].rpy.y(), rows[0].rpy.y(), 1e-8);
    EXPECT_THROW((void)app::convert_file(folder_ / "truth.txt", folder_ / "x.bin", {}), Error);
    EXPECT_THROW((void)app::convert_file(folder_ / "truth.txt", folder_ / "x.csv", "papyrus"), Error);
}

}  // namespace
}  // namespace schuler::solution
