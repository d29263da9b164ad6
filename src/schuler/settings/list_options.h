// Options whose value is a list of tables: `key = [ { name = value, ... }, ... ]`.
#pragma once

#include "schuler/core/error.h"
#include "schuler/settings/option_builders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace schuler::settings {

/// Target of one value of a table: number, count, text or list of texts.
struct Entry {
    const char* name;
    double* number = nullptr;
    double factor = 1.0;
    std::size_t* count = nullptr;
    std::string* text = nullptr;
    std::vector<std::string>* texts = nullptr;
};

inline void fill(const Value& v, const std::vector<Entry>& entries, const char* form) {
    if (v.table() == nullptr) throw input_error(fmt::format("{} is not a table", to_toml(v)), {}, form);
    for (const auto& [name, x] : *v.table()) {
        const auto e = std::ranges::find_if(entries, [&name = name](const Entry& entry) { return name == entry.name; });
        if (e == entries.end()) throw input_error(fmt::format("has no \"{}\"", name), {}, form);
        const bool names =
            x.list() != nullptr && std::ranges::all_of(*x.list(), [](const Value& item) { return item.text() != nullptr; });
        if (e->number != nullptr && x.is_number() && std::abs(x.number()) < 1e12) *e->number = x.number() * e->factor;
        else if (e->count != nullptr && x.is_number() && x.number() >= 0.0 && x.number() <= 1e6 &&
                 std::fmod(x.number(), 1.0) == 0.0)
            *e->count = static_cast<std::size_t>(x.number());
        else if (e->text != nullptr && x.text() != nullptr) *e->text = *x.text();
        else if (e->texts != nullptr && names)
            for (const Value& item : *x.list()) e->texts->push_back(*item.text());
        else throw input_error(fmt::format("{} = {} has the wrong type", name, to_toml(x)), {}, form);
    }
}

/// Default way of adding a table to its list.
struct Append {
    template <class T>
    void operator()(std::vector<T>& list, const T& item) const {
        list.push_back(item);
    }
};

/// A list of tables, each an Item. `at`: the list of a target; `entries`: the targets of an item's values; `join`: adds an item
/// to the list, or throws.
template <class Target, class Item, class At, class Entries, class Join = Append>
Option<Target> list_of(const char* key, const char* form, const char* help, At at, Entries entries, Join join = {}) {
    return special<Target>(
        key, form, help,
        [=](Target& target, const Value& v) {
            if (v.list() == nullptr) throw input_error(fmt::format("is {}, expected a list", kind_of(v)), {}, form);
            std::vector<Item>& list = at(target);
            list.clear();
            for (const Value& table : *v.list()) {
                Item item{};
                fill(table, entries(item), form);
                join(list, item);
            }
        },
        [](const Target&) { return std::optional<Value>(); });
}

}  // namespace schuler::settings
