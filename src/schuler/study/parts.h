// What the analyze commands share: keys of errors as options, numbers for JSON, a report of one section.
#pragma once

#include "schuler/core/error.h"
#include "schuler/report/outcome.h"
#include "schuler/report/report.h"

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

namespace schuler::study {

/// Runs work; an Error about the value "sample_rate" becomes one about the option --sample-rate.
template <class Work>
auto with_option_names(Work work) {
    try {
        return work();
    } catch (const Error& e) {
        SourcePlace place = e.place();
        if (!place.key.empty() && place.key.front() != '-') {
            std::ranges::replace(place.key, '_', '-');
            place.key.insert(0, "--");
        }
        throw Error(e.kind(), e.reason(), place, e.hint());
    }
}

/// An option and the number it was given.
struct GivenNumber {
    const char* option;
    double value;
};
/// @throws Error(Input) naming the first option whose number is not finite.
void check_finite(std::initializer_list<GivenNumber> numbers);

/// Six significant digits (or the given number), "-" where not finite, no negative zero.
[[nodiscard]] std::string short_number(double x, int digits = 6);

/// Writes FOLDER/report.html and notes it in the outcome. @throws Error
void write_report(report::Outcome& out, const std::filesystem::path& folder, const report::ReportInput& page);

/// A title and cells, aligned to the right from the second on.
[[nodiscard]] std::string table_line(const std::string& title, int title_width, const std::vector<std::string>& cells, int width);

}  // namespace schuler::study
