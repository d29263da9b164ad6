#include "schuler/io/text/csv/csv_instruments.h"

#include "schuler/core/units.h"
#include "schuler/io/text/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::io {
namespace {

/// Calls row(time, numbers) for every row; the first `required` columns must exist, numbers of missing others are NaN.
template <class Row>
void read_rows(const TextInput& input, const std::vector<std::string>& columns, std::size_t required, Row row) {
    const TableLayout layout = inspect_table(input);
    std::vector<FieldRequest> fields;
    std::vector<std::size_t> field_of(columns.size());
    const auto add = [&](const std::string& name, FieldKind kind, bool needed) {
        const auto found = std::ranges::find(layout.names, name);
        if (found != layout.names.end())
            fields.push_back(
                {.column = static_cast<int>(found - layout.names.begin()), .kind = kind, .required = needed, .name = name});
        else if (needed)
            throw input_error(fmt::format("needs a column {}", name), {layout.file, layout.header_line, 0, name},
                              fmt::format("write the header time_s,{}", fmt::join(columns, ",")));
        return found != layout.names.end();
    };
    add("time_s", FieldKind::Time, true);
    for (std::size_t k = 0; k < columns.size(); ++k)
        field_of[k] = add(columns[k], FieldKind::Number, k < required) ? fields.size() - 1 : 0;
    TableReader reader(input, layout, fields);
    Time latest{TableReader::no_time};
    while (reader.next()) {
        if (!reader.row_ok()) throw reader.row_error("give a number, or leave the row out");
        const Time time{reader.time_ns(0)};
        if (time <= latest) throw reader.field_error(0, "does not rise", "sort the rows by time, each time once");
        latest = time;
        Eigen::Vector3d numbers = not_given3();
        for (std::size_t k = 0; k < columns.size(); ++k)
            if (field_of[k] > 0) numbers(static_cast<Eigen::Index>(k)) = reader.number(field_of[k]);
        row(time, numbers);
    }
}

}  // namespace

std::vector<GaugeSample> read_gauges_csv(const TextInput& input) {
    std::vector<GaugeSample> out;
    read_rows(input, {"height_1_m", "height_2_m", "height_3_m"}, 1, [&](Time t, const Eigen::Vector3d& h) {
        out.push_back({t, h});
    });
    return out;
}

std::vector<BodyVelocitySample> read_dvl_csv(const TextInput& input) {
    std::vector<BodyVelocitySample> out;
    read_rows(input, {"vel_x_m_s", "vel_y_m_s", "vel_z_m_s"}, 3, [&](Time t, const Eigen::Vector3d& v) {
        out.push_back({t, v});
    });
    return out;
}

std::vector<HeadingSample> read_compass_csv(const TextInput& input) {
    std::vector<HeadingSample> out;
    read_rows(input, {"heading_deg", "std_deg"}, 1, [&](Time t, const Eigen::Vector3d& x) {
        out.push_back({t, x.x() * units::deg, x.y() * units::deg});
    });
    return out;
}

std::vector<OdometerSample> read_odometer_csv(const TextInput& input) {
    std::vector<OdometerSample> out;
    read_rows(input, {"speed_m_s", "std_m_s"}, 1, [&](Time t, const Eigen::Vector3d& x) { out.push_back({t, x.x(), x.y()}); });
    return out;
}

}  // namespace schuler::io
