// Common parts of the studies: keys of errors as options, errors by source, a report of one section.
#pragma once

#include "schuler/core/error.h"
#include "schuler/report/outcome.h"
#include "schuler/report/report.h"
#include "schuler/report/result_table.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

namespace schuler::study {

/// Runs work; an Error about the value "sample_rate" is converted to one about the option --sample-rate.
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

/// An option and its given number.
struct GivenNumber {
    const char* option;
    double value;
};
/// @throws Error(Input) that names the first option whose number is not finite.
void check_finite(std::initializer_list<GivenNumber> numbers);

/// Six significant digits (or the given number), "-" if not finite, no negative zero.
[[nodiscard]] std::string short_number(double x, int digits = 6);

/// Writes FOLDER/report.html and adds it to the outcome. @throws Error
void write_report(report::Outcome& out, const std::filesystem::path& folder, const report::ReportInput& page);

/// Errors by source, and of all sources together: horizontal, up, velocity, tilt, heading (root mean squares; m, m/s, deg), and
/// horizontal at the end of the first outage.
using ErrorMeasures = std::array<double, 6>;
[[nodiscard]] report::ResultTable source_table(std::string title);
void add_source(report::ResultTable& table, const std::string& key, const std::string& title, const ErrorMeasures& errors);

}  // namespace schuler::study
