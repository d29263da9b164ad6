// Data sets as arrays in the memory of the recording itself.
#include "recording.h"

#include "alone.h"
#include "values.h"

#include "schuler/core/log.h"
#include "schuler/io/text/fix_codes.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/dataset.h"
#include "schuler/solution/loaded_dataset.h"
#include "schuler/solution/provenance.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace schuler::python {
namespace {

using Path = std::filesystem::path;

SharedRecording opened(const Path& path, const py::dict& given) {
    const settings::SettingList above = settings_from(given);
    return alone([&] {
        const settings::Dataset dataset = settings::open_dataset(path, dataset::Needs::Imu, above);
        const settings::Config config = settings::config_from(dataset.settings);
        WarningLog warnings;
        solution::LoadedDataset loaded = solution::load_dataset(dataset, config, warnings);
        SharedRecording out;
        out.name = config.name.empty() ? dataset.name : config.name;
        out.imu_kind = loaded.config.filter.imu.kind;
        out.origin = loaded.origin.seconds();
        out.config_toml = solution::config_in_force(loaded);
        out.inferred_toml = dataset.inferred_toml;
        out.warnings = warnings.summary();
        out.recording = std::make_shared<const Recording>(std::move(loaded.recording));
        return out;
    });
}

/// Arrays of a channel; the capsule keeps the recording in memory during their lifetime.
template <class Row>
class Channel {
public:
    Channel(const SharedRecording& shared, const std::vector<Row>& rows)
        : rows_(rows), owner_(new std::shared_ptr<const Recording>(shared.recording), [](void* p) {
              delete static_cast<std::shared_ptr<const Recording>*>(p);
          }) {
        add("time_ns", 0, [](const Row& r) { return &r.time.ns; });
    }
    template <class Access>
    Channel& add(const char* name, py::ssize_t count, Access access) {
        using Pointer = decltype(access(std::declval<const Row&>()));
        columns_[name] = view_of(rows_, rows_.empty() ? Pointer{nullptr} : access(rows_.front()), count, owner_);
        return *this;
    }
    [[nodiscard]] py::dict columns() const { return columns_; }
    [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }

private:
    const std::vector<Row>& rows_;
    py::capsule owner_;
    py::dict columns_;
};

py::dict imu(const SharedRecording& s) {
    return Channel(s, s.recording->imu)
        .add("gyro", 3, [](const auto& r) { return r.gyro.data(); })
        .add("accel", 3, [](const auto& r) { return r.accel.data(); })
        .columns();
}

py::dict gnss(const SharedRecording& s) {
    py::dict out = Channel(s, s.recording->gnss)
                       .add("position", 3, [](const auto& r) { return &r.position.lat; })
                       .add("velocity", 3, [](const auto& r) { return r.velocity_n.data(); })
                       .add("std_position", 3, [](const auto& r) { return r.std_position.data(); })
                       .add("std_velocity", 3, [](const auto& r) { return r.std_velocity.data(); })
                       .add("satellites", 0, [](const auto& r) { return &r.satellites; })
                       .add("position_age", 0, [](const auto& r) { return &r.position_age; })
                       .add("velocity_age", 0, [](const auto& r) { return &r.velocity_age; })
                       .columns();
    py::list fix;
    for (const GnssFix& f : s.recording->gnss) fix.append(std::string(io::name_of(f.fix)));
    out["fix"] = py::module_::import("numpy").attr("array")(fix, py::arg("dtype") = "U13");
    return out;
}

py::dict channels(const SharedRecording& s) {
    const Recording& r = *s.recording;
    py::dict out;
    out["imu"] = imu(s);
    out["gnss"] = gnss(s);
    out["baro"] = Channel(s, r.baro)
                      .add("height", 0, [](const auto& x) { return &x.height; })
                      .add("pressure", 0, [](const auto& x) { return &x.pressure; })
                      .columns();
    out["mag"] = Channel(s, r.mag).add("field", 3, [](const auto& x) { return x.field_b.data(); }).columns();
    out["odometer"] = Channel(s, r.odometer)
                          .add("speed", 0, [](const auto& x) { return &x.speed; })
                          .add("std", 0, [](const auto& x) { return &x.std; })
                          .columns();
    out["heading"] = Channel(s, r.heading)
                         .add("heading", 0, [](const auto& x) { return &x.heading; })
                         .add("std", 0, [](const auto& x) { return &x.std; })
                         .columns();
    out["gauges"] = Channel(s, r.gauges).add("height", 3, [](const auto& x) { return x.height.data(); }).columns();
    out["body_velocity"] =
        Channel(s, r.body_velocity).add("velocity", 3, [](const auto& x) { return x.velocity_b.data(); }).columns();
    out["reference"] = Channel(s, r.reference)
                           .add("position", 3, [](const auto& x) { return &x.position.lat; })
                           .add("velocity", 3, [](const auto& x) { return x.velocity_n.data(); })
                           .add("rpy", 3, [](const auto& x) { return x.rpy.data(); })
                           .add("movement", 0, [](const auto& x) { return &x.movement; })
                           .columns();
    return out;
}

}  // namespace

void bind_recording(py::module_& m) {
    static_assert(sizeof(Geodetic) == 3 * sizeof(double));
    py::class_<SharedRecording>(m, "Recording", "The instruments of a data set in memory.")
        .def_readonly("name", &SharedRecording::name)
        .def_readonly("origin_s", &SharedRecording::origin)
        .def_readonly("config_toml", &SharedRecording::config_toml)
        .def_readonly("inferred_toml", &SharedRecording::inferred_toml)
        .def_readonly("warnings", &SharedRecording::warnings)
        .def_property_readonly("imu_kind",
                               [](const SharedRecording& s) { return s.imu_kind == ImuKind::Rates ? "rates" : "increments"; })
        .def("channels", &channels, "Arrays by instrument and column: views of its memory, not to be written to.");
    m.def("open_recording", &opened, py::arg("path"), py::arg("settings"), "Reads a data set.");
}

}  // namespace schuler::python
