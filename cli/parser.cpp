#include "parser.h"
#include "version.h"

#include "schuler/core/error.h"
#include "schuler/settings/command_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace schuler::cli {
namespace {

using settings::OptionSpec;
using settings::Shape;

std::string names_of(const OptionSpec& spec) {
    if (spec.line.positional) return spec.line.value_name;
    return spec.line.letter != 0 ? fmt::format("-{},--{}", spec.line.letter, spec.key) : "--" + spec.key;
}

constexpr std::array<const char*, 3> help_topics{"settings", "scenario", "formats"};

bool is_list(const OptionSpec& spec) { return spec.shape == Shape::Numbers || spec.shape == Shape::Texts; }

void add_option(CLI::App& app, const OptionSpec& spec, const settings::SettingList& defaults, Given& given) {
    const std::string help = settings::help_of(spec, defaults), names = names_of(spec);
    if (spec.shape == Shape::Flag) {
        app.add_flag(names, given.flag[spec.key], help);
        return;
    }
    CLI::Option* option =
        is_list(spec) ? app.add_option(names, given.words[spec.key], help) : app.add_option(names, given.word[spec.key], help);
    if (!spec.line.positional) option->type_name(settings::value_name_of(spec));
    if (is_list(spec) && spec.length > 0) {
        option->expected(static_cast<int>(spec.length));
    } else if (spec.line.repeated && !spec.line.positional) {
        option->allow_extra_args(false);
    }
    if (!spec.choices.empty())  // for help and completion; invalid words are rejected by the table itself
        option->check(
            CLI::Validator([](std::string&) { return std::string(); }, fmt::format("{{{}}}", fmt::join(spec.choices, ","))));
    if (spec.line.required) option->required();
    if (spec.line.hidden) option->group("");
}

void add_listed(CLI::App& parser, CommandLine& line, const app::Command& command) {
    const auto space = command.name.rfind(' ');
    CLI::App* parent = space == std::string::npos ? &parser : parser.get_subcommand(command.name.substr(0, space));
    CLI::App* app = add_command(*parent, line, space == std::string::npos ? command.name : command.name.substr(space + 1),
                                command.purpose, command.examples);
    if (!command.perform) {
        app->require_subcommand(1);
        return;
    }
    Given& given = line.given[command.name];
    for (const OptionSpec& spec : command.options) {
        add_option(*app, spec, command.defaults, given);
        // `--set a=1 b=2`: words after the first pair arrive as arguments without an option
        if (spec.key == "set") app->add_option("more_settings", given.loose)->group("");
    }
    if (!command.json.empty()) app->add_flag("--json", line.json, command.json);
    if (command.runs)
        app->add_option("--progress", line.progress,
                        "lines: \"progress 0.5\" and \"stage reading\" on standard error, for programs")
            ->check(CLI::IsMember({"lines"}))
            ->type_name("FORM");
}

void add_own(CLI::App& parser, CommandLine& line) {
    CLI::App* help = add_command(parser, line, "help", "a command, or the keys of settings and scenario files",
                                 "  schuler help process\n  schuler help settings\n  schuler help settings imu.\n"
                                 "  schuler help scenario trajectory.\n  schuler help --man >schuler.1");
    help->add_option("TOPIC", line.topic, "settings, scenario or formats, or a command")
        ->check(CLI::IsMember(std::vector<std::string>(help_topics.begin(), help_topics.end())));
    help->add_option("PREFIX", line.prefix, "only keys that begin so");
    help->add_flag("--man", line.manual, "all commands as a manual page");
    help->add_flag("--reference", line.reference,
                   "all options of commands, settings and scenarios as a document (docs/options.md)");

    CLI::App* completion = add_command(parser, line, "completion", "a script that completes commands and options in a shell",
                                       "  source <(schuler completion bash)\n"
                                       "  schuler completion zsh >~/.zsh/functions/_schuler            a folder of $fpath");
    completion->add_option("SHELL", line.topic, "bash or zsh")->required()->check(CLI::IsMember({"bash", "zsh"}));
}

std::string not_known(const std::string& word, const std::string& what, const std::vector<std::string>& known) {
    const std::string near = settings::nearest_key(word, known);
    return fmt::format("\"{}\" is not {}{}", word, what, near.empty() ? "" : fmt::format("; did you mean {}?", near));
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
    return app.get_subcommands([](const CLI::App*) { return true; });
}

void add_everywhere(CLI::App& app, CommandLine& line) {
    app.add_flag("-q,--quiet", line.quiet, "no table, no progress bar, no warnings; errors only");
    app.add_flag("--force", line.force,
                 "overwrite files at the place of the results even if another program wrote or changed them");
    app.add_option("--threads", line.threads, "number of threads; results do not depend on it")
        ->check(CLI::Range(0, 1024))
        ->type_name("N");
    app.set_version_flag("--version", version_line(), "print the version and the commit");
}

}  // namespace

CLI::App* add_command(CLI::App& parent, CommandLine& line, const std::string& name, const std::string& purpose,
                      const std::string& examples) {
    CLI::App* app = parent.add_subcommand(name, purpose);
    const std::string command = parent.get_parent() == nullptr ? name : parent.get_name() + " " + name;
    app->callback([&line, command] {
        if (line.command.empty()) line.command = command;  // a study's callback runs before that of `analyze`
    });
    app->footer("Examples:\n" + examples);
    add_everywhere(*app, line);
    return app;
}

void add_commands(CLI::App& parser, CommandLine& line) {
    add_everywhere(parser, line);
    parser.require_subcommand(1);
    parser.footer(
        "Examples:\n  schuler demo\n  schuler inspect drive/\n  schuler process drive/ --smooth\n  schuler evaluate "
        "out/drive/solution.csv truth.csv\n"
        "`schuler COMMAND --help` or `schuler help COMMAND` lists the options of a command.\n"
        "Inputs are files and folders, not pipes; samples as they arrive are read by `schuler live`.\n"
        "Exit status: 0 done, 1 the computation failed, 2 the input or the command line is unusable.");
    for (const app::Command& command : app::commands()) add_listed(parser, line, command);
    add_own(parser, line);
    add_ui_command(parser, line);
}

settings::SettingList settings_of(const app::Command& command, const CommandLine& line, const CLI::App& parser) {
    const CLI::App* app = &parser;
    for (std::size_t begin = 0; begin <= command.name.size();) {
        const std::size_t end = std::min(command.name.find(' ', begin), command.name.size());
        app = app->get_subcommand(command.name.substr(begin, end - begin));
        begin = end + 1;
    }
    const Given& given = line.given.at(command.name);
    settings::SettingList out;
    for (const OptionSpec& spec : command.options) {
        const std::string name = spec.line.positional ? spec.line.value_name : "--" + spec.key;
        if (app->count(name) == 0) continue;
        const SourcePlace place{name, 0, 0, {}};
        if (spec.shape == Shape::Flag) {
            if (given.flag.at(spec.key)) out.push_back({spec.key, {true}, place});
            continue;
        }
        std::vector<std::string> words =
            is_list(spec) ? given.words.at(spec.key) : std::vector<std::string>{given.word.at(spec.key)};
        if (spec.line.file && std::ranges::find(words, "-") != words.end())  // files are read more than once, and written beside
            throw input_error(
                "\"-\" is no file: neither is standard input read nor standard output written to", place,
                "copy what a pipe delivers into a file and name that; samples as they arrive are read by `schuler live`");
        if (spec.key == "set") words.insert(words.end(), given.loose.begin(), given.loose.end());
        out.push_back({spec.key, settings::value_from_words(spec, words), place});
    }
    const bool settings_given = std::ranges::any_of(out, [](const settings::Setting& s) { return s.key == "set"; });
    for (const std::string& text : given.loose)
        if (!settings_given || text.find('=') == std::string::npos)
            throw input_error(fmt::format("unexpected argument \"{}\"", text), {},
                              fmt::format("see `schuler {} --help`", command.name));
    return out;
}

std::string command_in(int argc, char** argv, const CLI::App& parser) {
    for (int i = 1; i < argc; ++i) {
        for (const CLI::App* command : commands_of(parser)) {
            if (command->get_name() != argv[i]) continue;
            std::string names = " " + command->get_name();
            for (const CLI::App* study : commands_of(*command))
                if (i + 1 < argc && study->get_name() == argv[i + 1]) names += " " + study->get_name();
            return names;
        }
    }
    return {};
}

std::string unknown_command(int argc, char** argv, const CLI::App& parser) {
    if (argc < 2 || argv[1][0] == '-' || !command_in(argc, argv, parser).empty()) return {};
    std::vector<std::string> known;
    for (const CLI::App* command : commands_of(parser)) known.push_back(command->get_name());
    return not_known(argv[1], "a command", known);
}

std::string unknown_topic(int argc, char** argv, const CLI::App& parser) {
    if (argc < 3 || std::string_view(argv[1]) != "help" || argv[2][0] == '-') return {};
    std::vector<std::string> known;
    for (const CLI::App* command : commands_of(parser)) {
        known.push_back(command->get_name());
        if (command->get_name() != argv[2]) continue;
        std::vector<std::string> studies;
        for (const CLI::App* study : commands_of(*command)) studies.push_back(study->get_name());
        if (argc < 4 || studies.empty() || std::ranges::find(studies, argv[3]) != studies.end()) return {};
        return not_known(argv[3], fmt::format("a command of {}", argv[2]), studies);
    }
    for (const char* topic : help_topics) known.emplace_back(topic);
    if (std::ranges::find(known, argv[2]) != known.end()) return {};
    return not_known(argv[2], "a command or a topic of help", known);
}

}  // namespace schuler::cli
