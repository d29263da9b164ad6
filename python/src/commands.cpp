// The commands of the program: their options, and their execution with progress, Ctrl-C and without the interpreter's lock.
#include "alone.h"
#include "values.h"

#include "schuler/app/command.h"
#include "schuler/app/commands.h"
#include "schuler/settings/config/config.h"

#include <pybind11/functional.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

namespace schuler::python {
namespace {

using settings::OptionSpec;
using settings::Shape;

py::dict described(const OptionSpec& spec, const settings::SettingList& defaults) {
    constexpr std::array shapes{"number", "integer", "flag", "text", "numbers", "texts", "table", "tables", "any"};
    py::dict out;
    out["key"] = spec.key;
    out["shape"] = shapes.at(static_cast<std::size_t>(spec.shape));
    out["help"] = spec.help;
    out["unit"] = spec.unit;
    out["accepts"] = settings::accepted_form(spec);
    out["choices"] = spec.choices;
    out["otherwise"] = spec.otherwise;
    out["positional"] = spec.line.positional;
    out["required"] = spec.line.required;
    out["repeated"] = spec.line.repeated;
    out["default"] = py::none();
    for (const settings::Setting& s : defaults)
        if (s.key == spec.key) out["default"] = object_of(s.value);
    return out;
}

py::list described(const std::vector<OptionSpec>& specs, const settings::SettingList& defaults) {
    py::list out;
    for (const OptionSpec& spec : specs) out.append(described(spec, defaults));
    return out;
}

py::list commands() {
    py::list out;
    for (const app::Command& c : app::commands()) {
        if (!c.perform) continue;
        py::dict item;
        item["name"] = c.name;
        item["purpose"] = c.purpose;
        item["runs"] = c.runs;
        item["json"] = c.json;
        item["options"] = described(c.options, c.defaults);
        out.append(item);
    }
    return out;
}

/// Thrown to cancel a computation; of a type that the library does not catch.
struct Stopped {};

/// A computation in a separate thread. The calling thread waits, and acquires the interpreter's lock only to report progress and
/// to check for Ctrl-C.
class Work {
public:
    explicit Work(std::function<report::Outcome(const std::function<void(double)>&)> work)
        : thread_([this, work = std::move(work)] {
              try {
                  outcome_ = work([this](double part) {
                      part_ = part;
                      if (stop_) throw Stopped{};
                  });
              } catch (...) {
                  thrown_ = std::current_exception();
              }
              const std::lock_guard lock(mutex_);
              done_ = true;
              changed_.notify_all();
          }) {}
    ~Work() {
        stop_ = true;
        thread_.join();
    }
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;

    /// True when it is done; false on timeout after `wait`.
    bool done_within(std::chrono::milliseconds wait) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, wait, [this] { return done_; });
    }
    [[nodiscard]] double part() const { return part_; }
    [[nodiscard]] report::Outcome result() {
        if (thrown_) std::rethrow_exception(thrown_);
        return std::move(outcome_);
    }

private:
    std::atomic<bool> stop_ = false;
    std::atomic<double> part_ = 0.0;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool done_ = false;
    report::Outcome outcome_;
    std::exception_ptr thrown_;
    std::thread thread_;
};

report::Outcome perform(const std::string& name, const py::dict& given, int threads, bool force, const py::object& progress) {
    const app::Command* command = app::command_named(name);
    if (command == nullptr || !command->perform) throw input_error(fmt::format("\"{}\" is not a command", name));
    settings::SettingList list;
    for (const OptionSpec& spec : command->options) {
        if (!given.contains(spec.key.c_str())) continue;
        const SourcePlace place{spec.key, 0, 0, {}};
        list.push_back({spec.key, value_for(spec, given[spec.key.c_str()]), place});
    }
    if (list.size() != given.size()) throw input_error(fmt::format("something given is not an option of {}", name));
    if (force) app::allow_overwrite(list);

    std::exception_ptr of_python;
    double shown = -1.0;
    std::optional<report::Outcome> outcome;
    {
        const py::gil_scoped_release release;
        const std::lock_guard alone(one_at_a_time());
        Work work([&](const std::function<void(double)>& report_part) {
            return command->perform(list, {.version = SCHULER_VERSION, .progress = report_part, .threads = threads});
        });
        while (!work.done_within(std::chrono::milliseconds(50))) {
            const py::gil_scoped_acquire acquire;
            try {
                if (PyErr_CheckSignals() != 0) throw py::error_already_set();
                if (const double part = work.part(); !progress.is_none() && part != shown) progress(shown = part);
            } catch (py::error_already_set&) {
                of_python = std::current_exception();
                break;
            }
        }
        if (!of_python) outcome = work.result();
    }
    if (of_python) std::rethrow_exception(of_python);
    if (!progress.is_none() && command->runs && shown < 1.0) progress(1.0);
    return std::move(*outcome);
}

}  // namespace

void bind_commands(py::module_& m) {
    using report::Outcome;
    py::class_<Outcome>(m, "Outcome", "What a command has done.")
        .def_readonly("text", &Outcome::tables)
        .def_readonly("json", &Outcome::json)
        .def_readonly("warnings", &Outcome::warnings)
        .def_readonly("notice", &Outcome::notice)
        .def_readonly("verdict", &Outcome::verdict)
        .def_readonly("usable", &Outcome::usable)
        .def_readonly("folder", &Outcome::folder)
        .def_readonly("files", &Outcome::files);
    m.def("commands", &commands, "Commands of the program with their options.");
    m.def(
        "setting_options",
        [] { return described(settings::config_table().specs(), settings::config_table().used(settings::Config{})); },
        "Settings of dataset.toml.");
    m.def(
        "setting_text",
        [](const std::string& key, const py::object& value) { return key + "=" + settings::to_toml(value_from(value, key)); },
        "key=value as --set takes it.");
    m.def(
        "check_settings", [](const py::dict& given) { (void)settings::config_from(settings_from(given)); },
        "Raises for a setting that cannot be.");
    m.def(
        "setting_keys",
        [](const py::dict& given) {
            std::vector<std::pair<std::string, py::object>> out;
            for (const settings::Setting& s : settings_from(given)) out.emplace_back(s.key, object_of(s.value));
            return out;
        },
        "Settings with their keys in full. Raises for an unknown key.");
    m.def("nearest_key", &settings::nearest_key, py::arg("key"), py::arg("known"),
          "The known key nearest to a misspelt one, or an empty text.");
    m.def("perform", &perform, py::arg("command"), py::arg("given"), py::arg("threads") = 0, py::arg("force") = false,
          py::arg("progress") = py::none(), "Performs a command.");
}

}  // namespace schuler::python
