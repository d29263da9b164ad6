#include "schuler/study/triad/triad.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/fusion/run_filter.h"
#include "schuler/gnss/constellation.h"
#include "schuler/ins/state_error.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/ranging.h"
#include "schuler/sim/simulate.h"
#include "schuler/sim/weave.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <string>

namespace schuler::study {
namespace {

using Eigen::Vector3d;

using units::deg;
constexpr double warm_up = 180.0, flight = 600.0;  // s
const Vector3d lever_arm_b(2.0, 0.5, -3.0);
constexpr double level_nav = 0.005 * deg, heading_nav = 0.05 * deg, level_tac = 0.1 * deg, heading_tac = 0.5 * deg;

sensor::ImuErrorModel imu_of(bool tactical) {
    sensor::ImuErrorModel m;
    m.gyro_bias = (tactical ? 1.0 : 0.01) * units::deg_per_hour;
    m.gyro_noise = (tactical ? 0.1 : 0.003) * units::deg_per_sqrt_hour;
    m.accel_bias = (tactical ? 1000.0 : 50.0) * units::ug;
    m.accel_noise = (tactical ? 0.1 : 0.02) * units::m_s_per_sqrt_hour;
    return m;
}

sensor::RangingErrorModel range_errors_of(const TriadCase& which) {
    sensor::RangingErrorModel m;
    m.clock = which.tcxo ? sensor::tcxo : sensor::ocxo;
    m.station.white = which.station_white;
    m.station.correlated = which.station_correlated;
    m.network = which.network;
    return m;
}

/// All random quantities of one run come from one seed.
std::uint64_t seed_of(std::size_t k, std::uint64_t seed) { return 1000 * seed + k + 1; }

sim::Scenario flight_of(const TriadCase& which, std::size_t k, std::uint64_t seed, double duration) {
    sim::Scenario s;
    s.seed = seed_of(k, seed);
    s.duration = duration;
    sim::WeavingFlight weave;
    weave.start = {52.3 * deg, 104.3 * deg, 10'000.0};
    weave.heading = std::fmod(static_cast<double>(k) * 137.508, 360.0) * deg;
    weave.duration = s.duration;
    s.path = sim::weaving_path(weave, s.earth.ellipsoid);
    s.imu.rate = 10.0;
    s.imu.errors = imu_of(which.tactical);
    s.gnss.rate = 0.0;
    s.baro.rate = which.baro ? 1.0 : 0.0;
    s.baro.white = 1.0;
    s.baro.bias = which.baro_sigma;
    s.baro.bias_time = 2000.0;
    s.reference_rate = 1.0;
    return s;
}

/// Distances, azimuths and heights relative to the ground point below the aircraft 480 s after the start of the clock.
std::vector<sim::GroundStation> stations_about(const Geodetic& middle, const earth::Earth& earth, std::size_t count) {
    constexpr double table[4][3] = {{90e3, 20, 300}, {120e3, 110, 800}, {150e3, 200, 200}, {180e3, 290, 500}};
    std::vector<sim::GroundStation> out;
    for (std::size_t i = 0; i < count; ++i) {
        const double azimuth = table[i][1] * deg;
        Geodetic p = earth::moved_by_ned(earth, {middle.lat, middle.lon, 0.0},
                                         {table[i][0] * std::cos(azimuth), table[i][0] * std::sin(azimuth), 0.0});
        p.h = table[i][2];
        out.push_back({"ADSB-" + std::to_string(i + 1), p});
    }
    return out;
}

RangingLog ranges_of(const TriadCase& which, std::size_t k, const sim::Scenario& s) {
    const auto path = sim::make_path(s.path, s.earth.ellipsoid);
    const double epoch = static_cast<double>(k % 12) * 7200.0 + 600.0 * static_cast<double>(k / 12);
    sim::RangingScenario frame{s.seed, s.duration, s.origin, Time::from_gps(2300, epoch), s.earth};
    sim::RangingSettings r;
    r.lever_arm_b = lever_arm_b;
    r.navigation = gnss::nominal_gps(frame.gps, frame.gps + Duration::from_seconds(s.duration));
    r.stations = stations_about(path->at(std::min(480.0, s.duration)).position, s.earth, which.stations);
    r.errors = range_errors_of(which);
    r.masks.throughout = true;
    r.blocked.push_back({{"stations"}, 0.0, warm_up + which.stations_on + 0.5});  // first used a second later
    if (which.satellites < 99) r.limits.push_back({warm_up + 0.5, which.satellites, k});
    return sim::simulate_ranges(frame, *path, r).log;
}

fusion::Settings settings_of(const TriadCase& which, const sim::Scenario& s, const ReferenceSample& truth) {
    fusion::Settings f;
    f.earth = s.earth;
    f.vehicle = fusion::VehicleKind::Air;
    f.mechanization = which.mechanization;
    f.coupling = fusion::Coupling::Tight;
    f.imu.kind = s.imu.kind;
    f.imu.errors = s.imu.errors;
    f.gnss.lever_arm_b = lever_arm_b;
    f.gnss.estimate_std = false;
    f.constraints.zero_velocity = false;
    f.ranging.errors = range_errors_of(which);
    f.ranging.corrections.troposphere = gnss::TroposphereModel::None;
    f.ranging.corrections.ionosphere = gnss::IonosphereModel::None;
    f.ranging.corrections.elevation_mask = 0.0;
    f.baro.bias_time = 2000.0;
    f.baro.std = 1.0;
    f.baro.bias_std = which.baro_sigma;
    f.output_rate = 1.0;
    f.state_rows = true;

    math::Random random(s.seed, "triad.start");
    const double level = which.tactical ? level_tac : level_nav, heading = which.tactical ? heading_tac : heading_nav;
    const double speed = which.tactical ? 0.3 : 0.1;
    const Vector3d std_position(10.0, 10.0, 15.0), std_phi(level, level, heading);
    ins::Vector9 error;
    error << std_position.cwiseProduct(random.normal3()), speed * random.normal3(), std_phi.cwiseProduct(random.normal3());
    const NavState exact{truth.time, truth.position, truth.velocity_n, math::quaternion_from_rpy(truth.rpy)};
    const NavState begun = ins::perturbed(s.earth, exact, error);
    f.initial.time = truth.time;
    f.initial.position = begun.position;
    f.initial.velocity_n = begun.v_eb_n;
    f.initial.rpy = math::rpy_from_quaternion(begun.q_nb);
    f.initial.std_position = std_position;
    f.initial.std_velocity.setConstant(speed);
    f.initial.std_rpy = std_phi;
    return f;
}

}  // namespace

TriadFlight triad_flight(const TriadCase& which, std::size_t k, std::uint64_t seed, double duration) {
    const sim::Scenario s = flight_of(which, k, seed, duration);
    TriadFlight out{sim::simulate(s).recording, {}, s.origin};
    out.recording.ranges = ranges_of(which, k, s);
    out.settings = settings_of(which, s, out.recording.reference.front());
    return out;
}

TriadRun run_triad(const TriadCase& which, std::size_t k, std::uint64_t seed) {
    const TriadFlight flown = triad_flight(which, k, seed, warm_up + flight);
    const Recording& recording = flown.recording;
    const earth::Earth& earth = flown.settings.earth;
    WarningLog unheard;
    const fusion::Result result = fusion::run_filter(recording, flown.settings, unheard);
    TriadRun out;
    std::size_t filled = 0;
    for (const fusion::StateRow& row : result.forward.states) {
        const double t = (row.time - flown.origin).seconds();
        const auto at = static_cast<std::size_t>(std::llround(t));
        if (t < warm_up - 1e-6 || at >= recording.reference.size() || std::abs(t - static_cast<double>(at)) > 1e-6) continue;
        const ReferenceSample& truth = recording.reference[at];
        ins::Vector9 error;
        error.head<3>() = earth::ned_difference(earth, row.nav.position, truth.position);
        error.segment<3>(3) = row.nav.v_eb_n - truth.velocity_n;
        // C_est = Exp(-[phi x]) C: the rotation from estimate to truth is phi
        const Eigen::Quaterniond q = math::quaternion_from_rpy(truth.rpy) * row.nav.q_nb.conjugate();
        error.tail<3>() = math::rotation_vector_from_quaternion(q);
        const std::size_t i = at - static_cast<std::size_t>(warm_up);
        if (i >= triad_epochs) break;
        const Eigen::Matrix<double, 9, 9>& P = row.P_navigation;
        out.horizontal[i] = error.head<2>().norm();
        out.vertical[i] = std::abs(error.z());
        out.predicted_horizontal[i] = std::sqrt(P(0, 0) + P(1, 1));
        out.predicted_vertical[i] = std::sqrt(P(2, 2));
        const Eigen::Matrix3d P3 = P.topLeftCorner<3, 3>();
        out.nees3[i] = error.head<3>().dot(P3.llt().solve(error.head<3>())) / 3.0;
        out.nees9[i] = error.dot(P.llt().solve(error)) / 9.0;
        ++filled;
    }
    if (filled < triad_epochs) throw computation_error("a run of the triad ended early", "look at its settings");
    return out;
}

}  // namespace schuler::study
