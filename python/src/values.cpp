#include "values.h"

#include "schuler/settings/command_line.h"
#include "schuler/settings/config/config.h"

namespace schuler::python {

using settings::OptionSpec;
using settings::Shape;
using settings::Value;
using settings::ValueList;
using settings::ValueTable;

Value value_from(const py::handle& object, const std::string& key) {
    if (py::isinstance<py::bool_>(object)) return {object.cast<bool>()};
    if (py::isinstance<py::int_>(object)) {
        int overflow = 0;
        const long long whole = PyLong_AsLongLongAndOverflow(object.ptr(), &overflow);
        if (overflow != 0) throw input_error("is too large for a whole number", {{}, 0, 0, key});
        return {static_cast<std::int64_t>(whole)};
    }
    if (py::isinstance<py::float_>(object)) return {object.cast<double>()};
    if (py::isinstance<py::str>(object)) return {object.cast<std::string>()};
    if (py::hasattr(object, "__fspath__")) return {py::str(object.attr("__fspath__")()).cast<std::string>()};
    if (py::isinstance<py::dict>(object)) {
        ValueTable table;
        for (const auto& [name, item] : py::reinterpret_borrow<py::dict>(object)) {
            const std::string inner = py::str(name).cast<std::string>();
            table.emplace_back(inner, value_from(item, key.empty() ? inner : key + "." + inner));
        }
        return {std::move(table)};
    }
    if (py::hasattr(object, "tolist")) return value_from(py::object(object.attr("tolist")()), key);  // of NumPy
    if (py::isinstance<py::list>(object) || py::isinstance<py::tuple>(object)) {
        ValueList list;
        for (const py::handle item : object) list.push_back(value_from(item, key));
        return {std::move(list)};
    }
    throw input_error(fmt::format("is a {}, which no setting can be",
                                  py::str(py::type::handle_of(object).attr("__name__")).cast<std::string>()),
                      {{}, 0, 0, key}, "give a number, text, true or false, a list or a dict of them");
}

Value value_for(const OptionSpec& spec, const py::handle& object) {
    Value value = value_from(object, spec.key);
    const bool on_off = spec.shape == Shape::Text && spec.choices == std::vector<std::string>{"on", "off"};
    if (on_off && value.flag() != nullptr) return {std::string(*value.flag() ? "on" : "off")};
    const bool list = spec.shape == Shape::Numbers || spec.shape == Shape::Texts;
    if (list && value.text() != nullptr) return settings::value_from_words(spec, {*value.text()});
    if (list && value.is_number()) return {ValueList{value}};
    return value;
}

py::object object_of(const Value& value) {
    if (const bool* flag = value.flag()) return py::bool_(*flag);
    if (const std::int64_t* whole = value.integer()) return py::int_(*whole);
    if (value.is_number()) return py::float_(value.number());
    if (const std::string* text = value.text()) return py::str(*text);
    if (const ValueList* list = value.list()) {
        py::list out;
        for (const Value& item : *list) out.append(object_of(item));
        return out;
    }
    py::dict out;
    for (const auto& [name, item] : *value.table()) out[py::str(name)] = object_of(item);
    return out;
}

settings::SettingList settings_from(const py::dict& given) {
    return settings::config_table().read(*value_from(given, {}).table(), "settings");
}

}  // namespace schuler::python
