// Commands that produce a solution from logs or a scenario.
#include "schuler/app/attitude/ahrs.h"
#include "schuler/app/batch.h"
#include "schuler/app/commands.h"
#include "schuler/app/commands/builders.h"
#include "schuler/app/satellites.h"
#include "schuler/study/montecarlo/montecarlo.h"

namespace schuler::app {
namespace {

using settings::ProcessRequest;

constexpr CommonRequest common;
constexpr const char* table_json = "summary.json on standard output instead of the tables";

/// Options of process, run, demo and montecarlo.
template <class R>
void add_processing(OptionTable<R>& table) {
    add_settings(table);
    table.add(written("SCHEME", of_setting<R>("scheme", "filter.scheme", common)))
        .add(written("FRAME", of_setting<R>("mechanization", "filter.mechanization", common)))
        .add(of_setting<R>("smooth", "filter.smooth", common))
        .add(of_setting<R>("backward", "filter.backward", common));
    add_run(table);
    Option<R> check = of_setting<R>("self-check", "filter.self_check", common);
    check.spec.shape = Shape::Text;
    check.spec.choices = {"on", "off"};
    check.set = [](R& r, const Value& v) {
        common(r).above.push_back({"filter.self_check", {*v.text() == "on"}, {"--self-check", 0, 0, {}}});
    };
    table.add(written("on|off", std::move(check)))
        .add(otherwise("10", written("HZ", of_setting<R>("output-rate", "output.rate_hz", common))));
}

template <class R>
Option<R> input(const char* value_name, const char* key, const char* help) {
    return argument(value_name, path<R>(key, help, [](auto& r) -> auto& { return common(r).input; }));
}

template <class R>
Option<R> output(const char* help, const char* usual) {
    return output_option<R>(help, usual, [](auto& r) -> auto& { return common(r).output; });
}

template <class R>
Option<R> seed(const char* help) {
    return seed_option<R>(help, [](auto& r) -> auto& { return common(r).seed; });
}

struct SimulateRequest {
    std::filesystem::path scenario, output;
    std::optional<std::uint64_t> seed;
};

Command demo() {
    OptionTable<ProcessRequest> t;
    t.add(output<ProcessRequest>("folder to write to", "out/demo"));
    add_processing(t);
    return command<ProcessRequest>("demo", "simulate a drive, process its logs, evaluate, write a report",
                                   "  schuler demo\n  schuler demo -o /tmp/demo", std::move(t), table_json, true,
                                   run_demonstration);
}

Command simulate() {
    using R = SimulateRequest;
    OptionTable<R> t;
    t.add(scenario_argument<R>("scenario file", [](auto& r) -> auto& { return r.scenario; }))
        .add(required(lettered(
            'o', written("DIR", path<R>("output", "folder of the data set", [](auto& r) -> auto& { return r.output; })))))
        .add(seed_option<R>("seed, instead of the scenario's", [](auto& r) -> auto& { return r.seed; }));
    return command<R>(
        "simulate", "write the sensor logs and the truth of a scenario as a data set",
        "  schuler simulate examples/demo.toml -o /tmp/drive\n  schuler simulate examples/paper-a-flight.toml -o /tmp/flight --seed 7\n"
        "`schuler help scenario` lists the keys of a scenario file.",
        std::move(t), "", false, [](const R& r) { return simulate_to_folder(r.scenario, r.output, r.seed); });
}

Command process() {
    OptionTable<ProcessRequest> t;
    t.add(input<ProcessRequest>("DATASET", "dataset", "folder, dataset.toml, KF-GINS YAML file, or a log"))
        .add(output<ProcessRequest>("folder to write to", "out/NAME"));
    add_processing(t);
    return command<ProcessRequest>(
        "process", "compute a trajectory from recorded logs",
        "  schuler process drive/                                  a folder with dataset.toml, or one that is recognised\n"
        "  schuler process drive/ --smooth --outage 50:15,100:15   withhold GNSS and evaluate the drift\n"
        "  schuler process kf-gins.yaml --outputs solution,summary --output-rate 0\n"
        "  schuler process drive/ --set imu.grade=mems --set gnss.lever_arm_m=[0.5,0,-1]\n"
        "  schuler process drive/ --config out/drive/config.toml   with the same settings\n"
        "`schuler help settings` lists the keys of dataset.toml, --config and --set.",
        std::move(t), table_json, true, process_dataset);
}

Command run() {
    OptionTable<ProcessRequest> t;
    t.add(input<ProcessRequest>("SCENARIO", "scenario", "scenario file"))
        .add(output<ProcessRequest>("folder to write to", "out/NAME"))
        .add(seed<ProcessRequest>("seed, instead of the scenario's"));
    add_processing(t);
    return command<ProcessRequest>(
        "run", "simulate a scenario, process the data and evaluate the solution",
        "  schuler run examples/paper-a-flight.toml\n  schuler run examples/demo.toml --seed 3 --smooth --json\n"
        "`schuler help scenario` lists the keys of a scenario file.",
        std::move(t), table_json, true, run_scenario);
}

std::vector<std::string> names_of_filters() {
    std::vector<std::string> out;
    for (const auto& [name, kind] : attitude_filters()) out.push_back(name);
    return out;
}

Command attitude() {
    using R = AhrsRequest;
    OptionTable<R> t;
    t.add(input<R>("DATASET", "dataset", "folder, dataset.toml, or a log"))
        .add(output<R>("folder to write to", "out/NAME"))
        .add(written(
            "FILTER",
            one_of<R>(
                "filter", names_of_filters(),
                "attitude filter: direction cosines, quaternion, quaternion as printed in the paper, quaternion whose roll and pitch magnetic disturbances affect too, or multiplicative Kalman filter",
                [](auto& r) -> auto& { return r.filter; })))
        .add(settings::flag<R>("six-axis", "do not use the magnetometer; heading starts at zero",
                               [](auto& r) -> auto& { return r.six_axis; }))
        .add(settings::flag<R>("offline", "forward filter and backward smoother (mekf)",
                               [](auto& r) -> auto& { return r.offline; }))
        .add(settings::flag<R>(
            "calibrate",
            "calibrate magnetometer and accelerometer by an ellipsoid fit to this log, where held-out parts of it confirm the fit",
            [](auto& r) -> auto& { return r.calibrate; }))
        .add(otherwise("all", written("LIST", described("files written besides summary.json: solution,report,config",
                                                        of_setting<R>("outputs", "output.files", common)))));
    add_settings(t);
    return command<R>(
        "ahrs", "attitude and heading from gyro, accelerometer and magnetometer",
        "  schuler ahrs hand/                              the multiplicative filter, nine axes\n"
        "  schuler ahrs hand/ --offline                    forwards and backwards\n"
        "  schuler ahrs hand/ --six-axis --json            without the magnetometer\n"
        "  schuler ahrs hand/ --filter quaternion-coupled  roll and pitch depend on the magnetometer too\n"
        "  schuler ahrs flight/ --calibrate                magnetometer and accelerometer calibrated from this log\n"
        "Heading is true where position and date are known (World Magnetic Model), magnetic otherwise.",
        std::move(t), table_json, true, ahrs_dataset);
}

Command satellites() {
    using R = SatellitesRequest;
    OptionTable<R> t;
    t.add(input<R>("DATASET", "dataset", "folder, dataset.toml, or a log of raw measurements"))
        .add(output<R>("folder to write to", "out/NAME"))
        .add(settings::number<R>("missed-detection", 1.0, 1e-9, 0.4,
                                 "probability of missed detection used for the protection levels",
                                 [](auto& r) -> auto& { return r.missed_detection; }));
    add_settings(t);
    return command<R>(
        "gnss", "satellites of a receiver's raw measurements: sky, residuals, DOP, protection levels, phases against a base",
        "  schuler gnss receiver.ubx                       the log of a receiver\n"
        "  schuler gnss survey/ -o out/survey              a folder with dataset.toml, or one that is recognised\n"
        "  schuler gnss survey/ --set gnss.systems=GE --json\n"
        "  schuler gnss rover.obs --set base.observations=base.obs    and slips and integers against a base\n"
        "Writes gnss.csv, satellites.csv, residuals.csv, report.html and summary.json; with a base carrier.csv. Exit status 1 where no epoch\n"
        "has a solution.",
        std::move(t), "summary.json on standard output instead of the tables", true, gnss_dataset);
}

Command montecarlo() {
    using R = study::CampaignRequest;
    OptionTable<R> t;
    t.add(input<R>("SCENARIO", "scenario", "scenario file"))
        .add(lettered('n', written("RUNS", otherwise("from the scenario; otherwise the number of sweep points, or 100",
                                                     settings::integer<R>("runs", 1, 100'000'000, "number of Monte Carlo runs",
                                                                          [](auto& r) -> auto& { return r.runs; })))))
        .add(jobs_option<R>([](auto& r) -> auto& { return r.jobs; }))
        .add(output<R>("folder to write to", "out/NAME-montecarlo"))
        .add(settings::flag<R>("resume", "resume the interrupted campaign in the folder; start one where there is none",
                               [](auto& r) -> auto& { return r.resume; }))
        .add(written("K", settings::integer<R>("first", 0, 9.0e15,
                                               "number of the first run, to compute a part of a campaign or to repeat one run",
                                               [](auto& r) -> auto& { return r.first; })))
        .add(seed<R>("seed of the first run, instead of the scenario's"));
    add_processing(t);
    return command<R>(
        "montecarlo", "many runs of a scenario with different seeds: errors and consistency over the runs",
        "  schuler montecarlo examples/paper-a-flight.toml -n 100\n"
        "  schuler montecarlo examples/paper-a-flight.toml -n 20 --jobs 2 --set filter.loop=open\n"
        "  schuler montecarlo examples/paper-a-flight.toml -n 10000 -o out/many --resume    resume after an interruption\n"
        "  schuler montecarlo examples/paper-a-flight.toml --first 17 -n 1                 run 17 again\n"
        "Run k has the seed of the scenario plus k: `schuler run SCENARIO --seed ...` repeats it. The files do not depend on --jobs\n"
        "(except the speed in summary.json), nor on interruptions. [montecarlo] vary draws or sweeps settings from run to run.",
        std::move(t), table_json, true, study::run_montecarlo);
}

Command batch() {
    using R = BatchRequest;
    OptionTable<R> t;
    Option<R> inputs = words<R>(
        "list",
        "text file with the path of a data set in each line (relative to the file; # comments), data sets, or a folder of them",
        [](auto& r) -> auto& { return r.inputs; });
    inputs.spec.line.file = inputs.spec.line.repeated = true;
    t.add(argument("LIST", std::move(inputs)))
        .add(jobs_option<R>([](auto& r) -> auto& { return r.jobs; }))
        .add(settings::flag<R>("resume",
                               "keep the results of data sets that an interrupted batch with the same settings has finished",
                               [](auto& r) -> auto& { return r.resume; }))
        .add(output<R>("folder to write to: a folder for each data set, and the table of all", "out/batch"));
    add_processing(t);
    return command<R>(
        "batch", "process many data sets; one table of all, worst first",
        "  schuler batch logs.txt -o out/logs                      a path in each line\n"
        "  schuler batch archive/ --jobs 2 --resume                a folder of data sets; resume after an interruption\n"
        "A data set that fails does not stop the others. The exit status is 1 where one failed or has the verdict \"do not use\". batch.csv, batch.json\n"
        "and index.html, which links the reports, do not depend on --jobs.",
        std::move(t), "batch.json on standard output instead of the table", true, process_batch);
}

}  // namespace

void add_data_commands(std::vector<Command>& list) {
    for (Command (*make)() : {demo, simulate, process, run, batch, attitude, satellites, montecarlo}) list.push_back(make());
}

}  // namespace schuler::app
