// The disturbance along a track: closed shapes, and the statistics of the random parts.
#include "schuler/sim/anomaly.h"

#include "schuler/core/error.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/simulate.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::sim {
namespace {

using Eigen::Vector3d;
using Kind = AnomalyPart::Kind;

TEST(Anomaly, ShapesAlongDistanceAndTime) {
    const Vector3d size(1e-5, -2e-5, 1e-4);
    // clang-format off
    const AnomalyTrack track({{Kind::Constant, size}, {Kind::Step, size, 100.0, 1.0, true}, {Kind::Ramp, size, 50.0, 200.0},
                              {Kind::Harmonic, size, 10.0, 400.0}},
                             // clang-format on
                             1000.0, 200.0, 1);
    EXPECT_LT((track.at(10.0, 99.0) - size).norm(), 1e-18);
    EXPECT_LT((track.at(110.0, 100.0) - (1.0 + 1.0 + 0.3 + 1.0) * size).norm(), 1e-18);
    EXPECT_LT((track.at(310.0, 0.0) - (1.0 + 0.0 + 1.0 - 1.0) * size).norm(), 1e-18);
}

TEST(Anomaly, RandomPartsHaveTheirCorrelation) {
    for (const Kind kind : {Kind::GaussMarkov1, Kind::GaussMarkov2}) {
        const double length = 100.0;
        const AnomalyTrack track({{kind, Vector3d(1.0, 2.0, 3.0), 0.0, length}}, 4e5, 0.0, 5);
        for (const double lag : {0.0, 50.0, 100.0, 300.0}) {
            Vector3d sum = Vector3d::Zero();
            int count = 0;
            for (double s = 0.0; s + lag < 4e5; s += 25.0, ++count) sum += track.at(s, 0.0).cwiseProduct(track.at(s + lag, 0.0));
            const double x = lag / length, expected = std::exp(-x) * (kind == Kind::GaussMarkov1 ? 1.0 : 1.0 + x);
            const Vector3d found = (sum / count).cwiseQuotient(Vector3d(1.0, 4.0, 9.0));
            for (int i = 0; i < 3; ++i)
                EXPECT_NEAR(found(i), expected, 0.11) << "lag " << lag;  // 4000 lengths: sigma 0.02 to 0.03
        }
    }
}

TEST(Anomaly, UnusablePartsAreRefused) {
    EXPECT_THROW(AnomalyTrack({{Kind::Harmonic, Vector3d::Ones(), 0.0, 0.0}}, 1.0, 1.0, 1), Error);
    EXPECT_THROW(AnomalyTrack({{Kind::GaussMarkov1, Vector3d::Ones(), 0.0, 1e-6}}, 1e5, 1.0, 1), Error);
}

TEST(Anomaly, AFieldOverTheGroundIsThatOfThePlaceAndIsFeltByTheAccelerometers) {
    // Two ways over one place meet one value; the accelerometers miss what the truth says.
    const GroundField field = [](const Geodetic& p) {
        return Vector3d(1e-4 * std::sin(p.lat * 6.4e6 / 900.0), 2e-5, 3e-4 * std::cos(p.lon * 4e6 / 1300.0));
    };
    Scenario scenario;
    scenario.duration = 60.0;
    scenario.path = GreatCirclePath{{0.9, 0.3, 500.0}, 0.7, 40.0};
    scenario.reference_rate = 1.0;
    const SimulatedData quiet = simulate(scenario);
    scenario.anomaly_field = field;
    const SimulatedData felt = simulate(scenario);
    Vector3d missing = Vector3d::Zero(), expected = Vector3d::Zero();
    for (std::size_t k = 0; k < felt.sensor_truth.size(); ++k) {
        const Vector3d there = field(felt.recording.reference[k].position);
        EXPECT_LT((felt.sensor_truth[k].disturbance_n - there).norm(), 1e-12);
        expected += (k == 0 || k + 1 == felt.sensor_truth.size() ? 0.5 : 1.0) * there;
    }
    for (std::size_t k = 0; k < felt.recording.imu.size(); ++k)
        missing += math::dcm_from_rpy(felt.recording.reference[k / 100].rpy) *
                   (quiet.recording.imu[k].accel - felt.recording.imu[k].accel);
    EXPECT_LT((missing - expected).norm(), 2e-3 * expected.norm());
}

}  // namespace
}  // namespace schuler::sim
