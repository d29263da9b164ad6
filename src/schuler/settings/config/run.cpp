#include "schuler/settings/config/config.h"
#include "schuler/settings/config/sections.h"
#include "schuler/settings/option_builders.h"

#include <algorithm>

namespace schuler::settings {
namespace {

Value value_of(const RunTime& t) { return t.absolute ? Value{fmt::format("abs:{}", t.seconds)} : Value{t.seconds}; }

RunTime run_time_of(const Value& v) {
    if (v.is_number() && std::abs(v.number()) < 1e10) return {v.number(), false};
    if (v.text() == nullptr) throw input_error(fmt::format("{} is not a time", to_toml(v)), {}, "give seconds, or \"abs:T\"");
    try {
        return run_time_from_text(*v.text(), {});
    } catch (const Error& e) {
        throw input_error(e.reason(), {}, e.hint());
    }
}

Option<Config> time_option(const std::string& key, const std::string& help, std::optional<RunTime> RunConfig::*field) {
    return special<Config>(
        key, "seconds after the first GNSS epoch, or \"abs:T\"", help,
        [=](Config& c, const Value& v) { c.run.*field = run_time_of(v); },
        [=](const Config& c) -> std::optional<Value> {
            if (!(c.run.*field)) return std::nullopt;
            return value_of(*(c.run.*field));
        });
}

OutageSpan outage_of(const ValueTable& table) {
    OutageSpan span;
    bool start = false;
    for (const auto& [name, v] : table) {
        if (name == "start_s") {
            const RunTime t = run_time_of(v);
            span.start = t.seconds;
            span.absolute = t.absolute;
            start = true;
        } else if (name == "duration_s") {
            if (!v.is_number() || !(v.number() > 0.0 && v.number() < 1e9))
                throw input_error(fmt::format("duration_s = {} is not a positive number", to_toml(v)), {}, "give seconds");
            span.duration = v.number();
        } else if (name != "sensor" || v.text() == nullptr || *v.text() != "gnss") {
            throw input_error(fmt::format("{} = {} is not understood", name, to_toml(v)), {},
                              "an [[outage]] has start_s, duration_s and sensor = \"gnss\"");
        }
    }
    if (!start || !(span.duration > 0.0))
        throw input_error("lacks start_s or duration_s", {}, "an [[outage]] has start_s and duration_s");
    return span;
}

Option<Config> outage_option() {
    OptionSpec spec = detail::spec("outage", Shape::Tables, "spans without GNSS: [[outage]] with start_s and duration_s");
    return {std::move(spec), [](Config& c, const Value& v) { c.run.outages = outages_from_tables(*v.list()); },
            [](const Config& c) -> std::optional<Value> {
                if (c.run.outages.empty()) return std::nullopt;
                ValueList list;
                for (const OutageSpan& o : c.run.outages) {
                    list.push_back({ValueTable{{"start_s", value_of({o.start, o.absolute})}, {"duration_s", Value{o.duration}}}});
                }
                return Value{std::move(list)};
            }};
}

Option<Config> output_files_option() {
    OptionSpec spec = detail::spec(
        "output.files", Shape::Texts,
        "files that are written; mat: run.mat, the tables of run.h5 for Octave and MATLAB; covariance: the full matrix, in run.h5; "
        "states: states.csv, every state with its sigma");
    spec.choices = {"solution", "summary", "h5", "report", "kml", "config", "mat", "covariance", "states"};
    spec.form =
        "a list of \"solution\", \"summary\", \"h5\", \"report\", \"kml\", \"config\", \"mat\", \"covariance\", \"states\"";
    return {std::move(spec),
            [](Config& c, const Value& v) {
                c.output.files.clear();
                for (const Value& item : *v.list()) c.output.files.push_back(*item.text());
                c.filter.covariance_rows = std::ranges::find(c.output.files, "covariance") != c.output.files.end();
            },
            [](const Config& c) -> std::optional<Value> {
                ValueList list;
                for (const std::string& f : c.output.files) list.push_back({f});
                return Value{std::move(list)};
            }};
}

}  // namespace

std::vector<OutageSpan> outages_from_tables(const ValueList& tables) {
    std::vector<OutageSpan> out;
    for (const Value& item : tables) out.push_back(outage_of(*item.table()));
    return out;
}

void add_run_options(OptionTable<Config>& table) {
    table
        .add(time_option(
            "run.start_s",
            "start of processing: seconds after the first GNSS epoch (without GNSS: the first IMU epoch), or abs:T in the time of the log",
            &RunConfig::start))
        .add(time_option("run.stop_s", "end of processing, given as run.start_s", &RunConfig::stop))
        .add(number<Config>("run.settle_s", 1.0, 0, 1e9, "start of the error statistics; default: alignment + 60 s",
                            [](auto& c) -> auto& { return c.run.settle; }))
        .add(flag<Config>(
            "run.keep_given",
            "keep given values that contradict the data; otherwise the value from the data is used. Both are reported",
            [](auto& c) -> auto& { return c.run.keep_given; }))
        .add(outage_option())
        .add(number<Config>("output.rate_hz", 1.0, 0, 1e5, "rate of the solution; 0 = every IMU epoch",
                            [](auto& c) -> auto& { return c.filter.output_rate; }))
        .add(vector3<Config>(
            "output.lever_arm_m", 1.0, -1e4, 1e4,
            "lever arm from the IMU to a further output point (point.csv): forward, right, down; events refer to that point",
            [](auto& c) -> auto& { return c.filter.output_lever_arm_b; }))
        .add(flag<Config>(
            "output.at_antenna",
            "the solution is the motion of the GNSS antenna instead of that of the IMU; `process` takes it where the "
            "lever arm is neither given nor shown by the log",
            [](auto& c) -> auto& { return c.filter.output_at_antenna; }))
        .add(text<Config>("output.events",
                          "file of instants (time_s, name) at which the solution is output as well: events.csv, one row each",
                          [](auto& c) -> auto& { return c.output.events; }))
        .add(output_files_option());
}

}  // namespace schuler::settings
