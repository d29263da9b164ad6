#include "schuler/solution/aided_receiver.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/sampled_ranges.h"
#include "schuler/math/quantile.h"
#include "schuler/math/rotation.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace schuler::solution {
namespace {

using Eigen::Vector3d;

/// The receiver's clock, c times its error and its rate, as the ranges of an epoch show them from a known antenna.
class ClockOfRanges {
public:
    void learn(const RangingLog& log, const filter::EarthFixedMotion& antenna, const earth::Ellipsoid& ellipsoid) {
        if (log.epochs.size() == known_) return;
        known_ = log.epochs.size();
        gnss::RangeSettings without;
        without.ionosphere = gnss::IonosphereModel::None;
        without.troposphere = gnss::TroposphereModel::None;
        const Ecef place{antenna.r_e};
        const Geodetic geodetic = earth::geodetic_from_ecef(ellipsoid, place);
        std::vector<double> clocks, drifts;
        for (const gnss::Range& r : gnss::satellite_ranges(log, log.epochs.back())) {
            const double clock = r.pseudorange - gnss::model_range(r, place, geodetic, nullptr, without).range,
                         rate = r.range_rate - gnss::model_range_rate(r, place, antenna.v_e);
            if (std::isfinite(clock)) clocks.push_back(clock);
            if (std::isfinite(rate)) drifts.push_back(rate);
        }
        if (!clocks.empty()) clock_ = math::median(std::move(clocks)), at_ = log.epochs.back().time;
        if (!drifts.empty()) drift_ = math::median(std::move(drifts));
    }
    void fill(filter::ReceiverAiding& aiding) const {
        constexpr double sigma = 10.0, sigma_of_drift = 0.3;  // m, m/s
        const double age = at_ ? (aiding.time - *at_).seconds() : 0.0;
        aiding.clock = clock_ + age * drift_;
        aiding.drift = drift_;
        aiding.std_clock = std::hypot(sigma, age * sigma_of_drift);
        aiding.std_drift = sigma_of_drift;
    }

private:
    std::size_t known_ = 0;
    double clock_ = 0.0, drift_ = 0.0;
    std::optional<Time> at_;
};

}  // namespace

RangingLog ranges_aided_by(const std::vector<SolutionRow>& rows, const earth::Earth& earth, const Vector3d& lever_arm_b,
                           scenario::SimulatedReceiver& receiver) {
    RangingLog log;
    ClockOfRanges clock;
    std::optional<filter::EarthFixedMotion> before;
    for (std::size_t k = 0; k + 1 < rows.size(); ++k) {
        const SolutionRow& row = rows[k];
        const Eigen::Matrix3d C_nb = math::dcm_from_rpy(row.rpy);
        filter::ReceiverAiding aiding;
        aiding.time = row.time;
        aiding.C_en = earth::C_en(row.position.lat, row.position.lon);
        aiding.antenna.r_e = earth::ecef_from_geodetic(earth.ellipsoid, row.position).r + aiding.C_en * (C_nb * lever_arm_b);
        aiding.antenna.v_e = aiding.C_en * row.v_eb_n;
        aiding.antenna.a_e.setZero();
        if (k > 0) {  // what the antenna moves about the unit, and its acceleration, since the row before
            const double dt = (row.time - rows[k - 1].time).seconds();
            const Eigen::Matrix3d turned = C_nb - math::dcm_from_rpy(rows[k - 1].rpy);
            aiding.antenna.v_e += aiding.C_en * (turned * lever_arm_b) / dt;
            aiding.antenna.a_e = aiding.C_en * (row.v_eb_n - rows[k - 1].v_eb_n) / dt;
        }
        aiding.P.diagonal() << row.std_position.cwiseAbs2(), row.std_velocity.cwiseAbs2();
        clock.fill(aiding);
        receiver.run(aiding, rows[k + 1].time, log);
        clock.learn(log, aiding.antenna, earth.ellipsoid);
    }
    return log;
}

}  // namespace schuler::solution
