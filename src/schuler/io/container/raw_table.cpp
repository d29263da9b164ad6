#include "schuler/io/container/raw_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace schuler::io {

const std::vector<double>* RawTable::find(std::string_view field) const {
    const auto it = std::ranges::find(fields, field);
    return it == fields.end() ? nullptr : &values[static_cast<std::size_t>(it - fields.begin())];
}

const std::vector<double>* RawTable::find(std::initializer_list<std::string_view> any_of) const {
    for (const std::string_view one : any_of)
        if (const auto* column = find(one)) return column;
    return nullptr;
}

std::vector<const RawTable*> tables_named(const RawTables& tables, std::string_view wanted) {
    std::vector<const RawTable*> found;
    for (const RawTable& t : tables)
        if (t.name == wanted && t.rows() > 0) found.push_back(&t);
    std::ranges::stable_sort(found, {}, &RawTable::instance);
    return found;
}

std::vector<double> interpolated(const std::vector<double>& at, const std::vector<double>& times,
                                 const std::vector<double>& values, double reach) {
    std::vector<double> out(at.size(), std::numeric_limits<double>::quiet_NaN());
    if (times.empty()) return out;
    if (!std::ranges::is_sorted(times)) {  // several boots in one log, or damage
        std::vector<std::pair<double, double>> rows;
        for (std::size_t i = 0; i < times.size(); ++i)
            if (std::isfinite(times[i])) rows.emplace_back(times[i], values[i]);
        std::ranges::stable_sort(rows, {}, &std::pair<double, double>::first);
        std::vector<double> t, v;
        for (const auto& [time, value] : rows) {
            t.push_back(time);
            v.push_back(value);
        }
        return interpolated(at, t, v, reach);
    }
    std::size_t k = 0;  // the first later row
    for (std::size_t i = 0; i < at.size(); ++i) {
        if (i == 0 || at[i] < at[i - 1]) k = static_cast<std::size_t>(std::ranges::upper_bound(times, at[i]) - times.begin());
        while (k < times.size() && times[k] <= at[i]) ++k;
        const std::size_t before = k > 0 ? k - 1 : 0, after = k < times.size() ? k : times.size() - 1;
        const double span = times[after] - times[before];
        if (!(std::min(std::abs(at[i] - times[before]), std::abs(at[i] - times[after])) <= reach)) continue;
        const double share = span > 0.0 ? std::clamp((at[i] - times[before]) / span, 0.0, 1.0) : 0.0;
        out[i] = values[before] + share * (values[after] - values[before]);
    }
    return out;
}

}  // namespace schuler::io
