// The program `schuler`: command line, output streams, exit status.
#include "documentation.h"
#include "parser.h"
#include "printable.h"
#include "progress.h"
#include "team.h"
#include "version.h"

#include "schuler/app/command.h"
#include "schuler/app/commands.h"
#include "schuler/app/formats_command.h"
#include "schuler/app/large_runs.h"
#include "schuler/core/error.h"
#include "serve/aside.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
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
    return cli::printable(text);
}

void complain(const std::string& text) { fmt::print(stderr, "schuler: {}\n", one_line(text)); }

/// What the command was to read, and how to need less memory.
struct Asked {
    std::string input, less;
};

Asked asked_of(const cli::CommandLine& line) {
    const app::Command* command = app::command_named(line.command);
    const auto given = line.given.find(line.command);
    if (command == nullptr || given == line.given.end()) return {};
    Asked out;
    const auto has = [&](const char* key) {
        return std::ranges::find(command->options, key, &settings::OptionSpec::key) != command->options.end();
    };
    for (const settings::OptionSpec& spec : command->options) {
        if (!spec.line.positional || !out.input.empty()) continue;
        if (const auto word = given->second.word.find(spec.key); word != given->second.word.end()) out.input = word->second;
        const auto words = given->second.words.find(spec.key);
        if (words != given->second.words.end() && !words->second.empty())
            out.input = fmt::format("{}", fmt::join(words->second, ", "));
    }
    out.less = has("scenario")               ? "simulate a shorter time, or at lower rates"
               : has("start") && has("stop") ? "process a part of the data with --start and --stop"
                                             : "give a part of the data";
    return out;
}

/// Displays the outcome of a command: the result on standard output, everything else on standard error.
void show(const report::Outcome& out, const cli::CommandLine& line) {
    if (!line.quiet) {
        if (!out.notice.empty())
            fmt::print(stderr, "no dataset.toml: this one was inferred and used\n\n{}\n", cli::printable(out.notice));
        for (const std::string& w : out.warnings) fmt::print(stderr, "warning: {}\n", one_line(w));
    }
    if (!out.usable && (line.json || line.quiet)) complain(out.verdict);
    if (line.json) {
        fmt::print("{}", out.json);
        return;
    }
    if (line.quiet) return;
    fmt::print("{}", cli::printable(out.tables));
    const bool several = out.files.size() > 1;
    std::string report;
    for (const auto& file : out.files) {
        if (file.filename() == "report.html" && several) {
            report = file.string();
        } else {
            fmt::print("wrote {}\n", cli::printable(file.string()));
        }
    }
    if (!report.empty()) fmt::print("the report is {}\n", cli::printable(report));
    if (out.files.empty() && !out.folder.empty()) fmt::print("wrote {}\n", cli::printable(out.folder.string()));
    if (!out.verdict.empty()) fmt::print("{}\n", one_line(out.verdict));
}

report::Outcome perform(const cli::CommandLine& line, const CLI::App& parser, const std::shared_ptr<Team>& team) {
    if (const app::Command* command = app::command_named(line.command)) {
        cli::ProgressBar bar(!line.quiet && (!team || team->rank() == 0), line.progress == "lines");
        const app::CommandContext context{.version = SCHULER_VERSION,
                                          .progress = [&bar](double done_part) { bar.show(done_part); },
                                          .stage = [&bar](std::string_view what) { bar.stage(what); },
                                          .threads = line.threads,
                                          .team = team};
        const auto given = cli::settings_of(*command, line, parser);
        if (line.force) app::allow_overwrite(given);
        if (const std::string size = line.quiet ? "" : app::notice_of_size(given); !size.empty())
            fmt::print(stderr, "schuler: {}\n", size);
        return command->perform(given, context);
    }
    report::Outcome help;
    if (line.topic == "formats") {
        help.tables = app::formats_help();
        return help;
    }
    help.tables = line.topic == "scenario" ? app::scenario_help(line.prefix) : app::settings_help(line.prefix);
    if (help.tables.empty())
        throw input_error(fmt::format("no key begins with \"{}\"", line.prefix), {}, "leave it out to list all keys");
    return help;
}

/// Standard output may be a closed pipe or a full disk: a missing result must be reflected in the exit status.
int flushed(int status) {
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
        complain("standard output cannot be written");
        return status == done ? computation_failed : status;
    }
    return status;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc > 1 && argv[1] == serve::aside_word) return serve::aside(argc - 2, argv + 2);  // a child of `schuler ui`
    cli::CommandLine line;
    CLI::App parser("Integrated inertial-satellite navigation: from IMU and GNSS logs to a trajectory with honest uncertainty.",
                    "schuler");
    cli::add_commands(parser, line);
    if (const std::string unknown = cli::unknown_topic(argc, argv, parser); !unknown.empty()) {
        complain(unknown + "; see `schuler --help`");
        return input_unusable;
    }
    try {
        auto arguments = cli::with_help_of_commands({argv + 1, argv + argc}, parser);
        std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them in reverse order
        parser.parse(std::move(arguments));
    } catch (const CLI::CallForVersion&) {
        fmt::print("{}\n", cli::version_line());
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
    const Asked asked = asked_of(line);  // before memory is short
    std::shared_ptr<Team> team;
    const auto failed = [&team](int status) {
        if (team) cli::end_team(*team, status);
        return status;
    };
    try {
        team = cli::team_of_processes();
        if (line.command == "ui") {
            cli::serve_page(line);
            return flushed(done);
        }
        if (line.command == "completion") {
            fmt::print("{}", cli::completion_script(parser, line.topic));
            return flushed(done);
        }
        if (line.command == "help" && line.reference) {
            fmt::print("{}", app::option_reference());
            return flushed(done);
        }
        if (line.command == "help" && line.topic.empty()) {
            fmt::print("{}", line.manual ? cli::manual_page(parser, SCHULER_VERSION)
                                         : parser.get_formatter()->make_help(&parser, "schuler", CLI::AppFormatMode::Normal));
            return flushed(done);
        }
        const report::Outcome out = perform(line, parser, team);
        if (!team || team->rank() == 0) show(out, line);
        return flushed(out.usable ? done : computation_failed);
    } catch (const Error& e) {
        cli::let_the_first_tell(team.get());
        const bool of_option = e.place().file.starts_with("--");
        complain(of_option ? fmt::format("{}; see `schuler {} --help`", e.what(), line.command) : std::string(e.what()));
        return failed(e.kind() == ErrorKind::Input ? input_unusable : computation_failed);
    } catch (const std::bad_alloc&) {
        complain(fmt::format("{}out of memory; {}", asked.input.empty() ? "" : asked.input + ": ", asked.less));
    } catch (const std::exception& e) {
        complain(fmt::format("unexpected failure: {}", e.what()));
    } catch (...) {
        complain("unexpected failure");
    }
    return failed(computation_failed);
}
