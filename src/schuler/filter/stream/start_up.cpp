#include "schuler/filter/stream/start_up.h"

#include "schuler/core/units.h"
#include "schuler/ins/align.h"
#include "schuler/math/rotation.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace schuler::filter {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

constexpr double longest_fit = 60.0;     // s: gyros drift, and the integrals are not linear in their errors
constexpr double moving_patience = 3.0;  // s without standstill after which the level is taken from the moving body
constexpr double gyrocompass_time = 60.0, least_gyrocompass = 20.0;  // s

bool is_place(const Geodetic& p) { return std::isfinite(p.lat) && std::isfinite(p.lon) && std::isfinite(p.h); }

}  // namespace

bool StartUp::stands() const { return memory.still >= 1.0 && (memory.now - memory.still_end).seconds() < 0.7; }

double StartUp::yaw_in_level() const { return math::rpy_from_quaternion(memory.q_wb).z(); }

double StartUp::least_tilt() const {
    return std::max(0.2 * units::deg, 1.5 * settings_.filter.imu.errors.accel_initial_bias() / units::g0);
}

Vector3d StartUp::lever_w() const { return memory.q_wb * settings_.filter.gnss.lever_arm_b; }

void StartUp::level_by(const Vector3d& force_b, double std, bool at_rest) {
    if (!(force_b.norm() > 0.5 * units::g0)) return;
    memory.q_wb = ins::attitude_from_specific_force(force_b, Vector3d(0.0, 0.0, -1.0), 0.0);
    memory.std_level = std;
    memory.level = true;
    memory.level_at_rest = at_rest;
    memory.has_heading = false;  // it referred to another level frame
    begin_fit();
}

void StartUp::begin_fit() {
    Memory& m = memory;
    m.fit = {};
    m.fit.since = m.now;
    // the known uncertainty of the tilt; for the rest only that it is bounded
    const double tilt = units::g0 * m.std_level;
    m.fit.N.diagonal() << 1e-12, 1e-12, 1.0 / (tilt * tilt), 1.0 / (tilt * tilt), 1e-8, 1e-8, 1e-12, 1e-12;
}

void StartUp::add(const ImuIncrement& inc, bool interpolated) {
    Memory& m = memory;
    if (!m.any_increment) m.first = inc.time;
    m.any_increment = true;
    m.now = inc.time;
    m.last = inc;
    if (interpolated) {  // nothing integrated so far may continue through a gap
        m.level = false;
        m.has_heading = false;
        m.still = m.recent_time = 0.0;
        m.recent_dv.setZero();
        m.first = inc.time;
        return;
    }
    const double keep = std::max(0.0, 1.0 - inc.dt);  // exponential mean over a second
    m.recent_dv = keep * m.recent_dv + inc.dv;
    m.recent_time = keep * m.recent_time + inc.dt;
    if (m.still > 0.0 && (m.now - m.still_end).seconds() > 1.0) {
        if (m.level && m.still >= least_gyrocompass) compass();
        m.still = 0.0;
    }
    if (!m.level && (m.now - m.first).seconds() > moving_patience && m.recent_time > 0.5)
        level_by(m.recent_dv / m.recent_time, 0.3, false);
    if (!m.level) return;
    const Vector3d turn = inc.dtheta - m.gyro_bias * inc.dt;
    const Quaterniond half = math::quaternion_from_rotation_vector(0.5 * turn);
    const Vector3d dv =
        (m.q_wb * half) * (inc.dv - settings_.filter.initial.accel_bias * inc.dt) + Vector3d(0.0, 0.0, units::g0 * inc.dt);
    m.q_wb = (m.q_wb * half * half).normalized();
    m.fit.p_w += (m.fit.v_w + 0.5 * dv) * inc.dt;
    m.fit.v_w += dv;
    if ((m.now - m.fit.since).seconds() > longest_fit) {
        if (m.level_at_rest) m.std_level = std::hypot(m.std_level, m.std_gyro_bias * longest_fit);
        begin_fit();
    }
}

void StartUp::add_still(const StillWindow& w) {
    Memory& m = memory;
    if (m.still == 0.0) {
        m.rate.setZero();
        m.force.setZero();
    }
    m.rate += w.mean_rate_b * w.length;
    m.force += w.mean_force_b * w.length;
    m.still += w.length;
    m.still_end = w.end;
    if (m.still < 1.0) return;
    const sensor::ImuErrorModel& imu = settings_.filter.imu.errors;
    const Vector3d force = m.force / m.still - settings_.filter.initial.accel_bias;
    level_by(force, least_tilt(), true);
    const double w_ie = settings_.filter.earth.ellipsoid.w_ie;
    m.gyro_bias = settings_.filter.initial.gyro_bias;
    m.std_gyro_bias = imu.gyro_initial_bias();
    m.at_rest_bias = m.std_gyro_bias > w_ie;
    if (m.still >= gyrocompass_time) compass();
    if (!m.at_rest_bias) return;
    // At rest the mean rate is the bias plus the Earth rate.
    m.gyro_bias = m.rate / m.still;
    m.std_gyro_bias = w_ie + imu.gyro_noise / std::sqrt(m.still) + 0.2 * imu.gyro_bias;
}

void StartUp::add_row(const Unknowns& row, double measured, double sigma) {
    Fit& f = memory.fit;
    const double weight = 1.0 / (sigma * sigma);
    f.N += weight * row * row.transpose();
    f.y += weight * measured * row;
    f.sum2 += weight * measured * measured;
    ++f.rows;
}

void StartUp::add_position(const GnssFix& fix, const FixNoise& noise, Time valid, std::uint8_t components) {
    Memory& m = memory;
    if ((components & 3) != 3) {
        if (m.has_position && (components & 4) != 0) {
            m.position.h = fix.position.h;
            m.has_height = true;
        }
        return;
    }
    const bool height = (components & 4) != 0 && std::isfinite(fix.position.h);
    const double h = m.has_height ? m.position.h : 0.0;
    m.position = fix.position;
    if (!height) m.position.h = h;
    m.has_height = m.has_height || height;
    m.position_time = valid;
    m.std_position = noise.position;
    m.has_position = true;
    if (!m.level) return;
    Fit& f = m.fit;
    if (!f.has_origin) {
        f.has_origin = true;
        f.origin = m.position;
    }
    const Vector3d ned = earth::ned_difference(settings_.filter.earth, m.position, f.origin);
    const double t = (m.now - f.since).seconds();
    const Vector3d p = f.p_w + lever_w();
    Unknowns north, east;
    north << p.x(), -p.y(), 0.5 * t * t, 0.0, t, 0.0, 1.0, 0.0;
    east << p.y(), p.x(), 0.0, 0.5 * t * t, 0.0, t, 0.0, 1.0;
    add_row(north, ned.x(), noise.position.x());
    add_row(east, ned.y(), noise.position.y());
    solve();
}

void StartUp::add_velocity(const GnssFix& fix, const FixNoise& noise, std::uint8_t components) {
    Memory& m = memory;
    for (int i = 0; i < 3; ++i) {
        if ((components >> i & 1) == 0 || !std::isfinite(fix.velocity_n(i))) continue;
        m.velocity(i) = fix.velocity_n(i);
        m.std_velocity(i) = noise.velocity(i);
        m.velocity_given[static_cast<std::size_t>(i)] = true;
    }
    m.velocity_time = m.now;
    m.has_velocity = m.velocity_given[0] && m.velocity_given[1];
    if (!m.level || (components & 3) != 3) return;
    Fit& f = m.fit;
    const double t = (m.now - f.since).seconds();
    const Vector3d rate = m.last.dtheta / m.last.dt - m.gyro_bias;
    const Vector3d v = f.v_w + m.q_wb * rate.cross(settings_.filter.gnss.lever_arm_b);
    Unknowns north, east;
    north << v.x(), -v.y(), t, 0.0, 1.0, 0.0, 0.0, 0.0;
    east << v.y(), v.x(), 0.0, t, 0.0, 1.0, 0.0, 0.0;
    add_row(north, fix.velocity_n.x(), noise.velocity.x());
    add_row(east, fix.velocity_n.y(), noise.velocity.y());
    solve();
    course();
}

void StartUp::solve() {
    Memory& m = memory;
    const Fit& f = m.fit;
    const double t = (m.now - f.since).seconds();
    if (stands() || f.rows < 2 * unknowns || t < 3.0) return;
    const Eigen::LDLT<Normal> ldlt(f.N);
    const Unknowns x = ldlt.solve(f.y);
    const Normal C = ldlt.solve(Normal::Identity());
    if (!x.allFinite() || !C.allFinite()) return;
    // larger or correlated errors of the fixes cause larger residuals
    const double residual = std::max(0.0, f.sum2 - x.dot(f.y)) / std::max(1, f.rows - unknowns);
    const double inflated = std::max(1.0, residual);
    const double size = std::hypot(x(0), x(1));
    if (!(size > 0.5)) return;
    const Eigen::Vector2d along = x.head<2>() / size, across(-along.y(), along.x());
    const Eigen::Matrix2d cs = inflated * C.topLeftCorner<2, 2>();
    const double std_size = std::sqrt(along.dot(cs * along));
    const double drift = std::max(m.std_gyro_bias, m.at_rest_bias ? 0.0 : settings_.filter.imu.errors.gyro_initial_bias()) * t;
    const double std_heading = std::hypot(std::sqrt(across.dot(cs * across)) / size, drift);
    constexpr double enough = 3.0 * units::deg;
    if (std_heading > enough || std::abs(size - 1.0) > 0.05 + 3.0 * std_size) return;
    const double g = units::g0;
    const Eigen::Vector2d tilt(x(3) / g, -x(2) / g);  // phi_N = b_E/g, phi_E = -b_N/g
    const double psi = std::atan2(x(1), x(0));
    if (tilt.norm() > 3.0 * units::deg && !m.level_at_rest) {  // relevel, within the linear range, and restart the integration
        const Vector3d phi_w = Eigen::AngleAxisd(-psi, Vector3d::UnitZ()) * Vector3d(tilt.x(), tilt.y(), 0.0);
        m.q_wb = (math::quaternion_from_rotation_vector(phi_w) * m.q_wb).normalized();
        m.std_level = std::max(1.0 * units::deg, 0.2 * tilt.norm());
        m.has_heading = false;
        begin_fit();
        return;
    }
    m.tilt = tilt;
    m.std_tilt = Eigen::Vector2d(std::sqrt(inflated * C(3, 3)), std::sqrt(inflated * C(2, 2))) / g;
    found(psi + yaw_in_level(), std::max(2.0 * units::deg, 3.0 * std_heading));
}

/// A wheeled vehicle points in the direction of travel; above reversing speed.
void StartUp::course() {
    Memory& m = memory;
    if (m.has_heading || !settings_.filter.constraints.nonholonomic || !m.has_velocity || (m.now - m.fit.since).seconds() < 10.0)
        return;
    const double speed = m.velocity.head<2>().norm();
    if (speed < 8.0) return;
    const double std = std::hypot(m.std_velocity.head<2>().maxCoeff() / speed, settings_.filter.imu.mounting_std);
    found(std::atan2(m.velocity.y(), m.velocity.x()), std::max(3.0 * units::deg, 3.0 * std));
}

void StartUp::found(double heading, double std) {
    memory.has_heading = true;
    memory.heading_of_mag = memory.heading_of_sensor = false;
    memory.psi = heading - yaw_in_level();
    memory.std_heading = std;
}

/// Heading of the level frame at standstill from the Earth rate.
void StartUp::compass() {
    Memory& m = memory;
    if (!can_gyrocompass()) return;
    if (!(m.rate.norm() > 0.0 && m.force.norm() > 0.0)) return;  // zero output gives no direction
    const Geodetic place = start_place();
    const sensor::ImuErrorModel& imu = settings_.filter.imu.errors;
    const double gyro_std = std::hypot(imu.gyro_initial_bias(), imu.gyro_noise / std::sqrt(m.still));
    const ins::Gyrocompass c =
        ins::gyrocompass(settings_.filter.earth, place, m.force / m.still, m.rate / m.still, imu.accel_initial_bias(), gyro_std);
    m.has_heading = true;
    m.heading_of_mag = m.heading_of_sensor = false;
    m.psi = c.rpy.z();  // body x had zero heading in the level frame at that time
    m.std_heading = 2.0 * c.std_rpy.z();
}

/// True if the Earth rate is measured sufficiently well, at a known position.
bool StartUp::can_gyrocompass() const {
    if (!memory.has_position && !is_place(settings_.filter.initial.position)) return false;
    const double lat = start_place().lat;
    const double horizontal_rate = settings_.filter.earth.ellipsoid.w_ie * std::cos(lat);
    return settings_.filter.imu.errors.gyro_initial_bias() < 0.1 * horizontal_rate && std::abs(lat) < 89.0 * units::deg;
}

Geodetic StartUp::start_place() const {
    const Geodetic& given = settings_.filter.initial.position;
    return is_place(given) ? given : memory.position;
}

void StartUp::add_mag(const Vector3d& field_b, double declination) {
    Memory& m = memory;
    // if the body moves, its motion may give a better heading
    constexpr double patience = 20.0;  // s
    if (!m.level || m.has_heading || phase() == Phase::Gyrocompassing) return;
    if (!stands() && (m.now - m.first).seconds() < patience) return;
    const Vector3d rpy = math::rpy_from_quaternion(m.q_wb);
    found(ins::heading_from_magnetometer(field_b, rpy.x(), rpy.y(), declination), settings_.filter.mag.first_std());
    m.heading_of_mag = true;
}

void StartUp::add_heading(const HeadingSample& s) {
    if (!memory.level) return;
    const double white = s.std > 0.0 ? s.std : settings_.filter.heading.std;
    found(s.heading, std::hypot(white, settings_.filter.heading.offset_std));
    memory.heading_of_sensor = true;
}

Phase StartUp::phase() const {
    const Memory& m = memory;
    if (!m.any_increment) return Phase::WaitingForImu;
    if (!m.has_position && !is_place(settings_.filter.initial.position)) return Phase::WaitingForPosition;
    if (!m.level) return Phase::Levelling;
    return can_gyrocompass() && stands() ? Phase::Gyrocompassing : Phase::FindingHeading;
}

Start StartUp::start_with(const Quaterniond& q_nb, const Vector3d& std_rpy) const {
    const Memory& m = memory;
    const Settings& s = settings_.filter;
    const InitialSettings& given = s.initial;
    const auto or_given = [](const Vector3d& g, const Vector3d& found) {
        Vector3d v;
        for (int i = 0; i < 3; ++i) v(i) = std::isfinite(g(i)) ? g(i) : found(i);
        return v;
    };
    Start start;
    start.nav.time = m.now;
    start.previous = m.last;
    Vector3d rpy = or_given(given.rpy, math::rpy_from_quaternion(q_nb));
    start.nav.q_nb = math::quaternion_from_rpy(rpy);
    start.std_rpy = or_given(given.std_rpy, std_rpy);
    start.gyro_bias = m.gyro_bias;
    start.std_gyro_bias.setConstant(m.at_rest_bias ? m.std_gyro_bias : s.imu.errors.gyro_initial_bias());
    start.accel_bias = given.accel_bias;
    start.std_accel_bias.setConstant(s.imu.errors.accel_initial_bias());
    start.std_mounting = s.imu.mounting_std;
    start.heading_of_mag = m.heading_of_mag && !std::isfinite(given.rpy.z());
    start.heading_of_sensor = m.heading_of_sensor && !std::isfinite(given.rpy.z());

    Vector3d velocity = Vector3d::Zero(), std_velocity = Vector3d::Constant(s.vehicle == VehicleKind::Air ? 20.0 : 5.0);
    if (stands()) {
        std_velocity.setConstant(0.1);
    } else {
        const double age = (m.now - m.velocity_time).seconds();
        for (int i = 0; i < 3; ++i) {
            if (!m.velocity_given[static_cast<std::size_t>(i)]) continue;
            velocity(i) = m.velocity(i);
            std_velocity(i) = 2.0 * m.std_velocity(i) + 0.1 + 3.0 * age;
            if (!std::isfinite(given.velocity_n(i))) start.velocity_of_fix(i) = 1.0;
        }
    }
    start.nav.v_eb_n = or_given(given.velocity_n, velocity);
    start.std_velocity = or_given(given.std_velocity, std_velocity);
    Vector3d std_position = Vector3d::Constant(10.0);
    if (is_place(given.position)) {
        start.nav.position = given.position;
    } else {
        const double lead = (m.now - m.position_time).seconds();
        start.nav.position = earth::moved_by_ned(s.earth, m.position, start.nav.v_eb_n * lead);
        start.at_antenna = true;
        std_position = m.std_position + start.std_velocity * std::abs(lead);
        start.position_of_fix.setOnes();
        if (!m.has_height) {
            std_position.z() = 1000.0;
            start.position_of_fix.z() = 0.0;
        }
    }
    start.std_position = or_given(given.std_position, std_position);
    return start;
}

std::optional<Start> StartUp::ready() const {
    const Memory& m = memory;
    const InitialSettings& given = settings_.filter.initial;
    const bool position = is_place(given.position) || m.has_position;
    if (!position || !m.any_increment) return std::nullopt;
    if (given.rpy.allFinite() && (given.velocity_n.allFinite() || m.has_velocity || stands()))
        return start_with(math::quaternion_from_rpy(given.rpy), Vector3d(3.0, 3.0, 5.0) * units::deg);
    if (!m.level) return std::nullopt;
    const Vector3d rpy = math::rpy_from_quaternion(m.q_wb);
    const double std_level = m.level_at_rest ? m.std_level : std::max(3.0 * units::deg, m.std_level);
    const auto with_heading = [&](double heading, double std) {
        return start_with(math::quaternion_from_rpy(Vector3d(rpy.x(), rpy.y(), heading)), Vector3d(std_level, std_level, std));
    };
    if (std::isfinite(given.rpy.z())) return with_heading(given.rpy.z(), 5.0 * units::deg);
    if (!m.has_heading) return std::nullopt;
    const double heading = m.psi + yaw_in_level();
    if (m.tilt.isZero()) return with_heading(heading, m.std_heading);
    // the fit has estimated a tilt as well: C_true = (I + [phi x]) C
    const Quaterniond q_nb = math::quaternion_from_rpy(Vector3d(rpy.x(), rpy.y(), heading));
    const Vector3d phi(m.tilt.x(), m.tilt.y(), 0.0);
    const double tilt = std::max(3.0 * m.std_tilt.maxCoeff(), least_tilt());  // an accelerometer bias has the same effect
    return start_with((math::quaternion_from_rotation_vector(phi) * q_nb).normalized(), Vector3d(tilt, tilt, m.std_heading));
}

}  // namespace schuler::filter
