// A value of a settings file, independent of the file's syntax: common form for TOML, --set and other programs' configurations.
#pragma once

#include "schuler/core/error.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace schuler::settings {

struct Value;
struct NamedValue;
using ValueList = std::vector<Value>;
using ValueTable = std::vector<NamedValue>;

/// One value; numbers preserve whether they were written as integers. Dates are text (2025-07-08).
struct Value {
    std::variant<bool, std::int64_t, double, std::string, ValueList, ValueTable> data;
    long line = 0;  ///< 1-based, 0 if there is no file

    [[nodiscard]] bool is_number() const { return data.index() == 1 || data.index() == 2; }
    [[nodiscard]] double number() const;  ///< for an integer or a floating number
    [[nodiscard]] const bool* flag() const { return std::get_if<bool>(&data); }
    [[nodiscard]] const std::int64_t* integer() const { return std::get_if<std::int64_t>(&data); }
    [[nodiscard]] const std::string* text() const { return std::get_if<std::string>(&data); }
    [[nodiscard]] const ValueList* list() const { return std::get_if<ValueList>(&data); }
    [[nodiscard]] const ValueTable* table() const { return std::get_if<ValueTable>(&data); }
};

/// An entry of a table.
struct NamedValue {
    std::string first;
    Value second;
    NamedValue(std::string name, Value value) : first(std::move(name)), second(std::move(value)) {}
};

/// One setting with its place: "imu.gyro_bias_deg_h" = 30.
struct Setting {
    std::string key;
    Value value;
    SourcePlace place;
};

/// Settings in the order given; a later one of the same key replaces an earlier one.
using SettingList = std::vector<Setting>;

/// "a number", "text", "a list", ...: for messages.
[[nodiscard]] std::string_view kind_of(const Value& value);

/// The value in TOML syntax, numbers in the fewest digits that read back identically.
[[nodiscard]] std::string to_toml(const Value& value);

/// The same for display: numbers that need more than twelve digits are shown with six.
[[nodiscard]] std::string shown(const Value& value);

}  // namespace schuler::settings
