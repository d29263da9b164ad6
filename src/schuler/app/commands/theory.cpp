// `schuler analyze`: closed solutions and error dynamics.
#include "schuler/app/commands/builders.h"
#include "schuler/study/covariance/observability.h"
#include "schuler/study/theory/analyze.h"
#include "schuler/study/theory/observability.h"

#include <array>

namespace schuler::app {
namespace {

constexpr double huge = 1e12;

template <class R, class Access>
Option<R> quantity(std::string key, const char* unit, std::string help, Access access) {
    return in_units(unit, settings::number<R>(std::move(key), 1.0, -huge, huge, std::move(help), access));
}

template <class R, class Access>
Option<R> time_option(std::string help, Access access) {
    return in_units("s", settings::number<R>("time", 1.0, 0, 1e9, std::move(help), access));
}

/// Three components of a vector, one option each.
template <class R>
void add_vector(OptionTable<R>& table, Eigen::Vector3d R::*field, const std::array<const char*, 3>& keys, const char* what,
                const char* unit) {
    constexpr std::array axes{"east", "north", "up"};
    for (Eigen::Index i = 0; i < 3; ++i)
        table.add(quantity<R>(keys[static_cast<std::size_t>(i)], unit, std::string(what) + axes[static_cast<std::size_t>(i)],
                              [=](auto& r) -> auto& { return (r.*field)[i]; }));
}

Command equator() {
    using R = study::EquatorRequest;
    OptionTable<R> t;
    t.add(quantity<R>("speed", "m/s", "east velocity over the Earth", [](auto& r) -> auto& { return r.speed; }))
        .add(quantity<R>("height", "m", "height above the sphere", [](auto& r) -> auto& { return r.height; }))
        .add(time_option<R>("time after the start at which the errors are evaluated", [](auto& r) -> auto& { return r.time; }));
    constexpr std::array keys{"dvn", "dvh", "dve", "dh", "dphi", "dlambda"};
    constexpr std::array what{"north velocity", "up velocity", "east velocity", "height", "latitude", "longitude"};
    constexpr std::array unit{"m/s", "m/s", "m/s", "m", "rad", "rad"};
    for (Eigen::Index i = 0; i < 6; ++i) {
        const auto k = static_cast<std::size_t>(i);
        t.add(quantity<R>(keys[k], unit[k], std::string("initial error of ") + what[k],
                          [i](auto& r) -> auto& { return r.errors[i]; }));
    }
    t
        .add(in_units(
            "rad",
            settings::vector3<R>(
                "misalignment", 1.0, -10, 10,
                "initial attitude error about the polar axis, about the equatorial axis in the meridian of the start, and about the one 90 deg east of it",
                [](auto& r) -> auto& { return r.misalignment; })))
        .add(settings::flag<R>("paper", "tables 1 to 3 of the paper: printed and correct values, with differences marked",
                               [](auto& r) -> auto& { return r.paper; }))
        .add(settings::flag<R>("compare", "integrate the complete and the linear equations too; writes a report with plots",
                               [](auto& r) -> auto& { return r.compare; }))
        .add(in_units("deg", settings::number<R>("latitude-deg", 1.0, -90, 90, "latitude of a comparison away from the equator",
                                                 [](auto& r) -> auto& { return r.latitude_deg; })))
        .add(quantity<R>("vn", "m/s", "north velocity of a comparison", [](auto& r) -> auto& { return r.north_speed; }))
        .add(quantity<R>("vh", "m/s", "up velocity of a comparison", [](auto& r) -> auto& { return r.up_speed; }))
        .add(settings::flag<R>("ellipsoid", "use the paper's e^2 instead of a sphere in the comparison",
                               [](auto& r) -> auto& { return r.ellipsoid; }))
        .add(output_option<R>("folder of the comparison's report", "out/equator", [](auto& r) -> auto& { return r.output; }));
    return command<R>(
        "analyze equator", "errors of an INS that follows the equator, in closed form (paper C, corrected)",
        "  schuler analyze equator --speed 600 --height 10000 --time 3600 --dh 1\n"
        "  schuler analyze equator --paper                          the paper's tables, its misprints marked\n"
        "  schuler analyze equator --speed 600 --height 10000 --time 7200 --dvn 0.01 --dh 1 --dphi 1.57e-7 --json\n"
        "  schuler analyze equator --speed 250 --dh 100 --compare -o out/equator     complete, linear and closed side by side\n"
        "  schuler analyze equator --speed 200 --vn 100 --latitude-deg 45 --dvn 0.1 --compare --ellipsoid\n"
        "  schuler analyze equator --speed 8000                     beyond the limiting speed\n"
        "Errors are estimate minus truth. The exit status is 0 also where the flight is unstable: the verdict states it.",
        std::move(t), one_json_document, false, study::analyze_equator);
}

Command modes() {
    using R = study::SchulerRequest;
    OptionTable<R> t;
    t.add(in_units("deg", settings::number<R>("latitude-deg", 1.0, -90, 90, "latitude",
                                              [](auto& r) -> auto& { return r.latitude_deg; })))
        .add(quantity<R>("height", "m", "height above the ellipsoid", [](auto& r) -> auto& { return r.height; }));
    add_vector(t, &R::v_enu, {"ve", "vn", "vh"}, "velocity over the Earth, ", "m/s");
    t.add(time_option<R>("end of the time span of the errors", [](auto& r) -> auto& { return r.time; }));
    add_vector(t, &R::position, {"de", "dn", "dh"}, "initial error of position, ", "m");
    add_vector(t, &R::velocity, {"dve", "dvn", "dvh"}, "initial error of velocity, ", "m/s");
    add_vector(t, &R::attitude, {"tilt-east", "tilt-north", "azimuth"}, "initial attitude error about ", "rad");
    add_vector(t, &R::gyro_deg_h, {"gyro-east-deg-h", "gyro-north-deg-h", "gyro-up-deg-h"}, "constant gyro drift about ",
               "deg/h");
    add_vector(t, &R::accel_ug, {"accel-east-ug", "accel-north-ug", "accel-up-ug"}, "constant accelerometer error ", "ug");
    t.add(written("KIND", one_of<R>("vertical", {"fixed", "free", "second", "third"},
                                    "vertical channel: fixed, free, or with a barometer loop of second or third order",
                                    [](auto& r) -> auto& { return r.vertical; })))
        .add(in_units("s", settings::number<R>("baro-time", 1.0, 1e-3, 1e6, "time constant of the barometer loop",
                                               [](auto& r) -> auto& { return r.baro_time; })))
        .add(quantity<R>("baro", "m", "constant error of the barometer", [](auto& r) -> auto& { return r.baro; }))
        .add(settings::flag<R>("paper", "cases of paper A, section 4.1", [](auto& r) -> auto& { return r.paper; }))
        .add(output_option<R>("folder of a report with plots", "none", [](auto& r) -> auto& { return r.output; }));
    return command<R>(
        "analyze schuler", "Schuler, Foucault, 24-hour and vertical modes of an INS's errors at any place and velocity",
        "  schuler analyze schuler --tilt-east 1e-3 --time 5064      a pendulum of 84.4 minutes\n"
        "  schuler analyze schuler --gyro-north-deg-h 0.01 --time 3600 -o out/drift\n"
        "  schuler analyze schuler --paper                          the cases of paper A, section 4.1, with the right numbers\n"
        "  schuler analyze schuler --ve 250 --height 10000 --vertical third --accel-up-ug 50\n"
        "Errors are estimate minus truth; errors of instruments are measured minus true, in east-north-up.",
        std::move(t), one_json_document, false, study::analyze_schuler);
}

Command observability() {
    using R = study::ObservabilityRequest;
    OptionTable<R> t;
    const auto angle = [](const char* key, double limit, const char* help, auto access) {
        return in_units("deg", settings::number<R>(key, 1.0, -limit, limit, help, access));
    };
    Option<R> scenario = scenario_argument<R>("scenario file: the states of its filter along its path; without: of gravimetry",
                                              [](auto& r) -> auto& { return r.scenario; });
    scenario.spec.line.required = false;
    t.add(std::move(scenario))
        .add(set_option<R>([](auto& r) -> auto& { return r.above; }))
        .add(seed_option<R>("seed, instead of the scenario's", [](auto& r) -> auto& { return r.seed; }))
        .add(in_units("Hz", settings::number<R>("rate", 1.0, 0.1, 1e4, "maximum IMU rate used along the path",
                                                [](auto& r) -> auto& { return r.rate; })))
        .add(angle("latitude-deg", 90, "latitude", [](auto& r) -> auto& { return r.latitude_deg; }))
        .add(angle("longitude-deg", 360, "longitude", [](auto& r) -> auto& { return r.longitude_deg; }))
        .add(quantity<R>("height", "m", "height above the ellipsoid", [](auto& r) -> auto& { return r.height; }))
        .add(quantity<R>("vn", "m/s", "velocity north", [](auto& r) -> auto& { return r.vn; }))
        .add(quantity<R>("ve", "m/s", "velocity east", [](auto& r) -> auto& { return r.ve; }))
        .add(quantity<R>("vd", "m/s", "velocity down", [](auto& r) -> auto& { return r.vd; }))
        .add(angle("heading-deg", 360, "heading", [](auto& r) -> auto& { return r.heading_deg; }))
        .add(quantity<R>("turn-deg-s", "deg/s", "rate of the heading", [](auto& r) -> auto& { return r.turn_deg_s; }))
        .add(in_units("s", settings::number<R>("correlation-time", 1.0, 0, 1e9,
                                               "correlation time of the random part of the disturbance; 0: constant",
                                               [](auto& r) -> auto& { return r.correlation_time; })))
        .add(written("N", settings::integer<R>("polynomial", 0, 2,
                                               "degree of the polynomial of the disturbance's systematic part along the track",
                                               [](auto& r) -> auto& { return r.polynomial; })))
        .add(settings::number<R>("tolerance", 1.0, 0, 1, "smallest pivot counted in the rank; 0: exact rank",
                                 [](auto& r) -> auto& { return r.tolerance; }))
        .add(settings::flag<R>("rhumb", "constant course and velocity relative to north instead of a great circle",
                               [](auto& r) -> auto& { return r.rhumb; }))
        .add(settings::flag<R>("frozen", "freeze the model at its initial state", [](auto& r) -> auto& { return r.frozen; }))
        .add(settings::flag<R>("paper", "analyse the motions of the paper too", [](auto& r) -> auto& { return r.paper; }));
    return command<R>(
        "analyze observability",
        "which states the measurements make observable, and by which manoeuvre: along a scenario, or in gravimetry (paper E)",
        "  schuler analyze observability examples/demo.toml          each state, and the combinations\n"
        "  schuler analyze observability examples/car-tight.toml --set filter.scale_factors=true --json\n"
        "  schuler analyze observability --paper                     at rest and at 1 m/s, beside the paper\n"
        "  schuler analyze observability --vn 1 --ve 1 --json        exact rank, pivots, combinations\n"
        "  schuler analyze observability --vn 1 --ve 1 --tolerance 1e-7\n"
        "Ranks are decided with fifty digits along the motion, a great circle. A pivot is a share of what gravity does in 13 minutes.",
        std::move(t), one_json_document, false,
        [](const R& r) { return r.scenario.empty() ? study::analyze_observability(r) : study::analyze_path_observability(r); });
}

}  // namespace

void add_theory_commands(std::vector<Command>& list) {
    for (Command (*make)() : {equator, modes, observability}) list.push_back(make());
}

}  // namespace schuler::app
