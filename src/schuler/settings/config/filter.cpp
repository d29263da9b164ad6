#include "schuler/core/units.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/config/sections.h"
#include "schuler/settings/option_builders.h"

namespace schuler::settings {
namespace {

using fusion::BaroSettings;
using fusion::ConstraintSettings;
using fusion::InitialSettings;
using fusion::Loop;
using fusion::MagSettings;

template <class T>
auto baro(T BaroSettings::*field) {
    return [=](auto& c) -> auto& { return c.filter.baro.*field; };
}
template <class T>
auto mag(T MagSettings::*field) {
    return [=](auto& c) -> auto& { return c.filter.mag.*field; };
}
template <class T>
auto constraints(T ConstraintSettings::*field) {
    return [=](auto& c) -> auto& { return c.filter.constraints.*field; };
}
/// One component of a vector of the initial state.
auto component(Eigen::Vector3d InitialSettings::*field, int axis) {
    return [=](auto& c) -> auto& { return (c.filter.initial.*field)[axis]; };
}

void add_environment(OptionTable<Config>& table) {
    table.add(flag<Config>("baro.use", "use the barometer", baro(&BaroSettings::use)))
        .add(number<Config>("baro.white_m", 1.0, 1e-3, 1e4, "white noise of the barometric height", baro(&BaroSettings::std)))
        .add(number<Config>("baro.bias_m", 1.0, 0, 1e5, "initial bias of the barometric height, one sigma",
                            baro(&BaroSettings::bias_std)))
        .add(number<Config>("baro.bias_walk_m", 1.0, 0, 1e3, "random walk of the bias of the barometric height",
                            baro(&BaroSettings::bias_walk)))
        .add(number<Config>("baro.sea_level_pressure_pa", 1.0, 8e4, 1.2e5,
                            "sea-level pressure used to convert pressures of the log to heights",
                            [](auto& c) -> auto& { return c.sea_level_pressure; }))
        .add(flag<Config>("mag.use", "use the magnetometer's heading", mag(&MagSettings::use)))
        .add(number<Config>("mag.declination_deg", units::deg, -180, 180,
                            "magnetic declination, east positive; not given: part of the heading offset",
                            mag(&MagSettings::declination)))
        .add(number<Config>("mag.heading_std_deg", units::deg, 1e-3, 180, "white noise of the magnetic heading",
                            mag(&MagSettings::heading_std)))
        .add(number<Config>("mag.heading_bias_deg", units::deg, 0, 180, "error of the magnetic heading at the start, one sigma",
                            mag(&MagSettings::bias_std)))
        .add(number<Config>("mag.heading_bias_walk_deg", units::deg, 0, 180, "random walk of the error of the magnetic heading",
                            mag(&MagSettings::bias_walk)))
        .add(
            number<Config>("mag.heading_deviation_deg", units::deg, 0, 90,
                           "constant deviation of the magnetic heading by the body's hard iron, one sigma of each axis; 0 = none",
                           mag(&MagSettings::deviation_std)))
        .add(number<Config>(
            "mag.heading_disturbance_deg", units::deg, 0, 90,
            "deviation of the magnetic heading that changes within seconds (soft iron in turns, currents), one sigma; "
            "0 = none; default: a quarter of mag.heading_deviation_deg",
            mag(&MagSettings::disturbance_std)))
        .add(flag<Config>("odometer.use", "use the odometer's speed", [](auto& c) -> auto& { return c.filter.odometer.use; }))
        .add(number<Config>("odometer.std_m_s", 1.0, 1e-4, 100, "white noise of the speed, where the log gives none",
                            [](auto& c) -> auto& { return c.filter.odometer.std; }))
        .add(number<Config>("odometer.scale_factor_ppm", units::ppm, 0, 1e6, "error of its scale, one sigma",
                            [](auto& c) -> auto& { return c.filter.odometer.scale_std; }))
        .add(flag<Config>("heading.use", "use the heading sensor", [](auto& c) -> auto& { return c.filter.heading.use; }))
        .add(number<Config>("heading.std_deg", units::deg, 1e-4, 180, "white noise of the heading, where the log gives none",
                            [](auto& c) -> auto& { return c.filter.heading.std; }))
        .add(number<Config>("heading.offset_deg", units::deg, 0, 180, "constant error of the heading, one sigma; 0 = none",
                            [](auto& c) -> auto& { return c.filter.heading.offset_std; }));
}

void add_initial(OptionTable<Config>& table) {
    using I = InitialSettings;
    constexpr double deg = units::deg;
    table
        .add(number<Config>("initial.time_s", 1.0, -1e11, 1e11, "time of the initial state on the data set's own axis",
                            [](auto& c) -> auto& { return c.initial_time; }))
        .add(number<Config>("initial.lat_deg", deg, -90, 90, "latitude of the IMU",
                            [](auto& c) -> auto& { return c.filter.initial.position.lat; }))
        .add(number<Config>("initial.lon_deg", deg, -360, 360, "longitude of the IMU",
                            [](auto& c) -> auto& { return c.filter.initial.position.lon; }))
        .add(number<Config>("initial.height_m", 1.0, -1e4, 1e6, "ellipsoidal height of the IMU",
                            [](auto& c) -> auto& { return c.filter.initial.position.h; }));
    const struct {
        const char* name;
        double factor, low, high;
        const char* help;
        Eigen::Vector3d I::*field;
        int axis;
    } rows[] = {{"vel_n_m_s", 1, -1e4, 1e4, "velocity north", &I::velocity_n, 0},
                {"vel_e_m_s", 1, -1e4, 1e4, "velocity east", &I::velocity_n, 1},
                {"vel_d_m_s", 1, -1e4, 1e4, "velocity down", &I::velocity_n, 2},
                {"roll_deg", deg, -180, 180, "roll of the body", &I::rpy, 0},
                {"pitch_deg", deg, -90, 90, "pitch", &I::rpy, 1},
                {"heading_deg", deg, -360, 360, "heading clockwise from north", &I::rpy, 2},
                {"std_n_m", 1, 0, 1e7, "one sigma of the position north", &I::std_position, 0},
                {"std_e_m", 1, 0, 1e7, "one sigma of the position east", &I::std_position, 1},
                {"std_d_m", 1, 0, 1e7, "one sigma of the position down", &I::std_position, 2},
                {"std_vn_m_s", 1, 0, 1e4, "one sigma of the velocity north", &I::std_velocity, 0},
                {"std_ve_m_s", 1, 0, 1e4, "one sigma of the velocity east", &I::std_velocity, 1},
                {"std_vd_m_s", 1, 0, 1e4, "one sigma of the velocity down", &I::std_velocity, 2},
                {"std_roll_deg", deg, 0, 180, "one sigma of roll", &I::std_rpy, 0},
                {"std_pitch_deg", deg, 0, 180, "one sigma of pitch", &I::std_rpy, 1},
                {"std_heading_deg", deg, 0, 180, "one sigma of heading", &I::std_rpy, 2}};
    for (const auto& r : rows) {
        table.add(number<Config>(std::string("initial.") + r.name, r.factor, r.low, r.high, r.help, component(r.field, r.axis)));
    }
    table
        .add(vector3<Config>("initial.gyro_bias_deg_h", units::deg_per_hour, -1e6, 1e6, "initial value of the gyro bias",
                             [](auto& c) -> auto& { return c.filter.initial.gyro_bias; }))
        .add(vector3<Config>("initial.accel_bias_mg", units::mg, -1e4, 1e4, "initial value of the accelerometer bias",
                             [](auto& c) -> auto& { return c.filter.initial.accel_bias; }));
}

/// Couplings by name.
struct CouplingPreset {
    std::string_view name;
    Scheme scheme;
    fusion::LooseKind kind = fusion::LooseKind::Standard;
};
constexpr CouplingPreset coupling_presets[] = {
    {"gnss", Scheme::Gnss},   {"separate", Scheme::Separate},
    {"loose", Scheme::Loose}, {"aggressive", Scheme::Loose, fusion::LooseKind::Aggressive},
    {"tight", Scheme::Tight}, {"intermediate", Scheme::Intermediate},
    {"deep", Scheme::Deep}};

/// A name for a group of settings; individually given ones take precedence because they come later in the table.
Option<Config> preset_option() {
    OptionSpec spec = detail::spec(
        "filter.preset", Shape::Text,
        "states, or a coupling by its name: ins15 = position, velocity, attitude, biases; ins21 = scale factors too; complex22 = those of paper "
        "A's integrated system: ins15, barometer bias, slow errors of the receiver's position and velocity (with the "
        "paper's sigmas where none are given); gnss, separate, loose, aggressive, tight, intermediate, deep = filter.scheme (aggressive: "
        "filter.loose too); gravity27 = the states of `schuler gravity`, which alone has them");
    spec.choices = {"ins15", "ins21", "complex22", "gravity27"};
    for (const CouplingPreset& p : coupling_presets) spec.choices.emplace_back(p.name);
    return {std::move(spec),
            [](Config& c, const Value& v) {
                c.preset = *v.text();
                if (const auto coupling = coupling_of_preset(c.preset)) {
                    c.scheme = coupling->scheme;
                    c.filter.loose_kind = coupling->loose_kind;
                    return;
                }
                if (c.preset == "gravity27") return;
                c.scale_factors = c.preset == "ins21";
                c.misalignments = false;
            },
            [](const Config& c) -> std::optional<Value> { return Value{c.preset}; }};
}

}  // namespace

std::optional<PresetCoupling> coupling_of_preset(std::string_view preset) {
    const auto* p = std::ranges::find(coupling_presets, preset, &CouplingPreset::name);
    if (p == std::end(coupling_presets)) return std::nullopt;
    return PresetCoupling{p->scheme, p->kind};
}

void add_filter_options(OptionTable<Config>& table) {
    add_environment(table);
    add_initial(table);
    using fusion::Mechanization;
    table.add(preset_option())
        .add(choice<Config, Scheme>(
            "filter.scheme",
            // clang-format off
            {{"loose", Scheme::Loose}, {"gnss", Scheme::Gnss}, {"separate", Scheme::Separate}, {"tight", Scheme::Tight},
             {"intermediate", Scheme::Intermediate}, {"medium", Scheme::Intermediate}, {"deep", Scheme::Deep}},
            // clang-format on
            "coupling: loose = one filter of receiver and inertial unit; separate (uncoupled) = the inertial navigation is reset to the receiver at intervals or "
            "corrected continuously; tight = one filter of the ranges themselves; intermediate (or medium) = tight, with a receiver-only filter in parallel; "
            "deep = tight, and the receiver's channels follow its solution (scenarios with [receiver]); gnss = the receiver's own solution",
            [](auto& c) -> auto& { return c.scheme; }))
        .add(choice<Config, Mechanization>(
            "filter.mechanization", {{"geographic", Mechanization::Geographic}, {"ecef", Mechanization::Ecef}},
            "frame of the strapdown equations", [](auto& c) -> auto& { return c.filter.mechanization; }))
        .add(choice<Config, Loop>(
            "filter.loop", {{"closed", Loop::Closed}, {"open", Loop::Open}, {"mixed", Loop::Mixed}},
            "estimated errors are fed back to the mechanization after every update (closed), applied to a copy "
            "(open), or fed back at intervals and applied to a copy in between (mixed)",
            [](auto& c) -> auto& { return c.filter.loop; }))
        .add(number<Config>("filter.feedback_period_s", 1.0, 1e-3, 1e6,
                            "time between corrections; default: until the attitude error can have grown by feedback_attitude_deg",
                            [](auto& c) -> auto& { return c.filter.feedback_period; }))
        .add(number<Config>("filter.feedback_attitude_deg", units::deg, 1e-6, 90,
                            "growth of the attitude error that is allowed between corrections",
                            [](auto& c) -> auto& { return c.filter.feedback_attitude; }))
        .add(flag<Config>("filter.smooth", "fixed-interval smoother after the filter",
                          [](auto& c) -> auto& { return c.filter.smooth; }))
        .add(flag<Config>(
            "filter.backward",
            "run a filter backward in time as well; its difference from the forward one, with its sigma: run.h5, report, summary.json",
            [](auto& c) -> auto& { return c.filter.backward; }))
        .add(flag<Config>(
            "filter.self_check",
            "`process` withholds fixes in windows that it chooses, checks the predicted sigmas against the withheld fixes, and raises the noise of the inertial "
            "unit (imu.gyro_noise_scale, imu.accel_noise_scale) where they are too small; it checks a given lever arm too",
            [](auto& c) -> auto& { return c.run.self_check; }))
        .add(flag<Config>("filter.scale_factors",
                          "gyro and accelerometer scale factors as states; default: on if a simulated IMU has them",
                          [](auto& c) -> auto& { return c.scale_factors; }))
        .add(flag<Config>("filter.misalignments",
                          "axis misalignments of both triads as states; default: on for a car and where a simulated IMU has them",
                          [](auto& c) -> auto& { return c.misalignments; }))
        .add(flag<Config>("filter.estimate_lever_arm", "the antenna lever arm as states",
                          [](auto& c) -> auto& { return c.filter.estimate_lever_arm; }))
        .add(flag<Config>("filter.zero_velocity", "zero-velocity and zero-rate updates where the log shows the body still",
                          constraints(&ConstraintSettings::zero_velocity)))
        .add(number<Config>("filter.zero_velocity_std_m_s", 1.0, 1e-6, 100, "velocity noise of zero-velocity updates",
                            constraints(&ConstraintSettings::zero_velocity_std)))
        .add(number<Config>("filter.zero_rate_std_deg_s", units::deg_per_s, 0, 100,
                            "rate noise of zero-rate updates, added to the gyro noise",
                            constraints(&ConstraintSettings::zero_rate_std)))
        .add(flag<Config>("filter.nonholonomic",
                          "non-holonomic constraint: wheels neither slip sideways nor leave the ground; default: on for a car",
                          [](auto& c) -> auto& { return c.nonholonomic; }))
        .add(flag<Config>("filter.detect_wheels",
                          "impose the vehicle constraint once the log shows that the vehicle rolls on wheels; default: "
                          "on for KF-GINS projects",
                          constraints(&ConstraintSettings::nonholonomic_auto)))
        .add(number<Config>("filter.nonholonomic_std_lateral_m_s", 1.0, 1e-4, 100, "sideways velocity, one sigma",
                            constraints(&ConstraintSettings::nonholonomic_std_lateral)))
        .add(number<Config>("filter.nonholonomic_std_vertical_m_s", 1.0, 1e-4, 100, "vertical velocity, one sigma",
                            constraints(&ConstraintSettings::nonholonomic_std_vertical)))
        .add(number<Config>("filter.constraint_rate_hz", 1.0, 0.01, 1000, "rate of the constraint updates",
                            constraints(&ConstraintSettings::constraint_rate)))
        .add(number<Config>("filter.gate_probability", 1.0, 0, 0.5,
                            "probability that a good measurement is rejected; 0 = no gate",
                            constraints(&ConstraintSettings::gate_probability)))
        .add(number<Config>("filter.floor_m", 1.0, 0, 1e6, "lower limit of the sigmas of the position",
                            constraints(&ConstraintSettings::floor_position)))
        .add(number<Config>("filter.floor_velocity_m_s", 1.0, 0, 1e6, "lower limit of the sigmas of the velocity",
                            constraints(&ConstraintSettings::floor_velocity)))
        .add(number<Config>("filter.floor_attitude_deg", units::deg, 0, 180, "lower limit of the sigmas of the attitude",
                            constraints(&ConstraintSettings::floor_attitude)))
        .add(number<Config>("filter.floor_gyro_bias_deg_h", units::deg_per_hour, 0, 1e6,
                            "lower limit of the sigmas of the gyro biases", constraints(&ConstraintSettings::floor_gyro_bias)))
        .add(number<Config>("filter.floor_accel_bias_mg", units::mg, 0, 1e4,
                            "lower limit of the sigmas of the accelerometer biases",
                            constraints(&ConstraintSettings::floor_accel_bias)))
        .add(number<Config>("filter.recovery_time_s", 1.0, 0, 1e5, "accept rejected fixes after they agree for this long",
                            constraints(&ConstraintSettings::recovery_time)))
        .add(integer<Config>("filter.recovery_count", 1, 100000, "smallest number of rejected fixes that must agree",
                             constraints(&ConstraintSettings::recovery_count)));
}

}  // namespace schuler::settings
