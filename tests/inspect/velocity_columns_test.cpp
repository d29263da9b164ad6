// Velocity columns of another unit, order or sign than their names say: found from the displacement of the positions.
#include "inspect/report_queries.h"
#include "inspect/synthetic_car.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <functional>
#include <map>
#include <random>
#include <string>

namespace schuler::inspect::test {
namespace {

using Change = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

/// Rewrites the three velocities of a log of fixes, which are its last columns.
void change_velocities(const std::filesystem::path& path, const std::string& header, const Change& change) {
    std::ifstream in(path);
    std::string text, line;
    std::getline(in, line);
    text = header + "\n";
    while (std::getline(in, line)) {
        std::size_t at = 0;
        for (int column = 0; column < 4; ++column) at = line.find(',', at) + 1;
        Eigen::Vector3d v;
        if (std::sscanf(line.c_str() + at, "%lf,%lf,%lf", &v.x(), &v.y(), &v.z()) != 3) continue;
        v = change(v);
        text += fmt::format("{}{:.4f},{:.4f},{:.4f}\n", line.substr(0, at), v.x(), v.y(), v.z());
    }
    in.close();
    write_file(path, text);
}

/// A row of a log of fixes: s, deg, m, m/s.
struct FixRow {
    double t = 0.0, lat = 0.0, lon = 0.0, h = 0.0, n = 0.0, e = 0.0, d = 0.0;
};

/// The log of fixes with another header and its rows written anew.
std::string rewritten(const std::filesystem::path& path, const std::string& header,
                      const std::function<std::string(const FixRow&)>& written) {
    std::ifstream in(path);
    std::string text = header + "\n", line;
    std::getline(in, line);
    while (std::getline(in, line)) {
        FixRow f;
        if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf", &f.t, &f.lat, &f.lon, &f.h, &f.n, &f.e, &f.d) == 7)
            text += written(f) + "\n";
    }
    return text;
}

const std::string short_names = "time_s,lat_deg,lon_deg,height_m,vn,ve,vd";
const std::string full_names = "time_s,lat_deg,lon_deg,height_m,vel_n_m_s,vel_e_m_s,vel_d_m_s";

std::filesystem::path car_with(const std::string& name, const std::string& header, const Change& change, CarLog car = {}) {
    const auto folder = fresh_folder("velocity_" + name);
    write_car(folder, car);
    change_velocities(folder / car.gnss_name, header, change);
    return folder;
}

double scale_of(const InspectReport& report, const std::string& key) {
    const Fact* scale = fact(report, "gnss.scale");
    const auto* table = scale == nullptr ? nullptr : std::get_if<std::map<std::string, double>>(&scale->value);
    return table == nullptr || !table->contains(key) ? std::nan("") : table->at(key);
}
std::string column_of(const InspectReport& report, const std::string& key) {
    const Fact* columns = fact(report, "gnss.columns");
    const auto* table = columns == nullptr ? nullptr : std::get_if<std::map<std::string, std::string>>(&columns->value);
    return table == nullptr || !table->contains(key) ? std::string() : table->at(key);
}
void expect_car(const InspectReport& report) {
    EXPECT_EQ(value_of(report, "imu.axes"), "frd");
    EXPECT_EQ(value_of(report, "vehicle.kind"), "car");
}

struct Unit {
    const char* name;
    double factor;  // to m/s
};

class VelocityUnits : public testing::TestWithParam<Unit> {};

TEST_P(VelocityUnits, FoundFromTheDisplacement) {
    const double factor = GetParam().factor;
    const auto folder = car_with("unit", short_names, [&](const Eigen::Vector3d& v) { return Eigen::Vector3d(v / factor); });
    const InspectReport r = inspect(folder);
    for (const char* key : {"vel_n_m_s", "vel_e_m_s", "vel_d_m_s"}) EXPECT_NEAR(scale_of(r, key), factor, 1e-9 * factor) << key;
    EXPECT_NE(value_of(r, "gnss.scale.vel_n_m_s").find(GetParam().name), std::string::npos);
    EXPECT_TRUE(r.doubts.empty()) << r.doubts.front();
    expect_car(r);
}

/// The names state m/s: the mend is told as a doubt.
TEST_P(VelocityUnits, AgainstTheNames) {
    const double factor = GetParam().factor;
    const auto folder = car_with("named", full_names, [&](const Eigen::Vector3d& v) { return Eigen::Vector3d(v / factor); });
    const InspectReport r = inspect(folder);
    EXPECT_NEAR(scale_of(r, "vel_e_m_s"), factor, 1e-9 * factor);
    ASSERT_EQ(r.doubts.size(), 1U);
    EXPECT_NE(r.doubts.front().find(std::string("in ") + GetParam().name), std::string::npos) << r.doubts.front();
    EXPECT_TRUE(has_problem(r, Level::Warning, "do not agree with the positions"));
}

INSTANTIATE_TEST_SUITE_P(All, VelocityUnits,
                         testing::Values(Unit{"km/h", 1.0 / 3.6}, Unit{"kn", 1852.0 / 3600.0}, Unit{"ft/s", 0.3048},
                                         Unit{"mph", 0.44704}, Unit{"cm/s", 0.01}, Unit{"mm/s", 0.001}));

TEST(VelocityColumns, AsNamedSaysNothing) {
    for (const double latency : {0.0, 0.4}) {
        for (const double noise : {0.01, 1.5}) {
            CarLog car;
            car.velocity_latency = latency;
            car.position_noise = noise;
            const auto folder = car_with(
                "right", short_names, [](const Eigen::Vector3d& v) { return v; }, car);
            const InspectReport r = inspect(folder);
            EXPECT_EQ(fact(r, "gnss.scale"), nullptr);
            EXPECT_EQ(fact(r, "gnss.columns"), nullptr);
            EXPECT_EQ(fact(r, "gnss.use_velocity"), nullptr);
            EXPECT_TRUE(r.doubts.empty()) << r.doubts.front();
        }
    }
}

TEST(VelocityColumns, NorthAndEastExchanged) {
    const auto folder =
        car_with("exchanged", full_names, [](const Eigen::Vector3d& v) { return Eigen::Vector3d(v.y(), v.x(), v.z()); });
    const InspectReport r = inspect(folder);
    EXPECT_EQ(column_of(r, "vel_n_m_s"), "vel_e_m_s");
    EXPECT_EQ(column_of(r, "vel_e_m_s"), "vel_n_m_s");
    EXPECT_EQ(column_of(r, "lat_deg"), "");
    EXPECT_EQ(fact(r, "gnss.scale"), nullptr);
    ASSERT_EQ(r.doubts.size(), 1U);
    expect_car(r);
}

TEST(VelocityColumns, UpAsDown) {
    for (const char* header : {"time_s,lat_deg,lon_deg,height_m,vel_n_m_s,vel_e_m_s,vel_d_m_s",
                               "time_s,lat_deg,lon_deg,height_m,vel_n_m_s,vel_e_m_s,vel_u_m_s"}) {
        const bool down = std::string(header).find("vel_d") != std::string::npos;
        const auto folder = car_with(
            "up", header, [&](const Eigen::Vector3d& v) { return Eigen::Vector3d(v.x(), v.y(), down ? -v.z() : v.z()); });
        const InspectReport r = inspect(folder);
        EXPECT_NEAR(scale_of(r, "vel_d_m_s"), down ? -1.0 : 1.0, 1e-12);
        EXPECT_TRUE(std::isnan(scale_of(r, "vel_n_m_s")));
        ASSERT_EQ(r.doubts.size(), 1U);
        EXPECT_NE(r.doubts.front().find("opposite sign"), std::string::npos);
    }
}

TEST(VelocityColumns, AllReversedInKilometresPerHour) {
    const auto folder = car_with("reversed", short_names, [](const Eigen::Vector3d& v) { return Eigen::Vector3d(-3.6 * v); });
    const InspectReport r = inspect(folder);
    for (const char* key : {"vel_n_m_s", "vel_e_m_s", "vel_d_m_s"}) EXPECT_NEAR(scale_of(r, key), -1.0 / 3.6, 1e-9) << key;
    expect_car(r);
}

TEST(VelocityColumns, EastNorthUp) {
    const auto folder =
        car_with("enu", short_names, [](const Eigen::Vector3d& v) { return Eigen::Vector3d(v.y(), v.x(), -v.z()); });
    const InspectReport r = inspect(folder);
    EXPECT_EQ(column_of(r, "vel_n_m_s"), "ve");
    EXPECT_EQ(column_of(r, "vel_e_m_s"), "vn");
    EXPECT_NEAR(scale_of(r, "vel_d_m_s"), -1.0, 1e-12);
    expect_car(r);
}

/// No unit: a ratio of 0.7. Better no velocities than wrong ones.
TEST(VelocityColumns, OfNoKnownUnitAreNotUsed) {
    const auto folder = car_with("odd", full_names, [](const Eigen::Vector3d& v) { return Eigen::Vector3d(v / 0.7); });
    const InspectReport r = inspect(folder);
    EXPECT_TRUE(sets(r, "gnss.use_velocity = false")) << r.dataset_toml;
    EXPECT_TRUE(has_problem(r, Level::Warning, "in any known unit"));
    ASSERT_EQ(r.doubts.size(), 1U);
    expect_car(r);
}

TEST(VelocityColumns, UnrelatedOnesAreNotUsed) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0.0, 8.0);
    const auto folder = car_with("unrelated", full_names, [&](const Eigen::Vector3d&) {
        const double a = normal(random), b = normal(random);
        return Eigen::Vector3d(a, b, 0.0);
    });
    const InspectReport r = inspect(folder);
    EXPECT_TRUE(sets(r, "gnss.use_velocity = false")) << r.dataset_toml;
    EXPECT_TRUE(has_problem(r, Level::Warning, "in any order, sign or unit"));
}

TEST(VelocityColumns, GivenScaleIsContradictedNotReplaced) {
    const auto folder = car_with("given", short_names, [](const Eigen::Vector3d& v) { return Eigen::Vector3d(3.6 * v); });
    Given given;
    given.keys = {"gnss.scale"};
    given.gnss.scale = {{"vel_n_m_s", 1.0}, {"vel_e_m_s", 1.0}, {"vel_d_m_s", 1.0}};
    const InspectReport r = inspect(folder, given);
    EXPECT_EQ(fact(r, "gnss.scale"), nullptr);
    ASSERT_EQ(r.contradictions.size(), 1U);
    EXPECT_EQ(r.contradictions.front().key, "gnss.scale");
    EXPECT_FALSE(r.contradictions.front().refuted);
    EXPECT_NE(r.contradictions.front().text.find("km/h"), std::string::npos);
}

/// At 6 degrees of latitude and 3 of longitude a degree of either is as long: what is exchanged does not show.
TEST(VelocityColumns, ExchangedNearTheEquator) {
    CarLog car;
    car.position_noise = 0.5;
    const auto folder = car_with(
        "equator", full_names, [](const Eigen::Vector3d& v) { return Eigen::Vector3d(v.y(), v.x(), v.z()); }, car);
    std::ifstream in(folder / car.gnss_name);
    std::string text, line;
    std::getline(in, line);
    text = line + "\n";
    while (std::getline(in, line)) {
        double t = 0.0, lat = 0.0, lon = 0.0;
        int length = 0;
        if (std::sscanf(line.c_str(), "%lf,%lf,%lf%n", &t, &lat, &lon, &length) != 3) continue;
        constexpr double cos_45 = 0.70710678118654752, cos_6 = 0.99452189536827329;
        text += fmt::format("{:.6f},{:.10f},{:.10f}{}\n", t, lat - 39.0, 3.0 + (lon - 7.0) * cos_45 / cos_6,
                            line.substr(static_cast<std::size_t>(length)));
    }
    in.close();
    write_file(folder / car.gnss_name, text);
    const InspectReport r = inspect(folder);
    EXPECT_EQ(fact(r, "gnss.columns"), nullptr);
    EXPECT_TRUE(sets(r, "gnss.use_velocity = false"));
    EXPECT_TRUE(has_problem(r, Level::Warning, "near the equator"));
}

/// The columns of a u-blox NAV-PVT message as exported: whole numbers of 1e-7 deg, mm and mm/s.
TEST(VelocityColumns, NavigationSolutionOfUblox) {
    CarLog car;
    for (const bool angles : {true, false}) {
        const auto here = fresh_folder(angles ? "velocity_nav_pvt_1" : "velocity_nav_pvt_2");
        write_car(here, car);
        const auto written = [angles](const FixRow& f) {
            const double h = f.h - 290.0;  // too low to be recognised by its size
            const std::string place =
                angles ? fmt::format("{:.0f},{:.0f}", f.lon * 1e7, f.lat * 1e7) : fmt::format("{:.7f},{:.7f}", f.lon, f.lat);
            return fmt::format("{:.0f},{},{:.0f},{:.0f},2500,3800,{:.0f},{:.0f},{:.0f},{:.0f},0,350", f.t * 1e3, place, h * 1e3,
                               (h - 48.0) * 1e3, f.n * 1e3, f.e * 1e3, f.d * 1e3, std::hypot(f.n, f.e) * 1e3);
        };
        write_file(
            here / car.gnss_name,
            rewritten(here / car.gnss_name, "iTOW,lon,lat,height,hMSL,hAcc,vAcc,velN,velE,velD,gSpeed,headMot,sAcc", written));
        const InspectReport r = inspect(here);
        for (const char* key : {"height_m", "std_h_m", "std_d_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "std_vel_m_s"})
            EXPECT_NEAR(scale_of(r, key), 1e-3, 1e-12) << key;
        EXPECT_NEAR(std::get<double>(fact(r, "gnss.stated_std_m")->value), 2.5, 1e-9);
        EXPECT_TRUE(r.doubts.empty()) << r.doubts.front();
        expect_car(r);
    }
}

/// Accuracies and speeds in whole metres are just coarse.
TEST(VelocityColumns, WholeMetresStayMetres) {
    const auto folder = fresh_folder("velocity_whole_metres");
    CarLog car;
    write_car(folder, car);
    write_file(folder / car.gnss_name,
               rewritten(folder / car.gnss_name, "time_s,lat,lon,height,hAcc,vAcc,velN,velE,velD,sAcc", [](const FixRow& f) {
                   return fmt::format("{:.3f},{:.8f},{:.8f},{:.0f},12,20,{:.0f},{:.0f},{:.0f},1", f.t, f.lat, f.lon, f.h, f.n,
                                      f.e, f.d);
               }));
    const InspectReport r = inspect(folder);
    EXPECT_EQ(fact(r, "gnss.scale"), nullptr);
    EXPECT_EQ(fact(r, "gnss.use_velocity"), nullptr);
}

/// Heights in feet beside velocities in m/s.
TEST(VelocityColumns, HeightsInFeet) {
    const auto folder = fresh_folder("velocity_feet");
    CarLog car;
    write_car(folder, car);
    write_file(folder / car.gnss_name, rewritten(folder / car.gnss_name, "time_s,lat,lon,altitude,vn,ve,vd", [](const FixRow& f) {
                   return fmt::format("{:.3f},{:.9f},{:.9f},{:.2f},{},{},{}", f.t, f.lat, f.lon, f.h / 0.3048, f.n, f.e, f.d);
               }));
    const InspectReport r = inspect(folder);
    EXPECT_NEAR(scale_of(r, "height_m"), 0.3048, 1e-9);
    expect_car(r);
}

/// A receiver that stays, with a jump of its positions now and then: the jumps are no motion that the velocities would have to show.
TEST(VelocityColumns, JumpsOfTheTrackAreNoMotion) {
    const auto folder = fresh_folder("velocity_jumps");
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    std::string text = full_names + "\n";
    double off = 0.0;
    for (int i = 0; i < 3000; ++i) {
        if (i % 100 == 99) off = 30.0 * normal(random);
        const double n = off + 0.05 * normal(random), e = 0.05 * normal(random), v = 0.03 * normal(random);
        text += fmt::format("{:.1f},{:.9f},{:.9f},300.00,{:.3f},{:.3f},0.010\n", 1000.0 + 0.2 * i, 45.0 + n / 111131.7,
                            7.0 + e / 78846.8, v, -v);
    }
    write_file(folder / "gnss.csv", text);
    const InspectReport r = inspect(folder);
    EXPECT_EQ(fact(r, "gnss.use_velocity"), nullptr);
    EXPECT_EQ(fact(r, "gnss.scale"), nullptr);
}

/// It hovers and climbs: the vertical shows the unit of all three.
TEST(VelocityColumns, AHoveringVehicleShowsTheUnitInTheVertical) {
    const auto folder = fresh_folder("velocity_hover");
    std::mt19937 random(6);
    std::normal_distribution<double> normal;
    std::string text = short_names + "\n";
    for (int i = 0; i < 1500; ++i) {
        const double t = 0.2 * i, h = 300.0 + 8.0 * std::sin(0.15 * t) + 0.03 * normal(random), d = -1.2 * std::cos(0.15 * t);
        text += fmt::format("{:.1f},{:.9f},{:.9f},{:.3f},{:.3f},{:.3f},{:.3f}\n", 1000.0 + t, 45.0 + 1e-7 * normal(random),
                            7.0 + 1e-7 * normal(random), h, 0.1 * normal(random), 0.1 * normal(random), 3.6 * d);
    }
    write_file(folder / "gnss.csv", text);
    const InspectReport r = inspect(folder);
    for (const char* key : {"vel_n_m_s", "vel_e_m_s", "vel_d_m_s"}) EXPECT_NEAR(scale_of(r, key), 1.0 / 3.6, 1e-9) << key;
}

/// A car at rest: positions wander, velocities are noise; nothing can be said.
TEST(VelocityColumns, AtRestNothingIsSaid) {
    CarLog car;
    car.duration = 20.0;
    car.position_noise = 2.0;
    const auto folder = car_with(
        "rest", short_names, [](const Eigen::Vector3d& v) { return Eigen::Vector3d(3.6 * v); }, car);
    const InspectReport r = inspect(folder);
    EXPECT_EQ(fact(r, "gnss.scale"), nullptr);
    EXPECT_EQ(fact(r, "gnss.use_velocity"), nullptr);
}

}  // namespace
}  // namespace schuler::inspect::test
