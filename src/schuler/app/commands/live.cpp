// Commands that process samples as they arrive.
#include "schuler/app/live.h"
#include "schuler/app/commands/builders.h"

namespace schuler::app {

void add_live_commands(std::vector<Command>& list) {
    using L = LiveRequest;
    OptionTable<L> t;
    t.add(argument("CONFIG", path<L>("config", "TOML file: the settings of dataset.toml, sources and outputs",
                                     [](auto& r) -> auto& { return r.config; })))
        .add(set_option<L>([](auto& r) -> auto& { return r.above; }));
    list.push_back(command<L>(
        "live", "navigate in real time: samples from serial ports, sockets or pipes, solutions as messages",
        "  schuler live examples/live/car.toml\n  schuler replay drive/ --to stdout | schuler live examples/live/pipe.toml\n"
        "Runs until it is interrupted (Ctrl-C, SIGTERM) or all sources have ended. docs/live.md has sources, outputs and messages.",
        std::move(t), "", false, run_live_config));
    using R = ReplayDatasetRequest;
    OptionTable<R> u;
    constexpr CommonRequest common;
    u.add(argument("DATASET",
                   path<R>("dataset", "folder, dataset.toml, or a log", [=](auto& r) -> auto& { return common(r).input; })))
        .add(required(written("PLACE", settings::text<R>("to", "tcp://HOST:PORT, tcp-listen://:PORT, udp://HOST:PORT or stdout",
                                                         [](auto& r) -> auto& { return r.to; }))))
        .add(settings::number<R>("speed", 1.0, 0, 1e6, "speed relative to real time; 0: as fast as the client accepts",
                                 [](auto& r) -> auto& { return r.speed; }));
    add_settings(u);
    list.push_back(command<R>(
        "replay", "send the samples of a data set as they would arrive, lines of JSON, to `schuler live` or any other client",
        "  schuler replay drive/ --to tcp://localhost:5001                in real time\n"
        "  schuler replay drive/ --to tcp-listen://:5001 --speed 100     a hundred times as fast, to the client that connects\n"
        "  schuler replay drive/ --to stdout --speed 0 | head",
        std::move(u), "", true, replay_dataset));
}

}  // namespace schuler::app
