// Result files (run.h5): reading their solution as a trajectory, and writing a solution alone as such a file.
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/io/container/hdf5_file.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/unpacked_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::io {
namespace {

StreamLog read_run(const TextInput& input, WarningLog&) {
    const UnpackedFile unpacked(input);
    const Hdf5Reader file(unpacked.path(), input.name());
    const std::vector<std::string> groups = file.names("/");
    const auto has = [&](const char* name) { return std::ranges::find(groups, name) != groups.end(); };
    StreamLog log;
    for (const char* group : {"solution", "forward", "reference"}) {
        if (!has(group)) continue;
        const std::vector<std::string> tables = file.names(fmt::format("/{}", group));
        const auto table = [&](const char* name) {
            return std::ranges::find(tables, name) == tables.end() ? Hdf5Table{} : file.table(fmt::format("/{}/{}", group, name));
        };
        const Hdf5Table time = table("time_ns"), position = table("position"), velocity = table("velocity"),
                        attitude = table("attitude"), std_position = table("std_position"), std_velocity = table("std_velocity"),
                        std_attitude = table("std_attitude");
        Stream s(group, TableKind::Reference, fmt::format("/{}", group),
                 {"lat_deg", "lon_deg", "height_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "roll_deg", "pitch_deg", "heading_deg",
                  "std_n_m", "std_e_m", "std_d_m", "std_vn_m_s", "std_ve_m_s", "std_vd_m_s", "std_roll_deg", "std_pitch_deg",
                  "std_heading_deg"});
        const auto at = [](const Hdf5Table& t, std::size_t row, std::size_t column) {
            return row < t.rows && column < t.columns ? t(row, column) : not_given;
        };
        for (std::size_t i = 0; i < time.rows; ++i)
            s.add(std::llround(time(i, 0)),
                  {at(position, i, 0), at(position, i, 1), at(position, i, 2), at(velocity, i, 0), at(velocity, i, 1),
                   at(velocity, i, 2), at(attitude, i, 0), at(attitude, i, 1), at(attitude, i, 2), at(std_position, i, 0),
                   at(std_position, i, 1), at(std_position, i, 2), at(std_velocity, i, 0), at(std_velocity, i, 1),
                   at(std_velocity, i, 2), at(std_attitude, i, 0), at(std_attitude, i, 1), at(std_attitude, i, 2)});
        log.add(std::move(s));
    }
    if (!log.streams.empty()) return log;
    std::string names;
    for (const std::string& name : groups) names += (names.empty() ? "" : ", ") + name;
    throw input_error("is an HDF5 file without the group /solution of a run.h5", place_in(input.name()),
                      "it has: " + (names.empty() ? std::string("nothing") : names) + "; export tables as CSV or MAT");
}

void write_solution(const std::filesystem::path& path, std::span<const SolutionRow> rows, const std::string& title) {
    Hdf5Writer file(path);
    std::vector<std::int64_t> ns;
    for (const SolutionRow& r : rows) ns.push_back(r.time.ns);
    file.create_table("/solution/position", 3, {{"columns", "lat,lon,height"}, {"units", "deg,deg,m"}});
    file.integers("/solution/time_ns", ns, {{"units", "ns"}});
    const auto three = [&](const char* name, const char* columns, const char* unit, double si, auto member) {
        std::vector<double> values;
        for (const SolutionRow& r : rows)
            for (int i = 0; i < 3; ++i) values.push_back((r.*member)(i) / si);
        file.table(fmt::format("/solution/{}", name), values, 3, {{"columns", columns}, {"units", unit}});
    };
    std::vector<double> position;
    for (const SolutionRow& r : rows)
        position.insert(position.end(), {r.position.lat / units::deg, r.position.lon / units::deg, r.position.h});
    file.append("/solution/position", position);
    three("velocity", "north,east,down", "m/s", 1.0, &SolutionRow::v_eb_n);
    three("attitude", "roll,pitch,heading", "deg", units::deg, &SolutionRow::rpy);
    three("std_position", "north,east,down", "m", 1.0, &SolutionRow::std_position);
    three("std_velocity", "north,east,down", "m/s", 1.0, &SolutionRow::std_velocity);
    three("std_attitude", "roll,pitch,heading", "deg", units::deg, &SolutionRow::std_rpy);
    file.attribute("/", "name", title);
    file.commit();
}

}  // namespace

extern const Format hdf5_format;
const Format hdf5_format = {.name = "hdf5",
                            .title = "HDF5 (run.h5)",
                            .extensions = ".h5 .hdf5",
                            .holds = "the solution, the forward solution and the reference of a `run.h5`",
                            .time = "as in the run",
                            .recognise = [](const FileHead& head) { return head.starts_with("\x89HDF\r\n\x1a\n"); },
                            .read = read_run,
                            .write = write_solution};

}  // namespace schuler::io
