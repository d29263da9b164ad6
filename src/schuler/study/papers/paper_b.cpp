// Paper B: effect of a disturbed magnetometer on the tilt. The same noise with and without the disturbance.
#include "schuler/ahrs/dcm_filter.h"
#include "schuler/ahrs/mekf.h"
#include "schuler/ahrs/quaternion_filter.h"
#include "schuler/core/units.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"
#include "schuler/report/result_table.h"
#include "schuler/study/papers/item.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

namespace schuler::study {
namespace {

using ahrs::DcmFilter;
using ahrs::QuaternionFilter;
using ahrs::Separation;
using Eigen::Vector3d;

constexpr double dt = 0.01, duration = 180.0, from = 60.0, to = 120.0;
constexpr double paper_horizontal = 18964e-9, paper_vertical = 46962e-9;  // T, of the paper

struct Sample {
    Vector3d gyro, accel, field;
};

Eigen::Quaterniond attitude_at(bool moving, double t) {
    if (!moving) return Eigen::Quaterniond::Identity();
    constexpr double tau = 2.0 * std::numbers::pi;
    t = std::max(0.0, t - 5.0);
    return math::quaternion_from_rpy({20.0 * units::deg * std::sin(tau * t / 7.0), 15.0 * units::deg * std::sin(tau * t / 5.0),
                                      60.0 * units::deg * std::sin(tau * t / 23.0)});
}

/// The sensors of math.md 3.5; from 60 to 120 s the horizontal field is rotated by 20 deg, the vertical one changed by 10000 nT.
std::vector<Sample> simulated(bool moving, bool disturbed, std::uint64_t seed) {
    math::Random gyro(seed, "gyro"), accel(seed, "accel"), field(seed, "field");
    const Vector3d bias = Vector3d(0.02, -0.03, 0.02) * units::deg_per_s;
    std::vector<Sample> out;
    for (int i = 1; i <= static_cast<int>(std::lround(duration / dt)); ++i) {
        const double t = i * dt;
        const Eigen::Quaterniond before = attitude_at(moving, t - dt), now = attitude_at(moving, t);
        const bool here = disturbed && t >= from && t < to;
        const double turn = here ? 20.0 * units::deg : 0.0;
        const Vector3d field_n(paper_horizontal * std::cos(turn), paper_horizontal * std::sin(turn),
                               paper_vertical - (here ? 10000e-9 : 0.0));
        out.push_back({math::rotation_vector_from_quaternion(before.conjugate() * now) / dt + bias +
                           0.1 * units::deg_per_s * gyro.normal3(),
                       now.conjugate() * Vector3d(0.0, 0.0, -9.81) + 0.05 * accel.normal3(),
                       now.conjugate() * field_n + 200e-9 * field.normal3()});
    }
    return out;
}

template <class Filter>
std::vector<Vector3d> attitudes(const std::vector<Sample>& data, Filter filter) {
    std::vector<Vector3d> out;
    for (const Sample& s : data) {
        if constexpr (std::is_same_v<Filter, ahrs::Mekf>) {
            filter.step(dt, s.gyro, s.accel);
            filter.magnetometer(s.field);
        } else {
            filter.propagate(dt, s.gyro);
            filter.accelerometer(s.accel);
            filter.magnetometer(s.field);
        }
        if constexpr (std::is_same_v<Filter, DcmFilter>) out.push_back(math::rpy_from_dcm(filter.C_nb()));
        else out.push_back(math::rpy_from_quaternion(filter.q_nb()));
    }
    return out;
}

struct Change {
    double roll = 0.0, pitch = 0.0, heading = 0.0;  ///< deg, largest
    std::vector<double> t, tilt;
};
template <class Filter>
Change change_of(const Filter& filter, bool moving, std::uint64_t seed) {
    const std::vector<Vector3d> clean = attitudes(simulated(moving, false, seed), filter),
                                other = attitudes(simulated(moving, true, seed), filter);
    Change c;
    for (std::size_t i = 0; i < clean.size(); ++i) {
        const Vector3d d = (other[i] - clean[i]).unaryExpr([](double x) { return std::abs(math::wrap_pi(x)) / units::deg; });
        c.roll = std::max(c.roll, d.x());
        c.pitch = std::max(c.pitch, d.y());
        c.heading = std::max(c.heading, d.z());
        if (i % 50 == 0) {
            c.t.push_back(static_cast<double>(i) * dt);
            c.tilt.push_back(std::max({d.x(), d.y(), 1e-9}));
        }
    }
    return c;
}

/// Noise of math.md 3.5: measurement covariances a hundred times those of the sensors.
ahrs::VectorFilterSettings settings_of(Separation separation) {
    ahrs::VectorFilterSettings s;
    s.gyro_noise = 0.01 * units::deg;
    s.accel_std = 0.5;
    s.field_std = 2e-6;
    s.horizontal_field = paper_horizontal;
    s.vertical_field = paper_vertical;
    s.separation = separation;
    return s;
}

PaperResult separation(const PaperWork& w) {
    struct Case {
        const char* name;
        Change still, moving;
        report::Ink ink;
    };
    const auto both = [&](const char* name, const auto& filter, report::Ink ink) {
        return Case{name, change_of(filter, false, w.seed), change_of(filter, true, w.seed), ink};
    };
    const std::vector<Case> cases{
        both("direction cosines", DcmFilter(settings_of(Separation::Projected)), report::Ink::Green),
        both("quaternion, gain projected", QuaternionFilter(settings_of(Separation::Projected)), report::Ink::Blue),
        both("quaternion as printed", QuaternionFilter(settings_of(Separation::Printed)), report::Ink::Vermillion),
        both("quaternion, not separated", QuaternionFilter(settings_of(Separation::None)), report::Ink::Purple),
        both("mekf of `schuler ahrs`", ahrs::Mekf(ahrs::MekfSettings{}), report::Ink::Orange)};
    PaperResult out;
    const auto worst = [](const Case& c) { return std::max({c.still.roll, c.still.pitch, c.moving.roll, c.moving.pitch}); };
    out.numbers = {{"dcm", worst(cases[0])},
                   {"projected", worst(cases[1])},
                   {"printed", worst(cases[2])},
                   {"field", paper_horizontal * 1e9}};
    // clang-format off
    report::ResultTable table{"change by the disturbance, deg", {{"filter", "filter"}, {"still_roll", "still: roll"}, {"still_pitch", "pitch"},
                              {"still_heading", "heading"}, {"moving_roll", "moving: roll"}, {"moving_pitch", "pitch"}, {"moving_heading", "heading"}}};
    // clang-format on
    report::Panel panel{"largest change of roll and pitch, moving", "time, s", "deg"};
    panel.log_y = true;
    panel.height = 280;
    panel.spans.push_back({from, to, "field disturbed", false});
    for (const Case& c : cases) {
        table.rows.push_back(
            {c.name, c.still.roll, c.still.pitch, c.still.heading, c.moving.roll, c.moving.pitch, c.moving.heading});
        panel.series.push_back(paper_curve(c.name, c.moving.t, c.moving.tilt, c.ink));
    }
    out.tables.push_back(std::move(table));
    out.panels.push_back(std::move(panel));
    out.notes =
        "The horizontal field turned by 20 deg and the vertical one changed by 10000 nT for a minute; gyro biases of 0.02 to 0.03 deg/s uncompensated.\n"
        "The paper shows no run of its own: it states that the channels are separate.\n";
    return out;
}

}  // namespace

std::vector<PaperItem> paper_b_items() {
    return {{"B", "separation", "filters with separated channels under a disturbed magnetometer", 0, 1.0, separation}};
}

}  // namespace schuler::study
