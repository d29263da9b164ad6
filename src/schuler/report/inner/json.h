// Common parts of all JSON documents of the program (internal: the JSON library does not appear in public headers).
#pragma once

#include "schuler/analysis/errors.h"
#include "schuler/report/result_table.h"
#include "schuler/solution/bundle.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <span>
#include <string>
#include <vector>

namespace schuler::report {

using Json = nlohmann::ordered_json;

/// null if not applicable.
[[nodiscard]] inline Json json_number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

[[nodiscard]] inline Json spread(const analysis::Spread& s, double unit = 1.0) {
    return {{"rms", json_number(s.rms / unit)}, {"p95", json_number(s.p95 / unit)}, {"max", json_number(s.max / unit)}};
}

/// `filter_alone_s`: of the forward filter, for its rate.
[[nodiscard]] inline Json timing(const solution::Timing& t, std::size_t epochs, double filter_alone_s) {
    return {{"read_s", t.read_s},
            {"filter_s", t.filter_s},
            {"check_s", t.check_s},
            {"write_s", t.write_s},
            {"wall_s", t.wall_s},
            {"imu_epochs_per_s", filter_alone_s > 0.0 ? Json(static_cast<double>(epochs) / filter_alone_s) : Json(nullptr)}};
}

/// Origin of settings, as used in summaries and by inspection.
[[nodiscard]] Json facts_json(const std::vector<Fact>& facts);
[[nodiscard]] Json ignored_json(const std::vector<solution::Ignored>& ignored);

/// A row of a result table: its cells under the keys of the columns, null for missing values.
void put_row(Json& object, std::span<const TableColumn> columns, const std::vector<Cell>& row);
/// All rows.
[[nodiscard]] Json table_json(const ResultTable& table);

/// Names from external sources may contain any bytes.
[[nodiscard]] inline std::string text_of(const Json& document) {
    return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace schuler::report
