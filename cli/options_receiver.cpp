// The command `receiver`.
#include "options.h"

#include <CLI/CLI.hpp>

namespace schuler::cli {

namespace {

/// Of the recording, read or written.
CLI::Option* add_sampling(CLI::App& app, double& sample_rate, double& intermediate_frequency) {
    app.add_option("--intermediate-frequency", intermediate_frequency, "of the carrier without Doppler, default 0")
        ->type_name("HZ");
    return app.add_option("--sample-rate", sample_rate, "complex samples a second")->type_name("HZ");
}

void add_generate(CLI::App& receiver, Options& o, const AddCommand& add_command) {
    CLI::App* app = add_command(receiver, "generate", "write a recording of GPS L1 C/A signals in noise",
                                "  schuler receiver generate sky.ibyte                     six satellites, 5 s at 4 MHz\n"
                                "  schuler receiver generate one.ibyte --satellites G07:45:1200:300.5 --seconds 10\n"
                                "  schuler receiver generate if.ibyte --sample-rate 8e6 --intermediate-frequency 2e6 --seed 3\n"
                                "Writes signed bytes, I and Q in turn, without a header: what gnss-sdr calls ibyte.");
    app::GenerateRequest& r = o.generate;
    app->add_option("FILE", o.output, "file to write")->required();
    app->add_option("--seconds", r.seconds, "length, default 5")->type_name("S");
    add_sampling(*app, r.sample_rate, r.intermediate_frequency)->description("complex samples a second, default 4e6");
    app->add_option("--satellites", r.satellites, "number, C/N0 in dB-Hz, Doppler in Hz, code delay in chips at the first sample")
        ->delimiter(',')
        ->type_name("G07:45:1200:300.5[,...]");
    app->add_option("--seed", o.seed, "of noise and messages, default 1")->type_name("N");
    add_json(*app, o);
}

void add_track(CLI::App& receiver, Options& o, const AddCommand& add_command) {
    CLI::App* app = add_command(
        receiver, "track", "find the satellites of a recording and track them",
        "  schuler receiver track sky.ibyte --sample-rate 4e6\n"
        "  schuler receiver track rtl.bin --sample-rate 2.048e6 --format ubyte --doppler 50000      a receiver with a poor "
        "oscillator\n"
        "  schuler receiver track if.dat --sample-rate 16.3676e6 --intermediate-frequency 4.1304e6 --format ishort --seconds 30\n"
        "  schuler receiver track weak.ibyte --sample-rate 4e6 --search-ms 100 --satellites G03,G22 --json\n"
        "Writes tracking.csv, summary.json and report.html. Exit status 1 where no satellite is found.");
    app::TrackRequest& r = o.track;
    app->add_option("FILE", o.input, "recording: complex samples without a header")->required();
    add_sampling(*app, r.sample_rate, r.intermediate_frequency)->required();
    app->add_option("--format", r.format,
                    "ibyte (default), ubyte, ishort or gr_complex: signed or unsigned bytes, 16-bit words, floats")
        ->type_name("FORMAT");
    app->add_option("--start", r.start, "leave out what is before, default 0")->type_name("S");
    app->add_option("--seconds", r.seconds, "so much of it, default all")->type_name("S");
    app->add_option("--satellites", r.satellites, "look for these only, default G01 to G32")
        ->delimiter(',')
        ->type_name("G07[,...]");
    app->add_option("--doppler", r.doppler, "half width of the search, default 5000")->type_name("HZ");
    app->add_option("--search-ms", r.search_ms,
                    "samples that a search sums, default 10; ten times as many find 5 dB weaker signals")
        ->type_name("MS");
    add_output(*app, o);
    add_json(*app, o, "summary.json on standard output instead of the table");
}

}  // namespace

void add_receiver_command(CLI::App& parser, Options& o, const AddCommand& add_command) {
    CLI::App* receiver =
        add_command(parser, "receiver", "recordings of satellite signals: make one, find and track its satellites",
                    "  schuler receiver generate sky.ibyte\n  schuler receiver track sky.ibyte --sample-rate 4e6\n"
                    "`schuler receiver generate --help` and `track --help` tell the options.");
    receiver->require_subcommand(1);
    add_generate(*receiver, o, add_command);
    add_track(*receiver, o, add_command);
}

}  // namespace schuler::cli
