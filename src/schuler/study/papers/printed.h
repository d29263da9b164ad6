// Printed numbers of the papers, from data/papers.toml, and their agreement with our results.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::study {

/// One printed number.
struct PrintedValue {
    enum class Kind { Equal, AtMost, AtLeast, Between };
    std::string key, quantity, unit;
    std::string printed, to;  ///< as in the paper; `to`: the upper end of Between
    Kind kind = Kind::Equal;
    std::optional<double> tolerance;  ///< fraction of the number, or absolute if that is 0; otherwise from its printed digits
    std::string right;                ///< result of the verified equations if the printed number cannot be reproduced; or empty
    bool misprint = false;            ///< the paper is wrong; otherwise it is incomplete
    std::string remark;               ///< the reason
};

/// A table or figure of a paper.
struct PrintedItem {
    std::string paper, name, page, place;
    std::vector<PrintedValue> values;
};

/// All items, in the order of the papers.
[[nodiscard]] const std::vector<PrintedItem>& printed_items();
/// @throws Error(Input) that names the invalid part of the text.
[[nodiscard]] std::vector<PrintedItem> printed_items_from(std::string_view toml, const std::string& origin);
/// @throws Error(Input) that lists the existing ones.
[[nodiscard]] const PrintedItem& printed_item(std::string_view paper, std::string_view name);

enum class Agreement {
    Agrees,     ///< with the printed number
    Misprint,   ///< differs from it, but agrees with the correct one: the paper is wrong
    Explained,  ///< likewise, but the paper is incomplete rather than wrong
    Differs
};
[[nodiscard]] const char* name_of(Agreement agreement);
/// Standard errors that a Monte Carlo number may deviate beyond the tolerance: three, 1 number in 370.
inline constexpr double scatter_allowed = 3.0;
/// `standard_error`: scatter of ours for its number of runs.
[[nodiscard]] Agreement agreement_of(const PrintedValue& value, double ours, double standard_error = 0.0);
/// Without the tolerance.
[[nodiscard]] bool agrees_exactly(const PrintedValue& value, double ours);

/// "1.2e-3", "pi/2".
[[nodiscard]] double number_of(const std::string& printed);

/// A file embedded in the program: data/papers.toml and the scenarios of the items. @throws Error(Input)
[[nodiscard]] std::string_view embedded_file(std::string_view name);

}  // namespace schuler::study
