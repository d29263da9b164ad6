// `gravity`.
#include "options.h"

#include <CLI/CLI.hpp>

namespace schuler::cli {

void add_gravity_command(CLI::App& parser, Options& o, const AddCommand& add_command) {
    CLI::App* app = add_command(
        parser, "gravity", "the disturbance of gravity along a track, from an IMU and GNSS",
        "  schuler gravity examples/gravity-car-5400s.toml        paper E's scenario\n"
        "  schuler gravity examples/gravity-flight.toml --runs 20 medians over twenty seeds\n"
        "  schuler gravity examples/gravity-variable.toml --response  amplitude and phase of the estimator\n"
        "  schuler gravity flight/ --set gravity.length_m=8000    recorded logs\n"
        "  schuler gravity lab/ --config step.toml                with an [[anomaly]] injected into the accelerometers\n"
        "Writes gravity.csv and gravity.geojson beside the files of `process`. A log that is not accurate enough gets a\n"
        "statement of what is attainable instead. `schuler help settings gravity.` and `schuler help scenario anomaly` list keys.");
    app->add_option("INPUT", o.input, "scenario file, folder of a data set, or dataset.toml")->required();
    add_output(*app, o);
    app->add_option("--seed", o.seed, "instead of the scenario's")->type_name("N");
    app->add_option("--runs", o.runs, "so many seeds of a scenario: medians and consistency instead of files")
        ->check(CLI::Range(1, 100000))
        ->type_name("N");
    app->add_flag("--response", o.response, "amplitude and phase of the estimator along a scenario's track, by added harmonics");
    add_run_options(*app, o);
    add_settings(*app, o);
}

}  // namespace schuler::cli
