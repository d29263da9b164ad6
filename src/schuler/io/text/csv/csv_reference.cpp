#include "schuler/core/units.h"
#include "schuler/io/place.h"
#include "schuler/io/text/csv/csv_recording.h"
#include "schuler/io/text/detail/position_columns.h"
#include "schuler/math/rotation.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace schuler::io {
namespace {

using detail::optional_number;
using detail::PositionColumns;
using detail::RowAudit;
using detail::SampleColumns;

/// Attitude columns: angles or a quaternion.
struct AttitudeColumns {
    std::array<std::size_t, 3> angle;       // roll, pitch, heading
    std::array<std::size_t, 4> quaternion;  // w, x, y, z
    bool has_quaternion = false;
    bool to_enu = false;
    Eigen::Matrix3d C_sb;
};

std::string quaternion_convention(const ColumnPlan& plan, const CsvOptions& options, const std::string& file) {
    if (!options.quaternion.empty()) {
        if (options.quaternion == "sensor_to_enu" || options.quaternion == "body_to_ned") return options.quaternion;
        throw input_error(fmt::format("'{}' is not a known convention", options.quaternion),
                          place_in(file, 0, 0, "reference quaternion"), "use sensor_to_enu or body_to_ned");
    }
    const ColumnMatch* qw = plan.find("qw");
    return qw != nullptr && qw->file_name.find("to_enu") != std::string::npos ? "sensor_to_enu" : "body_to_ned";
}

AttitudeColumns request_attitude(SampleColumns& columns, const CsvOptions& options, const std::string& convention) {
    AttitudeColumns a{};
    a.angle = {columns.add("roll_deg", false, units::deg), columns.add("pitch_deg", false, units::deg),
               columns.add("heading_deg", false, units::deg)};
    a.quaternion = {columns.add("qw", false), columns.add("qx", false), columns.add("qy", false), columns.add("qz", false)};
    a.has_quaternion = columns.has("qw") && columns.has("qx") && columns.has("qy") && columns.has("qz");
    a.to_enu = convention == "sensor_to_enu";
    a.C_sb = options.C_sb;
    return a;
}

Eigen::Vector3d attitude(const TableReader& row, const AttitudeColumns& a) {
    if (a.has_quaternion) {
        const Eigen::Quaterniond q(row.number(a.quaternion[0]), row.number(a.quaternion[1]), row.number(a.quaternion[2]),
                                   row.number(a.quaternion[3]));
        const double norm = q.norm();
        if (norm > 0.5 && norm < 2.0) {
            if (!a.to_enu) return math::rpy_from_quaternion(q.normalized());
            Eigen::Matrix3d C_ne;  // east-north-up to north-east-down
            C_ne << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
            const Eigen::Matrix3d C_nb = C_ne * q.normalized().toRotationMatrix() * a.C_sb;
            return math::rpy_from_dcm(C_nb);
        }
    }
    Eigen::Vector3d rpy(optional_number(row, a.angle[0]), optional_number(row, a.angle[1]), optional_number(row, a.angle[2]));
    if (!std::isnan(rpy.z())) rpy.z() = math::wrap_2pi(rpy.z());
    return rpy;
}

}  // namespace

ReferenceTable read_reference_csv(const TextInput& input, const CsvOptions& options, WarningLog& log) {
    SampleColumns columns(input, TableKind::Reference, options);
    ReferenceTable table;
    table.plan = columns.plan();
    columns.add("time_s", true, 1.0, FieldKind::Time);
    const PositionColumns position(columns, false);
    const std::string convention = quaternion_convention(columns.plan(), options, input.name());
    const AttitudeColumns attitude_columns = request_attitude(columns, options, convention);
    if (attitude_columns.has_quaternion) table.quaternion = convention;
    const std::size_t movement = columns.add("movement", false);
    if (!position.has_position() && !columns.has("vel_n_m_s") && !columns.has("roll_deg") && !columns.has("heading_deg") &&
        !attitude_columns.has_quaternion) {
        throw columns.missing("lat_deg");
    }
    const ColumnMatch* height = columns.plan().find("height_m");
    table.height = height != nullptr ? height->height : HeightKind::Ellipsoidal;
    for (const char* name : {"roll_deg", "lat_deg"}) {
        const ColumnMatch* match = columns.plan().find(name);
        if (match == nullptr) continue;
        const std::vector<std::string> words = words_of_name(match->file_name);
        table.autopilot = table.autopilot || words.front() == "onboard" || words.front() == "ahrs" || words.front() == "ekf";
    }

    TableReader reader = columns.reader();
    RowAudit audit(input.name(), columns.section(), log);
    const auto make = [&](const TableReader& row, ReferenceSample& sample) {
        if (position.has_position()) sample.position = position.position(row);
        sample.velocity_n = position.velocity_n(row);
        sample.rpy = attitude(row, attitude_columns);
        const double moving = optional_number(row, movement);
        sample.movement = std::isnan(moving) || moving != 0.0;
        const bool nothing =
            std::isnan(sample.position.lat) && sample.velocity_n.array().isNaN().all() && sample.rpy.array().isNaN().all();
        if (nothing) ++audit.counts().without_fix;
        return !nothing;
    };
    table.samples =
        detail::read_samples<ReferenceSample>(reader, audit, columns.layout().estimated_rows, options.time_offset, make);
    detail::put_in_time_order(table.samples, audit, [](const ReferenceSample& a, const ReferenceSample& b) {
        return detail::same_value(a.position.lat, b.position.lat) && detail::same_value(a.position.lon, b.position.lon) &&
               detail::same_value(a.position.h, b.position.h) && detail::same_vector(a.velocity_n, b.velocity_n) &&
               detail::same_vector(a.rpy, b.rpy);
    });
    table.rows = audit.counts();
    return table;
}

}  // namespace schuler::io
