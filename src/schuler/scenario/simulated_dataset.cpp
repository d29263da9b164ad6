#include "schuler/scenario/simulated_dataset.h"

#include "schuler/core/units.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/rinex/rinex_write.h"
#include "schuler/io/staged_folder.h"
#include "schuler/io/text/fixed_point.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"
#include "schuler/scenario/simulated_ranging.h"
#include "schuler/scenario/simulated_receiver.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/option_builders.h"
#include "schuler/settings/scenario/scenario.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace schuler::scenario {
namespace {

// Decimals of the files: increments to 1e-12 rad and m/s (a tenth of a nanoradian over an hour), positions to 1e-7 m.
constexpr int imu_decimals = 12, angle_decimals = 12, length_decimals = 6, pressure_decimals = 4, field_decimals = 9;

template <int Decimals>
double rounded(double x) {
    constexpr double scale = static_cast<double>(io::detail::power_of_ten(Decimals));
    return std::nearbyint(x * scale) / scale + 0.0;  // minus zero is written as zero
}

/// Radians from a number of degrees written with angle_decimals.
double rounded_angle(double rad) { return rounded<angle_decimals>(rad / units::deg) * units::deg; }

template <int Decimals>
Eigen::Vector3d rounded(const Eigen::Vector3d& v) {
    return {rounded<Decimals>(v.x()), rounded<Decimals>(v.y()), rounded<Decimals>(v.z())};
}

Geodetic rounded(const Geodetic& p) { return {rounded_angle(p.lat), rounded_angle(p.lon), rounded<length_decimals>(p.h)}; }

void round_to_files(Recording& r) {
    for (ImuSample& s : r.imu) {
        s.gyro = rounded<imu_decimals>(s.gyro);
        s.accel = rounded<imu_decimals>(s.accel);
    }
    for (GnssFix& f : r.gnss) {
        f.position = rounded(f.position);
        f.velocity_n = rounded<length_decimals>(f.velocity_n);
        f.std_position = rounded<length_decimals>(f.std_position);
        f.std_velocity = rounded<length_decimals>(f.std_velocity);
        f.satellites = -1;
    }
    for (BaroSample& b : r.baro) {
        if (std::isfinite(b.height)) b.height = rounded<length_decimals>(b.height);
        if (std::isfinite(b.pressure)) b.pressure = rounded<pressure_decimals>(b.pressure);
    }
    for (RangeSample& m : r.ranges.samples) {
        for (double* x : {&m.pseudorange, &m.range_rate, &m.std, &m.std_rate})
            if (std::isfinite(*x)) *x = rounded<length_decimals>(*x);
        m.tx.r = rounded<length_decimals>(m.tx.r);
        m.tx_velocity = rounded<length_decimals>(m.tx_velocity);
    }
    for (MagSample& m : r.mag) m.field_b = 1e-6 * rounded<field_decimals>(m.field_b / 1e-6);
    for (ReferenceSample& s : r.reference) {
        s.position = rounded(s.position);
        s.velocity_n = rounded<length_decimals>(s.velocity_n);
        s.rpy = {rounded_angle(s.rpy.x()), rounded_angle(s.rpy.y()), rounded_angle(s.rpy.z())};
        s.movement = true;
    }
}

void round_to_files(InstrumentLogs& log) {
    for (GaugeSample& s : log.gauges)
        for (double& h : s.height)
            if (std::isfinite(h)) h = rounded<length_decimals>(h);
    for (BodyVelocitySample& s : log.velocities) s.velocity_b = rounded<length_decimals>(s.velocity_b);
    for (HeadingSample& s : log.headings) s.heading = rounded_angle(s.heading);
}

/// Sets the filter's assumptions about those instruments to the simulated errors.
void describe(const sim::InstrumentErrors& simulated, const InstrumentLogs& log, settings::InstrumentsConfig& assumed) {
    if (!log.gauges.empty()) assumed.gauges.file = "gauges.csv";
    if (!log.velocities.empty()) assumed.log.file = "log.csv";
    if (!log.headings.empty()) assumed.compass.file = "compass.csv";
    assumed.gauges.white = std::max(simulated.gauges.white, 1e-3);
    assumed.gauges.bias = simulated.gauges.bias;
    assumed.gauges.lever_arms_b = simulated.gauges.lever_arms_b;
    assumed.log.white = std::max(simulated.log.white, 1e-4);
    assumed.log.scale = simulated.log.scale;
    assumed.log.misalignment = simulated.log.misalignment;
    assumed.log.lever_arm_b = simulated.log.lever_arm_b;
    assumed.compass.white = std::max(simulated.compass.white, 1e-5);
    assumed.compass.bias = simulated.compass.bias;
}

/// A table as text, formatted column by column.
class TextTable {
public:
    explicit TextTable(std::string header) : text_(std::move(header)) { text_ += '\n'; }

    TextTable& time(Time t) {
        end_ = io::put_seconds(cell_, t.ns);
        return flush();
    }
    template <int Decimals>
    TextTable& number(double x) {
        end_ = io::put_fixed<Decimals>(cell_, x);
        return flush();
    }
    template <int Decimals>
    TextTable& vector(const Eigen::Vector3d& v) {
        return number<Decimals>(v.x()).template number<Decimals>(v.y()).template number<Decimals>(v.z());
    }
    TextTable& position(const Geodetic& p) {
        return number<angle_decimals>(p.lat / units::deg).number<angle_decimals>(p.lon / units::deg).number<length_decimals>(p.h);
    }
    TextTable& word(std::string_view w) {
        text_ += w;
        text_ += ',';
        return *this;
    }
    void end_row() { text_.back() = '\n'; }
    [[nodiscard]] const std::string& text() const { return text_; }

private:
    TextTable& flush() {
        text_.append(cell_, end_);
        text_ += ',';
        return *this;
    }
    std::string text_;
    char cell_[64];
    char* end_ = cell_;
};

std::string imu_csv(const std::vector<ImuSample>& samples, ImuKind kind) {
    TextTable out(kind == ImuKind::Increments
                      ? "time_s,dtheta_x_rad,dtheta_y_rad,dtheta_z_rad,dv_x_m_s,dv_y_m_s,dv_z_m_s"
                      : "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2");
    for (const ImuSample& s : samples) out.time(s.time).vector<imu_decimals>(s.gyro).vector<imu_decimals>(s.accel).end_row();
    return out.text();
}

std::string gnss_csv(const std::vector<GnssFix>& fixes) {
    TextTable out(
        "time_s,lat_deg,lon_deg,height_m,vel_n_m_s,vel_e_m_s,vel_d_m_s,std_n_m,std_e_m,std_d_m,std_vn_m_s,std_ve_m_s,std_vd_m_s,"
        "fix");
    for (const GnssFix& f : fixes) {
        out.time(f.time).position(f.position).vector<length_decimals>(f.velocity_n).vector<length_decimals>(f.std_position);
        out.vector<length_decimals>(f.std_velocity).word(f.fix == FixType::RtkFixed ? "rtk_fixed" : "autonomous").end_row();
    }
    return out.text();
}

std::string baro_csv(const std::vector<BaroSample>& samples) {
    const bool pressure = !samples.empty() && std::isfinite(samples.front().pressure);
    TextTable out(pressure ? "time_s,pressure_pa" : "time_s,height_m");
    for (const BaroSample& s : samples) {
        out.time(s.time);
        if (pressure) out.number<pressure_decimals>(s.pressure).end_row();
        else out.number<length_decimals>(s.height).end_row();
    }
    return out.text();
}

std::string mag_csv(const std::vector<MagSample>& samples) {
    TextTable out("time_s,mag_x_ut,mag_y_ut,mag_z_ut");
    for (const MagSample& s : samples) out.time(s.time).vector<field_decimals>(s.field_b / 1e-6).end_row();
    return out.text();
}

std::string gauges_csv(const std::vector<GaugeSample>& samples) {
    TextTable out("time_s,height_1_m,height_2_m,height_3_m");
    for (const GaugeSample& s : samples) {
        out.time(s.time);
        for (const double h : s.height) std::isfinite(h) ? out.number<length_decimals>(h) : out.word("");
        out.end_row();
    }
    return out.text();
}

std::string log_csv(const std::vector<BodyVelocitySample>& samples) {
    TextTable out("time_s,vel_x_m_s,vel_y_m_s,vel_z_m_s");
    for (const BodyVelocitySample& s : samples) out.time(s.time).vector<length_decimals>(s.velocity_b).end_row();
    return out.text();
}

std::string compass_csv(const std::vector<HeadingSample>& samples) {
    TextTable out("time_s,heading_deg");
    for (const HeadingSample& s : samples) out.time(s.time).number<angle_decimals>(s.heading / units::deg).end_row();
    return out.text();
}

std::string reference_csv(const std::vector<ReferenceSample>& samples) {
    TextTable out("time_s,lat_deg,lon_deg,height_m,vel_n_m_s,vel_e_m_s,vel_d_m_s,roll_deg,pitch_deg,heading_deg");
    for (const ReferenceSample& s : samples) {
        out.time(s.time)
            .position(s.position)
            .vector<length_decimals>(s.velocity_n)
            .vector<angle_decimals>(s.rpy / units::deg)
            .end_row();
    }
    return out.text();
}

/// Assumptions of the filter: the simulated instruments unless the scenario specifies others.
settings::Config described(const settings::ScenarioConfig& s, const Recording& recording) {
    settings::Config c = s.processing;
    const sim::GnssSettings& g = s.sim.gnss;
    c.name = s.name;
    c.time.scale = TimeScale::Relative;
    c.imu.file = "imu.csv";
    if (!recording.gnss.empty()) c.gnss.file = "gnss.csv";
    if (!recording.baro.empty()) c.baro.file = "baro.csv";
    if (!recording.mag.empty()) c.mag.file = "mag.csv";
    if (!recording.ranges.empty()) {
        c.ranges.file = "ranges.csv";
        if (!s.ranging.settings.stations.empty()) c.station_coordinates = "stations.csv";
        c.filter.ranging.errors = s.ranging.settings.errors;
        if (s.receiver_channels.rate > 0.0)
            c.filter.ranging.errors.rate_span = receiver::shared_rate_span(s.receiver_channels.bank);
        gnss::RangeSettings& corrections = c.raw.solver.ranges;
        corrections.elevation_mask = s.ranging.settings.masks.elevation - 1.0 * units::deg;
        if (!s.ranging.settings.atmosphere) corrections.troposphere = gnss::TroposphereModel::None;
        corrections.ionosphere = gnss::IonosphereModel::None;
        corrections.code_sigma = s.ranging.settings.errors.satellite.white;
        corrections.doppler_sigma = s.ranging.settings.errors.satellite.rate;
    }
    c.reference.file = "reference.csv";
    c.filter.imu.kind = s.sim.imu.kind;
    const sensor::ImuErrorModel& imu = s.sim.imu.errors;
    c.filter.imu.errors = imu;
    // Effects without filter states, stated as biases: the drift of warming up as in-run, the g-dependent error as turn-on.
    c.filter.imu.errors.gyro_bias = std::hypot(imu.gyro_bias, imu.gyro_temperature * s.sim.imu.warm_up);
    c.filter.imu.errors.accel_bias = std::hypot(imu.accel_bias, imu.accel_temperature * s.sim.imu.warm_up);
    c.filter.imu.errors.gyro_turn_on_bias = std::hypot(imu.gyro_turn_on_bias, imu.gyro_g * units::g0);
    c.scale_factors = c.scale_factors.value_or(imu.gyro_scale > 0.0 || imu.accel_scale > 0.0);
    c.misalignments = c.misalignments.value_or(imu.gyro_misalignment > 0.0 || imu.accel_misalignment > 0.0);
    // Without their own states they act as biases, through the ever-present specific force.
    double& turn_on = c.filter.imu.errors.accel_turn_on_bias;
    if (!*c.scale_factors) turn_on = std::hypot(turn_on, imu.accel_scale * units::g0);
    if (!*c.misalignments) turn_on = std::hypot(turn_on, imu.accel_misalignment * units::g0);
    c.filter.imu.mounting_rpy = s.sim.imu.mounting;
    c.grade = s.grade;
    c.filter.gnss.lever_arm_b = g.lever_arm_b;
    c.filter.gnss.latency = g.position_latency;
    if (g.velocity_latency != g.position_latency) c.filter.gnss.velocity_latency = g.velocity_latency;
    c.filter.gnss.errors = g.errors;
    if (c.gravity.gnss_velocity == 0.0) c.gravity.gnss_velocity = g.errors.correlated_velocity.head<2>().mean();
    for (const double t : g.constellation_changes) c.filter.gnss.constellation_changes.push_back(Time::from_seconds(t));
    c.filter.baro.std = std::max(s.sim.baro.white, 1e-3);
    c.filter.baro.bias_std = std::max(s.sim.baro.bias, 1e-3);
    c.filter.baro.bias_walk = s.sim.baro.bias_walk;
    c.filter.baro.bias_time = s.sim.baro.bias_time;
    // Hard iron changes the heading by its component across it. Soft iron does by about its coefficients, which changes as the
    // vehicle turns; a turn takes some ten seconds.
    constexpr double turn_time = 10.0;
    const sim::MagSettings& mag = s.sim.mag;
    const double level = mag.field * std::cos(mag.inclination);
    c.filter.mag.declination = mag.declination;
    c.filter.mag.bias_std = std::max(0.01, std::hypot(mag.hard_iron / level, 2.0 * mag.soft_iron));
    c.filter.mag.deviation_std = mag.hard_iron / level;
    c.filter.mag.heading_std = std::max(0.005, mag.white / level);
    c.filter.mag.bias_walk = std::hypot(1e-4, 2.0 * mag.soft_iron * std::sqrt(2.0 / turn_time));
    c.filter.mag.disturbance_std = 0.0;  // none but that of soft iron
    // the scenario counts from its start, the command line from the first fix: absolute times have the same meaning for both
    for (const settings::OutageSpan& o : s.outages) c.run.outages.push_back({o.start, o.duration, true});
    return c;
}

/// The initial state of the filter: truth with errors drawn from the stated sigmas.
void give_initial_state(settings::Config& c, const settings::InitialError& e, const ReferenceSample& truth,
                        const earth::Earth& earth, std::uint64_t seed) {
    math::Random random(seed, "filter.initial_error");
    const Eigen::Vector3d dp = e.position * random.normal3(), dv = e.velocity * random.normal3();
    const Eigen::Vector3d std_rpy(e.level, e.level, e.heading);
    const Eigen::Vector3d rpy = truth.rpy + std_rpy.cwiseProduct(random.normal3());
    fusion::InitialSettings& initial = c.filter.initial;
    c.initial_time = truth.time.seconds();
    initial.position = earth::moved_by_ned(earth, truth.position, dp);
    initial.velocity_n = truth.velocity_n + dv;
    initial.rpy = {math::wrap_pi(rpy.x()), rpy.y(), math::wrap_2pi(rpy.z())};
}

void state_initial_sigmas(fusion::InitialSettings& initial, const settings::InitialError& e) {
    initial.std_position.setConstant(e.position);
    initial.std_velocity.setConstant(e.velocity);
    initial.std_rpy = {e.level, e.level, e.heading};
}

bool is_relevant(const std::string& key, const settings::Config& c, bool gravimetry) {
    if (key.starts_with("baro.")) return !c.baro.file.empty();
    if (key.starts_with("ranges.") || key.starts_with("stations.")) return !c.ranges.file.empty();
    if (key.starts_with("mag.")) return !c.mag.file.empty();
    if (key.starts_with("gauges.")) return !c.instruments.gauges.file.empty();
    if (key.starts_with("log.")) return !c.instruments.log.file.empty();
    if (key.starts_with("compass.")) return !c.instruments.compass.file.empty();
    if (key.starts_with("gravity.")) return gravimetry;
    return !key.starts_with("output.") && !key.ends_with(".time_offset_s") && key != "reference.quaternion";
}

}  // namespace

SimulatedDataset simulate_dataset(const settings::ScenarioConfig& scenario, const settings::ScenarioConfig* assumed,
                                  const sim::ExactFlight* flown) {
    const settings::ScenarioConfig& assumed_scenario = assumed != nullptr ? *assumed : scenario;
    SimulatedDataset out;
    out.truth = sim::simulate(scenario.sim, flown);
    out.recording = std::move(out.truth.recording);
    if (auto ranging = simulate_ranging(scenario)) {
        out.recording.ranges = std::move(ranging->ranges.log);
        for (const sim::GroundStation& g : scenario.ranging.settings.stations) out.stations.push_back({g.name, g.position});
        if (scenario.ranging.rinex) {
            const gnss::ObservationLog log = sim::observations_of(out.recording.ranges, ranging->gps - scenario.sim.origin);
            out.texts = {{"observations.rnx", io::rinex_observations_text(log)},
                         {"navigation.rnx", io::rinex_navigation_text(ranging->navigation)}};
        }
    }
    if (scenario.receiver_channels.rate > 0.0) {
        out.sky = std::make_shared<SimulatedSky>(scenario);
        SimulatedReceiver alone(*out.sky, receiver::Guidance::None);
        out.recording.ranges = alone.run_alone();
        out.receiver_rows = alone.rows();
    }
    out.seed = scenario.sim.seed;
    out.name = scenario.name;
    if (assumed != nullptr) {
        for (GnssFix& fix : out.recording.gnss) {
            fix.std_position = sim::stated_position_sigma(assumed->sim.gnss);
            fix.std_velocity = sim::stated_velocity_sigma(assumed->sim.gnss);
        }
        const sensor::RangingErrorModel& e = assumed->ranging.settings.errors;
        // a receiver at correlator level states the sigmas of its channels in any case
        if (!out.sky)
            for (RangeSample& m : out.recording.ranges.samples) {
                const bool station = out.recording.ranges.sources[m.source].station;
                m.std = station ? e.station.white : e.satellite.white;
                m.std_rate = station ? e.station.rate : e.satellite.rate;
            }
    }
    round_to_files(out.recording);
    const auto path = sim::make_path(scenario.sim.path, scenario.sim.earth.ellipsoid);
    out.instruments = sim::simulate_instruments(scenario.instruments, scenario.sim.earth, *path, scenario.sim.duration,
                                                scenario.sim.origin, out.seed);
    round_to_files(out.instruments);
    settings::Config c = described(assumed_scenario, out.recording);
    describe(assumed_scenario.instruments, out.instruments, c.instruments);
    if (scenario.initial_error.given() && !out.recording.reference.empty()) {
        give_initial_state(c, scenario.initial_error, out.recording.reference.front(), scenario.sim.earth, out.seed);
        state_initial_sigmas(c.filter.initial, assumed_scenario.initial_error);
    }
    // Fixes to be made from the ranges have the slow errors of these, which follow from the geometry: nothing else is assumed.
    const bool by_ranges = out.recording.gnss.empty() && !out.recording.ranges.empty() &&
                           !assumed_scenario.given.contains("gnss.correlated_m") &&
                           !assumed_scenario.given.contains("gnss.receiver");
    const bool gravimetry = scenario.sim.disturbed() || std::ranges::any_of(assumed_scenario.given, [](const std::string& key) {
                                return key.starts_with("gravity.");
                            });
    for (settings::Setting& s : settings::config_table().used(c)) {
        if (by_ranges && (s.key.starts_with("gnss.correlated_") || s.key.starts_with("gnss.change_")) &&
            !assumed_scenario.given.contains(s.key))
            continue;
        if (is_relevant(s.key, c, gravimetry)) out.settings.push_back(std::move(s));
    }
    out.settings.insert(out.settings.end(), assumed_scenario.assumed.begin(), assumed_scenario.assumed.end());
    return out;
}

void write_dataset(const SimulatedDataset& data, const std::filesystem::path& folder) {
    io::StagedFolder stage(folder);
    const Recording& r = data.recording;
    const ImuKind kind = data.truth.imu_kind;
    io::write_file(stage.path() / "imu.csv", imu_csv(r.imu, kind));
    if (!r.gnss.empty()) io::write_file(stage.path() / "gnss.csv", gnss_csv(r.gnss));
    if (!r.baro.empty()) io::write_file(stage.path() / "baro.csv", baro_csv(r.baro));
    if (!r.mag.empty()) io::write_file(stage.path() / "mag.csv", mag_csv(r.mag));
    if (!data.instruments.gauges.empty()) io::write_file(stage.path() / "gauges.csv", gauges_csv(data.instruments.gauges));
    if (!data.instruments.velocities.empty()) io::write_file(stage.path() / "log.csv", log_csv(data.instruments.velocities));
    if (!data.instruments.headings.empty()) io::write_file(stage.path() / "compass.csv", compass_csv(data.instruments.headings));
    if (!r.ranges.empty()) io::write_file(stage.path() / "ranges.csv", io::ranges_csv(r.ranges));
    if (!data.stations.empty()) io::write_file(stage.path() / "stations.csv", io::stations_csv(data.stations));
    for (const auto& [name, text] : data.texts) io::write_file(stage.path() / name, text);
    io::write_file(stage.path() / "reference.csv", reference_csv(r.reference));
    settings::SettingList last;  // for each key the last setting is valid
    for (const settings::Setting& s : data.settings) {
        std::erase_if(last, [&](const settings::Setting& e) { return e.key == s.key; });
        last.push_back(s);
    }
    const std::string head = fmt::format("# simulated, seed {}\n", data.seed);
    io::write_file(stage.path() / "dataset.toml", head + settings::to_toml(last, settings::config_table().specs(), true));
    stage.publish("dataset.toml");
}

}  // namespace schuler::scenario
