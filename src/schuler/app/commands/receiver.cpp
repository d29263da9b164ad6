// `schuler receiver`.
#include "schuler/app/commands/builders.h"
#include "schuler/app/receiver/if_recording.h"

namespace schuler::app {
namespace {

/// The limits of receiver::IfFormat; the limit of the carrier also depends on the sample rate and is checked there.
template <class R>
Option<R> sample_rate() {
    return in_units("Hz", settings::number<R>("sample-rate", 1.0, 2.046e6, 200e6, "complex samples per second",
                                              [](auto& r) -> auto& { return r.sample_rate; }));
}
template <class R>
Option<R> intermediate_frequency() {
    return in_units("Hz", settings::number<R>("intermediate-frequency", 1.0, -100e6, 100e6,
                                              "intermediate frequency of a carrier without Doppler",
                                              [](auto& r) -> auto& { return r.intermediate_frequency; }));
}

Command generate() {
    using R = GenerateRequest;
    OptionTable<R> t;
    t.add(argument("FILE", path<R>("file", "file to write", [](auto& r) -> auto& { return r.file; })))
        .add(in_units("s", settings::number<R>("seconds", 1.0, 1e-3, 3600, "length of the recording",
                                               [](auto& r) -> auto& { return r.seconds; })))
        .add(intermediate_frequency<R>())
        .add(sample_rate<R>())
        .add(written(
            "G07:45:1200:300.5[,...]",
            otherwise("six satellites",
                      words<R>("satellites", "number, C/N0 in dB-Hz, Doppler in Hz, code delay in chips at the first sample",
                               [](auto& r) -> auto& { return r.satellites; }))))
        .add(seed_option<R>("seed of the noise and of the messages", [](auto& r) -> auto& { return r.seed; }));
    return command<R>("receiver generate", "write a recording of GPS L1 C/A signals in noise",
                      "  schuler receiver generate sky.ibyte                     six satellites, 5 s at 4 MHz\n"
                      "  schuler receiver generate one.ibyte --satellites G07:45:1200:300.5 --seconds 10\n"
                      "  schuler receiver generate if.ibyte --sample-rate 8e6 --intermediate-frequency 2e6 --seed 3\n"
                      "Writes signed bytes, I and Q in turn, without a header: what gnss-sdr calls ibyte.",
                      std::move(t), one_json_document, true, generate_recording);
}

Command track() {
    using R = TrackRequest;
    OptionTable<R> t;
    t.add(of_role(settings::FileRole::Recording, argument("FILE", path<R>("file", "recording: complex samples without a header",
                                                                          [](auto& r) -> auto& { return r.file; }))))
        .add(intermediate_frequency<R>())
        .add(required(sample_rate<R>()))
        .add(written("FORMAT", one_of<R>("format", {"ibyte", "ubyte", "ishort", "gr_complex"},
                                         "sample format: signed bytes, unsigned bytes, 16-bit words or floats; I and Q in turn",
                                         [](auto& r) -> auto& { return r.format; })))
        .add(in_units("s", settings::number<R>("start", 1.0, 0, 1e9, "start of the part that is processed",
                                               [](auto& r) -> auto& { return r.start; })))
        .add(in_units("s", otherwise("all", settings::number<R>("seconds", 1.0, 1e-3, 1e9, "length of the part that is processed",
                                                                [](auto& r) -> auto& { return r.seconds; }))))
        .add(written("G07[,...]", otherwise("G01 to G32", words<R>("satellites", "satellites to search",
                                                                   [](auto& r) -> auto& { return r.satellites; }))))
        .add(in_units("Hz", settings::number<R>("doppler", 1.0, 0, 100e3, "half width of the Doppler search",
                                                [](auto& r) -> auto& { return r.doppler; })))
        .add(in_units("ms", settings::integer<R>("search-ms", 1, 1000,
                                                 "length of the samples summed in a search; ten times the length finds signals "
                                                 "weaker by 5 dB",
                                                 [](auto& r) -> auto& { return r.search_ms; })))
        .add(output_option<R>("folder to write to", "out/NAME", [](auto& r) -> auto& { return r.output; }));
    return command<R>(
        "receiver track", "acquire and track the satellites of a recording",
        "  schuler receiver track sky.ibyte --sample-rate 4e6\n"
        "  schuler receiver track rtl.bin --sample-rate 2.048e6 --format ubyte --doppler 50000      a receiver with a poor "
        "oscillator\n"
        "  schuler receiver track if.dat --sample-rate 16.3676e6 --intermediate-frequency 4.1304e6 --format ishort --seconds 30\n"
        "  schuler receiver track weak.ibyte --sample-rate 4e6 --search-ms 100 --satellites G03,G22 --json\n"
        "Writes tracking.csv, summary.json and report.html. Exit status 1 where no satellite is found.",
        std::move(t), "summary.json on standard output instead of the table", true, track_recording);
}

}  // namespace

void add_receiver_commands(std::vector<Command>& list) {
    list.push_back({.name = "receiver",
                    .purpose = "recordings of satellite signals: make one, find and track its satellites",
                    .examples = "  schuler receiver generate sky.ibyte\n  schuler receiver track sky.ibyte --sample-rate 4e6\n"
                                "`schuler receiver generate --help` and `track --help` list the options."});
    list.push_back(generate());
    list.push_back(track());
}

}  // namespace schuler::app
