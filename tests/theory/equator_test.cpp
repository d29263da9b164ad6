// The closed solution of paper C against 40-digit tables, the reference numbers of the specification and its own equations.
#include "schuler/theory/equator.h"

#include "schuler/core/error.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

namespace schuler::theory {
namespace {

using Rows = std::vector<std::vector<double>>;

Rows table(const std::string& name) {
    std::ifstream file(std::string(SCHULER_SOURCE_DIR) + "/tests/theory/" + name);
    Rows rows;
    for (std::string line; std::getline(file, line);) {
        std::vector<double>& row = rows.emplace_back();
        const char* at = line.c_str();
        for (char* end = nullptr;; at = end + 1) {
            row.push_back(std::strtod(at, &end));
            if (*end == '\0') break;
        }
    }
    EXPECT_FALSE(rows.empty()) << name;
    return rows;
}

void expect_close(double value, double exact, double relative, const std::string& what) {
    if (exact == 0.0) {
        EXPECT_EQ(value, 0.0) << what;
    } else {
        EXPECT_LE(std::abs(value - exact), relative * std::abs(exact)) << what << ": " << value << " for " << exact;
    }
}

TEST(Equator, FortyDigitTable) {
    double worst = 0.0;
    for (const std::vector<double>& row : table("equator_table.csv")) {
        ASSERT_EQ(row.size(), 39U);
        const EquatorFlight flight(row[0], row[1]);
        const Matrix6 P = flight.transition(row[2]);
        const double tolerance = flight.within_limits() ? 1e-12 : 1e-9;  // measured 3e-15
        for (int i = 0; i < 6; ++i)
            for (int j = 0; j < 6; ++j) {
                const double exact = row[static_cast<std::size_t>(3 + 6 * i + j)];
                const std::string what = "P(" + std::to_string(i) + ", " + std::to_string(j) + ") at " + std::to_string(row[0]) +
                                         " m/s, " + std::to_string(row[1]) + " m, " + std::to_string(row[2]) + " s";
                expect_close(P(i, j), exact, tolerance, what);
                if (exact != 0.0 && flight.within_limits()) worst = std::max(worst, std::abs(P(i, j) / exact - 1.0));
            }
    }
    RecordProperty("worst_relative", std::to_string(worst));
}

TEST(Equator, ForcedSolution) {
    for (const std::vector<double>& row : table("equator_forced.csv")) {
        ASSERT_EQ(row.size(), 19U);
        Eigen::Matrix3d l;
        l << row[4], row[5], row[6], row[7], row[8], row[9], row[10], row[11], row[12];
        const Vector6 x = forced_by_misalignment(EquatorFlight(row[0], row[1]), l, row[2], row[3]);
        for (int i = 0; i < 6; ++i)
            expect_close(x(i), row[static_cast<std::size_t>(13 + i)], 1e-10,
                         "x" + std::to_string(i) + " at " + std::to_string(row[0]));
    }
    // math.md 1.7: a rotation error about the pole forces the east channel by a constant, the vertical not at all.
    const Vector6 skew =
        forced_by_misalignment(EquatorFlight(600.0, 10000.0), misalignment_matrix({1e-5, 0.0, 0.0}), 0.3, 3600.0);
    const Vector6 expected =
        (Vector6() << 0.0, 1.80447703896, -0.209374391931, 1046.20185016, 0.0, -8.50973944740e-06).finished();
    for (const int i : {vh, ve, height, lon}) expect_close(skew(i), expected(i), 2e-10, "skew " + std::to_string(i));
    EXPECT_EQ(skew(vn), 0.0);
    EXPECT_EQ(skew(lat), 0.0);
}

TEST(Equator, ConstantsOfBothVehicles) {
    const EquatorConstants f = EquatorFlight(600.0, 10000.0).constants(), s = EquatorFlight(10.0, 0.0).constants();
    expect_close(f.g, 9.74989369403, 1e-11, "g");
    expect_close(f.a_h, 9.60606018849, 1e-11, "aH");
    expect_close(f.beta3, 0.00173228329403, 1e-11, "beta3");
    expect_close(f.omega, 0.00123540444154, 1e-11, "omega");
    expect_close(f.mu, 0.00124131768527, 1e-11, "mu");
    expect_close(s.a_h, 9.77901632171, 1e-11, "aH");
    expect_close(s.beta3, 0.00174708150796, 1e-11, "beta3");
    expect_close(s.omega, 0.00123831093511, 1e-11, "omega");
    expect_close(s.mu, 0.00124120891016, 1e-11, "mu");
}

TEST(Equator, LimitingSpeeds) {
    const double expected[3][3] = {
        {0.0, 7446.95126252, 8376.89938352}, {1e5, 7379.00610557, 8323.53422657}, {1e6, 6825.32937437, 7901.07749537}};
    for (const auto& [h, east, west] : expected) {
        const SpeedLimits limits = speed_limits(h);
        expect_close(limits.east, east, 1e-11, "east");
        expect_close(limits.west, west, 1e-11, "west");
        // On either side of each limit the roots are what the verdict says.
        EXPECT_TRUE(EquatorFlight(limits.east - 1e-3, h).within_limits());
        EXPECT_FALSE(EquatorFlight(limits.east + 1e-3, h).within_limits());
        EXPECT_TRUE(EquatorFlight(1e-3 - limits.west, h).within_limits());
        EXPECT_FALSE(EquatorFlight(-1e-3 - limits.west, h).within_limits());
    }
}

TEST(Equator, EveryRootIsOne) {
    // det(A - beta I) = 0, relative to the product of the other distances.
    for (const double v : {600.0, 0.0, -465.0, 7500.0, 9000.0, -8600.0}) {
        const EquatorFlight flight(v, 1000.0);
        Matrix6 D = Matrix6::Identity();  // SI units differ by 1e7: speeds in sqrt(g R), height in R
        const double R = flight.constants().R, speed = R * flight.constants().omega;
        D.diagonal() << speed, speed, speed, R, 1.0, 1.0;
        const Eigen::Matrix<std::complex<double>, 6, 6> A =
            (D.inverse() * flight.dynamics() * D / flight.constants().omega).cast<std::complex<double>>();
        for (const std::complex<double> root : flight.roots()) {
            const auto shifted = A - root / flight.constants().omega * Matrix6::Identity().cast<std::complex<double>>();
            EXPECT_LT(std::abs(shifted.eval().determinant()), 1e-12) << v << " m/s, root " << root;
        }
    }
}

TEST(Equator, OscillationsAndConstantsOfTheTables) {
    const EquatorFlight f(600.0, 10000.0);
    Vector6 x = Vector6::Zero();
    x(height) = 1.0;
    const EquatorFlight::Oscillation one = f.oscillation(x);
    expect_close(one.amplitude(vh), 1.17038285816e-05, 1e-9, "vh");
    expect_close(one.amplitude(ve), 0.000129554350985, 1e-9, "ve");
    expect_close(one.amplitude(height), 0.00942855219132, 1e-9, "height");
    expect_close(one.amplitude(lon), 1.64492448337e-08, 1e-9, "lon");
    EXPECT_NEAR(one.phase(vh), 0.0, 1e-12);
    EXPECT_NEAR(one.phase(ve), 0.5 * std::numbers::pi, 1e-12);
    EXPECT_NEAR(one.phase(height), -0.5 * std::numbers::pi, 1e-12);
    EXPECT_EQ(one.amplitude(vn), 0.0);
    EXPECT_TRUE(std::isnan(one.phase(vn)));
    const Vector6 C = f.integration_constants(x);
    expect_close(C(2), 0.504714276096, 1e-10, "C3");
    expect_close(C(4), -0.00942855219132, 1e-9, "C5");
    x = Vector6::Zero();
    x(lat) = 1.57e-7;
    EXPECT_NEAR(f.oscillation(x).amplitude(vn), 0.00123905440072, 1e-13);
    EXPECT_NEAR(std::abs(f.oscillation(x).phase(vn)), std::numbers::pi, 1e-12);

    // Oscillation plus exponentials are the solution, anywhere.
    const EquatorFlight w(-465.0, 0.0);
    const Vector6 start = (Vector6() << 0.3, -0.02, 0.1, 4.0, -2e-7, 3e-7).finished();
    const Vector6 K = w.integration_constants(start), at = w.transition(900.0) * start;
    const EquatorFlight::Oscillation o = w.oscillation(start);
    const double b = w.constants().beta3, m = w.constants().mu, t = 900.0;
    EXPECT_NEAR(K(2) * std::exp(b * t) + K(3) * std::exp(-b * t) + o.amplitude(height) * std::sin(m * t + o.phase(height)),
                at(height), 1e-10);
    EXPECT_NEAR(o.amplitude(vn) * std::sin(w.constants().omega * t + o.phase(vn)), at(vn), 1e-14);
}

TEST(Equator, RunOfThePaper) {
    // (24): the paper compares with MATLAB at 7200 s; its own misprints in row 2 are -1.3e-4 m/s there (docs/theory.md).
    const Vector6 start = (Vector6() << 0.01, 0.01, 0.01, 1.0, 1.57e-7, 1.57e-7).finished();
    const Vector6 x = EquatorFlight(600.0, 10000.0).transition(7200.0) * start;
    const double expected[6] = {-0.00925498816616, 1674.40565152, -124.066129404, 966589.3909, 5.049410494e-7, -0.01941366305};
    for (int i = 0; i < 6; ++i) expect_close(x(i), expected[i], 1e-9, std::to_string(i));
}

TEST(Equator, UnusableNumbersAreRefused) {
    EXPECT_THROW(EquatorFlight(std::nan(""), 0.0), Error);
    EXPECT_THROW(EquatorFlight(0.0, std::numeric_limits<double>::infinity()), Error);
    try {
        (void)EquatorFlight(0.0, -5000.0);
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.place().key, "height");
        EXPECT_NE(e.reason().find("under the ground"), std::string::npos);
    }
}

}  // namespace
}  // namespace schuler::theory
