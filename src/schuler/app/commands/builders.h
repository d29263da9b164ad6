// Builders of command options: those of the option tables, and their command-line notation.
#pragma once

#include "schuler/app/command.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/option_builders.h"
#include "schuler/settings/request.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace schuler::app {

using settings::Option;
using settings::OptionTable;
using settings::Shape;
using settings::Value;

/// Output of a study on standard output with --json, as described in the help text.
inline constexpr const char* one_json_document = "one JSON document";

template <class R>
Option<R> in_units(const char* unit, Option<R> option) {
    option.spec.unit = unit;
    return option;
}

template <class R>
Option<R> lettered(char letter, Option<R> option) {
    option.spec.line.letter = letter;
    return option;
}

template <class R>
Option<R> written(const char* value_name, Option<R> option) {
    option.spec.line.value_name = value_name;
    return option;
}

/// Another help than that of the setting, where the command narrows it.
template <class R>
Option<R> described(const char* help, Option<R> option) {
    option.spec.help = help;
    return option;
}

/// Default value.
template <class R>
Option<R> otherwise(const char* text, Option<R> option) {
    option.spec.otherwise = text;
    return option;
}

template <class R>
Option<R> required(Option<R> option) {
    option.spec.line.required = true;
    return option;
}

/// A positional argument; required.
template <class R>
Option<R> argument(const char* value_name, Option<R> option) {
    option.spec.line.positional = option.spec.line.required = true;
    option.spec.line.value_name = value_name;
    return option;
}

/// A file or folder.
template <class R, class Access>
Option<R> path(std::string key, std::string help, Access access) {
    settings::OptionSpec spec = settings::detail::spec(std::move(key), Shape::Text, std::move(help));
    spec.line.file = true;
    return {std::move(spec), [=](R& r, const Value& v) { access(r) = *v.text(); },
            [](const R&) { return std::optional<Value>(); }};
}

/// What the file of a path has to be.
template <class R>
Option<R> of_role(settings::FileRole role, Option<R> option) {
    option.spec.line.role = role;
    return option;
}

template <class R, class Access>
Option<R> scenario_argument(std::string help, Access access) {
    return of_role(settings::FileRole::Scenario, argument("SCENARIO", path<R>("scenario", std::move(help), access)));
}

/// Numbers separated by commas.
template <class R, class Access>
Option<R> numbers(std::string key, double low, double high, std::string help, Access access) {
    settings::OptionSpec spec = settings::detail::spec(std::move(key), Shape::Numbers, std::move(help));
    spec.low = low;
    spec.high = high;
    return {std::move(spec),
            [=](R& r, const Value& v) {
                access(r).clear();
                for (const Value& x : *v.list()) access(r).push_back(x.number());
            },
            [](const R&) { return std::optional<Value>(); }};
}

/// Words separated by commas.
template <class R, class Access>
Option<R> words(std::string key, std::string help, Access access) {
    return {settings::detail::spec(std::move(key), Shape::Texts, std::move(help)),
            [=](R& r, const Value& v) {
                access(r).clear();
                for (const Value& x : *v.list()) access(r).push_back(*x.text());
            },
            [](const R&) { return std::optional<Value>(); }};
}

/// A selection of these words, separated by commas.
template <class R, class Access>
Option<R> some_of(std::string key, std::vector<std::string> choices, std::string help, Access access) {
    Option<R> option = words<R>(std::move(key), std::move(help), access);
    option.spec.choices = std::move(choices);
    return option;
}

/// One of several words.
template <class R, class Access>
Option<R> one_of(std::string key, std::vector<std::string> choices, std::string help, Access access) {
    Option<R> option = settings::text<R>(std::move(key), std::move(help), access);
    option.spec.choices = std::move(choices);
    return option;
}

/// An option that sets a setting of the data set; unit, range, choices and help are those of the setting.
template <class R, class Access>
Option<R> of_setting(std::string key, const char* setting, Access request) {
    static const settings::SettingList usual = settings::config_table().used(settings::Config{});
    settings::OptionSpec spec = settings::config_table().find(setting)->spec;
    for (const settings::Setting& s : usual)
        if (s.key == setting && s.value.text() != nullptr) spec.otherwise = *s.value.text();
    spec.key = std::move(key);
    const std::string origin = "--" + spec.key;
    return {std::move(spec),
            [=](R& r, const Value& v) {
                request(r).above.push_back({setting, v, {origin, 0, 0, {}}});
            },
            [](const R&) { return std::optional<Value>(); }};
}

template <class R, class Access>
Option<R> seed_option(std::string help, Access access) {
    return written("N", settings::integer<R>("seed", 0, 9.007199254740992e15, std::move(help), access));
}

template <class R, class Access>
Option<R> jobs_option(Access access) {
    return lettered(
        'j', written("J", settings::integer<R>("jobs", 0, 1024, "number of parallel runs; 0: one per processor core", access)));
}

/// key=value, repeatable; overridden by separate options.
template <class R, class Access>
Option<R> set_option(Access above) {
    Option<R> option{
        settings::detail::spec(
            "set", Shape::Texts,
            "a setting of the processing by its key (`schuler help settings` lists them); what a scenario simulates does not change"),
        [=](R& r, const Value& v) {
            for (const Value& x : *v.list()) above(r).push_back(settings::setting_from_text(*x.text()));
        },
        [](const R&) { return std::optional<Value>(); }};
    option.spec.line.repeated = option.spec.line.file = true;
    return written("key=value", std::move(option));
}

/// Destination of the results.
template <class R, class Access>
Option<R> output_option(std::string help, const char* usual, Access access) {
    return lettered('o', written("DIR", otherwise(usual, path<R>("output", std::move(help), access))));
}

/// A command with a request: its options set the request, which is passed to its function.
template <class Request, class Function>
Command command(std::string name, std::string purpose, std::string examples, OptionTable<Request> table, std::string json,
                bool runs, Function function) {
    Command c{.name = std::move(name),
              .purpose = std::move(purpose),
              .examples = std::move(examples),
              .options = table.specs(),
              .defaults = table.used(Request{}),
              .json = std::move(json),
              .runs = runs};
    c.perform = [table = std::move(table), function](const settings::SettingList& given, const CommandContext& context) {
        Request request;
        if constexpr (requires { request.common; }) {
            request.common.version = context.version;
            request.common.progress = context.progress;
        }
        if constexpr (requires { request.team; }) {
            request.team = context.team;
        } else if (context.team) {
            throw input_error("this command does not share its work among processes", {},
                              "start it without mpirun; `schuler montecarlo` does");
        }
        if constexpr (requires { request.version; }) request.version = context.version;
        if constexpr (requires { request.progress; }) request.progress = context.progress;
        if constexpr (requires { request.stage; }) request.stage = context.stage;
        table.apply(given, request);
        if constexpr (requires { request.jobs; }) {
            if (request.jobs == 0) request.jobs = context.threads;
        }
        return function(request);
    };
    return c;
}

/// Destination of setting options.
struct CommonRequest {
    template <class R>
    auto& operator()(R& r) const {
        if constexpr (requires { r.common; }) {
            return r.common;
        } else {
            return r;
        }
    }
};

/// Settings that override those of the data set: for every command that processes one.
template <class R>
void add_settings(OptionTable<R>& table) {
    constexpr CommonRequest common;
    table.add(set_option<R>([=](auto& r) -> auto& { return common(r).above; }))
        .add(written("FILE.toml", path<R>("config", "settings over those of the data set: keys as in dataset.toml",
                                          [=](auto& r) -> auto& { return common(r).config; })))
        .add(written("T", of_setting<R>("start", "run.start_s", common)))
        .add(written("T", of_setting<R>("stop", "run.stop_s", common)));
}

/// Loop, outages, evaluated and written data: for every command that runs a filter once.
template <class R>
void add_run(OptionTable<R>& table) {
    constexpr CommonRequest common;
    table.add(written("LOOP", of_setting<R>("loop", "filter.loop", common)));
    Option<R> outage{
        settings::detail::spec("outage", Shape::Texts, "withhold GNSS for T < t < T+DUR and evaluate the errors there"),
        [=](R& r, const Value& v) {
            settings::ValueList spans;
            for (const Value& text : *v.list())
                for (const settings::OutageSpan& s : settings::outages_from_text(*text.text()))
                    spans.push_back(
                        {settings::ValueTable{{"start_s", s.absolute ? Value{fmt::format("abs:{}", s.start)} : Value{s.start}},
                                              {"duration_s", {s.duration}}}});
            common(r).above.push_back({"outage", {std::move(spans)}, {"--outage", 0, 0, {}}});
        },
        [](const R&) { return std::optional<Value>(); }};
    outage.spec.line.repeated = true;
    table.add(written("T:DUR[,T:DUR...]", std::move(outage)))
        .add(otherwise("alignment + 60 s", written("S", of_setting<R>("settle", "run.settle_s", common))))
        .add(otherwise("the first six", written("LIST", of_setting<R>("outputs", "output.files", common))));
}

/// Commands by group, see their files.
void add_data_commands(std::vector<Command>& list);
void add_file_commands(std::vector<Command>& list);
void add_live_commands(std::vector<Command>& list);
void add_gravity_command(std::vector<Command>& list);
void add_paper_command(std::vector<Command>& list);
void add_receiver_commands(std::vector<Command>& list);
void add_theory_commands(std::vector<Command>& list);
void add_study_commands(std::vector<Command>& list);

}  // namespace schuler::app
