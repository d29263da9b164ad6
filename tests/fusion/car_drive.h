// A simulated town drive, a flight, and the settings with which they are fused: what the tests of whole runs share.
#pragma once

#include "schuler/analysis/errors.h"
#include "schuler/core/units.h"
#include "schuler/fusion/run_filter.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"
#include "schuler/sensor/grades.h"
#include "schuler/sim/simulate.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <variant>
#include <vector>

namespace schuler::fusion::testing {

using units::deg;

/// MEMS without scale and alignment errors: what the fifteen states describe.
inline sensor::ImuErrorModel mems() {
    sensor::ImuErrorModel m = sensor::imu_grade("mems");
    m.gyro_scale = m.accel_scale = m.gyro_misalignment = m.accel_misalignment = 0.0;
    return m;
}

/// The same route for every seed; the seed draws the errors of the instruments.
inline sim::Scenario town_drive(std::uint64_t seed, double gnss_rate = 1.0, double duration = 200.0) {
    sim::Scenario s;
    s.seed = seed;
    s.duration = duration;
    s.origin = Time::from_seconds(1000.0);
    sim::RoutePath route = sim::town_route({50.4 * deg, 30.5 * deg, 150.0}, duration, 7);
    route.standstill = 8.0;
    s.path = route;
    s.imu.errors = mems();
    s.gnss.rate = gnss_rate;
    s.gnss.lever_arm_b = Eigen::Vector3d(0.4, -0.2, -1.1);
    return s;
}

/// A flight in slow curves from the first instant on, whose fixes are later than told.
inline sim::Scenario flight_in_curves(std::uint64_t seed, double latency) {
    sim::Scenario s;
    s.seed = seed;
    s.duration = 150.0;
    s.origin = Time::from_seconds(1000.0);
    sim::FigureEightPath path;
    path.start = {31.7 * deg, 52.8 * deg, 2400.0};
    path.length = 1800.0;
    path.width = 700.0;
    path.period = 110.0;
    s.path = path;
    s.imu.errors = sensor::imu_grade("mems");
    s.gnss.rate = 10.0;
    s.gnss.white_position = Eigen::Vector3d(0.3, 0.3, 0.5);
    s.gnss.white_velocity = Eigen::Vector3d(0.05, 0.05, 0.08);
    s.gnss.position_latency = s.gnss.velocity_latency = latency;
    return s;
}

/// The engine's shaking, by which an IMU tells driving from standing.
inline void shake(sim::Scenario& s) { std::get<sim::RoutePath>(s.path).vibration = {12.0, 5e-4, 0.5}; }

/// A simulated drive, what its instruments recorded, and how it is fused.
struct Drive {
    sim::Scenario scenario;
    Recording recording;
    Settings settings;
};

inline Settings settings_of(const sim::Scenario& s) {
    Settings f;
    f.earth = s.earth;
    f.vehicle = VehicleKind::Car;
    f.imu.kind = s.imu.kind;
    f.imu.errors = s.imu.errors;
    f.imu.mounting_rpy = s.imu.mounting;
    f.gnss.lever_arm_b = s.gnss.lever_arm_b;
    return f;
}

/// Start of the filter: truth with errors drawn from the sigmas that it is told.
inline void give_start(Settings& f, const Recording& recording, std::uint64_t seed) {
    math::Random random(seed, "test.start");
    const ReferenceSample& truth = recording.reference.front();
    f.initial.std_position = Eigen::Vector3d(1.0, 1.0, 2.0);
    f.initial.std_velocity = Eigen::Vector3d::Constant(0.1);
    f.initial.std_rpy = Eigen::Vector3d(0.5, 0.5, 3.0) * deg;
    f.initial.position = earth::moved_by_ned(f.earth, truth.position, f.initial.std_position.cwiseProduct(random.normal3()));
    f.initial.velocity_n = truth.velocity_n + f.initial.std_velocity.cwiseProduct(random.normal3());
    f.initial.rpy = truth.rpy + f.initial.std_rpy.cwiseProduct(random.normal3());
}

inline Result fuse(const Recording& recording, const Settings& settings) {
    WarningLog warnings;
    return run_filter(recording, settings, warnings);
}

/// Errors (east, north, up) at the epochs of the reference.
inline std::vector<analysis::ErrorRow> errors(const Settings& f, const std::vector<SolutionRow>& rows,
                                              const Recording& recording) {
    return analysis::errors_against(f.earth, rows, recording.reference);
}

/// Largest horizontal error from a time (s of the scenario) on.
inline double worst_horizontal(const std::vector<analysis::ErrorRow>& errors, double from) {
    double worst = 0.0;
    for (const analysis::ErrorRow& e : errors)
        if (e.time.seconds() >= 1000.0 + from) worst = std::max(worst, e.position.head<2>().norm());
    return worst;
}

/// Root mean square of position (m), velocity (m/s) and heading (rad) errors from a time on.
struct Rms {
    double position = 0.0, velocity = 0.0, heading = 0.0;
};
inline Rms rms(const std::vector<analysis::ErrorRow>& errors, double from) {
    Rms r;
    double n = 0.0;
    for (const analysis::ErrorRow& e : errors) {
        if (e.time.seconds() < 1000.0 + from) continue;
        r.position += e.position.squaredNorm();
        r.velocity += e.velocity.squaredNorm();
        r.heading += e.rpy.z() * e.rpy.z();
        n += 1.0;
    }
    return {std::sqrt(r.position / n), std::sqrt(r.velocity / n), std::sqrt(r.heading / n)};
}

}  // namespace schuler::fusion::testing
