// The program `schuler`: command line, what goes to which stream, exit status.
#include "documentation.h"
#include "options.h"
#include "progress.h"

#include "schuler/app/attitude/ahrs.h"
#include "schuler/app/commands.h"
#include "schuler/core/error.h"
#include "schuler/report/outcome.h"
#include "schuler/settings/request.h"
#include "schuler/study/allan.h"
#include "schuler/study/gravity/gravity.h"
#include "schuler/study/montecarlo/montecarlo.h"
#include "schuler/study/theory/analyze.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace schuler;

constexpr int done = 0, computation_failed = 1, input_unusable = 2;

std::string one_line(std::string text) {
    for (char& c : text) {
        if (c == '\n' || c == '\r') c = ' ';
    }
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

void complain(const std::string& text) { fmt::print(stderr, "schuler: {}\n", one_line(text)); }

/// Shows what a command has done: the result on standard output, everything else on standard error.
void show(const report::Outcome& out, const cli::Options& options) {
    if (!options.quiet) {
        if (!out.notice.empty()) fmt::print(stderr, "no dataset.toml: this one was inferred and used\n\n{}\n", out.notice);
        for (const std::string& w : out.warnings) fmt::print(stderr, "warning: {}\n", one_line(w));
    }
    if (!out.usable && (options.json || options.quiet)) complain(out.verdict);
    if (options.json) {
        fmt::print("{}", out.json);
        return;
    }
    if (options.quiet) return;
    fmt::print("{}", out.tables);
    const bool several = out.files.size() > 1;
    std::string report;
    for (const auto& file : out.files) {
        if (file.filename() == "report.html" && several) {
            report = file.string();
        } else {
            fmt::print("wrote {}\n", file.string());
        }
    }
    if (!report.empty()) fmt::print("the report is {}\n", report);
    if (out.files.empty() && !out.folder.empty()) fmt::print("wrote {}\n", out.folder.string());
    if (!out.verdict.empty()) fmt::print("{}\n", one_line(out.verdict));
}

report::Outcome analyze(const cli::Options& o) {
    if (o.command == "analyze observability") return study::analyze_observability(o.observability);
    if (o.command == "analyze schuler") {
        study::SchulerRequest request = o.schuler;
        request.output = o.output;
        request.version = SCHULER_VERSION;
        return study::analyze_schuler(request);
    }
    if (o.command == "analyze requirements") return study::analyze_requirements(o.requirements);
    if (o.command == "analyze budget" || o.command == "analyze integrity") {
        study::StudyRequest request = o.study;
        request.scenario = o.input;
        request.seed = o.seed;
        request.above = cli::settings_of(o);
        cli::ProgressBar bar(!o.quiet, o.progress == "lines");
        request.progress = [&bar](double done_part) { bar.show(done_part); };
        return o.command == "analyze budget" ? study::analyze_budget(request) : study::analyze_integrity(request);
    }
    if (o.command == "analyze triad") {
        study::TriadRequest request = o.triad;
        request.seed = o.seed.value_or(request.seed);
        request.output = o.output;
        request.version = SCHULER_VERSION;
        cli::ProgressBar bar(!o.quiet, o.progress == "lines");
        request.progress = [&bar](double done_part) { bar.show(done_part); };
        return study::analyze_triad(request);
    }
    if (o.command == "analyze protection") {
        study::ProtectionRequest request = o.protection;
        request.seed = o.seed.value_or(request.seed);
        request.output = o.output;
        cli::ProgressBar bar(!o.quiet, o.progress == "lines");
        request.progress = [&bar](double done_part) { bar.show(done_part); };
        return study::analyze_protection(request);
    }
    study::EquatorRequest request = o.equator;
    if (o.misalignment.size() == 3) request.misalignment = Eigen::Vector3d::Map(o.misalignment.data());
    request.output = o.output;
    request.version = SCHULER_VERSION;
    return study::analyze_equator(request);
}

report::Outcome receive(const cli::Options& o) {
    cli::ProgressBar bar(!o.quiet, o.progress == "lines");
    const auto progress = [&bar](double done_part) { bar.show(done_part); };
    if (o.command == "receiver generate") {
        app::GenerateRequest request = o.generate;
        request.file = o.output;
        request.seed = o.seed.value_or(request.seed);
        request.progress = progress;
        return app::generate_recording(request);
    }
    app::TrackRequest request = o.track;
    request.file = o.input;
    request.output = o.output;
    request.version = SCHULER_VERSION;
    request.progress = progress;
    return app::track_recording(request);
}

report::Outcome perform(const cli::Options& o) {
    if (o.command.starts_with("receiver")) return receive(o);
    if (o.command.starts_with("analyze") && o.command != "analyze allan") return analyze(o);
    settings::ProcessRequest request;
    request.input = o.input;
    request.output = o.output;
    request.config = o.config;
    request.seed = o.seed;
    request.version = SCHULER_VERSION;
    request.above = cli::settings_of(o);
    cli::ProgressBar bar(!o.quiet, o.progress == "lines");
    request.progress = [&bar](double done_part) { bar.show(done_part); };
    if (o.command == "analyze allan") return study::analyze_allan(request);
    if (o.command == "process") return app::process_dataset(request);
    if (o.command == "gravity" && o.response) return study::gravity_response({request, 1});
    if (o.command == "gravity" && o.runs.value_or(1) > 1) return study::gravity_campaign({request, static_cast<int>(*o.runs)});
    if (o.command == "gravity") return study::gravity_command({request, 1});
    if (o.command == "ahrs") return app::ahrs_dataset({request, o.filter, o.six_axis, o.offline, o.calibrate});
    if (o.command == "run") return app::run_scenario(request);
    if (o.command == "montecarlo") return study::run_montecarlo(request, o.runs, o.jobs > 0 ? o.jobs : o.threads);
    if (o.command == "demo") return app::run_demonstration(request);
    if (o.command == "simulate") return app::simulate_to_folder(o.input, o.output, o.seed);
    if (o.command == "evaluate") return app::evaluate_files(o.input, o.second, o.settle.value_or(0.0));
    if (o.command == "inspect") return app::inspect_path(o.input);
    if (o.command == "convert") return app::convert_file(o.input, o.output, o.format);
    report::Outcome help;
    help.tables = o.topic == "scenario" ? app::scenario_help(o.prefix) : app::settings_help(o.prefix);
    if (help.tables.empty())
        throw input_error(fmt::format("no key begins with \"{}\"", o.prefix), {}, "leave it out to list all keys");
    return help;
}

/// Standard output may be a closed pipe or a full disk: the result is not there, so the status says so.
int flushed(int status) {
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
        complain("standard output cannot be written");
        return status == done ? computation_failed : status;
    }
    return status;
}

}  // namespace

int main(int argc, char** argv) {
    cli::Options options;
    CLI::App parser("Integrated inertial-satellite navigation: from IMU and GNSS logs to a trajectory with honest uncertainty.",
                    "schuler");
    cli::add_commands(parser, options);
    try {
        auto arguments = cli::with_help_of_commands({argv + 1, argv + argc}, parser);
        std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the end
        parser.parse(std::move(arguments));
    } catch (const CLI::CallForVersion&) {
        fmt::print("schuler {}\n", SCHULER_VERSION);
        return flushed(done);
    } catch (const CLI::CallForHelp& e) {
        parser.exit(e);
        return flushed(done);
    } catch (const CLI::CallForAllHelp& e) {
        parser.exit(e);
        return flushed(done);
    } catch (const CLI::ParseError& e) {
        if (const std::string unknown = cli::unknown_command(argc, argv, parser); !unknown.empty()) {
            complain(unknown + "; see `schuler --help`");
            return input_unusable;
        }
        complain(fmt::format("{}; see `schuler{} --help`", one_line(e.what()), cli::command_in(argc, argv, parser)));
        return input_unusable;
    }
    try {
        if (options.command == "ui") {
            cli::serve_page(options);
            return flushed(done);
        }
        if (options.command == "completion") {
            fmt::print("{}", cli::completion_script(parser, options.topic));
            return flushed(done);
        }
        if (options.command == "help" && options.topic.empty()) {
            fmt::print("{}", options.manual ? cli::manual_page(parser, SCHULER_VERSION)
                                            : parser.get_formatter()->make_help(&parser, "schuler", CLI::AppFormatMode::Normal));
            return flushed(done);
        }
        const report::Outcome out = perform(options);
        show(out, options);
        return flushed(out.usable ? done : computation_failed);
    } catch (const Error& e) {
        complain(e.what());
        return e.kind() == ErrorKind::Input ? input_unusable : computation_failed;
    } catch (const std::bad_alloc&) {
        complain("out of memory; process a part of the data with --start and --stop");
    } catch (const std::exception& e) {
        complain(fmt::format("unexpected failure: {}", e.what()));
    } catch (...) {
        complain("unexpected failure");
    }
    return computation_failed;
}
