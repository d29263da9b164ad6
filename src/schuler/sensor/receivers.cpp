#include "schuler/sensor/receivers.h"

#include "schuler/core/fail.h"
#include "schuler/sensor/detail/names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

namespace schuler::sensor {

namespace {

/// One row: sigmas horizontal (each axis) and vertical, m and m/s; correlation time of the slow error of the position, s.
struct ReceiverSheet {
    std::string_view name;
    double white, white_down, slow, slow_down, slow_time;
    double velocity, velocity_down;
    FixType fix;
};

// Data sheets state the total error of a position over a day under an open sky, as a radius: CEP (half of the fixes inside) is 1.177
// sigma of each axis, a horizontal RMS is 1.414. Most of it varies slowly with atmosphere, orbits and multipath. The part taken as
// white is that of fixes from carrier-smoothed codes, the correlation time that of multipath and of the changing geometry (600 s);
// both are assumptions, as is a vertical sigma of 1.6 times the horizontal one where the sheet has none.
//  neo-m8   u-blox: autonomous 2.5 m CEP, velocity 0.05 m/s (half of the fixes).
//  zed-f9p  u-blox: autonomous 1.5 m CEP, velocity 0.05 m/s (half of the fixes); with corrections 0.01 m CEP both ways.
//  oem7     NovAtel, L1/L2: single point 1.2 m RMS, velocity 0.03 m/s RMS; RTK 1 cm RMS.
//  um980    Unicore: single point 1.5 m horizontally, 2.5 m vertically RMS, velocity 0.03 m/s RMS; RTK 0.8 cm and 1.5 cm.
// RTK: besides 1 ppm of the baseline.
constexpr std::array<ReceiverSheet, 9> receiver_sheets{{
    // clang-format off
    {"autonomous",  1.0,   2.0,   1.5,  3.0,  300.0, 0.05,  0.1,   FixType::Autonomous},
    {"rtk",         0.01,  0.02,  0.0,  0.0,  300.0, 0.03,  0.05,  FixType::RtkFixed},
    {"neo-m8",      0.5,   0.8,   2.06, 3.3,  600.0, 0.05,  0.08,  FixType::Autonomous},
    {"zed-f9p",     0.3,   0.5,   1.24, 2.0,  600.0, 0.05,  0.08,  FixType::Autonomous},
    {"zed-f9p-rtk", 0.0085, 0.01, 0.0,  0.0,  300.0, 0.05,  0.08,  FixType::RtkFixed},
    {"oem7",        0.3,   0.5,   0.79, 1.27, 600.0, 0.021, 0.034, FixType::Autonomous},
    {"oem7-rtk",    0.007, 0.011, 0.0,  0.0,  300.0, 0.021, 0.034, FixType::RtkFixed},
    {"um980",       0.3,   0.5,   1.02, 2.45, 600.0, 0.021, 0.034, FixType::Autonomous},
    {"um980-rtk",   0.006, 0.015, 0.0,  0.0,  300.0, 0.021, 0.034, FixType::RtkFixed},
    // clang-format on
}};

/// The airliner's receiver of paper A: lower ends of the ranges recommended after (3.2.2), which gives no separate sigma for the
/// white jump of the height.
GnssReceiver duostar1000() {
    GnssReceiver r;
    r.white_position = {1.0, 1.0, 1.5};
    r.white_velocity.setConstant(0.01);
    r.errors.correlated_position = {5.0, 5.0, 7.0};
    r.errors.correlated_velocity.setConstant(0.02);
    r.errors.correlated_time = 2000.0;
    r.errors.correlated_distance = 250e3;
    r.errors.correlated_velocity_time = 20.0;
    r.errors.change_white_position.setConstant(1.0);
    r.errors.change_white_velocity.setConstant(0.02);
    r.errors.change_correlated_position = {2.0, 2.0, 3.0};
    r.errors.change_correlated_velocity.setConstant(0.01);
    r.rate = 10.0;  // [PaperA:table 1.2.1]
    return r;
}

constexpr std::string_view paper_a = "duostar1000";

}  // namespace

GnssReceiver gnss_receiver(std::string_view name) {
    const std::string wanted = detail::bare(name);
    if (wanted == paper_a) return duostar1000();
    for (const ReceiverSheet& s : receiver_sheets) {
        if (wanted != detail::bare(s.name)) continue;
        GnssReceiver r;
        r.white_position = {s.white, s.white, s.white_down};
        r.white_velocity = {s.velocity, s.velocity, s.velocity_down};
        r.errors.correlated_position = {s.slow, s.slow, s.slow_down};
        r.errors.correlated_time = s.slow_time;
        r.fix = s.fix;
        return r;
    }
    fail(input_error(fmt::format("unknown receiver \"{}\"", name), {},
                     fmt::format("use one of {}, or give the numbers", fmt::join(gnss_receiver_names(), ", "))));
}

std::vector<std::string_view> gnss_receiver_names() {
    std::vector<std::string_view> names;
    for (const ReceiverSheet& s : receiver_sheets) names.push_back(s.name);
    names.insert(names.begin() + 2, paper_a);
    return names;
}

}  // namespace schuler::sensor
