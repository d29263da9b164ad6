// Recordings in parts, in one table, too short: what is not used is told, what can be read is.
#include "inspect/report_queries.h"
#include "inspect/synthetic_car.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

namespace schuler::inspect::test {
namespace {

std::vector<std::string> lines_of(const std::filesystem::path& path) {
    std::ifstream in(path);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}
void write_lines(const std::filesystem::path& path, const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    write_file(path, text);
}
bool has_doubt(const InspectReport& report, const std::string& text) {
    return std::ranges::any_of(report.doubts, [&](const std::string& d) { return d.find(text) != std::string::npos; });
}

/// imu.csv in two parts with the given names; the second begins `shift` rows behind the end of the first.
std::vector<std::string> split_imu(const std::filesystem::path& folder, const std::string& first, const std::string& second,
                                   int shift) {
    const std::vector<std::string> all = lines_of(folder / "imu.csv");
    const auto half = all.begin() + 6001;
    write_lines(folder / first, {all.begin(), half});
    std::vector<std::string> rest{all.front()};
    rest.insert(rest.end(), half + shift, all.end());
    write_lines(folder / second, rest);
    std::filesystem::remove(folder / "imu.csv");
    return rest;
}

TEST(Strangers, PartsOfALogAreJoined) {
    const auto whole = fresh_folder("whole");
    write_car(whole, {});
    const InspectReport reference = inspect(whole);
    for (const auto& [first, second] : {std::pair("imu_0001.csv", "imu_0002.csv"), std::pair("imu.csv.2", "imu.csv.1"),
                                        std::pair("2024-05-01-part1.csv", "2024-05-01-part2.csv")}) {
        SCOPED_TRACE(first);
        const auto folder = fresh_folder("parts");
        write_car(folder, {});
        split_imu(folder, first, second, -50);
        const InspectReport r = inspect(folder);
        EXPECT_TRUE(sets(r, std::string("imu.file = \"") + first + '"'));
        EXPECT_TRUE(sets(r, std::string("imu.parts = [\"") + second + "\"]"));
        EXPECT_TRUE(has_problem(r, Level::Info, "are parts of one log and are joined; 0.5 s of"));
        EXPECT_TRUE(r.doubts.empty()) << r.doubts.front();
        ASSERT_EQ(r.motion.t.size(), reference.motion.t.size());
        EXPECT_EQ(r.findings.size(), reference.findings.size());
        const auto file = std::ranges::find(r.files, first, &FileReport::path);
        ASSERT_NE(file, r.files.end());
        EXPECT_EQ(file->rows, std::ranges::find(reference.files, "imu.csv", &FileReport::path)->rows);
    }
}

TEST(Strangers, APauseBetweenPartsIsTold) {
    const auto folder = fresh_folder("parts_pause");
    write_car(folder, {});
    split_imu(folder, "imu_1.csv", "imu_2.csv", 500);
    const InspectReport r = inspect(folder);
    EXPECT_TRUE(sets(r, "imu.parts = [\"imu_2.csv\"]"));
    EXPECT_TRUE(has_doubt(r, "s are missing before imu_2.csv"));
}

TEST(Strangers, APartThatIsNotJoinedIsTold) {
    const auto folder = fresh_folder("parts_other");
    write_car(folder, {});
    std::vector<std::string> rest = split_imu(folder, "imu_1.csv", "imu_2.csv", 0);
    rest.front() += ",temperature";
    for (std::size_t i = 1; i < rest.size(); ++i) rest[i] += ",20";
    write_lines(folder / "imu_2.csv", rest);
    const InspectReport columns = inspect(folder);
    EXPECT_TRUE(sets(columns, "imu.file = \"imu_1.csv\""));
    EXPECT_TRUE(has_doubt(columns, "imu_2.csv is named like a part of imu_1.csv, but has other columns: it is not used"));
    std::filesystem::rename(folder / "imu_2.csv", folder / "later.csv");
    rest.front() = lines_of(folder / "imu_1.csv").front();
    write_lines(folder / "later.csv", rest);
    const InspectReport name = inspect(folder);
    EXPECT_TRUE(has_doubt(name, "later.csv continues imu_1.csv"));
    EXPECT_TRUE(has_doubt(name, "[imu] parts = [\"later.csv\"]"));
}

TEST(Strangers, DatesWhoseDayAndMonthDoNotShowAreRefused) {
    for (const auto& [date, open] : {std::pair("05/03/2024", true), std::pair("13/03/2024", false),
                                     std::pair("05/05/2024", false), std::pair("2024/05/03", false)}) {
        const auto folder = fresh_folder("open_dates");
        std::vector<std::string> imu{"time,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2"};
        for (int i = 0; i < 200; ++i) imu.push_back(fmt::format("{} 14:00:{:05.2f},0,0,0,0,0,-9.8", date, 0.01 * i));
        write_lines(folder / "imu.csv", imu);
        const InspectReport r = inspect(folder);
        const auto& problems = r.files.front().problems;
        EXPECT_EQ(std::ranges::any_of(problems,
                                      [](const Problem& p) {
                                          return p.level == Level::Error &&
                                                 p.text.find("in line 2 is 2024-03-05 (day first) or 2024-05-03 (month first)") !=
                                                     std::string::npos;
                                      }),
                  open)
            << date;
    }
}

TEST(Strangers, ASecondUnitIsNoOtherPart) {
    const auto folder = fresh_folder("second_unit");
    write_car(folder, {});
    std::filesystem::copy_file(folder / "imu.csv", folder / "imu_2.csv");
    const InspectReport r = inspect(folder);
    EXPECT_TRUE(r.doubts.empty()) << r.doubts.front();
    EXPECT_TRUE(has_problem(r, Level::Info, "could be [imu] as well"));
}

/// One table of both instruments; the cells of the fixes are blank between them, or hold the last one.
TEST(Strangers, OneTableOfImuAndFixes) {
    for (const bool held : {false, true}) {
        const auto folder = fresh_folder(held ? "one_table_held" : "one_table_blank");
        write_car(folder, {});
        const std::vector<std::string> imu = lines_of(folder / "imu.csv"), gnss = lines_of(folder / "gnss.csv");
        std::vector<std::string> table{imu[0] + gnss[0].substr(gnss[0].find(','))};
        std::size_t fix = 0;
        for (std::size_t i = 1; i < imu.size(); ++i) {
            bool fresh = false;
            while (fix + 1 < gnss.size() && std::atof(gnss[fix + 1].c_str()) <= std::atof(imu[i].c_str()) + 1e-6) {
                ++fix;
                fresh = true;
            }
            table.push_back(imu[i] + (held || fresh ? gnss[fix].substr(gnss[fix].find(',')) : std::string(",,,,,,")));
        }
        std::filesystem::remove(folder / "imu.csv");
        std::filesystem::remove(folder / "gnss.csv");
        write_lines(folder / "log.csv", table);
        const InspectReport r = inspect(folder);
        EXPECT_TRUE(sets(r, "imu.file = \"log.csv\"")) << r.dataset_toml;
        EXPECT_TRUE(sets(r, "gnss.file = \"log.csv\""));
        EXPECT_EQ(value_of(r, "imu.axes"), "frd");
        EXPECT_EQ(value_of(r, "vehicle.kind"), "car");
        const auto fixes = std::ranges::find(r.files, "gnss", &FileReport::kind);
        ASSERT_NE(fixes, r.files.end());
        EXPECT_NEAR(fixes->rate_hz, 5.0, 0.01);
        EXPECT_GE(fixes->rows, 490U);
        EXPECT_LE(fixes->rows, 600U);
        EXPECT_NEAR(number_of(r, "gnss.latency_s"), 0.0, 0.03);
    }
}

/// The solution of a navigation system in the table of its IMU: circular if it were taken for fixes.
TEST(Strangers, PositionsOfEverySampleAreNoFixes) {
    const auto folder = fresh_folder("own_solution");
    CarLog car;
    car.gnss_rate = car.imu_rate;
    write_car(folder, car);
    const std::vector<std::string> imu = lines_of(folder / "imu.csv"), gnss = lines_of(folder / "gnss.csv");
    ASSERT_EQ(imu.size(), gnss.size());
    std::vector<std::string> table;
    for (std::size_t i = 0; i < imu.size(); ++i) table.push_back(imu[i] + gnss[i].substr(gnss[i].find(',')));
    std::filesystem::remove(folder / "imu.csv");
    std::filesystem::remove(folder / "gnss.csv");
    write_lines(folder / "log.csv", table);
    const InspectReport r = inspect(folder);
    EXPECT_EQ(fact(r, "gnss.file"), nullptr);
    EXPECT_TRUE(has_problem(r, Level::Warning, "has positions at 100 Hz, as a navigation system computes them"));
}

/// A log of the receiver itself is preferred to what the table of the IMU repeats of it.
TEST(Strangers, TheReceiversOwnLogIsPreferred) {
    const auto folder = fresh_folder("own_log_preferred");
    CarLog car;
    car.write_velocity = false;
    car.gnss_header = "time_s,lat_deg,lon_deg,height_m,std_n_m,std_e_m,std_d_m";
    write_car(folder, car);
    std::vector<std::string> imu = lines_of(folder / "imu.csv");
    const std::vector<std::string> gnss = lines_of(folder / "gnss.csv");
    for (std::size_t i = 0; i < imu.size(); ++i) {
        const std::string& fix = gnss[i == 0 ? 0 : 1 + (i - 1) / 20];
        imu[i] += fix.substr(fix.find(','), fix.rfind(',', fix.rfind(',') - 1) - fix.find(','));
    }
    write_lines(folder / "a_imu.csv", imu);
    std::filesystem::remove(folder / "imu.csv");
    const InspectReport r = inspect(folder);
    EXPECT_TRUE(sets(r, "imu.file = \"a_imu.csv\"")) << r.dataset_toml;
    EXPECT_TRUE(sets(r, "gnss.file = \"gnss.csv\""));
}

TEST(Strangers, GivenFixCodesThatDoNotOccurAreTold) {
    const auto folder = fresh_folder("codes");
    write_car(folder, {});
    std::vector<std::string> gnss = lines_of(folder / "gnss.csv");
    for (std::size_t i = 0; i < gnss.size(); ++i) gnss[i] += i == 0 ? ",fix" : ",4";
    write_lines(folder / "gnss.csv", gnss);
    Given given;
    given.keys = {"gnss.fix_codes"};
    given.fix_codes = {{"4", "rtk_fixed"}, {"9", "none"}};
    const InspectReport r = inspect(folder, given);
    EXPECT_TRUE(has_doubt(r, "gnss.fix_codes: 9 does not occur in gnss.csv, which has 4"));
    given.fix_codes = {{"4", "rtk_fixed"}};
    EXPECT_TRUE(inspect(folder, given).doubts.empty());
}

TEST(Strangers, OfOtherInstrumentsInTheTableTheMagnetometerIsUsedAndTheOthersAreTold) {
    const auto folder = fresh_folder("others");
    write_car(folder, {});
    std::vector<std::string> imu = lines_of(folder / "imu.csv");
    for (std::size_t i = 0; i < imu.size(); ++i)
        imu[i] += i == 0 ? ",mag_x,mag_y,mag_z,pressure_hpa,wheel_speed_m_s,yaw_deg"
                         : fmt::format(",20.{},3.2,40.5,1009.2,7.1,33.0", i % 3);
    write_lines(folder / "imu.csv", imu);
    const InspectReport r = inspect(folder);
    EXPECT_TRUE(sets(r, "mag.file = \"imu.csv\"")) << r.dataset_toml;
    EXPECT_NEAR(number_of(r, "mag.norm"), 45.3, 0.2);
    EXPECT_FALSE(has_problem(r, Level::Info, "a magnetometer too"));
    EXPECT_TRUE(has_problem(r, Level::Info, "a barometer too, which are not used: pressure_hpa"));
    EXPECT_TRUE(has_problem(r, Level::Info, "an odometer's, which are not used: wheel_speed_m_s"));
    EXPECT_TRUE(has_problem(r, Level::Info, "look like headings, which are not used: yaw_deg"));
    EXPECT_TRUE(r.doubts.empty());
    // also where the IMU alone is named, but readings that never change are none
    Given named;
    named.find_logs = false;
    named.find_companions = true;
    named.keys = {"imu.file"};
    named.imu.path = folder / "imu.csv";
    named.imu.name = "imu.csv";
    EXPECT_TRUE(sets(inspect(folder, named), "mag.file = \"imu.csv\""));
    const auto stuck = fresh_folder("others_stuck");
    write_car(stuck, {});
    std::vector<std::string> constant = lines_of(stuck / "imu.csv");
    for (std::size_t i = 0; i < constant.size(); ++i) constant[i] += i == 0 ? ",mag_x,mag_y,mag_z" : ",20.1,3.2,40.5";
    write_lines(stuck / "imu.csv", constant);
    EXPECT_FALSE(sets(inspect(stuck), "mag.file = \"imu.csv\""));
    // named for the magnetometer, the table is that of the IMU all the same
    Given given;
    given.keys = {"mag.file"};
    given.mag.path = folder / "imu.csv";
    given.mag.name = "imu.csv";
    const InspectReport both = inspect(folder, given);
    EXPECT_TRUE(sets(both, "imu.file = \"imu.csv\"")) << both.dataset_toml;
    EXPECT_NEAR(number_of(both, "mag.norm"), 45.3, 0.2);
}

TEST(Strangers, SerialDatesAreRefusedWithTheirName) {
    const auto folder = fresh_folder("serial");
    CarLog car;
    car.time_factor = 1.0 / 86400.0;
    car.imu_start = car.gnss_start = 45413.0 * 86400.0 + 1000.0;
    write_car(folder, car);
    for (const char* name : {"imu.csv", "gnss.csv"}) {  // as many digits as a spreadsheet writes
        std::vector<std::string> rows = lines_of(folder / name);
        const double rate = name[0] == 'i' ? car.imu_rate : car.gnss_rate;
        for (std::size_t i = 1; i < rows.size(); ++i)
            rows[i] = fmt::format("{:.10f}{}", 45413.0 + (1000.0 + static_cast<double>(i - 1) / rate) / 86400.0,
                                  rows[i].substr(rows[i].find(',')));
        write_lines(folder / name, rows);
    }
    const InspectReport r = inspect(folder);
    ASSERT_TRUE(r.refusal.has_value());
    EXPECT_NE(r.refusal->text.find("serial dates of a spreadsheet"), std::string::npos);
    EXPECT_EQ(r.refusal->file, "imu.csv");
}

TEST(Strangers, ALinkIsTheFileItLeadsTo) {
    const auto folder = fresh_folder("links");
    write_car(folder, {});
    std::filesystem::create_symlink("imu.csv", folder / "again.csv");
    std::filesystem::rename(folder / "gnss.csv", folder.parent_path() / "fixes_elsewhere.csv");
    std::filesystem::create_symlink("../fixes_elsewhere.csv", folder / "gnss.csv");
    std::filesystem::create_symlink("nowhere.csv", folder / "broken.csv");
    const InspectReport r = inspect(folder);
    EXPECT_TRUE(sets(r, "imu.file = \"imu.csv\""));
    EXPECT_TRUE(sets(r, "gnss.file = \"gnss.csv\"")) << r.dataset_toml;
    EXPECT_EQ(std::ranges::count(r.files, "imu.csv", &FileReport::path), 1);
    EXPECT_EQ(file_named(r, "again.csv"), nullptr);
    EXPECT_TRUE(has_problem(r, Level::Info, "again.csv is a link to imu.csv"));
    EXPECT_TRUE(has_problem(r, Level::Warning, "broken.csv is a link to nowhere.csv, which does not exist"));
    EXPECT_FALSE(has_problem(r, Level::Info, "could be [imu] as well"));
}

TEST(Strangers, FoldersThatAreNotLookedThroughAreNamed) {
    const auto folder = fresh_folder("deep");
    const std::string far = "folders further down are not looked through: ";
    std::filesystem::create_directories(folder / "a/b/c");
    write_car(folder / "a/b", {});
    EXPECT_TRUE(sets(inspect(folder), "imu.file = \"a/b/imu.csv\""));
    EXPECT_TRUE(has_problem(inspect(folder), Level::Info, far + "a/b/c"));
    std::filesystem::rename(folder / "a/b/imu.csv", folder / "a/b/c/imu.csv");
    std::filesystem::remove(folder / "a/b/gnss.csv");
    EXPECT_TRUE(has_problem(inspect(folder), Level::Warning, far + "a/b/c"));
    std::filesystem::create_directories(folder / "other/one");
    std::filesystem::create_directories(folder / "other/two");
    EXPECT_TRUE(has_problem(inspect(folder), Level::Warning, far + "a/b, other/one, other/two"));
}

TEST(Strangers, TheWeekBesideTheSecondsOfTheWeekIsTaken) {
    const auto with_week = [](const std::filesystem::path& file, const std::string& name, const std::string& week) {
        std::vector<std::string> lines = lines_of(file);
        for (std::string& line : lines) line = (&line == &lines.front() ? name : week) + "," + line;
        write_lines(file, lines);
    };
    CarLog car;
    car.imu_start = car.gnss_start = 200'000.0;
    car.imu_header = "gps_sow_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2";
    const auto folder = fresh_folder("week");
    write_car(folder, car);
    EXPECT_FALSE(sets(inspect(folder), "time.week = 2244")) << "no column gives it";
    with_week(folder / "imu.csv", "gps_week", "2244");
    const InspectReport r = inspect(folder);
    EXPECT_TRUE(sets(r, "time.week = 2244")) << r.dataset_toml;
    const FileReport* imu = file_named(r, "imu.csv");
    ASSERT_NE(imu, nullptr);
    EXPECT_TRUE(std::ranges::any_of(imu->understood, [](const std::string& line) { return line.find("gps_week") == 0; }))
        << "not among the unused columns";
    // another week in the other log, and numbers that are no weeks
    write_car(folder, car);
    with_week(folder / "imu.csv", "gps_week", "2244");
    with_week(folder / "gnss.csv", "week", "2245");
    EXPECT_TRUE(has_problem(inspect(folder), Level::Warning, "imu.csv is of GPS week 2244 and gnss.csv of week 2245"));
    write_car(folder, car);
    with_week(folder / "imu.csv", "gps_week", "12");
    EXPECT_FALSE(sets(inspect(folder), "time.week = 12"));
}

TEST(Strangers, TooShortIsSaid) {
    const auto folder = fresh_folder("short");
    CarLog car;
    car.duration = 6.0;
    write_car(folder, car);
    const InspectReport r = inspect(folder);
    EXPECT_TRUE(has_doubt(r, "too short"));
    EXPECT_TRUE(std::isnan(number_of(r, "imu.scale.gyro_rad_s"))) << "no unit is refuted by so little";
    car.duration = 120.0;
    write_car(folder, car);
    EXPECT_FALSE(has_doubt(inspect(folder), "too short"));
}

}  // namespace
}  // namespace schuler::inspect::test
