#include "schuler/sensor/grades.h"

#include "schuler/core/fail.h"
#include "schuler/core/units.h"
#include "schuler/sensor/detail/names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <string>

namespace schuler::sensor {

namespace {

// One row in the units of data sheets. Columns: noise, in-run bias, its correlation time, turn-on bias, scale, misalignment.
struct GyroSheet {
    double noise_deg_sqrt_h, bias_deg_h, bias_time_s, turn_on_deg_h, scale_ppm, misalignment_arcsec;
};
struct AccelSheet {
    double noise_m_s_sqrt_h, bias_mg, bias_time_s, turn_on_mg, scale_ppm, misalignment_arcsec;
};
struct Sheet {
    std::string_view name;
    GyroSheet gyro;
    AccelSheet accel;
};

// Grades: the classes of Groves 2013 (Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems, 2nd ed.,
// ch. 4: tables of biases, sections on scale factor, cross-coupling and random noise), a central value of each class. In-run
// biases and correlation times, which that book does not tabulate, are the Allan floor of typical devices of the class,
// with a margin of two to three because a Gauss-Markov process represents flicker noise and temperature.
// Devices, typical columns of the manufacturers' data sheets:
//  adis16405   Analog Devices rev. B: 0.05 deg/s/sqrt(Hz), ARW 2 deg/sqrt(h), initial 3 deg/s, in-run 0.007 deg/s (25 deg/h),
//              VRW 0.2 m/s/sqrt(h), initial 50 mg, in-run 0.2 mg, sensitivity 1 %, axes 0.05 deg.
//  adis16488   Analog Devices (16488A within a fifth): ARW 0.3 deg/sqrt(h), initial 0.2 deg/s, in-run 6.25 deg/h,
//              VRW 0.029 m/s/sqrt(h), initial 16 mg, in-run 0.1 mg, sensitivity 1 % and 0.5 %, axes 0.05 and 0.035 deg.
//  stim300     Sensonor TS1524: ARW 0.15 deg/sqrt(h), in-run 0.5 deg/h, bias after switch-on 4 deg/h, 500 ppm; accelerometers of 10 g:
//              VRW 0.07 m/s/sqrt(h), in-run 0.05 mg, after switch-on 0.75 mg, 300 ppm; axes 1 mrad. In-run biases doubled, as above.
//  hg9900      Honeywell: GG1320AN gyros 0.003 deg/h, 0.002 deg/sqrt(h), 5 ppm; QA-2000 accelerometers 25 ug, 100 ppm (paper A,
//              tables 1.4.2 and 1.4.3). The random walk printed there for the accelerometers is that of the gyros; 5 ug/sqrt(Hz)
//              (QA-2000 sheet: 8 ug rms in 0 to 10 Hz, with margin) is used here. The stated bias is taken as in-run with an
//              hour's correlation time. Axes: 5 arcsec after calibration, assumed.
constexpr std::array<Sheet, 9> sheets{{
    {"consumer", {0.3, 30.0, 300.0, 1000.0, 10000.0, 1800.0}, {0.1, 5.0, 300.0, 20.0, 10000.0, 1800.0}},
    {"adis16405", {2.0, 25.2, 300.0, 10800.0, 10000.0, 180.0}, {0.2, 0.2, 300.0, 50.0, 10000.0, 180.0}},
    {"mems", {0.2, 10.0, 600.0, 100.0, 3000.0, 180.0}, {0.05, 0.2, 600.0, 3.0, 3000.0, 180.0}},
    {"adis16488", {0.3, 6.25, 600.0, 720.0, 10000.0, 180.0}, {0.029, 0.1, 600.0, 16.0, 5000.0, 126.0}},
    {"stim300", {0.15, 1.0, 1800.0, 4.0, 500.0, 206.0}, {0.07, 0.1, 1800.0, 0.75, 300.0, 206.0}},
    {"tactical", {0.05, 1.0, 1800.0, 3.0, 300.0, 100.0}, {0.03, 0.1, 1800.0, 1.0, 300.0, 100.0}},
    {"navigation", {0.002, 0.003, 3600.0, 0.01, 5.0, 5.0}, {0.01, 0.01, 3600.0, 0.05, 100.0, 5.0}},
    {"hg9900", {0.002, 0.003, 3600.0, 0.0, 5.0, 5.0}, {0.003, 0.025, 3600.0, 0.0, 100.0, 5.0}},
    {"perfect", {0.0, 0.0, 3600.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 3600.0, 0.0, 0.0, 0.0}},
}};

ImuErrorModel si(const Sheet& sheet) {
    ImuErrorModel m;
    m.gyro_noise = sheet.gyro.noise_deg_sqrt_h * units::deg_per_sqrt_hour;
    m.gyro_bias = sheet.gyro.bias_deg_h * units::deg_per_hour;
    m.gyro_bias_time = sheet.gyro.bias_time_s;
    m.gyro_turn_on_bias = sheet.gyro.turn_on_deg_h * units::deg_per_hour;
    m.gyro_scale = sheet.gyro.scale_ppm * units::ppm;
    m.gyro_misalignment = sheet.gyro.misalignment_arcsec * units::arcsec;
    m.accel_noise = sheet.accel.noise_m_s_sqrt_h * units::m_s_per_sqrt_hour;
    m.accel_bias = sheet.accel.bias_mg * units::mg;
    m.accel_bias_time = sheet.accel.bias_time_s;
    m.accel_turn_on_bias = sheet.accel.turn_on_mg * units::mg;
    m.accel_scale = sheet.accel.scale_ppm * units::ppm;
    m.accel_misalignment = sheet.accel.misalignment_arcsec * units::arcsec;
    return m;
}

}  // namespace

// Flicker from 1e-5 to 1 Hz has a standard deviation of B sqrt(ln(1e5)/pi) = 1.9 B.
double ImuErrorModel::gyro_initial_bias() const { return std::hypot(gyro_turn_on_bias, gyro_bias, 1.9 * gyro_flicker); }
double ImuErrorModel::accel_initial_bias() const { return std::hypot(accel_turn_on_bias, accel_bias, 1.9 * accel_flicker); }

ImuErrorModel imu_grade(std::string_view name) {
    const std::string wanted = detail::bare(name);
    for (const Sheet& sheet : sheets) {
        if (wanted == sheet.name) return si(sheet);
    }
    fail(input_error(fmt::format("unknown IMU grade \"{}\"", name), {},
                     fmt::format("use one of {}, or give the numbers", fmt::join(imu_grade_names(), ", "))));
}

std::vector<std::string_view> imu_grade_names() {
    std::vector<std::string_view> names;
    for (const Sheet& sheet : sheets) names.push_back(sheet.name);
    return names;
}

}  // namespace schuler::sensor
