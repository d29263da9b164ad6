#include "documentation.h"

#include <fmt/format.h>

#include <algorithm>

namespace schuler::cli {
namespace {

/// A command with its full name ("analyze equator"); empty for the program itself.
struct Command {
    const CLI::App* app;
    std::string words;
};

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
    return app.get_subcommands([](const CLI::App*) { return true; });
}

/// The command of that name; null if there is none.
const CLI::App* command_of(const CLI::App& app, const std::string& name) {
    for (const CLI::App* child : commands_of(app))
        if (child->get_name() == name) return child;
    return nullptr;
}

void gather(const CLI::App& app, const std::string& words, std::vector<Command>& out) {
    out.push_back({&app, words});
    for (const CLI::App* child : commands_of(app))
        gather(*child, words.empty() ? child->get_name() : words + " " + child->get_name(), out);
}

std::vector<Command> all_commands(const CLI::App& parser) {
    std::vector<Command> out;
    gather(parser, "", out);
    return out;
}

/// The options shown by the help.
std::vector<CLI::Option*> options_of(const CLI::App& app) {
    std::vector<CLI::Option*> out;
    for (const CLI::Option* option : app.get_options())
        if (!option->get_group().empty()) out.push_back(const_cast<CLI::Option*>(option));
    return out;
}

std::vector<std::string> names_of(const CLI::Option& option) {
    std::vector<std::string> out;
    for (const std::string& name : option.get_snames()) out.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) out.push_back("--" + name);
    return out;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

/// The permitted words of an option; none if unrestricted. CLI11 provides them only in the validator's description: {a,b,c}.
std::vector<std::string> choices_of(CLI::Option& option) {
    std::string text;
    try {
        text = option.get_validator(0)->get_description();
    } catch (const CLI::OptionNotFound&) {
        return {};
    }
    if (text.size() < 2 || text.front() != '{' || text.back() != '}') return {};
    return CLI::detail::split(text.substr(1, text.size() - 2), ',');
}

std::string joined(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, " ")); }

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    return CLI::detail::find_and_replace(std::move(text), what, by);
}

std::string shell_quoted(const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; }

/// Shell statements that assign the words of the command to `command`. `typed` loops over the words before the one to complete.
std::string command_so_far(const std::vector<Command>& all, const std::string& typed) {
    std::string patterns;
    for (const Command& c : all) {
        if (c.words.empty()) continue;
        const auto space = c.words.rfind(' ');
        const std::string before = space == std::string::npos ? "" : c.words.substr(0, space);
        patterns += fmt::format("{}\"{} {}\"", patterns.empty() ? "" : " | ", before, c.app->get_name());
    }
    return fmt::format(
        "    {}; do\n        case \"$command $typed\" in\n            {}) command=\"${{command:+$command }}$typed\" ;;\n"
        "        esac\n    done\n",
        typed, patterns);
}

/// `case` branches for the values of options: "process --progress" | ... ) TEMPLATE with {} for the words.
template <class Print>
std::string value_branches(const std::vector<Command>& all, const Print& print) {
    std::string out;
    for (const Command& c : all) {
        for (CLI::Option* option : options_of(*c.app)) {
            const auto choices = choices_of(*option);
            const auto names = names_of(*option);
            if (choices.empty() || names.empty()) continue;
            std::string patterns;
            for (const std::string& name : names)
                patterns += fmt::format("{}\"{} {}\"", patterns.empty() ? "" : " | ", c.words, name);
            out += fmt::format("        {}) {} ;;\n", patterns, print(joined(choices)));
        }
    }
    return out;
}

/// The words possible where no option is expected.
std::vector<std::string> positional_words(const CLI::App& app) {
    std::vector<std::string> out;
    for (const CLI::App* child : commands_of(app)) out.push_back(child->get_name());
    for (CLI::Option* option : options_of(app)) {
        if (!option->get_positional()) continue;
        for (const std::string& word : choices_of(*option)) out.push_back(word);
    }
    return out;
}

std::string bash_completion(const std::vector<Command>& all) {
    std::string out =
        "# bash completion of schuler; made by `schuler completion bash`\n_schuler() {\n"
        "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} command= typed words=\n";
    out += command_so_far(all, "for typed in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"");
    out += "    case \"$command $before\" in\n";
    out += value_branches(all, [](const std::string& words) { return fmt::format("words=\"{}\"", words); });
    out += "    esac\n    if [ -z \"$words\" ]; then\n        case \"$command:$word\" in\n";
    for (const Command& c : all) {
        std::string names;
        for (const CLI::Option* option : options_of(*c.app)) names += (names.empty() ? "" : " ") + joined(names_of(*option));
        out += fmt::format("            \"{}:\"-*) words=\"{}\" ;;\n", c.words, names);
        if (const auto words = positional_words(*c.app); !words.empty())
            out += fmt::format("            \"{}:\"*) words=\"{}\" ;;\n", c.words, joined(words));
    }
    out +=
        "        esac\n    fi\n    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n}\n"
        "complete -o default -F _schuler schuler\n";
    return out;
}

std::string described(const std::string& word, const std::string& description) {
    return shell_quoted(replaced(word, ":", "\\:") + ":" + description);
}

std::string zsh_completion(const std::vector<Command>& all) {
    std::string out =
        "#compdef schuler\n# zsh completion of schuler; made by `schuler completion zsh`\n_schuler() {\n"
        "    local command= typed before=${words[CURRENT-1]}\n    local -a found\n";
    out += command_so_far(all, "for typed in \"${(@)words[2,CURRENT-1]}\"");
    out += "    case \"$command $before\" in\n";
    out += value_branches(all, [](const std::string& words) { return fmt::format("compadd -- {}; return", words); });
    out += "    esac\n    case \"$command:$PREFIX\" in\n";
    for (const Command& c : all) {
        out += fmt::format("        \"{}:\"-*)\n            found=(\n", c.words);
        for (const CLI::Option* option : options_of(*c.app))
            for (const std::string& name : names_of(*option))
                out += fmt::format("                {}\n", described(name, option->get_description()));
        out += "            )\n            _describe -o option found ;;\n";
        const auto words = positional_words(*c.app);
        if (words.empty()) continue;
        out += fmt::format("        \"{}:\"*)\n            found=(\n", c.words);
        for (const std::string& word : words) {
            const CLI::App* child = command_of(*c.app, word);
            out += fmt::format("                {}\n",
                               child != nullptr ? described(word, child->get_description()) : shell_quoted(word));
        }
        out += "            )\n            _describe command found ;;\n";
    }
    out +=
        "        *) _files ;;\n    esac\n}\n"
        "if [ \"$funcstack[1]\" = _schuler ]; then _schuler \"$@\"; else compdef _schuler schuler; fi\n";
    return out;
}

/// Text for man: a line must not begin with a control character, and hyphens must remain copyable.
std::string roff(const std::string& text) {
    std::string out;
    for (const char c : text) {
        const bool first = out.empty() || out.back() == '\n';
        if (first && (c == '.' || c == '\'')) out += "\\&";
        if (c == '\\') {
            out += "\\e";
        } else if (c == '-') {
            out += "\\-";
        } else {
            out += c;
        }
    }
    return out;
}

std::string manual_of_options(const CLI::App& app) {
    std::string out;
    for (const CLI::Option* option : options_of(app)) {
        std::string names = option->get_positional() ? option->get_name(true) : std::string{};
        for (const std::string& name : names_of(*option)) names += (names.empty() ? "" : ", ") + name;
        if (!option->get_positional() && takes_value(*option)) names += " " + option->get_type_name();
        out += fmt::format(".TP\n.B {}\n{}\n", roff(names), roff(option->get_description()));
    }
    return out;
}

}  // namespace

std::vector<std::string> with_help_of_commands(std::vector<std::string> arguments, const CLI::App& parser) {
    if (arguments.empty() || arguments.front() != "help") return arguments;
    if (arguments.size() == 1) return {"--help"};
    if (command_of(parser, arguments[1]) == nullptr) return arguments;
    arguments.erase(arguments.begin());
    arguments.emplace_back("--help");
    return arguments;
}

std::string completion_script(const CLI::App& parser, const std::string& shell) {
    return shell == "zsh" ? zsh_completion(all_commands(parser)) : bash_completion(all_commands(parser));
}

std::string manual_page(const CLI::App& parser, const std::string& version) {
    std::string out = fmt::format(
        ".TH SCHULER 1 \"\" \"schuler {}\"\n.SH NAME\nschuler \\- integrated inertial\\-satellite navigation\n"
        ".SH SYNOPSIS\n.B schuler\n.I COMMAND\n[\n.I OPTIONS\n]\n.SH DESCRIPTION\n{}\n",
        version, roff(parser.get_description()));
    for (const Command& c : all_commands(parser)) {
        if (c.words.empty()) {
            out += ".SH OPTIONS\n" + manual_of_options(*c.app) + ".SH COMMANDS\n";
            continue;
        }
        out += fmt::format(".SS schuler {}\n{}\n", roff(c.words), roff(c.app->get_description()));
        out += manual_of_options(*c.app);
        out += fmt::format(".PP\n.nf\n{}\n.fi\n", roff(c.app->get_footer()));
    }
    out +=
        ".SH KEYS OF SETTINGS\n.B schuler help settings\nand\n.B schuler help scenario\nlist them with unit, range and default.\n"
        ".SH EXIT STATUS\n0 done, 1 the computation failed, 2 the input or the command line is unusable.\n";
    return out;
}

}  // namespace schuler::cli
