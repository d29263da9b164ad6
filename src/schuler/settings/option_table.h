// One table of options for settings files, --set, help and the dump of used settings: key, unit, range, default, help, binding.
#pragma once

#include "schuler/core/error.h"
#include "schuler/settings/units_of_keys.h"
#include "schuler/settings/value.h"

#include <fmt/format.h>

#include <cmath>
#include <concepts>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::settings {

/// Required form of a value before its setter is called.
enum class Shape { Number, Integer, Flag, Text, Numbers, Texts, Table, Tables, Any };

/// What a file named on the command line has to be, where forms offer a choice of them.
enum class FileRole { Any, Scenario, DatasetOrScenario, Recording };

/// Command line notation of an option.
struct CommandLine {
    char letter = 0;  ///< -n beside --runs
    bool positional = false;
    bool required = false;
    bool repeated = false;  ///< for Texts: repeated option instead of a list with commas
    bool hidden = false;    ///< not shown by the help
    bool file = false;      ///< it names a file or folder, or settings that may: not a form field
    FileRole role = FileRole::Any;
    std::string value_name;  ///< "T:DUR"; otherwise derived from the unit
};

/// Description of an option, independent of its target.
struct OptionSpec {
    std::string key;  ///< "imu.gyro_noise_deg_sqrt_h": section, name, unit
    Shape shape = Shape::Any;
    std::size_t length = 0;                                 ///< of a list; 0 = any
    double low = -std::numeric_limits<double>::infinity();  ///< in the unit of the key
    double high = std::numeric_limits<double>::infinity();
    std::vector<std::string> choices;  ///< of a text, or of the items of a list; empty = any
    bool any_spelling = false;         ///< choices are also accepted in capitals, and without their - and _
    std::string form;                  ///< for Any, as readable text: "[roll, pitch, yaw] or \"estimate\""
    std::string help;                  ///< one sentence
    std::string unit;                  ///< for display: "m/s"; taken from the key if that ends with a unit
    std::string applies;               ///< when it has an effect: "filter.scheme = \"separate\""; empty: always
    std::string otherwise;             ///< effect of omitting an option that has no default value: "all"
    CommandLine line;                  ///< command line notation
};

/// Throws Error(Input) at `place` if the value does not have the shape, range or choice of the option.
void check_value(const OptionSpec& spec, const Value& value, const SourcePlace& place);

/// "number from 0 to 10", "\"car\", \"air\" or \"ship\"": accepted values, for help and messages.
[[nodiscard]] std::string accepted_form(const OptionSpec& spec);

/// The known key nearest to a misspelt one (optimal string alignment distance; a missing unit suffix has a low cost), or "".
[[nodiscard]] std::string nearest_key(std::string_view key, const std::vector<std::string>& known);

/// " from 0 to 10", " of at least 0"; empty if there is no relevant limit.
[[nodiscard]] std::string range_text(const OptionSpec& spec);

/// The number whose product with `factor` is exactly `si` if there is one, in the fewest digits required.
[[nodiscard]] double in_unit(double si, double factor);

/// Flattens nested tables to dotted keys. A table that is itself the value of a known key stays whole.
/// @throws Error(Input) with file, line, the key and the nearest known key for an unknown one.
[[nodiscard]] SettingList flatten(const ValueTable& root, const std::string& file, const std::vector<OptionSpec>& known);

/// An option bound to the struct it sets.
template <class Target>
struct Option {
    OptionSpec spec;
    std::function<void(Target&, const Value&)> set;          ///< the value has passed check_value
    std::function<std::optional<Value>(const Target&)> get;  ///< empty: not set and without a default
};

/// All options of one kind of settings file, in the order of application, listing and dump.
template <class Target>
class OptionTable {
public:
    OptionTable& add(Option<Target> option) {
        if (option.spec.unit.empty()) option.spec.unit = unit_of_key(option.spec.key).symbol;
        specs_.push_back(option.spec);
        options_.push_back(std::move(option));
        return *this;
    }

    /// Calls edit(spec) for each option.
    template <class Edit>
    void edit_specs(Edit edit) {
        specs_.clear();
        for (auto& option : options_) {
            edit(option.spec);
            specs_.push_back(option.spec);
        }
    }

    [[nodiscard]] const std::vector<OptionSpec>& specs() const { return specs_; }

    [[nodiscard]] const Option<Target>* find(std::string_view key) const {
        for (const auto& option : options_) {
            if (option.spec.key == key) return &option;
        }
        return nullptr;
    }

    [[nodiscard]] std::vector<std::string> keys() const {
        std::vector<std::string> out;
        for (const auto& spec : specs_) out.push_back(spec.key);
        return out;
    }

    /// Settings of a parsed file. @throws Error(Input) for an unknown key.
    [[nodiscard]] SettingList read(const ValueTable& root, const std::string& file) const { return flatten(root, file, specs_); }

    /// Applies settings in the order of the table (so that a grade comes before the numbers that refine it), the last one of
    /// each key only. @throws Error(Input) with the place of the setting.
    void apply(const SettingList& settings, Target& target) const {
        for (const auto& option : options_) {
            const Setting* last = nullptr;
            for (const Setting& s : settings) {
                if (s.key == option.spec.key) last = &s;
            }
            if (last == nullptr) continue;
            check_value(option.spec, last->value, last->place);
            try {
                option.set(target, last->value);
            } catch (const Error& e) {
                if (!e.place().file.empty()) throw;
                SourcePlace place = last->place;  // or a place within the value, if named by the setter
                if (e.place().line > 0) place.line = e.place().line;
                if (e.place().key.starts_with(place.key)) place.key = e.place().key;
                throw Error(e.kind(), e.reason(), place, e.hint());
            }
        }
    }

    /// Every option with a value, as settings in the order of the table.
    [[nodiscard]] SettingList used(const Target& target) const {
        SettingList out;
        for (const auto& option : options_) {
            if (std::optional<Value> value = option.get(target)) out.push_back({option.spec.key, std::move(*value), {}});
        }
        return out;
    }

private:
    std::vector<Option<Target>> options_;
    std::vector<OptionSpec> specs_;
};

/// Settings as TOML text, grouped in [sections]; `comments` adds the help of each option.
[[nodiscard]] std::string to_toml(const SettingList& settings, const std::vector<OptionSpec>& known, bool comments);

/// A readable listing: key, accepted values, default, help; `prefix` limits it to a section.
[[nodiscard]] std::string listing(const std::vector<OptionSpec>& known, const SettingList& defaults, std::string_view prefix);

}  // namespace schuler::settings
