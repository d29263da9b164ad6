// The two mechanizations as policies of one filter: state, step, error dynamics and the map of errors to the local level.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/earth/earth.h"
#include "schuler/filter/states/gathered_motion.h"
#include "schuler/ins/error_model.h"
#include "schuler/ins/state_error.h"
#include "schuler/ins/step.h"
#include "schuler/math/rotation.h"

#include <Eigen/Core>

namespace schuler::filter {

/// Geographic frame: errors are already in north-east-down.
struct GeographicFrame {
    using State = NavState;

    static State step(const earth::Earth& earth, const State& s, const ins::CompensatedIncrement& inc) {
        return ins::step_n(earth, s, inc);
    }
    static const Eigen::Quaterniond& attitude(const State& s) { return s.q_nb; }
    static ins::ErrorDynamics dynamics(const earth::Earth& earth, const State& s, const Eigen::Vector3d& f) {
        return ins::error_n(earth, s.position, s.v_eb_n, f);
    }
    static State corrected(const earth::Earth& earth, const State& s, const Vector9& dx) { return ins::corrected(earth, s, dx); }
    static NavState geographic(const earth::Earth&, const State& s) { return s; }
    static State from_geographic(const earth::Earth&, const NavState& s) { return s; }
    static double ground_speed(const State& s) { return s.v_eb_n.head<2>().norm(); }
    static const Eigen::Vector3d& velocity(const State& s) { return s.v_eb_n; }
    static Eigen::Matrix3d C_en(const earth::Earth&, const State& s) { return earth::C_en(s.position.lat, s.position.lon); }
    static constexpr bool errors_are_geographic = true;
};

/// Earth-fixed frame.
struct EarthFixedFrame {
    using State = NavStateEcef;

    static State step(const earth::Earth& earth, const State& s, const ins::CompensatedIncrement& inc) {
        return ins::step_e(earth, s, inc);
    }
    static const Eigen::Quaterniond& attitude(const State& s) { return s.q_eb; }
    static ins::ErrorDynamics dynamics(const earth::Earth& earth, const State& s, const Eigen::Vector3d& f) {
        return ins::error_e(earth, s.position, f);
    }
    static State corrected(const earth::Earth&, const State& s, const Vector9& dx) { return ins::corrected(s, dx); }
    static NavState geographic(const earth::Earth& earth, const State& s) { return ins::to_geographic(earth, s); }
    static State from_geographic(const earth::Earth& earth, const NavState& s) { return ins::to_ecef(earth, s); }
    /// Up is taken as geocentric: it differs from the vertical by at most 3e-3 rad.
    static double ground_speed(const State& s) {
        const Eigen::Vector3d up = s.position.r.normalized();
        return (s.v_eb_e - s.v_eb_e.dot(up) * up).norm();
    }
    static const Eigen::Vector3d& velocity(const State& s) { return s.v_eb_e; }
    static Eigen::Matrix3d C_en(const earth::Earth& earth, const State& s) {
        const Geodetic place = earth::geodetic_from_ecef(earth.ellipsoid, s.position);
        return earth::C_en(place.lat, place.lon);
    }
    static constexpr bool errors_are_geographic = false;
};

}  // namespace schuler::filter
