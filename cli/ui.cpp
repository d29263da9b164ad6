// The command `ui`: the program behind a page.
#include "parser.h"

#include "schuler/core/error.h"
#include "serve/server.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <thread>

namespace schuler::cli {
namespace {

constexpr int usual_port = 8642;

std::filesystem::path own_path() {
    std::error_code ec;
    const auto path = std::filesystem::read_symlink("/proc/self/exe", ec);
    if (ec) throw computation_error("the program does not find itself: /proc/self/exe cannot be read");
    return path;
}

}  // namespace

void add_ui_command(CLI::App& parser, CommandLine& o) {
    CLI::App* ui =
        add_command(parser, o, "ui", "the program as a page in a browser: logs, scenarios, runs, plots, comparison",
                    "  schuler ui                                  then open the address that it prints\n"
                    "  schuler ui --open drive/                    with the logs of a folder\n"
                    "  schuler ui --live tcp://vehicle:5010        with the navigation of a running `schuler live`\n"
                    "  schuler ui --workspace /data/work --port 9000\n"
                    "  schuler ui --host 0.0.0.0                   for other machines too: the address then carries a token\n"
                    "Runs are kept as folders of the workspace; nothing outside it is written, and beside it only the folder of "
                    "--open is read.\n"
                    "/api/openapi.json documents the interface that the page uses.");
    ui->add_option("--port", o.port, fmt::format("default {}, or another where that is taken; 0: any", usual_port))
        ->check(CLI::Range(0, 65535))
        ->type_name("P");
    ui->add_option("--host", o.host, "address to listen at, default 127.0.0.1: this machine only")->type_name("ADDRESS");
    ui->add_option("--open", o.open, "folder of a data set to offer on the page")->type_name("DIR");
    ui->add_option("--live", o.live, "an output of a running `schuler live`, tcp://HOST:PORT, shown as it arrives")
        ->type_name("ADDRESS");
    ui->add_option("--tiles", o.tiles, "folder of map tiles, ZOOM/X/Y.png, as the background of tracks")
        ->check(CLI::ExistingDirectory)
        ->type_name("DIR");
    ui->add_option("--workspace", o.workspace, "folder of runs and uploads, default out")->type_name("DIR");
    ui->add_option("--max-upload", o.max_upload_mb, "largest file that is taken, default 2048")
        ->check(CLI::Range(1, 1 << 20))
        ->type_name("MB");
}

void serve_page(const CommandLine& o) {
    // Blocked before any thread starts, so that a single thread waits for these signals.
    sigset_t ending;
    sigemptyset(&ending);
    sigaddset(&ending, SIGINT);
    sigaddset(&ending, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &ending, nullptr);
    signal(SIGPIPE, SIG_IGN);

    serve::ServerSettings settings;
    settings.service.workspace = o.workspace;
    settings.service.opened = o.open;
    settings.service.tiles = o.tiles;
    settings.service.live = serve::live_address(o.live);
    settings.service.program = own_path();
    settings.service.version = SCHULER_VERSION;
    settings.service.max_upload = static_cast<std::uintmax_t>(o.max_upload_mb) << 20;
    settings.address = o.host == "localhost" ? "127.0.0.1" : o.host;
    settings.port = o.port.value_or(usual_port);
    settings.port_is_wish = !o.port;
    serve::Server server(std::move(settings));
    fmt::print("Schuler is at {}\n", server.url());
    std::fflush(stdout);
    std::thread waiter([&] {
        int caught = 0;
        sigwait(&ending, &caught);
        server.stop();
    });
    const bool served = server.serve();
    kill(getpid(), SIGTERM);  // wakes the waiting thread if serving ended by itself; otherwise blocked, and lost at exit
    waiter.join();
    if (!served) throw computation_error("the server could not listen");
}

}  // namespace schuler::cli
