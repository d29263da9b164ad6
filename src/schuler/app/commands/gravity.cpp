// `schuler gravity`.
#include "schuler/study/gravity/gravity.h"
#include "schuler/app/commands/builders.h"

namespace schuler::app {
namespace {

struct GravityCommandRequest {
    settings::ProcessRequest common;
    int runs = 1, jobs = 0;
    bool response = false;
};

report::Outcome perform(const GravityCommandRequest& r) {
    if (r.response) return study::gravity_response({r.common});
    return r.runs > 1 ? study::gravity_campaign({r.common, r.runs, r.jobs}) : study::gravity_command({r.common});
}

}  // namespace

void add_gravity_command(std::vector<Command>& list) {
    using R = GravityCommandRequest;
    OptionTable<R> t;
    t.add(argument("INPUT", path<R>("input", "scenario file, folder of a data set, or dataset.toml",
                                    [](auto& r) -> auto& { return r.common.input; })))
        .add(output_option<R>("folder to write to", "out/NAME", [](auto& r) -> auto& { return r.common.output; }))
        .add(seed_option<R>("seed, instead of the scenario's", [](auto& r) -> auto& { return r.common.seed; }))
        .add(written("N",
                     settings::integer<R>("runs", 1, 100000,
                                          "number of Monte Carlo runs of a scenario: medians and consistency instead of files",
                                          [](auto& r) -> auto& { return r.runs; })))
        .add(settings::flag<R>("response", "amplitude and phase of the estimator along a scenario's track, by added harmonics",
                               [](auto& r) -> auto& { return r.response; }));
    t.add(of_setting<R>("backward", "filter.backward", [](auto& r) -> auto& { return r.common; }));
    add_settings(t);
    add_run(t);
    list.push_back(command<R>(
        "gravity", "estimate the gravity disturbance along a track from IMU and GNSS",
        "  schuler gravity examples/gravity-car-5400s.toml        paper E's scenario\n"
        "  schuler gravity examples/gravity-flight.toml --runs 20 medians over twenty seeds\n"
        "  schuler gravity examples/gravity-variable.toml --response  amplitude and phase of the estimator\n"
        "  schuler gravity flight/ --set gravity.length_m=8000    recorded logs\n"
        "  schuler gravity lab/ --config step.toml                with an [[anomaly]] injected into the accelerometers\n"
        "Writes gravity.csv and gravity.geojson besides the files of `process`. For a log that is not accurate enough it states\n"
        "what is attainable instead. `schuler help settings gravity.` and `schuler help scenario anomaly` list keys.",
        std::move(t), "summary.json on standard output instead of the tables", true, perform));
}

}  // namespace schuler::app
