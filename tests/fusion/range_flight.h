// A flight with ranges for the tests of the tight and medium filters.
#pragma once

#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/fusion/run_filter.h"
#include "schuler/gnss/constellation.h"
#include "schuler/sim/ranging.h"
#include "schuler/sim/simulate.h"
#include "schuler/sim/weave.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace schuler::fusion::test {

struct Flight {
    Recording recording;
    Settings settings;
    earth::Earth earth;
};

/// Two minutes at 10 Hz with a navigation-grade unit, all GPS satellites in view (and stations).
inline Flight flight(const std::vector<sim::GroundStation>& stations = {}, std::vector<sim::SatelliteLimit> limits = {}) {
    Flight f;
    sim::Scenario s;
    s.seed = 3;
    s.duration = 120.0;
    sim::WeavingFlight weave;
    weave.start = {52.3 * units::deg, 104.3 * units::deg, 3000.0};
    weave.duration = s.duration;
    s.path = sim::weaving_path(weave, f.earth.ellipsoid);
    s.imu.rate = 10.0;
    s.imu.errors = sensor::imu_grade("navigation");
    s.gnss.rate = 0.0;
    s.reference_rate = 1.0;
    f.recording = sim::simulate(s).recording;
    sim::RangingScenario frame{s.seed, s.duration, {}, Time::from_gps(2300, 3600.0), f.earth};
    sim::RangingSettings r;
    r.lever_arm_b = {2.0, 0.5, -3.0};
    r.navigation = gnss::nominal_gps(frame.gps, frame.gps + Duration::from_seconds(s.duration));
    r.masks.throughout = true;
    r.stations = stations;
    r.limits = std::move(limits);
    const auto path = sim::make_path(s.path, f.earth.ellipsoid);
    f.recording.ranges = sim::simulate_ranges(frame, *path, r).log;
    Settings& t = f.settings;
    t.coupling = Coupling::Tight;
    t.vehicle = VehicleKind::Air;
    t.imu.kind = ImuKind::Increments;
    t.imu.errors = s.imu.errors;
    t.gnss.lever_arm_b = r.lever_arm_b;
    t.constraints.zero_velocity = false;
    t.ranging.corrections.troposphere = gnss::TroposphereModel::None;
    t.ranging.corrections.ionosphere = gnss::IonosphereModel::None;
    t.output_rate = 1.0;
    const ReferenceSample& truth = f.recording.reference.front();
    t.initial = {truth.time,
                 truth.position,
                 truth.velocity_n,
                 truth.rpy,
                 Eigen::Vector3d::Constant(10.0),
                 Eigen::Vector3d::Constant(0.1),
                 Eigen::Vector3d(1e-4, 1e-4, 1e-3),
                 Eigen::Vector3d::Zero(),
                 Eigen::Vector3d::Zero()};
    return f;
}

inline Result run(const Flight& f) {
    WarningLog unheard;
    return run_filter(f.recording, f.settings, unheard);
}

/// Largest horizontal error from `from` seconds on, m.
inline double largest_error(const Flight& f, const Result& result, double from) {
    double out = 0.0;
    for (const SolutionRow& row : result.forward.rows) {
        const auto k = static_cast<std::size_t>(std::llround(row.time.seconds()));
        if (row.time.seconds() < from || k >= f.recording.reference.size()) continue;
        out = std::max(out, earth::ned_difference(f.earth, row.position, f.recording.reference[k].position).head<2>().norm());
    }
    return out;
}

/// Adds metres to a source's pseudoranges from a time on.
inline void spoil(RangingLog& log, std::uint16_t source, double from, double metres) {
    for (const RangeEpoch& e : log.epochs)
        for (std::size_t i = e.first; e.time.seconds() >= from && i < e.first + e.count; ++i)
            if (log.samples[i].source == source) log.samples[i].pseudorange += metres;
}

}  // namespace schuler::fusion::test
