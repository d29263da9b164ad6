#include "schuler/io/solution/solution_csv.h"
#include "schuler/io/own_files.h"
#include "schuler/io/text/fixed_point.h"

#include "schuler/core/samples.h"

#include "io/io_fixture.h"
#include "support/draws.h"

#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <random>

namespace schuler::io {
namespace {

template <int Decimals>
std::string fixed(double value) {
    char text[widest_number];
    return {text, put_fixed<Decimals>(text, value)};
}

std::string seconds(std::int64_t ns) {
    char text[widest_number];
    return {text, put_seconds(text, ns)};
}

TEST(FixedPoint, AgreesWithPrintf) {
    std::mt19937_64 rng(3);
    std::uniform_real_distribution<double> power(-12.0, 5.0), unit(-1.0, 1.0);
    const auto compare = [](const std::string& got, double value, int decimals) {
        char expected[128];
        std::snprintf(expected, sizeof expected, "%.*f", decimals, value);
        // A tie of the exact decimal value may round either way: then they differ by one unit of the last digit.
        if (got != expected) {
            EXPECT_EQ(got.size(),
                      std::string(expected[0] == '-' && std::strtod(expected, nullptr) == 0.0 ? expected + 1 : expected).size())
                << value;
            EXPECT_LE(std::abs(std::strtod(got.c_str(), nullptr) - value), 0.5000001 * std::pow(10.0, -decimals)) << value;
        }
        return got == expected;
    };
    int different = 0;
    for (int i = 0; i < 100000; ++i) {
        const double magnitude = std::pow(10.0, power(rng)), value = magnitude * unit(rng);
        different += compare(fixed<0>(value), value, 0) ? 0 : 1;
        different += compare(fixed<1>(value), value, 1) ? 0 : 1;
        different += compare(fixed<3>(value), value, 3) ? 0 : 1;
        different += compare(fixed<4>(value), value, 4) ? 0 : 1;
        different += compare(fixed<5>(value), value, 5) ? 0 : 1;
        different += compare(fixed<6>(value), value, 6) ? 0 : 1;
        if (std::abs(value) < 400.0) different += compare(fixed<10>(value), value, 10) ? 0 : 1;
    }
    EXPECT_LT(different, 250000);  // values that round to minus zero
}

TEST(FixedPoint, EdgesAndUnusualValues) {
    EXPECT_EQ(fixed<5>(0.0), "0.00000");
    EXPECT_EQ(fixed<5>(-0.0), "0.00000");
    EXPECT_EQ(fixed<5>(-0.000004), "0.00000");
    EXPECT_EQ(fixed<5>(-0.000006), "-0.00001");
    EXPECT_EQ(fixed<4>(99.99999), "100.0000");
    EXPECT_EQ(fixed<10>(-105.7654321), "-105.7654321000");
    EXPECT_EQ(fixed<4>(123456789.25), "123456789.2500");
    EXPECT_EQ(fixed<4>(std::numeric_limits<double>::quiet_NaN()), "");
    EXPECT_EQ(std::strtod(fixed<4>(1e300).c_str(), nullptr), 1e300);
    EXPECT_EQ(std::strtod(fixed<4>(-1.2345678e13).c_str(), nullptr), -1.2345678e13);
    EXPECT_EQ(fixed<4>(std::numeric_limits<double>::infinity()), "inf");
    EXPECT_EQ(seconds(100000005000000), "100000.005");
    EXPECT_EQ(seconds(1), "0.000000001");
    EXPECT_EQ(seconds(-1500000000), "-1.500");
    EXPECT_EQ(seconds(0), "0.000");
    EXPECT_EQ(seconds(std::numeric_limits<std::int64_t>::min()), "-9223372036.854775808");
}

class Solution : public test::IoTest {};

SolutionRow row(std::mt19937_64& rng, std::int64_t ns) {
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    const auto three = [&](double size) { return Eigen::Vector3d(size * schuler::test::draw3(u, rng)); };
    SolutionRow r;
    r.time.ns = ns;
    r.position = {1.57 * u(rng), std::numbers::pi * u(rng), 9000.0 * u(rng)};
    r.v_eb_n = three(300.0);
    r.rpy = three(1.5) + Eigen::Vector3d(0.0, 0.0, 3.0);
    r.std_position = three(10.0).cwiseAbs();
    r.std_velocity = three(1.0).cwiseAbs();
    r.std_rpy = three(0.1).cwiseAbs();
    return r;
}

TEST_F(Solution, RoundTrip) {
    std::mt19937_64 rng(4);
    std::vector<SolutionRow> rows;
    for (int i = 0; i < 20000; ++i)
        rows.push_back(row(rng, 100'000'000'000'000 + i * std::int64_t{5'000'123}));  // more than one buffer
    rows[7].std_rpy = not_given3();
    const auto path = folder() / "solution.csv";
    write_solution_csv(path, rows);
    WarningLog log;
    const std::vector<SolutionRow> back = read_solution_csv(path, log);
    ASSERT_EQ(back.size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(back[i].time, rows[i].time);
        EXPECT_NEAR(back[i].position.lat, rows[i].position.lat, 0.51e-10 * std::numbers::pi / 180.0);
        EXPECT_NEAR(back[i].position.lon, rows[i].position.lon, 0.51e-10 * std::numbers::pi / 180.0);
        EXPECT_NEAR(back[i].position.h, rows[i].position.h, 0.51e-4);
        EXPECT_LT((back[i].v_eb_n - rows[i].v_eb_n).cwiseAbs().maxCoeff(), 0.51e-5);
        EXPECT_LT((back[i].rpy - rows[i].rpy).cwiseAbs().maxCoeff(), 0.51e-6 * std::numbers::pi / 180.0);
        EXPECT_LT((back[i].std_position - rows[i].std_position).cwiseAbs().maxCoeff(), 0.51e-5);
        EXPECT_LT((back[i].std_velocity - rows[i].std_velocity).cwiseAbs().maxCoeff(), 0.51e-5);
        if (i == 7) EXPECT_TRUE(back[i].std_rpy.array().isNaN().all());
        else EXPECT_LT((back[i].std_rpy - rows[i].std_rpy).cwiseAbs().maxCoeff(), 0.51e-6 * std::numbers::pi / 180.0);
    }
    EXPECT_TRUE(log.empty());
}

TEST_F(Solution, TextIsAsDocumented) {
    SolutionRow r;
    r.time.ns = 100030005000000;
    r.position = {0.5, -2.0, -12.34567};
    r.v_eb_n = {1.0, -2.5, 0.0};
    r.rpy = {0.0, 0.1, 2.0 * std::numbers::pi - 1e-12};
    r.std_position = {0.01, 0.02, 0.03};
    r.std_velocity = not_given3();
    r.std_rpy = {0.001, 0.001, 0.001};
    write_solution_csv(folder() / "s.csv", std::span(&r, 1));
    EXPECT_EQ(
        content_of(folder() / "s.csv"),
        "time_s,lat_deg,lon_deg,height_m,vel_n_m_s,vel_e_m_s,vel_d_m_s,roll_deg,pitch_deg,heading_deg,std_n_m,std_e_m,std_d_m,"
        "std_vn_m_s,std_ve_m_s,std_vd_m_s,std_roll_deg,std_pitch_deg,std_heading_deg\n"
        "100030.005,28.6478897565,-114.5915590262,-12.3457,1.00000,-2.50000,0.00000,0.000000,5.729578,0.000000,"
        "0.01000,0.02000,0.03000,,,,0.057296,0.057296,0.057296\n");
}

TEST_F(Solution, LegsAreALastColumnWhereThereAreSeveral) {
    std::mt19937_64 rng(4);
    const std::vector<SolutionRow> rows{row(rng, 1'000'000'000), row(rng, 2'000'000'000), row(rng, 9'000'000'000)};
    const std::vector<Time> legs{Time{500'000'000}, Time{9'000'000'000}};
    write_solution_csv(folder() / "s.csv", rows, legs);
    const std::string text = content_of(folder() / "s.csv");
    EXPECT_EQ(text.substr(0, text.find('\n')), std::string(solution_csv_header()) + ",leg");
    EXPECT_EQ(text.substr(text.size() - 3), ",2\n");
    WarningLog log;
    EXPECT_EQ(read_solution_csv(folder() / "s.csv", log).size(), 3u);
    write_solution_csv(folder() / "one.csv", rows, std::span(legs).first(1));
    EXPECT_EQ(content_of(folder() / "one.csv").find("leg"), std::string::npos);
}

TEST_F(Solution, AppearsOnlyWhenCommitted) {
    const auto path = folder() / "solution.csv";
    {
        SolutionCsvWriter writer(path);
        std::mt19937_64 rng(5);
        writer.append(row(rng, 0));
        EXPECT_FALSE(std::filesystem::exists(path));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder())) << "the temporary file is removed";
    write("solution.csv", "old");
    test::expect_parts(test::message_of([&] { AtomicFile file(path); }), {"solution.csv", "exists", "--force"});
    EXPECT_EQ(content_of(path), "old");
    allow_overwrite(path);
    {
        AtomicFile file(path);
        file.write("new");
        EXPECT_EQ(content_of(path), "old");
        file.commit();
    }
    EXPECT_EQ(content_of(path), "new");
    test::expect_parts(test::message_of([&] { AtomicFile file(folder() / "no/such/f.csv"); }),
                       {"no/such/f.csv", "cannot be written", "make the folder"});
    test::expect_parts(test::message_of([&] { AtomicFile file(folder()); }), {"cannot be written"});
    write_file("/dev/null", "x");  // written directly, not replaced
    EXPECT_TRUE(std::filesystem::is_character_file(std::filesystem::path("/dev/null")));
    try {
        write_file("/dev/full", "x");
        ADD_FAILURE() << "written to a full disk";
    } catch (const Error& e) {  // no fault of the computation: exit status 2
        EXPECT_EQ(e.kind(), ErrorKind::Input);
        test::expect_parts(e.what(), {"/dev/full", "cannot be written", "make room"});
    }
}

}  // namespace
}  // namespace schuler::io
