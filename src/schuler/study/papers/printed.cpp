#include "schuler/study/papers/printed.h"

#include "schuler/core/error.h"
#include "schuler/settings/toml_file.h"
#include "schuler/theory/paper_c_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace schuler::study {
namespace {

using settings::Value;
using settings::ValueTable;

const std::string& text_of(const Value& v, const std::string& origin, const std::string& key) {
    if (v.text() == nullptr) throw input_error(fmt::format("{} is not a text", key), {origin, v.line, 0, key});
    return *v.text();
}

PrintedValue::Kind kind_of(const std::string& name, const std::string& origin, long line) {
    if (name == "at_most") return PrintedValue::Kind::AtMost;
    if (name == "at_least") return PrintedValue::Kind::AtLeast;
    if (name == "between") return PrintedValue::Kind::Between;
    throw input_error(fmt::format("there is no kind \"{}\"", name), {origin, line, 0, "kind"},
                      "write at_most, at_least or between");
}

PrintedValue value_of(const ValueTable& table, const std::string& origin, long line) {
    PrintedValue out;
    std::string misprint, reason;
    for (const auto& [name, v] : table) {
        if (name == "key") out.key = text_of(v, origin, name);
        else if (name == "quantity") out.quantity = text_of(v, origin, name);
        else if (name == "unit") out.unit = text_of(v, origin, name);
        else if (name == "printed") out.printed = text_of(v, origin, name);
        else if (name == "to") out.to = text_of(v, origin, name);
        else if (name == "right") out.right = text_of(v, origin, name);
        else if (name == "misprint") misprint = text_of(v, origin, name);
        else if (name == "reason") reason = text_of(v, origin, name);
        else if (name == "kind") out.kind = kind_of(text_of(v, origin, name), origin, line);
        else if (name == "tolerance" && v.is_number()) out.tolerance = v.number();
        else throw input_error(fmt::format("a printed value has no \"{}\"", name), {origin, v.line, 0, name});
    }
    out.misprint = !misprint.empty();
    out.remark = out.misprint ? misprint : reason;
    if (out.key.empty() || out.quantity.empty() || out.unit.empty() || out.printed.empty())
        throw input_error("a printed value needs key, quantity, unit and printed", {origin, line, 0, out.key});
    if ((out.kind == PrintedValue::Kind::Between) == out.to.empty())
        throw input_error("\"to\" is the upper end of \"between\"", {origin, line, 0, out.key});
    for (const std::string* number : {&out.printed, &out.to, &out.right})
        if (!number->empty()) static_cast<void>(number_of(*number));
    return out;
}

PrintedItem item_of(const ValueTable& table, const std::string& origin, long line) {
    PrintedItem out;
    for (const auto& [name, v] : table) {
        if (name == "paper") out.paper = text_of(v, origin, name);
        else if (name == "name") out.name = text_of(v, origin, name);
        else if (name == "page") out.page = text_of(v, origin, name);
        else if (name == "place") out.place = text_of(v, origin, name);
        else if (name == "values" && v.list() != nullptr)
            for (const Value& one : *v.list()) {
                if (one.table() == nullptr) throw input_error("a printed value is a table", {origin, one.line, 0, name});
                out.values.push_back(value_of(*one.table(), origin, one.line));
            }
        else throw input_error(fmt::format("an item has no \"{}\"", name), {origin, v.line, 0, name});
    }
    if (out.paper.empty() || out.name.empty() || out.page.empty() || out.place.empty())
        throw input_error("an item needs paper, name, page and place", {origin, line, 0, out.name});
    return out;
}

double half_unit_of(const std::string& printed) {
    return printed.starts_with("pi") ? 0.0 : theory::printed_number(printed).half_unit;
}

/// Permitted deviation of our number from this one.
double room_about(const std::string& number, const std::optional<double>& tolerance) {
    const double x = std::abs(number_of(number));
    if (!tolerance) return half_unit_of(number) * (1.0 + 1e-9);
    return *tolerance * (x > 0.0 ? x : 1.0);
}

/// `scatter`: of ours, in addition to the tolerance.
bool holds(const PrintedValue& v, double ours, double scatter = 0.0) {
    const double printed = number_of(v.printed);
    constexpr double rounding = 1e-9;
    const double room =
        v.kind == PrintedValue::Kind::Equal || v.tolerance ? room_about(v.printed, v.tolerance) : rounding * std::abs(printed);
    switch (v.kind) {
        case PrintedValue::Kind::AtMost: return ours <= printed + room + scatter;
        case PrintedValue::Kind::AtLeast: return ours >= printed - room - scatter;
        case PrintedValue::Kind::Between:
            return ours >= printed - room - scatter &&
                   ours <= number_of(v.to) + room_about(v.to, v.tolerance.value_or(rounding)) + scatter;
        case PrintedValue::Kind::Equal: break;
    }
    // A printed zero with a correct number is exact: "no influence".
    if (printed == 0.0 && !v.right.empty()) return std::abs(ours) <= (number_of(v.right) == 0.0 ? room : 0.0);
    return std::abs(ours - printed) <= room + scatter;
}

}  // namespace

double number_of(const std::string& printed) {
    if (printed == "pi/2") return 0.5 * std::numbers::pi;
    return theory::printed_number(printed).value;
}

const char* name_of(Agreement agreement) {
    switch (agreement) {
        case Agreement::Agrees: return "agrees";
        case Agreement::Misprint: return "misprint";
        case Agreement::Explained: return "explained";
        case Agreement::Differs: break;
    }
    return "DIFFERS";
}

Agreement agreement_of(const PrintedValue& v, double ours, double standard_error) {
    if (!std::isfinite(ours)) return Agreement::Differs;
    const double scatter = scatter_allowed * standard_error;
    if (holds(v, ours)) return Agreement::Agrees;
    if (!v.right.empty() && std::abs(ours - number_of(v.right)) <= room_about(v.right, v.tolerance) + scatter)
        return v.misprint ? Agreement::Misprint : Agreement::Explained;
    return holds(v, ours, scatter) ? Agreement::Agrees : Agreement::Differs;
}

bool agrees_exactly(const PrintedValue& v, double ours) {
    PrintedValue strict = v;
    strict.tolerance.reset();
    return std::isfinite(ours) && holds(strict, ours);
}

std::vector<PrintedItem> printed_items_from(std::string_view toml, const std::string& origin) {
    std::vector<PrintedItem> out;
    for (const auto& [name, v] : settings::parse_toml(toml, origin)) {
        if (name != "item" || v.list() == nullptr)
            throw input_error(fmt::format("\"{}\" is no [[item]]", name), {origin, v.line, 0, name});
        for (const Value& one : *v.list()) out.push_back(item_of(*one.table(), origin, one.line));
    }
    return out;
}

const std::vector<PrintedItem>& printed_items() {
    static const std::vector<PrintedItem> all = printed_items_from(embedded_file("papers.toml"), "papers.toml");
    return all;
}

const PrintedItem& printed_item(std::string_view paper, std::string_view name) {
    std::string there;
    for (const PrintedItem& item : printed_items()) {
        if (item.paper != paper) continue;
        if (item.name == name) return item;
        there += (there.empty() ? "" : ", ") + item.name;
    }
    throw input_error(fmt::format("paper {} has no item \"{}\"", paper, name), {{}, 0, 0, "ITEM"},
                      there.empty() ? "give A, B, C, D or E" : "there are " + there);
}

}  // namespace schuler::study
