// ANTEX files: made up in the columns of the format's description.
#include "schuler/io/rinex/antex.h"
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/io/formats.h"

#include "io/io_fixture.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace schuler::io {
namespace {

std::string line(const std::string& content, const std::string& label) { return fmt::format("{:60}{}\n", content, label); }

std::string row(const std::string& name, const std::vector<double>& values) {
    std::string out = fmt::format("{:>8}", name);
    for (const double v : values) out += fmt::format("{:8.2f}", v);
    return out + "\n";
}

std::string carrier(const std::string& code, const std::string& offset, const std::string& rows) {
    return line("   " + code, "START OF FREQUENCY") + line(offset, "NORTH / EAST / UP") + rows +
           line("   " + code, "END OF FREQUENCY");
}

const std::string antex_header =
    line("     1.4            M", "ANTEX VERSION / SYST") + line("A", "PCV TYPE / REFANT") + line("", "END OF HEADER");

std::string receiver(const std::string& rows_of_l1) {
    return line("", "START OF ANTENNA") + line("MADE UP         NONE                    ", "TYPE / SERIAL NO") +
           line("     0.0", "DAZI") + line("     0.0  90.0  45.0", "ZEN1 / ZEN2 / DZEN") + line("     2", "# OF FREQUENCIES") +
           line("a remark", "COMMENT") + carrier("G01", "      1.00     -2.00     66.80", rows_of_l1) +
           carrier("E05", "      0.50      0.25     51.00", row("NOAZI", {0, -1, 2})) + line("   G01", "START OF FREQ RMS") +
           line("      0.10      0.10      0.10", "NORTH / EAST / UP") + row("NOAZI", {9, 9, 9}) +
           line("   G01", "END OF FREQ RMS") + line("", "END OF ANTENNA");
}

const std::string satellite =
    line("", "START OF ANTENNA") + line("BLOCK IIF           G01                 G063      2011-036A", "TYPE / SERIAL NO") +
    line("     5.0", "DAZI") + line("     0.0  17.0  17.0", "ZEN1 / ZEN2 / DZEN") + line("     1", "# OF FREQUENCIES") +
    line("  2011     7    16     0     0    0.0000000", "VALID FROM") +
    line("  2020     1     1    23    59   59.9999999", "VALID UNTIL") +
    [] {
        std::string rows = row("NOAZI", {6.1, 5.7});
        for (int azimuth = 0; azimuth <= 360; azimuth += 5) rows += row(fmt::format("{:.1f}", 1.0 * azimuth), {1.0 * azimuth, 0});
        return carrier("G01", "    394.00      0.00   1501.80", rows);
    }() +
    line("", "END OF ANTENNA");

TEST(Antex, OffsetsAndVariationsOfEachCarrier) {
    WarningLog log;
    const AntexFile file =
        read_antex(TextInput::memory(antex_header + receiver(row("NOAZI", {0, -3.5, 7})) + satellite, "a.atx"), log);
    EXPECT_EQ(file.records.read, 2U);
    EXPECT_TRUE(log.summary().empty());
    const gnss::Antenna* a = file.antennas.of_receiver("MADE UP         NONE");
    ASSERT_NE(a, nullptr);
    ASSERT_EQ(a->carriers.size(), 2U);
    EXPECT_LT((a->carriers[0].offset - Eigen::Vector3d(1e-3, -2e-3, 66.8e-3)).norm(), 1e-12);
    EXPECT_NEAR(a->carriers[0].frequency, 1575.42e6, 1.0);
    EXPECT_NEAR(a->carriers[0].variation.at(45.0 * units::deg, 1.0), -3.5e-3, 1e-12);
    EXPECT_NEAR(a->carriers[0].variation.at(67.5 * units::deg, 2.0), 1.75e-3, 1e-12);
    EXPECT_EQ(a->on(1176e6), &a->carriers[1]);
    const Time within = gps_from_utc({2015, 1, 1, 0, 0, 0.0}), after = gps_from_utc({2021, 1, 1, 0, 0, 0.0});
    const gnss::SatelliteId g1{gnss::System::Gps, 1};
    const gnss::Antenna* s = file.antennas.of_satellite(g1, within);
    ASSERT_NE(s, nullptr);
    EXPECT_EQ(file.antennas.of_satellite(g1, after), nullptr);
    EXPECT_NEAR(s->carriers[0].offset.z(), 1.5018, 1e-12);
    EXPECT_NEAR(s->carriers[0].variation.at(0.0, 47.5 * units::deg), 47.5e-3, 1e-9);
}

TEST(Antex, DamagedAntennasAreLeftOut) {
    WarningLog log;
    // a row that is cut, and an antenna without an end
    const std::string text =
        antex_header + receiver(row("NOAZI", {0, 1})) + satellite + receiver(row("NOAZI", {0, 1, 2})).substr(0, 400);
    const AntexFile file = read_antex(TextInput::memory(text, "a.atx"), log);
    EXPECT_EQ(file.records.read, 1U);
    EXPECT_EQ(file.records.bad, 2U);
    EXPECT_TRUE(file.antennas.receivers.empty());
    ASSERT_EQ(log.summary().size(), 1U);
    EXPECT_NE(log.summary()[0].find("line 4"), std::string::npos) << log.summary()[0];
}

TEST(Antex, OtherFilesAreRefused) {
    WarningLog log;
    test::expect_parts(test::message_of([&] { (void)read_antex(TextInput::memory("time_s\n", "a.atx"), log); }),
                       {"a.atx:1", "not an ANTEX"});
    test::expect_parts(test::message_of([&] { (void)read_antex(TextInput::memory(antex_header, "a.atx"), log); }),
                       {"no usable antenna"});
}

}  // namespace
}  // namespace schuler::io
