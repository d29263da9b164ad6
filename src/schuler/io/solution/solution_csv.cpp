#include "schuler/io/solution/solution_csv.h"

#include "schuler/core/samples.h"
#include "schuler/core/units.h"
#include "schuler/io/place.h"
#include "schuler/io/text/detail/sample_rows.h"
#include "schuler/io/text/fixed_point.h"
#include "schuler/math/rotation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::io {
namespace {

constexpr std::size_t buffer_size = 1024 * 1024;
constexpr std::size_t columns = 19;
constexpr std::size_t required_columns = 4;  // time and position
constexpr std::size_t widest_row = columns * (widest_number + 1) + 2;
constexpr double to_deg = 1.0 / units::deg;

constexpr std::array<const char*, columns> names = {
    "time_s",     "lat_deg",    "lon_deg",      "height_m",      "vel_n_m_s",      "vel_e_m_s", "vel_d_m_s",
    "roll_deg",   "pitch_deg",  "heading_deg",  "std_n_m",       "std_e_m",        "std_d_m",   "std_vn_m_s",
    "std_ve_m_s", "std_vd_m_s", "std_roll_deg", "std_pitch_deg", "std_heading_deg"};

template <int Decimals>
char* put_three(char* out, const Eigen::Vector3d& v, double factor) {
    for (int i = 0; i < 3; ++i) {
        *out++ = ',';
        out = put_fixed<Decimals>(out, v(i) * factor);
    }
    return out;
}

/// A heading that rounds to 360 is written as 0.
double heading_deg(double heading) {
    const double deg = heading * to_deg;
    return deg >= 359.9999995 && deg <= 360.0000005 ? 0.0 : deg;
}

char* put_row(char* out, const SolutionRow& row) {
    out = put_seconds(out, row.time.ns);
    *out++ = ',';
    out = put_fixed<10>(out, row.position.lat * to_deg);
    *out++ = ',';
    out = put_fixed<10>(out, row.position.lon * to_deg);
    *out++ = ',';
    out = put_fixed<4>(out, row.position.h);
    out = put_three<5>(out, row.v_eb_n, 1.0);
    *out++ = ',';
    out = put_fixed<6>(out, row.rpy.x() * to_deg);
    *out++ = ',';
    out = put_fixed<6>(out, row.rpy.y() * to_deg);
    *out++ = ',';
    out = put_fixed<6>(out, heading_deg(row.rpy.z()));
    out = put_three<5>(out, row.std_position, 1.0);
    out = put_three<5>(out, row.std_velocity, 1.0);
    out = put_three<6>(out, row.std_rpy, to_deg);
    *out++ = '\n';
    return out;
}

}  // namespace

char* detail::put_unusual(char* out, double value, int decimals) {
    if (std::isnan(value)) return out;
    if (std::abs(value) < 1e15) return fmt::format_to(out, "{:.{}f}", value, decimals);
    return fmt::format_to(out, "{:.17g}", value);
}

char* put_seconds(char* out, std::int64_t ns) {
    const std::uint64_t magnitude = ns < 0 ? 0U - static_cast<std::uint64_t>(ns) : static_cast<std::uint64_t>(ns);
    if (ns < 0) *out++ = '-';
    out = detail::put_integer(out, magnitude / 1'000'000'000U);
    *out++ = '.';
    out = detail::put_digits<9>(out, magnitude % 1'000'000'000U);
    for (int i = 0; i < 6 && out[-1] == '0'; ++i) --out;
    return out;
}

std::string_view solution_csv_header() {
    static const std::string header = [] {
        std::string text;
        for (const char* name : names) text.append(text.empty() ? 0 : 1, ',').append(name);
        return text;
    }();
    return header;
}

std::string solution_csv_row(const SolutionRow& row) {
    std::array<char, widest_row> text;
    return {text.data(), put_row(text.data(), row) - 1};
}

SolutionCsvWriter::SolutionCsvWriter(const std::filesystem::path& path) : file_(path), buffer_(buffer_size) {
    const std::string_view header = solution_csv_header();
    std::copy(header.begin(), header.end(), buffer_.begin());
    used_ = header.size();
    buffer_[used_++] = '\n';
}

void SolutionCsvWriter::append(const SolutionRow& row) { append(std::span(&row, 1)); }

void SolutionCsvWriter::append(std::span<const SolutionRow> rows) {
    for (const SolutionRow& row : rows) {
        if (used_ + widest_row > buffer_.size()) flush();
        used_ = static_cast<std::size_t>(put_row(buffer_.data() + used_, row) - buffer_.data());
    }
}

void SolutionCsvWriter::flush() {
    file_.write({buffer_.data(), used_});
    used_ = 0;
}

void SolutionCsvWriter::commit() {
    flush();
    file_.commit();
}

int leg_at(std::span<const Time> legs, Time time) {
    return std::max(1, static_cast<int>(std::ranges::upper_bound(legs, time) - legs.begin()));
}

void write_solution_csv(const std::filesystem::path& path, std::span<const SolutionRow> rows, std::span<const Time> legs) {
    if (legs.size() > 1) {
        std::string text = fmt::format("{},leg\n", solution_csv_header());
        for (const SolutionRow& row : rows) text += fmt::format("{},{}\n", solution_csv_row(row), leg_at(legs, row.time));
        write_file(path, text);
        return;
    }
    SolutionCsvWriter writer(path);
    writer.append(rows);
    writer.commit();
}

bool is_solution_csv(const TextInput& input) {
    const TableLayout layout = inspect_table(input);
    const auto has = [&](const char* name) { return std::ranges::find(layout.names, name) != layout.names.end(); };
    return std::all_of(names.begin(), names.begin() + required_columns, has) && has("std_n_m");
}

std::vector<SolutionRow> read_solution_csv(const TextInput& input, WarningLog& log) {
    const TableLayout layout = inspect_table(input);
    std::vector<FieldRequest> requests;
    for (const char* name : names) {
        FieldRequest r;
        for (std::size_t i = 0; i < layout.names.size(); ++i) {
            if (layout.names[i] == name) r.column = static_cast<int>(i);
        }
        r.required = requests.size() < required_columns;
        r.name = name;
        if (requests.empty()) r.kind = FieldKind::Time;
        if (r.required && r.column < 0) {
            throw input_error("there is no such column", place_in(input.name(), layout.header_line, 0, name),
                              fmt::format("a solution has the columns {}", solution_csv_header()));
        }
        if (std::string_view(name).ends_with("_deg")) r.factor = units::deg;
        requests.push_back(std::move(r));
    }
    TableReader reader(input, layout, requests);
    detail::RowAudit audit(input.name(), "solution", log);
    const auto three = [](const TableReader& row, std::size_t first) {
        return Eigen::Vector3d(row.number(first), row.number(first + 1), row.number(first + 2));
    };
    const auto make = [&](const TableReader& row, SolutionRow& s) {
        s.position = {row.number(1), row.number(2), row.number(3)};
        s.v_eb_n = three(row, 4);
        s.rpy = three(row, 7);
        s.std_position = three(row, 10);
        s.std_velocity = three(row, 13);
        s.std_rpy = three(row, 16);
        return true;
    };
    return detail::read_samples<SolutionRow>(reader, audit, layout.estimated_rows, {}, make);
}

}  // namespace schuler::io
