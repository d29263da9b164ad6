// `gravity`.
#include "options.h"

namespace schuler::cli {

void add_gravity_command(CLI::App& parser, Options& o, const AddCommand& add_command) {
    CLI::App* app = add_command(
        parser, "gravity", "the disturbance of gravity along a track, from an IMU and GNSS",
        "  schuler gravity examples/gravity-car-5400s.toml        paper E's scenario\n"
        "  schuler gravity examples/gravity-flight.toml --runs 20 medians over twenty seeds\n"
        "  schuler gravity flight/ --set gravity.length_m=8000    recorded logs\n"
        "  schuler gravity lab/ --config step.toml                with an [[anomaly]] injected into the accelerometers\n"
        "Writes gravity.csv and gravity.geojson beside the files of `process`. A log that is not accurate enough gets a statement of\n"
        "what is attainable instead. `schuler help settings gravity.` and `schuler help scenario anomaly` list the keys.");
    app->add_option("INPUT", o.input, "scenario file, folder of a data set, or dataset.toml")->required();
    app->add_option("-o,--output", o.output, "folder to write to (default out/NAME)")->type_name("DIR");
    app->add_option("--seed", o.seed, "instead of the scenario's")->type_name("N");
    app->add_option("--runs", o.runs, "so many seeds of a scenario: medians and consistency instead of files")
        ->check(CLI::Range(1, 100000))
        ->type_name("N");
    app->add_option("--config", o.config, "settings over those of the data set: keys as in dataset.toml")->type_name("FILE.toml");
    app->add_option("--start", o.start, "leave out what is before; seconds after the first GNSS epoch, or abs:T")->type_name("T");
    app->add_option("--stop", o.stop, "leave out what is after")->type_name("T");
    app->add_option("--outage", o.outages, "withhold GNSS for T < t < T+DUR")->type_name("T:DUR[,T:DUR...]")->allow_extra_args(false);
    app->add_option("--settle", o.settle, "count errors from here; default: 60 s")->type_name("S");
    app->add_option("--outputs", o.outputs, "what is written beside gravity.csv: solution,summary,h5,report,kml,config (default all)")
        ->type_name("LIST");
    app->add_option("--set", o.set, "a setting by its key; `schuler help settings` lists them")
        ->type_name("key=value")
        ->allow_extra_args(false);
    app->add_flag("--json", o.json, "summary.json on standard output instead of the tables");
}

}  // namespace schuler::cli
