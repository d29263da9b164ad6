// What the papers print, from data/papers.toml, and whether a number of ours agrees with it.
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
    std::string printed, to;  ///< as it stands in the paper; `to`: the upper end of Between
    Kind kind = Kind::Equal;
    std::optional<double> tolerance;  ///< share of the number, or the number itself where that is 0; otherwise its printed digits
    std::string right;                ///< what the checked equations give where the printed number cannot be reached; or empty
    bool misprint = false;            ///< the paper is wrong; otherwise it says too little
    std::string remark;               ///< why
};

/// A table or figure of a paper.
struct PrintedItem {
    std::string paper, name, page, place;
    std::vector<PrintedValue> values;
};

/// All items, in the order of the papers.
[[nodiscard]] const std::vector<PrintedItem>& printed_items();
/// @throws Error(Input) naming what of the text cannot be used.
[[nodiscard]] std::vector<PrintedItem> printed_items_from(std::string_view toml, const std::string& origin);
/// @throws Error(Input) with those that there are.
[[nodiscard]] const PrintedItem& printed_item(std::string_view paper, std::string_view name);

enum class Agreement {
    Agrees,     ///< with the printed number
    Misprint,   ///< not with it, but with the right one: the paper is wrong
    Explained,  ///< likewise, but the paper says too little to be wrong
    Differs
};
[[nodiscard]] const char* name_of(Agreement agreement);
[[nodiscard]] Agreement agreement_of(const PrintedValue& value, double ours);

/// "1.2e-3", "pi/2".
[[nodiscard]] double number_of(const std::string& printed);

/// A file in the program itself: data/papers.toml and the scenarios that the items are made of. @throws Error(Input)
[[nodiscard]] std::string_view embedded_file(std::string_view name);

}  // namespace schuler::study
