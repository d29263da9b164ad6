// The command `analyze` with its studies.
#include "options.h"

#include <CLI/CLI.hpp>

#include <array>

namespace schuler::cli {
namespace {

/// Three numbers of a vector, one option each.
void add_vector(CLI::App& app, Eigen::Vector3d& target, const std::array<const char*, 3>& names, const char* what,
                const char* unit) {
    constexpr std::array axes{"east", "north", "up"};
    for (std::size_t i = 0; i < 3; ++i)
        app.add_option(names[i], target[static_cast<Eigen::Index>(i)], std::string(what) + axes[i])->type_name(unit);
}

void add_equator(CLI::App& analyze, Options& o, const AddCommand& add_command) {
    CLI::App* app = add_command(
        analyze, "equator", "errors of an INS that follows the equator, in closed form (paper C, corrected)",
        "  schuler analyze equator --speed 600 --height 10000 --time 3600 --dh 1\n"
        "  schuler analyze equator --paper                          the paper's tables, its misprints marked\n"
        "  schuler analyze equator --speed 600 --height 10000 --time 7200 --dvn 0.01 --dh 1 --dphi 1.57e-7 --json\n"
        "  schuler analyze equator --speed 250 --dh 100 --compare -o out/equator     complete, linear and closed side by side\n"
        "  schuler analyze equator --speed 200 --vn 100 --latitude-deg 45 --dvn 0.1 --compare --ellipsoid\n"
        "  schuler analyze equator --speed 8000                     beyond the limiting speed\n"
        "Errors are estimate minus truth. Exit status 0 also where the flight is unstable: the verdict says it.");
    study::EquatorRequest& r = o.equator;
    app->add_option("--speed", r.speed, "east velocity over the Earth, default 0")->type_name("M_S");
    app->add_option("--height", r.height, "default 0")->type_name("M");
    app->add_option("--time", r.time, "when the errors are asked for, default 3600")->type_name("S");
    constexpr std::array names{"--dvn", "--dvh", "--dve", "--dh", "--dphi", "--dlambda"};
    constexpr std::array what{"north velocity", "up velocity", "east velocity", "height", "latitude", "longitude"};
    constexpr std::array unit{"M_S", "M_S", "M_S", "M", "RAD", "RAD"};
    for (std::size_t i = 0; i < 6; ++i)
        app->add_option(names[i], r.errors[static_cast<Eigen::Index>(i)], std::string("initial error of ") + what[i])
            ->type_name(unit[i]);
    app->add_option("--misalignment", o.misalignment, "initial attitude error about the pole, the start's meridian, east of it")
        ->expected(3)
        ->type_name("RAD");
    app->add_flag("--paper", r.paper, "tables 1 to 3 of the paper: printed, right, marked where off");
    app->add_flag("--compare", r.compare, "integrate the complete and the linear equations too; writes a report with plots");
    app->add_option("--latitude-deg", r.latitude_deg, "of a comparison away from the equator")->type_name("DEG");
    app->add_option("--vn", r.north_speed, "north velocity of a comparison")->type_name("M_S");
    app->add_option("--vh", r.up_speed, "up velocity of a comparison")->type_name("M_S");
    app->add_flag("--ellipsoid", r.ellipsoid, "a comparison with the paper's e^2 instead of a sphere");
    add_output(*app, o, "folder of the comparison's report (default out/equator)");
    add_json(*app, o);
}

void add_schuler(CLI::App& analyze, Options& o, const AddCommand& add_command) {
    CLI::App* app = add_command(
        analyze, "schuler", "Schuler, Foucault, 24-hour and vertical modes of an INS's errors at any place and velocity",
        "  schuler analyze schuler --tilt-east 1e-3 --time 5064      a pendulum of 84.4 minutes\n"
        "  schuler analyze schuler --gyro-north-deg-h 0.01 --time 3600 -o out/drift\n"
        "  schuler analyze schuler --paper                          the cases of paper A, section 4.1, with the right numbers\n"
        "  schuler analyze schuler --ve 250 --height 10000 --vertical third --accel-up-ug 50\n"
        "Errors are estimate minus truth; errors of instruments are measured minus true, in east-north-up.");
    study::SchulerRequest& r = o.schuler;
    app->add_option("--latitude-deg", r.latitude_deg, "default 50.45")->type_name("DEG");
    app->add_option("--height", r.height, "default 0")->type_name("M");
    add_vector(*app, r.v_enu, {"--ve", "--vn", "--vh"}, "velocity over the Earth, ", "M_S");
    app->add_option("--time", r.time, "errors are followed up to here, default 3600")->type_name("S");
    add_vector(*app, r.position, {"--de", "--dn", "--dh"}, "initial error of position, ", "M");
    add_vector(*app, r.velocity, {"--dve", "--dvn", "--dvh"}, "initial error of velocity, ", "M_S");
    add_vector(*app, r.attitude, {"--tilt-east", "--tilt-north", "--azimuth"}, "initial attitude error about ", "RAD");
    add_vector(*app, r.gyro_deg_h, {"--gyro-east-deg-h", "--gyro-north-deg-h", "--gyro-up-deg-h"}, "constant drift about ",
               "DEG_H");
    add_vector(*app, r.accel_ug, {"--accel-east-ug", "--accel-north-ug", "--accel-up-ug"}, "constant accelerometer error ", "UG");
    app->add_option("--vertical", r.vertical, "height: fixed (default), free, or a barometer loop: second, third")
        ->type_name("KIND");
    app->add_option("--baro-time", r.baro_time, "time constant of the loop, default 100")->type_name("S");
    app->add_option("--baro", r.baro, "constant error of the barometer")->type_name("M");
    app->add_flag("--paper", r.paper, "cases of paper A, section 4.1");
    add_output(*app, o, "folder of a report with plots (default: none)");
    add_json(*app, o);
}

void add_studies(CLI::App& analyze, Options& o, const AddCommand& add_command) {
    CLI::App* requirements =
        add_command(analyze, "requirements", "sensors for a position budget over an outage, and outages for devices (paper A, 1.4)",
                    "  schuler analyze requirements --budget 5 --outage 60\n  schuler analyze requirements --budget 5 --device hg9900 --json");
    requirements->add_option("--budget", o.requirements.budget, "horizontal position error that is allowed, default 5")->type_name("M");
    requirements->add_option("--outage", o.requirements.outages, "default 10 s to an hour")->delimiter(',')->type_name("S[,S...]");
    requirements->add_option("--device", o.requirements.devices, "how long an outage may it have? default: all")->delimiter(',')->type_name("NAME");
    add_json(*requirements, o);
    const auto add_study = [&](const char* name, const char* purpose, const char* examples) {
        CLI::App* app = add_command(analyze, name, purpose, examples);
        app->add_option("SCENARIO", o.input, "scenario file")->required();
        app->add_option("-n,--runs", o.study.runs, "runs each, default 10")->check(CLI::PositiveNumber);
        app->add_option("--jobs", o.study.jobs, "threads, default one a core")->check(CLI::NonNegativeNumber);
        app->add_option("--seed", o.seed, "of the first run");
        app->add_option("--set", o.set, "settings of the filter")->type_name("key=value")->allow_extra_args(false);
        add_json(*app, o);
        return app;
    };
    add_study("budget", "errors by source: one at a time, the filter believing in all",
              "  schuler analyze budget examples/paper-a-flight.toml\n  schuler analyze budget examples/airliner-hg9900.toml -n 20 --json");
    CLI::App* integrity = add_study("integrity", "faults of the receiver: detection, time to alert, false alarms",
                                    "  schuler analyze integrity examples/paper-a-flight.toml\n"
                                    "  schuler analyze integrity examples/paper-a-flight.toml --kind ramp --size 0.1,0.5 -n 50");
    integrity->add_option("--kind", o.study.kinds, "step, ramp (position alone), drift (with its velocity), velocity, noise, freeze")
        ->delimiter(',')->type_name("KIND");
    integrity->add_option("--size", o.study.sizes, "m, or m/s")->delimiter(',')->type_name("SIZE");
    integrity->add_option("--start", o.study.start, "default: half of the scenario")->type_name("S");
    integrity->add_option("--duration", o.study.duration, "default 100")->type_name("S");
}

void add_observability(CLI::App& analyze, Options& o, const AddCommand& add_command) {
    CLI::App* app = add_command(
        analyze, "observability", "what position and velocity fixes tell of the states of strapdown gravimetry (paper E)",
        "  schuler analyze observability --paper                     at rest and at 1 m/s, beside the paper\n"
        "  schuler analyze observability --vn 1 --ve 1 --json        exact rank, pivots, combinations\n"
        "  schuler analyze observability --vn 1 --ve 1 --tolerance 1e-7\n"
        "Ranks are decided with fifty digits along the motion, a great circle. A pivot is a share of what gravity does in 13 minutes.");
    study::ObservabilityRequest& r = o.observability;
    app->add_option("--latitude-deg", r.latitude_deg, "default 55.8114694")->type_name("DEG");
    app->add_option("--longitude-deg", r.longitude_deg, "default 37.4998612")->type_name("DEG");
    app->add_option("--height", r.height, "default 164.15")->type_name("M");
    app->add_option("--vn", r.vn, "velocity north, default 0")->type_name("M_S");
    app->add_option("--ve", r.ve, "velocity east, default 0")->type_name("M_S");
    app->add_option("--vd", r.vd, "velocity down, default 0")->type_name("M_S");
    app->add_option("--heading-deg", r.heading_deg, "default 45")->type_name("DEG");
    app->add_option("--turn-deg-s", r.turn_deg_s, "rate of the heading, default 0")->type_name("DEG_S");
    app->add_option("--correlation-time", r.correlation_time, "of the disturbance's random part; 0 (default): constant")
        ->type_name("S");
    app->add_option("--polynomial", r.polynomial, "degree of its systematic part along the track: 0 (default), 1, 2")
        ->type_name("N");
    app->add_option("--tolerance", r.tolerance, "smallest pivot that counts; 0 (default): exact rank");
    app->add_flag("--rhumb", r.rhumb, "constant course and velocity against north instead of a great circle");
    app->add_flag("--frozen", r.frozen, "hold the model as it is at the start");
    app->add_flag("--paper", r.paper, "the paper's motions too");
    add_json(*app, o);
}

void add_triad(CLI::App& analyze, Options& o, const AddCommand& add_command) {
    CLI::App* app = add_command(analyze, "triad", "satellites, ADS-B stations and INS in one filter: paper D's experiments over 48 geometries",
                                "  schuler analyze triad                                    the cases of the reference simulation, 48 runs each\n"
                                "  schuler analyze triad --cases ce -n 480 -o out/triad     ten seeds on each geometry, with plots\n"
                                "  schuler analyze triad --grade tactical --oscillator tcxo --baro 0");
    study::TriadRequest& r = o.triad;
    app->add_option("--cases", r.cases, "letters: a 4, b 3, c 2 satellites, d 4 stations, e 2 and 2, s those from 300 s on, f all, g f and 4 stations")
        ->type_name("LETTERS");
    app->add_option("--grade", r.grade, "of the inertial unit: navigation or tactical")->type_name("GRADE");
    app->add_option("--oscillator", r.oscillator, "of the receiver: ocxo or tcxo")->type_name("KIND");
    app->add_option("--baro", r.baro, "sigma of the barometer's bias, 0: no barometer; default 30")->type_name("M");
    app->add_option("--mechanization", r.mechanization, "geographic or ecef")->type_name("FRAME");
    app->add_option("-n,--runs", r.runs, "runs of each case, default 48: run j has geometry j mod 48")->check(CLI::PositiveNumber);
    app->add_option("--jobs", r.jobs, "threads, default one a core")->check(CLI::NonNegativeNumber);
    app->add_option("--seed", o.seed, "of the first 48 runs, default 1");
    add_output(*app, o, "folder of CSV files and a report with plots (default: none)");
    add_json(*app, o);
}

void add_allan(CLI::App& analyze, Options& o, const AddCommand& add_command) {
    CLI::App* app = add_command(
        analyze, "allan", "noise of the inertial sensors: Allan deviation, its coefficients, spectra",
        "  schuler analyze allan bench/                              a log of an instrument at rest\n"
        "  schuler analyze allan drive/ --set run.stop_s=300 --json   its first minutes, with the points of the curves\n"
        "  schuler analyze allan examples/static.toml                the instrument of a scenario\n"
        "Axes are those of the body. Only an instrument at rest shows its noise alone.");
    app->add_option("INPUT", o.input, "data set or scenario file")->required();
    app->add_option("--config", o.config, "settings over those of the data set")->type_name("FILE");
    app->add_option("--seed", o.seed, "instead of the scenario's")->type_name("N");
    app->add_option("--set", o.set, "one setting")->type_name("key=value")->allow_extra_args(false);
    add_json(*app, o);
}

void add_protection(CLI::App& analyze, Options& o, const AddCommand& add_command) {
    CLI::App* app = add_command(analyze, "protection", "wrong pseudoranges in the tight filter: missed detections, false alarms, protection levels",
                                "  schuler analyze protection -n 10000                       single faults on the flights of paper D\n"
                                "  schuler analyze protection -n 2000 --double --json");
    study::ProtectionRequest& r = o.protection;
    app->add_option("-n,--runs", r.runs, "faults, each a flight of its own, default 1000")->check(CLI::Range(1, 1'000'000));
    app->add_flag("--double", r.double_fault, "two satellites wrong at once");
    app->add_option("--missed-detection", r.settings.missed_detection, "stated risk of an epoch, default 0.001")->check(CLI::Range(1e-9, 0.1));
    app->add_option("--false-alarm", r.settings.false_alarm, "of one test, default 1e-7")->check(CLI::Range(1e-15, 0.1));
    app->add_option("--jobs", r.jobs, "threads, default one a core")->check(CLI::NonNegativeNumber);
    app->add_option("--seed", o.seed, "default 1");
    add_output(*app, o, "folder of trials.csv (default: none)");
    add_json(*app, o);
}

}  // namespace

void add_analyze_command(CLI::App& parser, Options& o, const AddCommand& add_command) {
    CLI::App* analyze = add_command(parser, "analyze", "theory and studies: error solutions, modes, requirements, budgets, integrity, noise",
                                    "  schuler analyze equator --paper\n  schuler analyze schuler --tilt-east 1e-3 --time 5064\n"
                                    "`schuler analyze STUDY --help` tells the options of a study.");
    analyze->require_subcommand(1);
    add_equator(*analyze, o, add_command);
    add_schuler(*analyze, o, add_command);
    add_studies(*analyze, o, add_command);
    add_observability(*analyze, o, add_command);
    add_triad(*analyze, o, add_command);
    add_allan(*analyze, o, add_command);
    add_protection(*analyze, o, add_command);
}

}  // namespace schuler::cli
