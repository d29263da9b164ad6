// What is said of raw satellite measurements and ephemerides. The files are the seeds of the fuzz targets, whose contents
// tests/fuzz/make_corpus.py tells.
#include "schuler/inspect/inspect.h"

#include "schuler/io/rinex/rinex_write.h"

#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace schuler::inspect {
namespace {

class RawFiles : public testing::Test {
protected:
    /// A seed as a file of its own, inspected alone.
    FileReport report(const std::string& seed, const std::string& name) const {
        const auto from = std::filesystem::path(SCHULER_SOURCE_DIR) / "tests/fuzz/corpus" / seed;
        const auto to = folder_.path() / name;
        std::ofstream(to, std::ios::binary) << schuler::test::content_of(from).substr(1);
        const InspectReport r = inspect(to);
        for (const Problem& p : r.problems) EXPECT_NE(p.level, Level::Error) << p.text;
        for (const FileReport& f : r.files)
            EXPECT_TRUE(f.path.ends_with(name) || f.path.find(name + "#") != std::string::npos)
                << f.path;  // its instruments follow
        return r.files.at(0);
    }
    static void expect_line(const FileReport& report, const std::string& line) {
        EXPECT_EQ(std::ranges::count(report.contents, line), 1) << line << "\n is not among\n"
                                                                << testing::PrintToString(report.contents);
    }

    schuler::test::TemporaryFolder folder_{"inspect_raw"};
};

TEST_F(RawFiles, RinexObservations) {
    const FileReport r = report("rinex/observation3", "a.obs");
    EXPECT_EQ(r.kind, "rinex_obs");
    EXPECT_EQ(r.provides, std::vector<std::string>{"ranges"});
    EXPECT_EQ(r.rows, 3U);
    EXPECT_EQ(r.rate_hz, 1.0);
    expect_line(r, "3 epochs of raw measurements, 2023-01-08 09:59:42 to 2023-01-08 09:59:44 UTC, every 1 s");
    expect_line(r, "marker SEED");
    expect_line(r, "GPS: 2 satellites, on average 2.0 an epoch; signals 1C (CLDS)");
    expect_line(r, "BeiDou: 1 satellite, on average 1.0 an epoch; signals 2I (CLDS)");
    expect_line(r,
                "approximate position stated in it: 0.000000 deg latitude, 0.000000 deg longitude, "
                "0.0 m above the ellipsoid");
}

TEST_F(RawFiles, MissingEpochsAndEphemerides) {
    const auto file = folder_.path() / "holes.obs";
    {
        std::ofstream out(file);
        const auto line = [&](const std::string& text, const std::string& label) {
            out << text << std::string(60 - text.size(), ' ') << label << '\n';
        };
        line("     3.04           OBSERVATION DATA    G", "RINEX VERSION / TYPE");
        line("G    1 C1C", "SYS / # / OBS TYPES");
        line("", "END OF HEADER");
        for (const int second : {0, 1, 2, 4, 5, 6, 20, 21})
            out << "> 2023 01 08 10 00 " << (second < 10 ? " " : "") << second << ".0000000  0  1\nG03  20000000.000\n";
    }
    const InspectReport r = inspect(file);
    EXPECT_EQ(r.files.at(0).gaps, 1U);
    expect_line(r.files.at(0),
                "8 epochs of raw measurements, 2023-01-08 09:59:42 to 2023-01-08 10:00:03 UTC, every 1 s, 14 missing");
    expect_line(r.files.at(0), "GPS: 1 satellite, on average 1.0 an epoch; signals 1C (C)");
    EXPECT_EQ(std::ranges::count(r.problems, "there are raw measurements, and no ephemerides", &Problem::text), 1);
}

TEST_F(RawFiles, RinexNavigationAndPreciseOrbits) {
    const FileReport n = report("rinex/navigation3", "a.nav");
    EXPECT_EQ(n.kind, "rinex_nav");
    expect_line(n, "1 ephemeris of GLONASS: 1 satellite, 2023-01-08 09:45:00 to 2023-01-08 09:45:00 UTC");
    expect_line(n, "1 ephemeris of Galileo: 1 satellite, 2023-01-08 09:59:42 to 2023-01-08 09:59:42 UTC");
    expect_line(n, "ionosphere coefficients of GPS, BeiDou, Galileo");
    const FileReport p = report("rinex/sp3", "a.sp3");
    EXPECT_EQ(p.kind, "sp3");
    expect_line(p, "precise orbits and clocks, 3 epochs");
    expect_line(p, "GLONASS: 1 satellite, 2023-01-08 09:59:42 to 2023-01-08 10:29:42 UTC");
}

TEST_F(RawFiles, EphemeridesThatContradictEachOtherAreNamed) {
    gnss::Navigation navigation;
    for (const std::uint8_t number : {std::uint8_t{3}, std::uint8_t{7}}) {
        gnss::KeplerEphemeris k;
        k.satellite = {gnss::System::Gps, number};
        k.sqrt_a = 5153.7;
        k.e = 0.01;
        k.i0 = 0.96;
        k.accuracy = 2.0;
        const double a = k.sqrt_a * k.sqrt_a, n = std::sqrt(3.986005e14 / (a * a * a));
        for (const double t : {0.0, 3600.0}) {
            k.toe = k.toc = k.transmission = Time::from_gps(2244, 36'000.0 + t);
            k.m0 = n * t + (number == 7 ? t / 3600.0 * 1000.0 / a : 0.0);  // the second of one is a kilometre off
            navigation.kepler.push_back(k);
        }
    }
    const auto file = folder_.path() / "a.nav";
    std::ofstream(file) << io::rinex_navigation_text(navigation);
    const InspectReport r = inspect(file);
    const FileReport& f = r.files.at(0);
    EXPECT_EQ(std::ranges::count(f.problems, "ephemerides that contradict each other are not used: G07", &Problem::text), 1)
        << testing::PrintToString(f.contents);
}

TEST_F(RawFiles, LogsOfReceivers) {
    const FileReport u = report("receiver_logs/ubx", "a.ubx");
    EXPECT_EQ(u.kind, "ubx");
    EXPECT_EQ(u.provides, (std::vector<std::string>{"ranges", "ephemerides", "fixes"}));
    EXPECT_EQ(u.rows, 2U);
    expect_line(u, "GPS: 2 satellites, on average 2.0 an epoch; signals 1C (CLDS) 2X (CLDS)");
    expect_line(u, "2 ephemerides of BeiDou: 2 satellites, 2023-01-08 09:59:56 to 2023-01-08 09:59:56 UTC");
    expect_line(u, "1 fix of the receiver itself, 2023-01-08 09:59:42 to 2023-01-08 09:59:42 UTC");
    const FileReport t = report("receiver_logs/rtcm3", "a.rtcm3");
    EXPECT_EQ(t.kind, "rtcm3");
    expect_line(t, "3 epochs of raw measurements, 2023-01-08 09:59:42 to 2023-01-08 09:59:44 UTC, every 1 s");
    expect_line(t, "1 ephemeris of GLONASS: 1 satellite, 2023-01-08 09:45:00 to 2023-01-08 09:45:00 UTC");
}

}  // namespace
}  // namespace schuler::inspect
