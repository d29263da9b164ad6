// Two real receivers of Japan's network against RTKLIB and the headers.
#include "ppk/ppk_fixture.h"

#include "schuler/core/error.h"
#include "schuler/earth/earth.h"
#include "schuler/io/solution/rtklib_pos.h"

#include <fmt/format.h>

#include <cstdlib>
#include <map>

namespace schuler::ppk {
namespace {

using test::Errors;
using test::PairOfLogs;

class Geonet : public io::test::IoTest {
protected:
    static PairOfLogs logs() { return {"rtklib_geonet_pair", "07590920.05o", "30400920.05o", {"07590920.05n", "30400920.05n"}}; }
    static Settings settings(const PairOfLogs& pair) {
        Settings s;
        s.air.ionosphere = gnss::broadcast_ionosphere(pair.navigation);
        return s;
    }
    /// Fixed positions of RTKLIB at GPS times.
    std::map<std::int64_t, Geodetic> theirs() {
        const auto data = io::test::data_folder() / "rtklib_geonet_pair";
        const auto conf =
            write("rtklib.conf",
                  "pos1-posmode =kinematic\npos1-frequency =l1+l2\npos1-elmask =10\npos1-ionoopt =brdc\npos1-tropopt =saas\n"
                  "pos1-navsys =1\npos2-armode =continuous\nant2-postype =rinexhead\nout-solformat =llh\nout-timesys =gpst\n"
                  "out-height =ellipsoidal\n");
        const std::string command =
            fmt::format("rnx2rtkp -k {} -o {} {} {} {} > /dev/null 2>&1", conf.string(), (folder() / "r.pos").string(),
                        (data / "07590920.05o").string(), (data / "30400920.05o").string(), (data / "07590920.05n").string());
        EXPECT_EQ(std::system(command.c_str()), 0) << command;
        WarningLog log;
        std::map<std::int64_t, Geodetic> out;
        for (const GnssFix& f : io::read_rtklib_pos(folder() / "r.pos", log).fixes)
            if (f.fix == FixType::RtkFixed) out[std::llround(f.time.seconds())] = f.position;
        return out;
    }
};

TEST_F(Geonet, FixedWhereRtklibIs) {
    SKIP_WITHOUT_DATA();
    const PairOfLogs pair = logs();
    const bool oracle = std::system("command -v rnx2rtkp > /dev/null 2>&1") == 0;
    const auto rtklib = oracle ? theirs() : std::map<std::int64_t, Geodetic>();
    if (oracle) {
        EXPECT_GT(rtklib.size(), 100U);
    }
    for (const Direction direction : {Direction::Forward, Direction::Combined}) {
        for (const std::size_t frequencies : {2U, 1U}) {
            Settings s = settings(pair);
            s.direction = direction;
            s.frequencies = frequencies;
            WarningLog warnings;
            const Solution found = test::solved(pair, s, {}, warnings);
            std::size_t compared = 0, outside = 0;
            double square = 0, largest = 0;
            Eigen::Vector3d mean = Eigen::Vector3d::Zero();
            for (const EpochSolution& e : found.epochs) {
                const Geodetic own = earth::geodetic_from_ecef(earth::wgs84, e.position),
                               header = earth::geodetic_from_ecef(earth::wgs84, pair.rover.approximate);
                mean += earth::ned_difference({}, own, header) / static_cast<double>(found.epochs.size());
                const auto it = rtklib.find(std::llround(e.tag.seconds()));
                if (it == rtklib.end()) continue;
                const Eigen::Vector3d d = earth::ned_difference({}, own, it->second);
                const Eigen::Matrix3d C_ne = earth::C_en(own.lat, own.lon).transpose();
                const Eigen::Vector3d sigma = (C_ne * e.covariance * C_ne.transpose()).diagonal().cwiseSqrt();
                outside += (d.array().abs() > 3.0 * sigma.array() + 0.005).any() ? 1 : 0;
                if (e.quality != Quality::Fixed) continue;
                ++compared;
                square += d.squaredNorm();
                largest = std::max(largest, d.norm());
            }
            const double rms = std::sqrt(square / static_cast<double>(std::max<std::size_t>(compared, 1)));
            fmt::print(
                "GEONET, {} frequencies, direction {}: {} epochs, {} fixed, {} float; against RTKLIB at {} epochs RMS {:.1f} mm, largest {:.1f} mm, "
                "{} outside three sigma; from the header {:.3f} N {:.3f} E {:.3f} D\n",
                frequencies, static_cast<int>(direction), found.epochs.size(), found.count(Quality::Fixed),
                found.count(Quality::Float), compared, 1e3 * rms, 1e3 * largest, outside, mean.x(), mean.y(), mean.z());
            EXPECT_LT(mean.norm(), 0.25);
            if (oracle && frequencies == 2) {
                EXPECT_LT(rms, 0.01);
                EXPECT_LE(outside, 1U);
            }
        }
    }
}

}  // namespace
}  // namespace schuler::ppk
