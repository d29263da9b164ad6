#include "schuler/io/text/detail/column_dictionary.h"

#include "schuler/core/units.h"

#include <algorithm>
#include <array>

namespace schuler::io::detail {
namespace {

struct NamedUnit {
    Dimension dimension;
    std::string_view name;
    UnitFactor to_canonical;
};

constexpr double per_deg = 1.0 / units::deg;

// Canonical units: s, deg, m, rad/s, m/s^2, m/s, Pa, microtesla, degrees Celsius.
constexpr std::array named_units = {
    NamedUnit{Dimension::Angle, "deg", {1.0}},
    NamedUnit{Dimension::Angle, "degree", {1.0}},
    NamedUnit{Dimension::Angle, "degrees", {1.0}},
    NamedUnit{Dimension::Angle, "rad", {per_deg}},
    NamedUnit{Dimension::Angle, "radians", {per_deg}},
    NamedUnit{Dimension::Angle, "mrad", {1e-3 * per_deg}},
    NamedUnit{Dimension::Angle, "urad", {1e-6 * per_deg}},
    NamedUnit{Dimension::Angle, "arcmin", {1.0 / 60.0}},
    NamedUnit{Dimension::Angle, "arcsec", {1.0 / 3600.0}},
    NamedUnit{Dimension::Angle, "e7", {1e-7}},
    NamedUnit{Dimension::Angle, "dege7", {1e-7}},
    NamedUnit{Dimension::Angle, "deg_e7", {1e-7}},
    NamedUnit{Dimension::Angle, "1e7", {1e-7}},
    NamedUnit{Dimension::Angle, "1e_7deg", {1e-7}},
    NamedUnit{Dimension::Angle, "cdeg", {1e-2}},
    NamedUnit{Dimension::Length, "m", {1.0}},
    NamedUnit{Dimension::Length, "meter", {1.0}},
    NamedUnit{Dimension::Length, "meters", {1.0}},
    NamedUnit{Dimension::Length, "metres", {1.0}},
    NamedUnit{Dimension::Length, "mm", {1e-3}},
    NamedUnit{Dimension::Length, "cm", {1e-2}},
    NamedUnit{Dimension::Length, "km", {1e3}},
    NamedUnit{Dimension::Length, "ft", {0.3048}},
    NamedUnit{Dimension::Length, "feet", {0.3048}},
    NamedUnit{Dimension::Rate, "rad_s", {1.0}},
    NamedUnit{Dimension::Rate, "rad_sec", {1.0}},
    NamedUnit{Dimension::Rate, "rads", {1.0}},
    NamedUnit{Dimension::Rate, "radps", {1.0}},
    NamedUnit{Dimension::Rate, "rps", {1.0}},
    NamedUnit{Dimension::Rate, "mrad_s", {1e-3}},
    NamedUnit{Dimension::Rate, "rad_s_1", {1.0}},
    NamedUnit{Dimension::Rate, "deg_s_1", {units::deg}},
    NamedUnit{Dimension::Rate, "deg_s", {units::deg}},
    NamedUnit{Dimension::Rate, "deg_sec", {units::deg}},
    NamedUnit{Dimension::Rate, "dps", {units::deg}},
    NamedUnit{Dimension::Rate, "degs", {units::deg}},
    NamedUnit{Dimension::Rate, "degps", {units::deg}},
    NamedUnit{Dimension::Rate, "mdps", {1e-3 * units::deg}},
    NamedUnit{Dimension::Rate, "deg_h", {units::deg_per_hour}},
    NamedUnit{Dimension::Rate, "deg_hr", {units::deg_per_hour}},
    NamedUnit{Dimension::Rate, "dph", {units::deg_per_hour}},
    NamedUnit{Dimension::Acceleration, "m_s2", {1.0}},
    NamedUnit{Dimension::Acceleration, "m_s_2", {1.0}},
    NamedUnit{Dimension::Acceleration, "m_s_s", {1.0}},
    NamedUnit{Dimension::Acceleration, "mps2", {1.0}},
    NamedUnit{Dimension::Acceleration, "ms2", {1.0}},
    NamedUnit{Dimension::Acceleration, "ms_2", {1.0}},
    NamedUnit{Dimension::Acceleration, "mss", {1.0}},
    NamedUnit{Dimension::Acceleration, "m_sec2", {1.0}},
    NamedUnit{Dimension::Acceleration, "mpss", {1.0}},
    NamedUnit{Dimension::Acceleration, "g", {units::g0}},
    NamedUnit{Dimension::Acceleration, "mg", {units::mg}},
    NamedUnit{Dimension::Acceleration, "ug", {units::ug}},
    NamedUnit{Dimension::Acceleration, "gal", {1e-2}},
    NamedUnit{Dimension::Acceleration, "mgal", {units::mgal}},
    NamedUnit{Dimension::Acceleration, "ft_s2", {0.3048}},
    NamedUnit{Dimension::Velocity, "m_s", {1.0}},
    NamedUnit{Dimension::Velocity, "mps", {1.0}},
    NamedUnit{Dimension::Velocity, "m_sec", {1.0}},
    NamedUnit{Dimension::Velocity, "ms", {1.0}},
    NamedUnit{Dimension::Velocity, "m_s_1", {1.0}},
    NamedUnit{Dimension::Velocity, "mm_s", {1e-3}},
    NamedUnit{Dimension::Velocity, "cm_s", {1e-2}},
    NamedUnit{Dimension::Velocity, "km_h", {1.0 / 3.6}},
    NamedUnit{Dimension::Velocity, "kmh", {1.0 / 3.6}},
    NamedUnit{Dimension::Velocity, "kph", {1.0 / 3.6}},
    NamedUnit{Dimension::Velocity, "kn", {1852.0 / 3600.0}},
    NamedUnit{Dimension::Velocity, "kt", {1852.0 / 3600.0}},
    NamedUnit{Dimension::Velocity, "knots", {1852.0 / 3600.0}},
    NamedUnit{Dimension::Velocity, "ft_s", {0.3048}},
    NamedUnit{Dimension::Pressure, "pa", {1.0}},
    NamedUnit{Dimension::Pressure, "hpa", {100.0}},
    NamedUnit{Dimension::Pressure, "kpa", {1e3}},
    NamedUnit{Dimension::Pressure, "mbar", {100.0}},
    NamedUnit{Dimension::Pressure, "mb", {100.0}},
    NamedUnit{Dimension::Pressure, "bar", {1e5}},
    NamedUnit{Dimension::Pressure, "psi", {6894.757293168361}},
    NamedUnit{Dimension::Pressure, "inhg", {3386.389}},
    NamedUnit{Dimension::Pressure, "mmhg", {133.322387415}},
    NamedUnit{Dimension::Field, "ut", {1.0}},
    NamedUnit{Dimension::Field, "t", {1e6}},
    NamedUnit{Dimension::Field, "mt", {1e3}},
    NamedUnit{Dimension::Field, "nt", {1e-3}},
    NamedUnit{Dimension::Field, "gauss", {100.0}},
    NamedUnit{Dimension::Field, "g", {100.0}},
    NamedUnit{Dimension::Field, "ga", {100.0}},
    NamedUnit{Dimension::Field, "mgauss", {0.1}},
    NamedUnit{Dimension::Field, "mg", {0.1}},
    NamedUnit{Dimension::Field, "mga", {0.1}},
    NamedUnit{Dimension::Temperature, "c", {1.0}},
    NamedUnit{Dimension::Temperature, "degc", {1.0}},
    NamedUnit{Dimension::Temperature, "deg_c", {1.0}},
    NamedUnit{Dimension::Temperature, "celsius", {1.0}},
    NamedUnit{Dimension::Temperature, "k", {1.0, -273.15}},
    NamedUnit{Dimension::Temperature, "kelvin", {1.0, -273.15}},
    NamedUnit{Dimension::Temperature, "f", {5.0 / 9.0, -160.0 / 9.0}},
    NamedUnit{Dimension::Temperature, "degf", {5.0 / 9.0, -160.0 / 9.0}},
};

/// Of dates with the time of day.
constexpr const char* calendar_stems = "datetime date_time datetime_utc date_time_utc iso_time time_iso iso_timestamp utc date";

constexpr const char* time_stems =
    "time t timestamp time_stamp stamp gps_time gpstime gpst tow gps_tow gpstow time_of_week sow gps_sow gps_seconds gps_sec "
    "sec_of_week i_tow "
    "seconds_of_week time_gps time_startup time_boot time_since_start time_imu header_stamp seconds_elapsed elapsed_seconds itow utc_time time_utc epoch elapsed "
    "elapsed_time recorded_at created_at local_time timestamp_utc ts unix_time time_unix unix_timestamp timestamp_unix epoch_time gps_time_of_week sample_time time_sample "
    "| sec secs second seconds s ms us ns timer millis micros";

using D = Dimension;

std::vector<Quantity> position_and_velocity() {
    return {
        {"lat_deg", D::Angle, "lat latitude pos_lat position_lat gps_lat | phi"},
        {"lon_deg", D::Angle, "lon longitude long lng pos_lon position_lon gps_lon | lambda lam"},
        {"height_m", D::Length,
         "height_ellipsoidal ellipsoidal_height height_ell ell_height h_ell hell hae height_hae alt_hae height_wgs84 "
         "alt_ellipsoid altitude_ellipsoidal",
         1.0, HeightKind::Ellipsoidal},
        {"height_m", D::Length,
         "height altitude alt hgt height_above_ellipsoid pos_height pos_alt position_alt gps_alt | h z_geo elevation"},
        {"height_m", D::Length,
         "height_msl msl_height alt_msl altitude_msl h_msl hmsl msl amsl alt_amsl height_amsl orthometric_height", 1.0,
         HeightKind::Msl},
        {"height_m", D::Length,
         "height_rel rel_height height_relative relative_height rel_alt alt_rel relative_altitude altitude_rel "
         "height_agl agl",
         1.0, HeightKind::Relative},
        {"ecef_x_m", D::Length, "ecef_x x_ecef pos_ecef_x ecefx xecef"},
        {"ecef_y_m", D::Length, "ecef_y y_ecef pos_ecef_y ecefy yecef"},
        {"ecef_z_m", D::Length, "ecef_z z_ecef pos_ecef_z ecefz zecef"},
        {"vel_n_m_s", D::Velocity,
         "vel_n vn v_n veln vel_north v_north velocity_n velocity_north north_velocity vnorth vel_ned_n | speed_n"},
        {"vel_e_m_s", D::Velocity,
         "vel_e ve v_e vele vel_east v_east velocity_e velocity_east east_velocity veast vel_ned_e | speed_e"},
        {"vel_d_m_s", D::Velocity,
         "vel_d vd v_d veld vel_down v_down velocity_d velocity_down down_velocity vdown vel_ned_d | speed_d"},
        {"vel_d_m_s", D::Velocity,
         "vel_u vu v_u velu vel_up v_up velocity_u velocity_up up_velocity vup | climb climb_rate vertical_speed", -1.0},
    };
}

std::vector<Quantity> with(std::vector<Quantity> a, const std::vector<Quantity>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

const std::vector<Quantity> time_only = {{"time_s", D::Time, time_stems}, {"time_s", D::Calendar, calendar_stems}};

std::string with_axis(std::string pattern, char axis) {
    std::replace(pattern.begin(), pattern.end(), '@', axis);
    std::replace(pattern.begin(), pattern.end(), '#', static_cast<char>(axis - 'x' + '0'));
    return pattern;
}

/// The three components of a vector; '@' represents the axis, '#' its number from 0.
std::vector<Quantity> three_axes(const std::string& canonical, Dimension dimension, const std::string& stems, double unit = 1.0) {
    std::vector<Quantity> result;
    for (const char axis : {'x', 'y', 'z'})
        result.push_back({with_axis(canonical, axis), dimension, with_axis(stems, axis), unit});
    return result;
}

std::vector<Quantity> imu_quantities() {
    std::vector<Quantity> q = time_only;
    q = with(
        q,
        three_axes("gyro_@_rad_s", D::Rate,
                   "gyro_@ gyr_@ gyroscope_@ gyro@ gyr@ @_gyro w@ w_@ omega_@ omega@ angular_velocity_@ angular_rate_@ ang_vel_@ "
                   "angvel_@ ang_rate_@ rate_@ g_@ gyro_rate_@ angularvelocity_@ w_rs_s_@ gyro_rad_# uncomp_gyro_@ | g@"));
    q = with(q,
             three_axes("accel_@_m_s2", D::Acceleration,
                        "accel_@ acc_@ accelerometer_@ acceleration_@ accel@ acc@ @_accel @_acc a@ a_@ f@ f_@ specific_force_@ "
                        "linear_acceleration_@ sf_@ lin_acc_@ a_rs_s_@ accelerometer_m_s2_# uncomp_accel_@"));
    // MAVLink's RAW_IMU and SCALED_IMU: milliradians per second and thousandths of g
    q = with(q, three_axes("gyro_@_rad_s", D::Rate, "@gyro", 1e-3));
    q = with(q, three_axes("accel_@_m_s2", D::Acceleration, "@acc", units::mg));
    q = with(q, three_axes("dtheta_@_rad", D::Angle, "dtheta_@ dth_@ dang_@ delta_theta_@ delta_angle_@ dtheta@ delta_ang_@"));
    q = with(q, three_axes("dv_@_m_s", D::Velocity, "dv_@ dvel_@ delta_v_@ delta_velocity_@ delta_vel_@ dv@ dvel@"));
    return with(q, {{"temperature_c", D::Temperature, "temperature temp imu_temp imu_temperature"}});
}

const std::vector<Quantity> imu = imu_quantities();

const std::vector<Quantity> gnss = with(
    with(with(time_only, {{"time_valid_s", D::Time, "time_valid valid_time time_of_validity"},
                          {"vel_time_valid_s", D::Time, "vel_time_valid velocity_time_valid vel_valid_time"}}),
         position_and_velocity()),
    {
        {"std_n_m", D::Length,
         "std_n sdn sd_n sigma_n n_std std_north north_std sigma_north std_lat lat_std sigma_lat lat_sigma sdlat"},
        {"std_e_m", D::Length,
         "std_e sde sd_e sigma_e e_std std_east east_std sigma_east std_lon lon_std sigma_lon lon_sigma sdlon"},
        {"std_d_m", D::Length,
         "std_d sdd sd_d sigma_d d_std std_down down_std std_u sdu sd_u sigma_u u_std std_up std_h std_height std_alt "
         "height_std alt_std sigma_h sigma_height sdh v_acc vacc vertical_accuracy std_vertical std_ver epv"},
        {"std_h_m", D::Length, "std_h std_horizontal std_hor h_acc hacc horizontal_accuracy eph"},
        {"std_vn_m_s", D::Velocity, "std_vn sdvn std_vel_n vel_std_n sd_vn sigma_vn vel_n_std vn_std std_vnorth std_vel_north"},
        {"std_ve_m_s", D::Velocity, "std_ve sdve std_vel_e vel_std_e sd_ve sigma_ve vel_e_std ve_std std_veast std_vel_east"},
        {"std_vd_m_s", D::Velocity,
         "std_vd sdvd std_vel_d vel_std_d sd_vd sigma_vd vel_d_std vd_std std_vdown std_vel_down std_vu sdvu std_vel_u sd_vu "
         "sigma_vu std_vel_up vel_std_u vel_u_std"},
        {"std_vel_m_s", D::Velocity,
         "std_vel std_velocity std_v vel_std velocity_std s_acc sacc speed_acc speed_accuracy std_speed"},
        {"fix", D::Count,
         "fix fix_type gps_fix gps_fix_type fix_quality gps_quality gps_qual gnss_fix pos_type solution_type q quality "
         "fixtype gnss_fix_type gps_status gnss_status fix_status | mode status"},
        {"carrier_solution", D::Count, "carrier_solution carr_soln carrsoln carrier_soln"},
        {"satellites", D::Count,
         "satellites num_sats numsats num_sat num_satellites num_sv numsv nsat nsats n_sat n_sats ns nsv n_sv sats "
         "satellites_used satellites_visible sat_count numsatellites"},
    });

const std::vector<Quantity> baro = with(
    time_only, {{"height_m", D::Length,
                 "height baro_height baro_alt height_baro alt_baro altitude alt baro_altitude pressure_altitude "
                 "pressure_alt pressure_height barometric_height press_alt"},
                {"height_m", D::Length, "baro_height_msl_std baro_height_msl baro_alt_msl height_msl alt_msl baro_height_std",
                 1.0, HeightKind::Msl},
                {"height_m", D::Length, "baro_height_rel baro_alt_rel height_rel alt_rel rel_alt", 1.0, HeightKind::Relative},
                {"pressure_pa", D::Pressure,
                 "pressure press baro static_pressure baro_pressure pressure_static air_pressure abs_pressure "
                 "baro_press fluid_pressure | p"},
                {"temperature_c", D::Temperature, "temperature temp baro_temp baro_temperature"}});

const std::vector<Quantity> mag = with(
    time_only, with(three_axes("mag_@_ut", D::Field,
                               "mag_@ mag@ m@ m_@ magnetometer_@ magnetic_field_@ mag_uncal_@ field_@ magnetic_@ b_@ b@ @_mag "
                               "magnetometer_ga_#"),
                    three_axes("mag_@_ut", D::Field, "@mag", 0.1)));  // of MAVLink, milligauss

const std::vector<Quantity> reference =
    with(with(time_only, position_and_velocity()),
         {{"roll_deg", D::Angle, "roll rll bank | phi"},
          {"pitch_deg", D::Angle, "pitch pit | theta"},
          {"heading_deg", D::Angle, "heading yaw hdg azimuth yaw_ned true_heading | psi course"},
          {"qw", D::Count,
           "qw q_w quat_w quaternion_w quat_sensor_to_enu_w quat_body_to_ned_w q_sensor_to_enu_w q_body_to_ned_w q_nb_w "
           "orientation_w q_rs_w pose_orientation_w | q0"},
          {"qx", D::Count,
           "qx q_x quat_x quaternion_x quat_sensor_to_enu_x quat_body_to_ned_x q_sensor_to_enu_x q_body_to_ned_x q_nb_x "
           "orientation_x q_rs_x pose_orientation_x | q1"},
          {"qy", D::Count,
           "qy q_y quat_y quaternion_y quat_sensor_to_enu_y quat_body_to_ned_y q_sensor_to_enu_y q_body_to_ned_y q_nb_y "
           "orientation_y q_rs_y pose_orientation_y | q2"},
          {"qz", D::Count,
           "qz q_z quat_z quaternion_z quat_sensor_to_enu_z quat_body_to_ned_z q_sensor_to_enu_z q_body_to_ned_z q_nb_z "
           "orientation_z q_rs_z pose_orientation_z | q3"},
          {"local_x_m", D::Length, "local_x x tx pos_x p_x px position_x pose_x pose_position_x p_rs_r_x"},
          {"local_y_m", D::Length, "local_y y ty pos_y p_y py position_y pose_y pose_position_y p_rs_r_y"},
          {"local_z_m", D::Length, "local_z z tz pos_z p_z pz position_z pose_z pose_position_z p_rs_r_z"},
          {"movement", D::Count, "movement moving motion in_motion"}});

std::vector<Quantity> range_quantities() {
    std::vector<Quantity> q = with(time_only, {{"source", D::Count, "source satellite sv prn sat transmitter | id"},
                                               {"pseudorange_m", D::Length, "pseudorange pseudo_range prange code c1 | pr range"},
                                               {"range_rate_m_s", D::Velocity, "range_rate pseudorange_rate rangerate prr"},
                                               {"std_m", D::Length, "std sigma std_pseudorange pseudorange_std"},
                                               {"std_rate_m_s", D::Velocity, "std_rate sigma_rate std_range_rate range_rate_std"},
                                               {"cn0_db_hz", D::Count, "cn0_db_hz cn0 c_n0 cno snr"}});
    q = with(q, three_axes("tx_@_m", D::Length, "tx_@ sat_@ sv_@"));
    q = with(q, three_axes("tx_v@_m_s", D::Velocity, "tx_v@ sat_v@ sv_v@"));
    return with(q, {{"tx_clock_s", D::Count, "tx_clock_s tx_clock sat_clock sv_clock"},
                    {"tx_clock_rate", D::Count, "tx_clock_rate sat_clock_rate"}});
}

const std::vector<Quantity> ranges = range_quantities();

const std::vector<Quantity> stations = {{"id", D::Count, "id name station icao"},
                                        {"lat_deg", D::Angle, "lat latitude"},
                                        {"lon_deg", D::Angle, "lon longitude long lng"},
                                        {"height_m", D::Length, "height altitude alt hgt | h elevation"}};

}  // namespace

const std::vector<Quantity>& quantities(TableKind kind) {
    switch (kind) {
        case TableKind::Imu: return imu;
        case TableKind::Gnss: return gnss;
        case TableKind::Baro: return baro;
        case TableKind::Mag: return mag;
        case TableKind::Reference: return reference;
        case TableKind::Ranges: return ranges;
        case TableKind::Stations: return stations;
    }
    return imu;
}

std::vector<std::string> unit_names(Dimension dimension) {
    if (dimension == Dimension::Time) return {"s", "ms", "us", "ns"};
    std::vector<std::string> names;
    for (const NamedUnit& u : named_units)
        if (u.dimension == dimension) names.emplace_back(u.name);
    return names;
}

std::optional<UnitFactor> unit_factor(Dimension dimension, std::string_view unit) {
    for (const NamedUnit& u : named_units) {
        if (u.dimension == dimension && u.name == unit) return u.to_canonical;
    }
    return std::nullopt;
}

std::optional<TimeUnit> time_unit(std::string_view unit) {
    for (const std::string_view s : {"s", "sec", "secs", "second", "seconds"}) {
        if (unit == s) return TimeUnit::Seconds;
    }
    for (const std::string_view s : {"ms", "msec", "msecs", "millis", "milliseconds"}) {
        if (unit == s) return TimeUnit::Milliseconds;
    }
    for (const std::string_view s : {"us", "usec", "usecs", "micros", "microseconds"}) {
        if (unit == s) return TimeUnit::Microseconds;
    }
    for (const std::string_view s : {"ns", "nsec", "nsecs", "nanos", "nanosec", "nanosecs", "nanosecond", "nanoseconds"}) {
        if (unit == s) return TimeUnit::Nanoseconds;
    }
    return std::nullopt;
}

bool is_origin_word(std::string_view word) {
    static constexpr std::array<std::string_view, 40> words = {
        "imu",  "imu0",     "imu1",      "imu2", "gps",      "gps0",   "gnss",     "gnss1",  "gnss2", "ins",
        "ahrs", "onboard",  "autopilot", "ekf",  "nav",      "filter", "truth",    "true",   "ref",   "reference",
        "est",  "estimate", "raw",       "cal",  "uncal",    "comp",   "uncomp",   "sensor", "baro",  "mag",
        "vn",   "att",      "attitude",  "pos",  "position", "vel",    "velocity", "data",   "field", "meas"};
    return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace schuler::io::detail
