// Real receivers: single-point fixes against those of RTKLIB's rnx2rtkp with the same options.
#include "schuler/core/units.h"
#include "schuler/earth/earth.h"
#include "schuler/gnss/single_point.h"
#include "schuler/io/receiver/rtcm3.h"
#include "schuler/io/receiver/ubx.h"
#include "schuler/io/rinex/rinex.h"
#include "schuler/io/solution/rtklib_pos.h"

#include "io/io_fixture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace schuler::gnss {
namespace {

using units::deg;

/// Where and when.
struct Fix {
    Time time;
    Geodetic position;
};

class Rnx2rtkp : public io::test::IoTest {
protected:
    static std::vector<Fix> solved(const ObservationLog& log, const Navigation& navigation, const SinglePointSettings& settings) {
        const BroadcastSource source(navigation);
        SinglePoint solver(source, broadcast_ionosphere(navigation), settings);
        std::vector<Fix> fixes;
        for (const ObservationEpoch& e : log.epochs) {
            const SinglePointSolution s = solver.solve(log.of(e), e.time, log.channels);
            if (s.status == SinglePointStatus::Solved)
                fixes.push_back({s.time, earth::geodetic_from_ecef(earth::wgs84, s.position)});
        }
        return fixes;
    }
    std::vector<Fix> theirs(const std::filesystem::path& observations, const std::filesystem::path& navigation) {
        // GPS and Galileo, the models that SinglePointSettings has by default
        const auto settings = write("rtklib.conf",
                                    "pos1-posmode =single\npos1-elmask =15\npos1-ionoopt =brdc\npos1-tropopt =saas\n"
                                    "pos1-navsys =9\nout-solformat =llh\nout-timesys =gpst\nout-height =ellipsoidal\n");
        const std::string command = "rnx2rtkp -k " + settings.string() + " -o " + (folder() / "r.pos").string() + " " +
                                    observations.string() + " " + navigation.string() + " > /dev/null 2>&1";
        EXPECT_EQ(std::system(command.c_str()), 0) << command;
        std::vector<Fix> fixes;
        for (const GnssFix& f : io::read_rtklib_pos(folder() / "r.pos", log).fixes) fixes.push_back({f.time, f.position});
        return fixes;
    }
    struct Comparison {
        std::size_t common = 0;
        double horizontal = 0, down = 0;  ///< medians of the distances, m
    };
    static Comparison compare(const std::vector<Fix>& a, const std::vector<Fix>& b) {
        std::vector<double> horizontal, down;
        std::size_t k = 0;
        constexpr double same = 0.05;  // s: solutions carry the receiver's clock error or not
        for (const Fix& f : a) {
            while (k < b.size() && (b[k].time - f.time).seconds() < -same) ++k;
            if (k == b.size() || (b[k].time - f.time).seconds() > same) continue;
            const Eigen::Vector3d d = earth::ned_difference({}, f.position, b[k].position);
            horizontal.push_back(d.head<2>().norm());
            down.push_back(std::abs(d.z()));
        }
        if (horizontal.empty()) return {};
        std::ranges::sort(horizontal);
        std::ranges::sort(down);
        return {horizontal.size(), horizontal[horizontal.size() / 2], down[down.size() / 2]};
    }
    static SinglePointSettings with_mask(double mask_deg) {
        SinglePointSettings s;
        s.ranges.elevation_mask = mask_deg * deg;
        return s;
    }
    /// The figures of docs/results.md.
    static void print(const std::string& name, std::size_t ours, std::size_t rnx2rtkp, const Comparison& c) {
        fmt::print("{}: {} epochs solved, {} by rnx2rtkp; median difference {:.3f} m horizontal, {:.3f} m vertical\n", name, ours,
                   rnx2rtkp, c.horizontal, c.down);
    }
    WarningLog log;
};

#define SKIP_WITHOUT_RNX2RTKP() \
    if (std::system("command -v rnx2rtkp > /dev/null 2>&1") != 0) GTEST_SKIP() << "rnx2rtkp (package rtklib) is not installed"

TEST_F(Rnx2rtkp, PairOfGeonet) {
    SKIP_WITHOUT_DATA();
    SKIP_WITHOUT_RNX2RTKP();
    const auto data = io::test::data_folder() / "rtklib_geonet_pair";
    for (const std::string name : {"07590920.05", "30400920.05"}) {
        const auto observations = data / (name + "o"), navigation = data / (name + "n");
        const ObservationLog raw = io::read_rinex_observations(observations, log).log;
        const auto fixes = solved(raw, io::read_rinex_navigation(navigation, log).navigation, with_mask(15.0));
        EXPECT_GE(fixes.size(), 117U);  // of 120; rnx2rtkp solves 115
        const auto rtklib = theirs(observations, navigation);
        const Comparison c = compare(fixes, rtklib);
        print(name, fixes.size(), rtklib.size(), c);
        EXPECT_GE(c.common, 115U);
        EXPECT_LT(c.horizontal, 0.1);
        EXPECT_LT(c.down, 0.1);
        // headers are good to decimetres
        const Geodetic header = earth::geodetic_from_ecef(earth::wgs84, raw.approximate);
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        for (const Fix& f : fixes) mean += earth::ned_difference({}, f.position, header) / static_cast<double>(fixes.size());
        fmt::print("  mean from the header's position, m: {:.2f} N {:.2f} E {:.2f} D\n", mean.x(), mean.y(), mean.z());
        EXPECT_LT(mean.norm(), 0.5);
    }
}

TEST_F(Rnx2rtkp, ReceiverOnASignalGenerator) {
    SKIP_WITHOUT_DATA();
    SKIP_WITHOUT_RNX2RTKP();
    const auto data = io::test::data_folder() / "spirent_f9p_static_ubx";
    const ObservationLog raw = io::read_rinex_observations(data / "f9p.obs", log).log;
    const auto fixes = solved(raw, io::read_rinex_navigation(data / "f9p.nav", log).navigation, with_mask(15.0));
    const auto rtklib = theirs(data / "f9p.obs", data / "f9p.nav");
    const Comparison c = compare(fixes, rtklib);
    print("f9p", fixes.size(), rtklib.size(), c);
    EXPECT_GE(fixes.size(), 925U);  // of 931; rnx2rtkp solves 927
    EXPECT_GE(c.common, 920U);
    EXPECT_LT(c.horizontal, 0.15);
    EXPECT_LT(c.down, 0.15);
    // the same from the receiver's own log, whose ephemerides are those of its satellites' messages
    const io::UbxLog ubx = io::read_ubx(data / "f9p.ubx", log);
    const Comparison own = compare(solved(ubx.observations, ubx.navigation, with_mask(15.0)), fixes);
    EXPECT_GT(own.common, 850U);
    EXPECT_LT(own.horizontal, 0.01);
}

TEST_F(Rnx2rtkp, Rtcm3StreamOfAStation) {
    SKIP_WITHOUT_DATA();
    // GPS only: the stream has ephemerides of GPS and GLONASS; all fixes at one place of Japan's south
    const auto file = io::test::data_folder() / "parser_corpus/rtklib_raw/GMSD7_20121014.rtcm3";
    const io::Rtcm3Log rtcm = io::read_rtcm3(file, gps_from_utc({2012, 10, 14, 0, 0, 0.0}), log);
    const auto fixes = solved(rtcm.observations, rtcm.navigation, with_mask(10.0));
    ASSERT_GT(fixes.size(), 100U);
    for (const Fix& f : fixes) {
        EXPECT_NEAR(f.position.lat / deg, fixes.back().position.lat / deg, 2e-4);
        EXPECT_NEAR(f.position.lon / deg, fixes.back().position.lon / deg, 2e-4);
    }
    EXPECT_NEAR(fixes.back().position.lat / deg, 30.556, 0.01);
    EXPECT_NEAR(fixes.back().position.lon / deg, 131.015, 0.01);
}

}  // namespace
}  // namespace schuler::gnss
