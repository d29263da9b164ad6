#include "schuler/io/text/columns.h"
#include "schuler/core/units.h"

#include "io/io_fixture.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace schuler::io {
namespace {

using test::expect_parts;
using test::message_of;

TableLayout layout_of(std::vector<std::string> names) {
    TableLayout layout;
    layout.file = "log.csv";
    layout.columns = static_cast<int>(names.size());
    layout.header_line = 1;
    layout.names = std::move(names);
    return layout;
}

struct Synonym {
    TableKind kind;
    const char* name;
    const char* canonical;
    double factor;
};

class Synonyms : public testing::TestWithParam<Synonym> {};

TEST_P(Synonyms, AreKnownWithTheirUnits) {
    const ColumnPlan plan = match_columns(layout_of({"zzz", GetParam().name}), GetParam().kind);
    const ColumnMatch* match = plan.find(GetParam().canonical);
    ASSERT_NE(match, nullptr) << GetParam().name;
    EXPECT_EQ(match->column, 1);
    EXPECT_NEAR(match->factor, GetParam().factor, 1e-12 * std::abs(GetParam().factor)) << GetParam().name;
    EXPECT_EQ(plan.unused, std::vector<std::string>{"zzz"});
}

using units::deg;
constexpr auto K = TableKind::Imu;
constexpr auto G = TableKind::Gnss;
constexpr auto R = TableKind::Reference;
INSTANTIATE_TEST_SUITE_P(
    All, Synonyms,
    testing::Values(
        Synonym{K, "gyro_x_rad_s", "gyro_x_rad_s", 1.0}, Synonym{K, "gyro_y_deg_s", "gyro_y_rad_s", deg},
        Synonym{K, "gx", "gyro_x_rad_s", 1.0}, Synonym{K, "GyrX", "gyro_x_rad_s", 1.0},
        Synonym{K, "wz [deg/h]", "gyro_z_rad_s", deg / 3600.0}, Synonym{K, "omega_x", "gyro_x_rad_s", 1.0},
        Synonym{K, "angular_velocity.x", "gyro_x_rad_s", 1.0}, Synonym{K, "Gyro Z (\xc2\xb0/s)", "gyro_z_rad_s", deg},
        Synonym{K, "IMU::UncompAccel::X [m/s^2]", "accel_x_m_s2", 1.0}, Synonym{K, "accel_x_g", "accel_x_m_s2", 9.80665},
        Synonym{K, "accel_x_mg", "accel_x_m_s2", 9.80665e-3}, Synonym{K, "ax", "accel_x_m_s2", 1.0},
        Synonym{K, "fx", "accel_x_m_s2", 1.0}, Synonym{K, "specific_force_z", "accel_z_m_s2", 1.0},
        Synonym{K, "dtheta_x_rad", "dtheta_x_rad", 1.0}, Synonym{K, "dtheta_x_deg", "dtheta_x_rad", deg},
        Synonym{K, "dv_z_m_s", "dv_z_m_s", 1.0}, Synonym{K, "temp_c", "temperature_c", 1.0}, Synonym{G, "lat", "lat_deg", 1.0},
        Synonym{G, "Latitude [rad]", "lat_deg", 1.0 / deg}, Synonym{G, "lon_e7", "lon_deg", 1e-7},
        Synonym{G, "longitude(deg)", "lon_deg", 1.0}, Synonym{G, "alt_mm", "height_m", 1e-3},
        Synonym{G, "hMSL_mm", "height_m", 1e-3}, Synonym{G, "vn(m/s)", "vel_n_m_s", 1.0}, Synonym{G, "v_east", "vel_e_m_s", 1.0},
        Synonym{G, "vel_up_m_s", "vel_d_m_s", -1.0}, Synonym{G, "vu", "vel_d_m_s", -1.0},
        Synonym{G, "vel_d_cm_s", "vel_d_m_s", 1e-2}, Synonym{G, "sdn(m)", "std_n_m", 1.0}, Synonym{G, "sde", "std_e_m", 1.0},
        Synonym{G, "sdu", "std_d_m", 1.0}, Synonym{G, "hAcc_mm", "std_h_m", 1e-3}, Synonym{G, "std_vel_m_s", "std_vel_m_s", 1.0},
        Synonym{G, "fix_rtk1fix_2float_5single", "fix", 1.0}, Synonym{G, "fix_3is3d", "fix", 1.0}, Synonym{G, "Q", "fix", 1.0},
        Synonym{G, "num_sats", "satellites", 1.0}, Synonym{G, "ns", "satellites", 1.0},
        Synonym{G, "time_valid_s", "time_valid_s", 1.0}, Synonym{G, "vel_time_valid_s", "vel_time_valid_s", 1.0},
        Synonym{TableKind::Baro, "baro_height_rel_m", "height_m", 1.0},
        Synonym{TableKind::Baro, "pressure_kpa", "pressure_pa", 1000.0},
        Synonym{TableKind::Baro, "pressure_hpa", "pressure_pa", 100.0},
        Synonym{TableKind::Baro, "press [mbar]", "pressure_pa", 100.0}, Synonym{TableKind::Mag, "mag_x_mgauss", "mag_x_ut", 0.1},
        Synonym{TableKind::Mag, "mag_uncal_y_gauss", "mag_y_ut", 100.0}, Synonym{TableKind::Mag, "mag_z_nt", "mag_z_ut", 1e-3},
        Synonym{TableKind::Mag, "mx [\xc2\xb5T]", "mag_x_ut", 1.0}, Synonym{R, "ahrs_roll_deg", "roll_deg", 1.0},
        Synonym{R, "onboard_yaw_deg", "heading_deg", 1.0}, Synonym{R, "Pitch [rad]", "pitch_deg", 1.0 / deg},
        Synonym{R, "quat_sensor_to_enu_w", "qw", 1.0}, Synonym{R, "ecef_x_m", "ecef_x_m", 1.0},
        Synonym{R, "onboard_vel_n_m_s", "vel_n_m_s", 1.0}));

TEST(Columns, TimesAndTheirUnits) {
    const auto unit = [](const char* name) { return match_columns(layout_of({name}), K).find("time_s")->time_unit; };
    EXPECT_EQ(unit("time_s"), TimeUnit::Seconds);
    EXPECT_EQ(unit("timestamp_ns"), TimeUnit::Nanoseconds);
    EXPECT_EQ(unit("TimeUS"), TimeUnit::Microseconds);
    EXPECT_EQ(unit("iTOW"), TimeUnit::Milliseconds);
    EXPECT_EQ(unit("t"), TimeUnit::Seconds);
    TableLayout unix_time = layout_of({"timestamp"});
    unix_time.sample = {{"1751990400123456"}};
    EXPECT_EQ(match_columns(unix_time, K).find("time_s")->time_unit, TimeUnit::Microseconds);
    EXPECT_EQ(match_columns(layout_of({"device_time_ms"}), K).find("time_s"), nullptr);
}

TEST(Columns, OfAVelocityAreNoPosition) {
    const ColumnPlan plan = match_columns(layout_of({"time_s", "lat", "lon", "vel_n_std", "vel_e_std", "vel_std_d"}), G);
    EXPECT_EQ(plan.find("std_n_m"), nullptr);
    EXPECT_EQ(plan.find("std_e_m"), nullptr);
    EXPECT_EQ(plan.find("std_d_m"), nullptr);
    EXPECT_EQ(plan.find("std_vn_m_s")->column, 3);
    EXPECT_EQ(plan.find("std_ve_m_s")->column, 4);
    EXPECT_EQ(plan.find("std_vd_m_s")->column, 5);
    EXPECT_TRUE(plan.unused.empty());
    const ColumnPlan local = match_columns(layout_of({"time_s", "velocity_x", "velocity_y", "vel_ecef_x"}), R);
    EXPECT_EQ(local.find("local_x_m"), nullptr);
    EXPECT_EQ(local.find("ecef_x_m"), nullptr);
    EXPECT_EQ(match_columns(layout_of({"pos_n_std", "position_std_e"}), G).matches.size(), 2U);
}

TEST(Columns, TheSurestNameWins) {
    const ColumnPlan plan = match_columns(layout_of({"height_msl_m", "alt", "height_m"}), G);
    EXPECT_EQ(plan.find("height_m")->column, 2);
    EXPECT_EQ(plan.find("height_m")->certainty, Certainty::Exact);
    EXPECT_EQ(plan.find("height_m")->height, HeightKind::Unstated);
    const ColumnPlan msl = match_columns(layout_of({"height_msl_m", "alt"}), G);
    EXPECT_EQ(msl.find("height_m")->height, HeightKind::Msl);
    EXPECT_EQ(match_columns(layout_of({"height_rel_m"}), G).find("height_m")->height, HeightKind::Relative);
    EXPECT_EQ(match_columns(layout_of({"onboard_height_m"}), R).find("height_m")->height, HeightKind::Autopilot);
    // An empty column is no candidate.
    TableLayout layout = layout_of({"time_s", "gps_tow_s"});
    layout.sample = {{"", "1.5"}, {"", "1.6"}};
    EXPECT_EQ(match_columns(layout, G).find("time_s")->column, 1);
}

TEST(Columns, TicksAreToldApartBySizeAndStep) {
    struct Case {
        TableKind kind;
        const char *first, *second;
        TimeUnit unit;
    };
    for (const Case& c : {Case{K, "1734523200.5", "1734523200.51", TimeUnit::Seconds},
                          Case{K, "1734523200000", "1734523200010", TimeUnit::Milliseconds},
                          Case{K, "1734523200000000", "1734523200010000", TimeUnit::Microseconds},
                          Case{K, "1734523200000000000", "1734523200010000000", TimeUnit::Nanoseconds},
                          Case{G, "1734523200000", "1734523230000", TimeUnit::Milliseconds},
                          // the clock of an instrument: a minute, two minutes, ten minutes, two days
                          Case{K, "50000000000", "50010000000", TimeUnit::Nanoseconds},
                          Case{K, "113005000000", "113015000000", TimeUnit::Nanoseconds},
                          Case{K, "700000000000", "700005000000", TimeUnit::Nanoseconds},
                          Case{K, "200000000000", "200000010000", TimeUnit::Microseconds},
                          Case{K, "200000000000000", "200000010000000", TimeUnit::Nanoseconds},
                          Case{G, "200000000000", "200001000000", TimeUnit::Microseconds},
                          Case{G, "113005000000", "113205000000", TimeUnit::Nanoseconds}}) {
        TableLayout layout = layout_of({"timestamp"});
        layout.sample = {{c.first}, {c.second}};
        EXPECT_EQ(match_columns(layout, c.kind).find("time_s")->time_unit, c.unit) << c.first << " " << c.second;
    }
}

TEST(Columns, APauseAtTheBeginningIsNoStep) {
    for (const auto& [seconds, unit] : {std::pair(1e6, TimeUnit::Microseconds), std::pair(1e3, TimeUnit::Milliseconds)}) {
        TableLayout layout = layout_of({"timestamp"});
        for (const double t :
             {1734523200.0, 1734523600.0, 1734523600.01, 1734523600.02, 1734523600.03})  // the first row is of before
            layout.sample.push_back({fmt::format("{:.0f}", t * seconds)});
        EXPECT_EQ(match_columns(layout, K).find("time_s")->time_unit, unit) << layout.sample.front().front();
    }
}

TEST(Columns, TheUsersMapOverrides) {
    ColumnOverrides user;
    user.columns = {{"height_m", "height_msl_m"}, {"gyro", ""}};
    user.columns.erase("gyro");
    user.scale = {{"std_n_m", 0.001}};
    const ColumnPlan plan = match_columns(layout_of({"time_s", "height_m", "height_msl_m", "std_n_m"}), G, user);
    EXPECT_EQ(plan.find("height_m")->column, 2);
    EXPECT_EQ(plan.find("height_m")->certainty, Certainty::Given);
    EXPECT_EQ(plan.find("height_m")->height, HeightKind::Msl);
    EXPECT_EQ(plan.find("std_n_m")->factor, 0.001);
    for (const auto& [name, kind] : {std::pair("Hoehe", HeightKind::Unstated), std::pair("Z", HeightKind::Unstated),
                                     std::pair("Hoehe_rel", HeightKind::Relative)})
        EXPECT_EQ(
            match_columns(layout_of({"time_s", name}), G, {{{"height_m", name}}, {}, std::nullopt}).find("height_m")->height,
            kind)
            << name;
    // A unit in the name of a column that the user names; a number instead of a name; a factor for three axes.
    const ColumnPlan imu =
        match_columns(layout_of({"t_ms", "foo_deg_s", "gyro_y_rad_s"}), K,
                      {{{"time_s", "#1"}, {"gyro_x_rad_s", "foo_deg_s"}}, {{"gyro_rad_s", 2.0}}, std::nullopt});
    EXPECT_EQ(imu.find("time_s")->time_unit, TimeUnit::Milliseconds);
    EXPECT_EQ(imu.find("gyro_x_rad_s")->column, 1);
    EXPECT_EQ(imu.find("gyro_x_rad_s")->factor, 2.0);
    EXPECT_EQ(imu.find("gyro_y_rad_s")->factor, 2.0);
    const ColumnPlan unit_only = match_columns(layout_of({"foo_deg_s"}), K, {{{"gyro_x_rad_s", "foo_deg_s"}}, {}, std::nullopt});
    EXPECT_NEAR(unit_only.find("gyro_x_rad_s")->factor, deg, 1e-16);
}

TEST(Columns, MisspeltMapsAreErrors) {
    const TableLayout layout = layout_of({"time_s", "acc_forward"});
    expect_parts(message_of([&] {
                     (void)match_columns(layout, K, {{{"acel_x_m_s2", "acc_forward"}}, {}, {}});
                 }),
                 {"log.csv", "columns.acel_x_m_s2", "not a canonical", "did you mean 'accel_x_m_s2'?"});
    expect_parts(message_of([&] {
                     (void)match_columns(layout, K, {{{"accel_x_m_s2", "acc_forwrd"}}, {}, {}});
                 }),
                 {"log.csv:1", "columns.accel_x_m_s2", "no column 'acc_forwrd'", "did you mean 'acc_forward'?"});
    expect_parts(message_of([&] {
                     (void)match_columns(layout, K, {{}, {{"gyr_rad_s", 2.0}}, {}});
                 }),
                 {"scale.gyr_rad_s", "did you mean"});
    expect_parts(message_of([&] {
                     (void)match_columns(layout, K, {{}, {{"gyro_rad_s", 0.0}}, {}});
                 }),
                 {"scale.gyro_rad_s", "factor"});
}

TEST(Columns, KindsAreGuessed) {
    EXPECT_EQ(guess_table_kind(layout_of({"time_s", "gx", "gy", "gz", "ax", "ay", "az"})), TableKind::Imu);
    EXPECT_EQ(guess_table_kind(layout_of({"time_s", "lat_deg", "lon_deg", "height_m", "Q"})), TableKind::Gnss);
    EXPECT_EQ(guess_table_kind(layout_of({"time_s", "lat_deg", "lon_deg", "height_m", "roll_deg", "pitch_deg", "yaw_deg"})),
              TableKind::Reference);
    EXPECT_EQ(guess_table_kind(layout_of({"time_s", "baro_height_rel_m"})), TableKind::Baro);
    EXPECT_EQ(guess_table_kind(layout_of({"time", "easting", "northing", "height"})), std::nullopt) << "of a total station";
    EXPECT_EQ(guess_table_kind(layout_of({"time", "Position", "Altitude"})), std::nullopt);
    EXPECT_EQ(guess_table_kind(layout_of({"time_s", "mag_x_mgauss", "mag_y_mgauss", "mag_z_mgauss"})), TableKind::Mag);
    EXPECT_EQ(guess_table_kind(layout_of({"time_s", "landed"})), std::nullopt);
}

TEST(Columns, StdHIsHorizontalUnlessNorthAndEastHaveTheirOwn) {
    for (const char* name : {"std_h_m", "std_h"}) {
        const ColumnPlan alone = match_columns(layout_of({"time_s", "lat_deg", "lon_deg", "height_m", name}), TableKind::Gnss);
        EXPECT_NE(alone.find("std_h_m"), nullptr) << name;
        EXPECT_EQ(alone.find("std_d_m"), nullptr) << name;
        const ColumnPlan beside =
            match_columns(layout_of({"time_s", "lat_deg", "lon_deg", "height_m", "std_n_m", "std_e_m", name}), TableKind::Gnss);
        EXPECT_EQ(beside.find("std_h_m"), nullptr) << name;
        EXPECT_NE(beside.find("std_d_m"), nullptr) << name;
    }
    const ColumnPlan both = match_columns(layout_of({"time_s", "lat_deg", "lon_deg", "std_h_m", "std_d_m"}), TableKind::Gnss);
    EXPECT_EQ(both.find("std_h_m")->column, 3);
    EXPECT_EQ(both.find("std_d_m")->column, 4);
}

}  // namespace
}  // namespace schuler::io
