// `schuler analyze`: studies of designs, of faults and of instruments.
#include "schuler/study/studies.h"
#include "schuler/app/commands/builders.h"
#include "schuler/sensor/grades.h"
#include "schuler/study/allan.h"
#include "schuler/study/covariance/covariance.h"
#include "schuler/study/triad/protection.h"

namespace schuler::app {
namespace {

Option<study::RequirementsRequest> device_option() {
    using R = study::RequirementsRequest;
    const std::vector<std::string_view> names = sensor::imu_grade_names();
    Option<R> option =
        some_of<R>("device", {names.begin(), names.end()}, "inertial units whose longest tolerable outage is computed",
                   [](auto& r) -> auto& { return r.devices; });
    option.spec.any_spelling = true;
    return option;
}

Command requirements() {
    using R = study::RequirementsRequest;
    OptionTable<R> t;
    t.add(in_units("m", settings::number<R>("budget", 1.0, 0, 1e7, "horizontal position error that is allowed",
                                            [](auto& r) -> auto& { return r.budget; })))
        .add(in_units("s",
                      otherwise("10 s to an hour", written("S[,S...]", numbers<R>("outage", 0, 1e7, "lengths of outages",
                                                                                  [](auto& r) -> auto& { return r.outages; })))))
        .add(otherwise("all", written("NAME", device_option())));
    return command<R>(
        "analyze requirements", "sensors for a position budget over an outage, and outages for devices (paper A, 1.4)",
        "  schuler analyze requirements --budget 5 --outage 60\n  schuler analyze requirements --budget 5 --device hg9900 --json",
        std::move(t), one_json_document, false, study::analyze_requirements);
}

/// Common options of the studies of a scenario.
OptionTable<study::StudyRequest> study_of_scenario() {
    using R = study::StudyRequest;
    OptionTable<R> t;
    t.add(scenario_argument<R>("scenario file", [](auto& r) -> auto& { return r.scenario; }))
        .add(lettered('n', written("RUNS", settings::integer<R>("runs", 1, 1'000'000, "number of runs of each case",
                                                                [](auto& r) -> auto& { return r.runs; }))))
        .add(jobs_option<R>([](auto& r) -> auto& { return r.jobs; }))
        .add(otherwise("the scenario's", seed_option<R>("seed of the first run", [](auto& r) -> auto& { return r.seed; })))
        .add(set_option<R>([](auto& r) -> auto& { return r.above; }));
    return t;
}

Command budget() {
    return command<study::StudyRequest>("analyze budget",
                                        "error budget: one source at a time is simulated, the filter assumes all of them",
                                        "  schuler analyze budget examples/paper-a-flight.toml\n"
                                        "  schuler analyze budget examples/airliner-hg9900.toml -n 20 --json",
                                        study_of_scenario(), one_json_document, true, study::analyze_budget);
}

Command covariance() {
    using R = study::CovarianceRequest;
    OptionTable<R> t;
    t.add(scenario_argument<R>("scenario file, with filter.initial_error", [](auto& r) -> auto& { return r.scenario; }))
        .add(set_option<R>([](auto& r) -> auto& { return r.above; }))
        .add(seed_option<R>("seed of the satellite constellation's changes", [](auto& r) -> auto& { return r.seed; }))
        .add(in_units("Hz", settings::number<R>("rate", 1.0, 0.1, 1e4, "maximum IMU rate used along the path",
                                                [](auto& r) -> auto& { return r.rate; })))
        .add(in_units(
            "s",
            settings::number<R>(
                "outage", 1.0, 0, 1e6,
                "duration of an outage of GNSS at the end of the scenario, instead of the scenario's outages; 0: the scenario's outages",
                [](auto& r) -> auto& { return r.outage; })))
        .add(written("KEY", settings::text<R>(
                                "find", "scenario key to solve for, by bisection, so that the horizontal error equals --target",
                                [](auto& r) -> auto& { return r.find; })))
        .add(in_units("m",
                      settings::number<R>("target", 1.0, 0, 1e9,
                                          "horizontal error (one sigma, radial) at the end of the first outage, or of the path",
                                          [](auto& r) -> auto& { return r.target; })))
        .add(output_option<R>("folder of covariance.csv and a report with plots", "none",
                              [](auto& r) -> auto& { return r.output; }));
    return command<R>(
        "analyze covariance",
        "covariance analysis of a filter: true covariance under its gains, its own covariance, and the contribution of each error source",
        "  schuler analyze covariance examples/paper-a-flight.toml\n"
        "  schuler analyze covariance examples/paper-a-flight.toml --outage 60 -o out/covariance\n"
        "  schuler analyze covariance examples/paper-a-flight.toml --outage 60 --find imu.gyro_bias_deg_h --target 5\n"
        "[filter] assumed gives the filter another error model than the true one: the table then shows how far its sigmas are off.",
        std::move(t), one_json_document, false, study::analyze_covariance);
}

Command integrity() {
    using R = study::StudyRequest;
    OptionTable<R> t = study_of_scenario();
    t
        .add(otherwise(
            "step, ramp, drift",
            written(
                "KIND",
                some_of<R>(
                    "kind", {"step", "ramp", "drift", "velocity", "noise", "freeze", "dropout"},
                    "kinds of faults; ramp: of the position alone, drift: of position and velocity; range faults: step, ramp and drift only",
                    [](auto& r) -> auto& { return r.kinds; }))))
        .add(otherwise("by the kind", written("SIZE", numbers<R>("size", -1e9, 1e9, "sizes of the faults, m or m/s",
                                                                 [](auto& r) -> auto& { return r.sizes; }))))
        .add(in_units("s", settings::number<R>("start", 1.0, 0, 1e9, "start of the fault; 0: half of the scenario",
                                               [](auto& r) -> auto& { return r.start; })))
        .add(in_units("s", settings::number<R>("duration", 1.0, 0, 1e9, "duration of the fault",
                                               [](auto& r) -> auto& { return r.duration; })));
    return command<R>("analyze integrity", "faults of the receiver: detection, time to alert, false alarms",
                      "  schuler analyze integrity examples/paper-a-flight.toml\n"
                      "  schuler analyze integrity examples/paper-a-flight.toml --kind ramp --size 0.1,0.5 -n 50",
                      std::move(t), one_json_document, true, study::analyze_integrity);
}

/// Letters without separators, unlike a list of words.
Option<study::TriadRequest> cases_option() {
    using R = study::TriadRequest;
    static const std::string known = "abcdesfg";
    Option<R> option = settings::text<R>(
        "cases",
        "cases: a 4, b 3, c 2 satellites, d 4 stations, e 2 satellites and 2 stations, s as e with the stations from 300 s on, f all "
        "satellites, g all satellites and 4 stations",
        [](auto& r) -> auto& { return r.cases; });
    option.spec.form = fmt::format("letters of {}", known);
    option.set = [](R& r, const Value& v) {
        if (v.text()->find_first_not_of(known) != std::string::npos)
            throw input_error(fmt::format("\"{}\" contains an unknown case letter", *v.text()), {},
                              fmt::format("give letters of {}", known));
        r.cases = *v.text();
    };
    return option;
}

Command triad() {
    using R = study::TriadRequest;
    OptionTable<R> t;
    t.add(otherwise("all", written("LETTERS", cases_option())))
        .add(written("GRADE", one_of<R>("grade", {"navigation", "tactical"}, "grade of the inertial unit",
                                        [](auto& r) -> auto& { return r.grade; })))
        .add(written("KIND", one_of<R>("oscillator", {"ocxo", "tcxo"}, "oscillator of the receiver",
                                       [](auto& r) -> auto& { return r.oscillator; })))
        .add(in_units("m", otherwise("30", settings::number<R>("baro", 1.0, 0, 1e4,
                                                               "standard deviation of the barometer's bias; 0: no barometer",
                                                               [](auto& r) -> auto& { return r.baro; }))))
        .add(written("FRAME", one_of<R>("mechanization", {"geographic", "ecef"}, "axes of the mechanization",
                                        [](auto& r) -> auto& { return r.mechanization; })))
        .add(lettered('n', written("RUNS", settings::integer<R>("runs", 1, 1'000'000,
                                                                "number of runs of each case; run j has geometry j mod 48",
                                                                [](auto& r) -> auto& { return r.runs; }))))
        .add(jobs_option<R>([](auto& r) -> auto& { return r.jobs; }))
        .add(seed_option<R>("seed of the first 48 runs", [](auto& r) -> auto& { return r.seed; }))
        .add(output_option<R>("folder of CSV files and a report with plots", "none", [](auto& r) -> auto& { return r.output; }));
    return command<R>(
        "analyze triad", "satellites, ADS-B stations and INS in one filter: paper D's experiments over 48 geometries",
        "  schuler analyze triad                                    the cases of the reference simulation, 48 runs each\n"
        "  schuler analyze triad --cases ce -n 480 -o out/triad     ten seeds on each geometry, with plots\n"
        "  schuler analyze triad --grade tactical --oscillator tcxo --baro 0",
        std::move(t), one_json_document, true, study::analyze_triad);
}

Command allan() {
    using R = settings::ProcessRequest;
    OptionTable<R> t;
    t.add(of_role(settings::FileRole::DatasetOrScenario,
                  argument("INPUT", path<R>("input", "data set or scenario file", [](auto& r) -> auto& { return r.input; }))))
        .add(set_option<R>([](auto& r) -> auto& { return r.above; }))
        .add(written("FILE.toml",
                     path<R>("config", "settings over those of the data set", [](auto& r) -> auto& { return r.config; })))
        .add(seed_option<R>("seed, instead of the scenario's", [](auto& r) -> auto& { return r.seed; }));
    return command<R>(
        "analyze allan", "noise of the inertial sensors: Allan deviation, its coefficients, spectra",
        "  schuler analyze allan bench/                              a log of an instrument at rest\n"
        "  schuler analyze allan drive/ --set run.stop_s=300 --json   its first minutes, with the points of the curves\n"
        "  schuler analyze allan examples/static.toml                the instrument of a scenario\n"
        "Axes are those of the body. Only an instrument at rest shows its noise alone.",
        std::move(t), one_json_document, true, study::analyze_allan);
}

Command protection() {
    using R = study::ProtectionRequest;
    OptionTable<R> t;
    t.add(lettered('n',
                   written("RUNS", settings::integer<R>("runs", 1, 1'000'000, "number of trials, one fault per simulated flight",
                                                        [](auto& r) -> auto& { return r.runs; }))))
        .add(settings::flag<R>("double", "faults of two satellites at the same time",
                               [](auto& r) -> auto& { return r.kind.twice; }))
        .add(settings::flag<R>("ramp", "faults that grow by 0.1 to 5 m/s instead of constant ones",
                               [](auto& r) -> auto& { return r.kind.ramp; }))
        .add(settings::number<R>("missed-detection", 1.0, 1e-9, 0.1, "required probability of missed detection per epoch",
                                 [](auto& r) -> auto& { return r.settings.missed_detection; }))
        .add(settings::number<R>("false-alarm", 1.0, 1e-15, 0.1, "required probability of false alarm per test",
                                 [](auto& r) -> auto& { return r.settings.false_alarm; }))
        .add(jobs_option<R>([](auto& r) -> auto& { return r.jobs; }))
        .add(seed_option<R>("seed of the first flight", [](auto& r) -> auto& { return r.seed; }))
        .add(output_option<R>("folder of trials.csv", "none", [](auto& r) -> auto& { return r.output; }));
    return command<R>("analyze protection",
                      "pseudorange faults in the tight filter: missed detections, false alarms, protection levels",
                      "  schuler analyze protection -n 10000                       single faults on the flights of paper D\n"
                      "  schuler analyze protection -n 2000 --double --json\n"
                      "  schuler analyze protection -n 500 --ramp                 faults that grow slowly",
                      std::move(t), one_json_document, true, study::analyze_protection);
}

}  // namespace

void add_study_commands(std::vector<Command>& list) {
    for (Command (*make)() : {requirements, budget, covariance, integrity, triad, allan, protection}) list.push_back(make());
}

}  // namespace schuler::app
