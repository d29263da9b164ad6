// Options whose value is a list of tables: `key = [ { name = value, ... }, ... ]`.
#pragma once

#include "schuler/app/option_builders.h"
#include "schuler/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace schuler::app {

/// Numbers, texts and lists of texts of one table in a list, each to its place.
struct Entry {
    const char* name;
    double* number = nullptr;
    double factor = 1.0;
    std::string* text = nullptr;
    std::vector<std::string>* texts = nullptr;
};

inline void fill(const Value& v, const std::vector<Entry>& entries, const char* form) {
    if (v.table() == nullptr) throw input_error(fmt::format("{} is no table", to_toml(v)), {}, form);
    for (const auto& [name, x] : *v.table()) {
        const auto e = std::ranges::find_if(entries, [&name = name](const Entry& entry) { return name == entry.name; });
        if (e == entries.end()) throw input_error(fmt::format("has no \"{}\"", name), {}, form);
        const bool names =
            x.list() != nullptr && std::ranges::all_of(*x.list(), [](const Value& item) { return item.text() != nullptr; });
        if (e->number != nullptr && x.is_number() && std::abs(x.number()) < 1e12)
            *e->number = x.number() * e->factor;
        else if (e->text != nullptr && x.text() != nullptr)
            *e->text = *x.text();
        else if (e->texts != nullptr && names)
            for (const Value& item : *x.list()) e->texts->push_back(*item.text());
        else
            throw input_error(fmt::format("{} = {} has another kind", name, to_toml(x)), {}, form);
    }
}

/// A list of tables of one kind.
template <class Target, class Read>
Option<Target> list_of(const char* key, const char* form, const char* help, Read read) {
    return special<Target>(
        key, form, help,
        [=](Target& s, const Value& v) {
            if (v.list() == nullptr) throw input_error(fmt::format("is {}, expected a list", kind_of(v)), {}, form);
            read(s, *v.list(), form);
        },
        [](const Target&) { return std::optional<Value>(); });
}

}  // namespace schuler::app
