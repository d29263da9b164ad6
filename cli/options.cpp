#include "options.h"

#include "schuler/app/config.h"

#include <fmt/format.h>

namespace schuler::cli {
namespace {

void add_everywhere(CLI::App& app, Options& o) {
    app.add_flag("-q,--quiet", o.quiet, "no table, no progress bar, no warnings; errors only");
    app.add_option("--threads", o.threads, "number of threads; results do not depend on it")->check(CLI::Range(0, 1024));
    app.set_version_flag("--version", "schuler " SCHULER_VERSION, "print the version");
}

}  // namespace

void add_output(CLI::App& app, Options& o, const char* what) {
    app.add_option("-o,--output", o.output, what)->type_name("DIR");
}

void add_json(CLI::App& app, Options& o, const char* what) { app.add_flag("--json", o.json, what); }

void add_settings(CLI::App& app, Options& o) {
    app.add_option("--config", o.config, "settings over those of the data set: keys as in dataset.toml")->type_name("FILE.toml");
    app.add_option("--start", o.start, "leave out what is before; seconds after the first GNSS (without one: IMU) epoch, or abs:T")
        ->type_name("T");
    app.add_option("--stop", o.stop, "leave out what is after")->type_name("T");
    app.add_option("--set", o.set, "a setting by its key; `schuler help settings` lists them")
        ->type_name("key=value")
        ->allow_extra_args(false);
    // `--set a=1 b=2`: what follows the first pair arrives as arguments of no option
    app.add_option("more_settings", o.loose_arguments)->group("");
    add_json(app, o, "summary.json on standard output instead of the tables");
}

void add_run_options(CLI::App& app, Options& o) {
    app.add_option("--loop", o.loop, "feedback of the estimated errors: closed, open or mixed")->type_name("LOOP");
    app.add_option("--outage", o.outages, "withhold GNSS for T < t < T+DUR and compare there")
        ->type_name("T:DUR[,T:DUR...]")
        ->allow_extra_args(false);
    app.add_option("--settle", o.settle, "count errors from here; default: alignment + 60 s")->type_name("S");
    app.add_option("--outputs", o.outputs, "what is written: solution,summary,h5,report,kml,config (default all of these), covariance (the whole of it, in run.h5)")
        ->delimiter(',')
        ->type_name("LIST");
    app.add_option("--progress", o.progress, "lines: \"progress 0.5\" on standard error, for programs")
        ->check(CLI::IsMember({"lines"}))
        ->type_name("FORM");
}

namespace {

/// Options of process, run and demo.
void add_processing(CLI::App& app, Options& o) {
    add_settings(app, o);
    app.add_option("--scheme", o.scheme,
                   "coupling: loose, separate, tight, intermediate, deep (of a scenario with [receiver]), or gnss for the receiver's own "
                   "solution")
        ->type_name("SCHEME");
    app.add_option("--mechanization", o.mechanization, "geographic or ecef")->type_name("FRAME");
    app.add_flag("--smooth", o.smooth, "fixed-interval smoother after the filter");
    app.add_flag("--backward", o.backward, "a filter backward in time as well, and its difference from the forward one with its sigma");
    add_run_options(app, o);
    app.add_option("--self-check", o.self_check,
                   "on (default): process withholds fixes in windows of its own, says how true the sigmas are, and widens the noise of the "
                   "inertial unit where they are too small")
        ->check(CLI::IsMember({"on", "off"}))
        ->type_name("on|off");
    app.add_option("--output-rate", o.output_rate, "rate of the solution, default 10; 0 = every IMU epoch")->type_name("HZ");
}

CLI::App* add_command(CLI::App& parser, Options& o, const std::string& name, const std::string& purpose,
                      const std::string& examples) {
    CLI::App* app = parser.add_subcommand(name, purpose);
    const std::string command = parser.get_parent() == nullptr ? name : parser.get_name() + " " + name;
    app->callback([&o, command] {
        if (o.command.empty()) o.command = command;  // a study's callback runs before that of `analyze`
    });
    app->footer("Examples:\n" + examples);
    add_everywhere(*app, o);
    return app;
}

void add_data_commands(CLI::App& parser, Options& o) {
    CLI::App* demo = add_command(parser, o, "demo", "simulate a drive, process its logs, evaluate, write a report",
                                 "  schuler demo\n  schuler demo -o /tmp/demo");
    add_output(*demo, o, "folder to write to (default out/demo)");
    add_processing(*demo, o);

    CLI::App* simulate = add_command(
        parser, o, "simulate", "write the sensor logs and the truth of a scenario as a data set",
        "  schuler simulate examples/demo.toml -o /tmp/drive\n  schuler simulate examples/paper-a-flight.toml -o /tmp/flight --seed 7\n"
        "`schuler help scenario` lists the keys of a scenario file.");
    simulate->add_option("SCENARIO", o.input, "scenario file")->required();
    simulate->add_option("-o,--output", o.output, "folder of the data set")->required()->type_name("DIR");
    simulate->add_option("--seed", o.seed, "instead of the scenario's")->type_name("N");

    CLI::App* process = add_command(
        parser, o, "process", "from the logs of a data set to its trajectory",
        "  schuler process drive/                                  a folder with dataset.toml, or one that is recognised\n"
        "  schuler process drive/ --smooth --outage 50:15,100:15   withhold GNSS, see how far it drifts\n"
        "  schuler process kf-gins.yaml --outputs solution,summary --output-rate 0\n"
        "  schuler process drive/ --set imu.grade=mems --set gnss.lever_arm_m=[0.5,0,-1]\n"
        "  schuler process drive/ --config out/drive/config.toml   the same settings again\n"
        "`schuler help settings` lists the keys of dataset.toml, --config and --set.");
    process->add_option("DATASET", o.input, "folder, dataset.toml, KF-GINS YAML file, or a log")->required();
    add_output(*process, o);
    add_processing(*process, o);

    CLI::App* run = add_command(parser, o, "run", "simulate a scenario, process and evaluate it in one go",
                                "  schuler run examples/paper-a-flight.toml\n  schuler run examples/demo.toml --seed 3 --smooth --json\n"
                                "`schuler help scenario` lists the keys of a scenario file.");
    run->add_option("SCENARIO", o.input, "scenario file")->required();
    add_output(*run, o);
    run->add_option("--seed", o.seed, "instead of the scenario's")->type_name("N");
    add_processing(*run, o);
}

void add_attitude_command(CLI::App& parser, Options& o) {
    CLI::App* ahrs = add_command(
        parser, o, "ahrs", "attitude and heading from gyro, accelerometer and magnetometer",
        "  schuler ahrs hand/                              the multiplicative filter, nine axes\n"
        "  schuler ahrs hand/ --offline                    forwards and backwards\n"
        "  schuler ahrs hand/ --six-axis --json            without the magnetometer\n"
        "  schuler ahrs hand/ --filter quaternion-coupled  the filter whose horizon a magnet can tilt\n"
        "  schuler ahrs flight/ --calibrate                magnetometer and accelerometer calibrated from this log\n"
        "Heading is true where position and date are known (World Magnetic Model), magnetic otherwise.");
    ahrs->add_option("DATASET", o.input, "folder, dataset.toml, or a log")->required();
    add_output(*ahrs, o);
    ahrs->add_option("--filter", o.filter, "dcm, quaternion, quaternion-printed, quaternion-coupled or mekf (default)")
        ->check(CLI::IsMember({"dcm", "quaternion", "quaternion-printed", "quaternion-coupled", "mekf"}));
    ahrs->add_flag("--six-axis", o.six_axis, "leave the magnetometer out; heading starts at zero");
    ahrs->add_flag("--offline", o.offline, "forward filter and backward smoother (mekf)");
    ahrs->add_flag("--calibrate", o.calibrate, "ellipsoid fit of magnetometer and accelerometer from this log first");
    ahrs->add_option("--outputs", o.outputs, "what is written beside summary.json: solution,report,config (default all)")
        ->delimiter(',')
        ->type_name("LIST");
    add_settings(*ahrs, o);
}

void add_montecarlo_command(CLI::App& parser, Options& o) {
    CLI::App* app = add_command(parser, o, "montecarlo", "many seeds of a scenario: errors and consistency over the runs",
                                "  schuler montecarlo examples/paper-a-flight.toml -n 100\n"
                                "  schuler montecarlo examples/paper-a-flight.toml -n 20 --jobs 2 --set filter.loop=open\n"
                                "Run k has the seed of the scenario plus k: `schuler run SCENARIO --seed ...` repeats it. The files do not\n"
                                "depend on --jobs (but for the speed told in summary.json). [montecarlo] vary draws settings anew for each run.");
    app->add_option("SCENARIO", o.input, "scenario file")->required();
    app->add_option("-n,--runs", o.runs, "number of runs (default: the scenario's, else 100)")->type_name("RUNS")->check(CLI::Range(1, 1000000));
    app->add_option("-j,--jobs", o.jobs, "runs at once (default: one a core)")->type_name("J")->check(CLI::Range(0, 1024));
    add_output(*app, o, "folder to write to (default out/NAME-montecarlo)");
    app->add_option("--seed", o.seed, "of the first run, instead of the scenario's")->type_name("N");
    add_processing(*app, o);
}

void add_file_commands(CLI::App& parser, Options& o) {
    CLI::App* evaluate = add_command(parser, o, "evaluate", "errors of a solution against a reference",
                                     "  schuler evaluate out/drive/solution.csv drive/reference.csv\n  schuler evaluate "
                                     "out/drive truth.txt --settle 300 --json");
    evaluate->add_option("SOLUTION", o.input, "solution.csv, a folder with one, or any trajectory that can be read")->required();
    evaluate->add_option("REFERENCE", o.second, "reference.csv, a solution, or ten columns: t lat lon h vN vE vD roll pitch yaw")
        ->required();
    evaluate->add_option("--settle", o.settle, "leave out the first S seconds")->type_name("S")->check(CLI::NonNegativeNumber);
    add_json(*evaluate, o, "one JSON document with the fields of summary.json");

    CLI::App* inspect =
        add_command(parser, o, "inspect", "what is in a file or folder, what is wrong, a dataset.toml to start from",
                    "  schuler inspect drive/\n  schuler inspect imu.csv --json");
    inspect->add_option("PATH", o.input, "file or folder")->required();
    add_json(*inspect, o);

    CLI::App* convert =
        add_command(parser, o, "convert", "a solution from one format to another",
                    "  schuler convert receiver.ubx rover.obs               and receiver.ubx rover.nav: RINEX 3.04\n"
                    "  schuler convert truth.txt reference.csv\n  schuler convert out/drive/solution.csv track.kml\n"
                    "  schuler convert reference.csv truth.txt --to kf-gins");
    convert->add_option("IN", o.input, "any trajectory that can be read, or raw measurements (RINEX, UBX, RTCM 3)")->required();
    convert->add_option("OUT", o.output, "file to write")->required();
    convert->add_option("--to", o.format, "csv, kml, kf-gins, rinex-obs or rinex-nav (default: by the name of OUT)")->type_name("FORMAT");

    CLI::App* help = add_command(parser, o, "help", "a command, or the keys of settings and scenario files",
                                 "  schuler help process\n  schuler help settings\n  schuler help settings imu.\n"
                                 "  schuler help scenario trajectory.\n  schuler help --man >schuler.1");
    help->add_option("TOPIC", o.topic, "settings or scenario, or a command")->check(CLI::IsMember({"settings", "scenario"}));
    help->add_option("PREFIX", o.prefix, "only keys that begin so");
    help->add_flag("--man", o.manual, "all commands as a manual page");

    CLI::App* completion = add_command(parser, o, "completion", "a script that completes commands and options in a shell",
                                       "  source <(schuler completion bash)\n"
                                       "  schuler completion zsh >~/.zsh/functions/_schuler            a folder of $fpath");
    completion->add_option("SHELL", o.topic, "bash or zsh")->required()->check(CLI::IsMember({"bash", "zsh"}));
}

app::Setting text_setting(const std::string& key, const std::string& text, const std::string& option) {
    return {key, {text}, {option, 0, 0, {}}};
}

app::Value time_value(const app::RunTime& t) {
    return t.absolute ? app::Value{fmt::format("abs:{}", t.seconds)} : app::Value{t.seconds};
}

}  // namespace

void add_commands(CLI::App& parser, Options& o) {
    add_everywhere(parser, o);
    parser.require_subcommand(1);
    parser.footer(
        "Examples:\n  schuler demo\n  schuler inspect drive/\n  schuler process drive/ --smooth\n  schuler evaluate "
        "out/drive/solution.csv truth.csv\n"
        "`schuler COMMAND --help` tells the options of a command.\n"
        "Exit status: 0 done, 1 the computation failed, 2 the input or the command line is unusable.");
    add_data_commands(parser, o);
    add_attitude_command(parser, o);
    add_montecarlo_command(parser, o);
    add_file_commands(parser, o);
    const AddCommand add = [&o](CLI::App& parent, const std::string& name, const std::string& purpose, const std::string& examples) {
        return add_command(parent, o, name, purpose, examples);
    };
    add_gravity_command(parser, o, add);
    add_receiver_command(parser, o, add);
    add_analyze_command(parser, o, add);
    add_ui_command(parser, o, add);
}

app::SettingList settings_of(const Options& o) {
    app::SettingList out;
    for (const std::string& text : o.loose_arguments) {
        if (o.set.empty() || text.find('=') == std::string::npos)
            throw input_error(fmt::format("unexpected argument \"{}\"", text), {},
                              fmt::format("see `schuler {} --help`", o.command));
    }
    for (const std::string& text : o.set) out.push_back(app::setting_from_text(text));
    for (const std::string& text : o.loose_arguments) out.push_back(app::setting_from_text(text));
    if (!o.scheme.empty()) out.push_back(text_setting("filter.scheme", o.scheme, "--scheme"));
    if (!o.mechanization.empty()) out.push_back(text_setting("filter.mechanization", o.mechanization, "--mechanization"));
    if (!o.loop.empty()) out.push_back(text_setting("filter.loop", o.loop, "--loop"));
    if (o.smooth) out.push_back({"filter.smooth", {true}, {"--smooth", 0, 0, {}}});
    if (o.backward) out.push_back({"filter.backward", {true}, {"--backward", 0, 0, {}}});
    if (!o.self_check.empty()) out.push_back({"filter.self_check", {o.self_check == "on"}, {"--self-check", 0, 0, {}}});
    if (!o.start.empty())
        out.push_back({"run.start_s", time_value(app::run_time_from_text(o.start, "--start")), {"--start", 0, 0, {}}});
    if (!o.stop.empty())
        out.push_back({"run.stop_s", time_value(app::run_time_from_text(o.stop, "--stop")), {"--stop", 0, 0, {}}});
    if (o.settle) out.push_back({"run.settle_s", {*o.settle}, {"--settle", 0, 0, {}}});
    if (o.output_rate) out.push_back({"output.rate_hz", {*o.output_rate}, {"--output-rate", 0, 0, {}}});
    app::ValueList outages;
    for (const std::string& text : o.outages) {
        for (const app::OutageSpan& s : app::outages_from_text(text)) {
            outages.push_back({app::ValueTable{{"start_s", time_value({s.start, s.absolute})}, {"duration_s", {s.duration}}}});
        }
    }
    if (!outages.empty()) out.push_back({"outage", {std::move(outages)}, {"--outage", 0, 0, {}}});
    if (!o.outputs.empty()) {
        app::ValueList files;
        for (const std::string& name : o.outputs) files.push_back({name});
        out.push_back({"output.files", {std::move(files)}, {"--outputs", 0, 0, {}}});
    }
    return out;
}

std::string command_in(int argc, char** argv, const CLI::App& parser) {
    for (int i = 1; i < argc; ++i) {
        for (const CLI::App* command : parser.get_subcommands([](const CLI::App*) { return true; })) {
            if (command->get_name() != argv[i]) continue;
            std::string names = " " + command->get_name();
            for (const CLI::App* study : command->get_subcommands([](const CLI::App*) { return true; }))
                if (i + 1 < argc && study->get_name() == argv[i + 1]) names += " " + study->get_name();
            return names;
        }
    }
    return {};
}

std::string unknown_command(int argc, char** argv, const CLI::App& parser) {
    if (argc < 2 || argv[1][0] == '-' || !command_in(argc, argv, parser).empty()) return {};
    std::vector<std::string> known;
    for (const CLI::App* command : parser.get_subcommands([](const CLI::App*) { return true; })) known.push_back(command->get_name());
    const std::string near = app::nearest_key(argv[1], known);
    return fmt::format("\"{}\" is not a command{}", argv[1], near.empty() ? std::string{} : fmt::format("; did you mean {}?", near));
}

}  // namespace schuler::cli
