#include "schuler/io/solution/kfgins.h"
#include "schuler/core/units.h"

#include "io/io_fixture.h"

#include <numbers>

namespace schuler::io {
namespace {

using test::expect_parts;
using test::message_of;

using units::deg;

const std::string yaml = R"(imupath: "imu.txt"
gnsspath: "sub/gnss.txt"
outputpath: "out"
imudatalen: 7
imudatarate: 200
starttime: 100030.0
endtime: 101799.99
initpos: [ 30.1234567891, 114.9876543219, 20.5000 ]
initvel: [ 0.1, -0.2, 0.3 ]
initatt: [ 0.85, -2.04, 276.0 ]
initgyrbias: [ 3600, 0, 0 ]
initaccbias: [ 100, 0, 0 ]
initgyrscale: [ 0, 0, 0 ]
initaccscale: [ 500, 0, 0 ]
initposstd: [ 0.05, 0.05, 0.1 ]
initvelstd: [ 0.05, 0.05, 0.05 ]
initattstd: [ 0.5, 0.5, 1.5 ]
imunoise:
  arw: [0.24, 0.24, 0.24]
  vrw: [0.24, 0.24, 0.24]
  gbstd: [24.0, 24.0, 24.0]
  abstd: [400, 400, 400]
  gsstd: [1000, 1000, 1000]
  asstd: [1000, 1000, 1000]
  corrtime: 1.0
antlever:  [ 0.136, -0.301, -0.184 ]
)";

KfGinsProject project(const std::string& text) { return read_kfgins_project(TextInput::memory(text, "drive.yaml")); }

std::string replaced(const std::string& from, const std::string& to) {
    std::string text = yaml;
    text.replace(text.find(from), from.size(), to);
    return text;
}

class KfGins : public test::IoTest {};

TEST_F(KfGins, SettingsInSi) {
    const KfGinsProject p = project(yaml);
    EXPECT_EQ(p.imu_rate_hz, 200.0);
    EXPECT_EQ(p.start.ns, 100030000000000);
    EXPECT_EQ(p.end->ns, 101799990000000);
    EXPECT_DOUBLE_EQ(p.position.lat, 30.1234567891 * deg);
    EXPECT_DOUBLE_EQ(p.position.lon, 114.9876543219 * deg);
    EXPECT_EQ(p.position.h, 20.5);
    EXPECT_EQ(p.velocity_n, Eigen::Vector3d(0.1, -0.2, 0.3));
    EXPECT_DOUBLE_EQ(p.rpy.z(), 276.0 * deg);
    EXPECT_DOUBLE_EQ(p.gyro_bias.x(), deg);
    EXPECT_DOUBLE_EQ(p.accel_bias.x(), 1e-3);
    EXPECT_DOUBLE_EQ(p.accel_scale.x(), 5e-4);
    EXPECT_DOUBLE_EQ(p.std_rpy.z(), 1.5 * deg);
    EXPECT_DOUBLE_EQ(p.noise.angle_random_walk.x(), 0.24 * deg / 60.0);
    EXPECT_DOUBLE_EQ(p.noise.velocity_random_walk.x(), 0.24 / 60.0);
    EXPECT_DOUBLE_EQ(p.noise.gyro_bias.x(), 24.0 * deg / 3600.0);
    EXPECT_DOUBLE_EQ(p.noise.accel_bias.x(), 4e-3);
    EXPECT_DOUBLE_EQ(p.noise.gyro_scale.x(), 1e-3);
    EXPECT_EQ(p.noise.correlation_time, 3600.0);
    EXPECT_EQ(p.std_gyro_bias, p.noise.gyro_bias);  // not given: the noise model's
    EXPECT_EQ(p.std_accel_scale, p.noise.accel_scale);
    EXPECT_EQ(p.lever_arm_b, Eigen::Vector3d(0.136, -0.301, -0.184));
    EXPECT_FALSE(project(replaced("endtime: 101799.99", "endtime: -1")).end.has_value());
    EXPECT_DOUBLE_EQ(project(yaml + "initbgstd: [ 36, 36, 36 ]\n").std_gyro_bias.x(), 0.01 * deg);
}

TEST_F(KfGins, PathsBesideTheYamlOrInTheCurrentFolder) {
    const auto path = write("drive.yaml", yaml);
    write("imu.txt", "");
    const KfGinsProject p = read_kfgins_project(path);
    EXPECT_EQ(p.imu_path, folder() / "imu.txt");
    EXPECT_EQ(p.gnss_path, folder() / "sub/gnss.txt");
    EXPECT_TRUE(is_kfgins_project(path));
    EXPECT_FALSE(is_kfgins_project(write("other.yaml", "a: 1\n")));
    EXPECT_FALSE(is_kfgins_project(write("no.yaml", "a: [\n")));
    const auto there = std::filesystem::current_path();
    std::filesystem::create_directories(folder() / "sub");
    std::filesystem::create_directories(folder() / "elsewhere");
    write("sub/gnss.txt", "");
    write("elsewhere/drive.yaml", yaml);
    std::filesystem::current_path(folder());
    const KfGinsProject q = read_kfgins_project("elsewhere/drive.yaml");
    EXPECT_TRUE(std::filesystem::exists(q.gnss_path));
    std::filesystem::current_path(there);
}

TEST_F(KfGins, MistakesAreNamed) {
    const auto message = [](const std::string& text) { return message_of([&] { (void)project(text); }); };
    expect_parts(message(replaced("imudatarate", "imudatarte")),
                 {"drive.yaml:5", "imudatarte", "not a known key", "did you mean 'imudatarate'?"});
    expect_parts(message(replaced("  gbstd:", "  gbsdt:")), {"drive.yaml", "imunoise.", "gbstd"});
    expect_parts(message(replaced("  corrtime: 1.0", "  corrtime: 1.0\n  corr: 2")),
                 {"drive.yaml:26", "imunoise.corr", "not a known key"});
    expect_parts(message(replaced("starttime: 100030.0", "starttime: noon")),
                 {"drive.yaml:6", "starttime", "'noon' is not a number"});
    expect_parts(message(replaced("initvel: [ 0.1, -0.2, 0.3 ]", "initvel: [ 0.1, -0.2 ]")),
                 {"drive.yaml:9", "initvel", "2 elements instead of 3"});
    expect_parts(message(replaced("initpos: [ 30.1", "initpos: [ 130.1")), {"drive.yaml:8", "initpos", "latitude"});
    expect_parts(message(replaced("endtime: 101799.99", "endtime: 5")), {"drive.yaml:7", "endtime", "not after starttime"});
    expect_parts(message(replaced("corrtime: 1.0", "corrtime: 0")), {"drive.yaml:25", "imunoise.corrtime", "not positive"});
    expect_parts(message(replaced("arw: [0.24,", "arw: [-0.24,")), {"drive.yaml:19", "imunoise.arw", "negative"});
    expect_parts(message(replaced("initatt: [ 0.85,", "initatt: [ 0.85")), {"drive.yaml:10", "initatt"});
    expect_parts(message(replaced("gnsspath: \"sub/gnss.txt\"\n", "")), {"drive.yaml", "gnsspath", "is missing", "add gnsspath"});
    expect_parts(message("imupath: [\n"), {"drive.yaml:2", "not valid YAML"});
    expect_parts(message("hello"), {"drive.yaml:1", "no keys"});
    expect_parts(message(""), {"drive.yaml"});
}

TEST_F(KfGins, TextFiles) {
    WarningLog log;
    const KfGinsImu imu = read_kfgins_imu(TextInput::memory("100000.0050 1.234567890123456e-05 -2e-06 3e-08 1e-3 -2e-3 -4.9e-02\n"
                                                            "100000.0100 1e-05 -2e-06 3e-08 1e-3 -2e-3 -4.9e-02\n",
                                                            "imu.txt"),
                                          log);
    ASSERT_EQ(imu.samples.size(), 2U);
    EXPECT_EQ(imu.samples[0].time.ns, 100000005000000);
    EXPECT_EQ(imu.samples[0].gyro.x(), 1.234567890123456e-05);
    EXPECT_EQ(imu.samples[0].accel.z(), -4.9e-02);
    const KfGinsGnss gnss = read_kfgins_gnss(
        TextInput::memory("100001.000 30.12345678912 114.98765432198 21.50000 0.0100 0.0100 0.0200\n", "gnss.txt"), log);
    ASSERT_EQ(gnss.fixes.size(), 1U);
    EXPECT_DOUBLE_EQ(gnss.fixes[0].position.lat, 30.12345678912 * deg);
    EXPECT_EQ(gnss.fixes[0].std_position, Eigen::Vector3d(0.01, 0.01, 0.02));
    EXPECT_TRUE(std::isnan(gnss.fixes[0].velocity_n.x()));
    expect_parts(message_of([&] { (void)read_kfgins_imu(TextInput::memory("1 2 3 4\n2 3 4 5\n", "imu.txt"), log); }),
                 {"imu.txt:1", "4 columns", "angle increments"});
    expect_parts(message_of([&] { (void)read_kfgins_gnss(TextInput::memory("1 114.4 30.4 20 0.1 0.1 0.1\n", "gnss.txt"), log); }),
                 {"gnss.txt:1", "column 2", "latitude"});
    expect_parts(message_of([&] {
                     (void)read_kfgins_imu(TextInput::memory("1 0 0 0 0 0 0\n2 0 0 0 0 0 0\n3 0 0 0 0\n", "imu.txt"), log);
                 }),
                 {"imu.txt:3", "column 6", "dvel_y", "is missing", "1 of 3 rows"});
}

/// Rows of KF-GINS and OB_GINS end with a blank.
TEST_F(KfGins, ACutLastNumberIsTold) {
    const std::string rows =
        "357971.000    30.4538104823   114.4633241543     34.189    0.009    0.012    0.037 \n"
        "357972.000    30.4538166367   114.4631898135     34.420    0.009    0.014    0.039 ";
    const auto read = [](const std::string& text, WarningLog& log) {
        return read_kfgins_gnss(TextInput::memory(text, "gnss.txt"), log).fixes.size();
    };
    WarningLog whole, cut;
    EXPECT_EQ(read(rows, whole), 2U);
    EXPECT_TRUE(whole.empty());
    EXPECT_EQ(read(rows.substr(0, rows.size() - 3), cut), 1U);
    expect_parts(cut.summary().at(0), {"gnss.txt", "line 2", "no line end", "left out"});
}

}  // namespace
}  // namespace schuler::io
