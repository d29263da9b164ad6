#include "schuler/study/parts.h"

#include "schuler/io/atomic_file.h"
#include "schuler/report/outcome.h"

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

std::string table_line(const std::string& title, int title_width, const std::vector<std::string>& cells, int width) {
    std::string out = fmt::format("{:<{}}", title, title_width);
    for (const std::string& cell : cells) out += fmt::format("{:>{}}", cell, width);
    return out + "\n";
}

}  // namespace schuler::study
