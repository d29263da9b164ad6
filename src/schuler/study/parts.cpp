#include "schuler/study/parts.h"

#include "schuler/io/atomic_file.h"
#include "schuler/report/outcome.h"
#include "schuler/report/result_table.h"

#include <fmt/format.h>

#include <cmath>

namespace schuler::study {

void check_finite(std::initializer_list<GivenNumber> numbers) {
    for (const GivenNumber& n : numbers)
        if (!std::isfinite(n.value)) throw input_error("is not a finite number", {{}, 0, 0, n.option}, "give a number");
}

std::string short_number(double x, int digits) {
    return std::isfinite(x) ? fmt::format("{:.{}g}", x == 0.0 ? 0.0 : x, digits) : "-";
}

void write_report(report::Outcome& out, const std::filesystem::path& folder, const report::ReportInput& page) {
    std::error_code ec;
    std::filesystem::create_directories(folder, ec);
    if (ec)
        throw input_error(fmt::format("the folder cannot be made: {}", ec.message()), {folder.string(), 0, 0, {}},
                          "give another one with -o");
    out.files.push_back(folder / "report.html");
    io::write_file(out.files.back(), report::render(page));
}

report::ResultTable source_table(std::string title) {
    return {std::move(title),
            {{"source", ""},
             {"", "source"},
             {"horizontal_m", "horizontal", "m"},
             {"up_m", "up", "m"},
             {"velocity_m_s", "velocity", "m/s"},
             {"tilt_deg", "tilt", "deg"},
             {"heading_deg", "heading", "deg"},
             {"outage_end_horizontal_m", "end of outage", "m"}}};
}

void add_source(report::ResultTable& table, const std::string& key, const std::string& title, const ErrorMeasures& errors) {
    std::vector<report::Cell>& row = table.rows.emplace_back(std::vector<report::Cell>{key, title});
    row.insert(row.end(), errors.begin(), errors.end());
}

}  // namespace schuler::study
