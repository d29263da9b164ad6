// The class Navigator of Python.
#include "navigator.h"

#include "schuler/filter/measurement/kinds.h"
#include "schuler/filter/states/layout.h"
#include "schuler/math/rotation.h"

#include <pybind11/stl.h>

namespace schuler::python {
namespace {

using filter::NavigatorEvent;
using filter::NavigatorState;

template <class Of>
py::array_t<double> gathered(const std::vector<SolutionRow>& rows, Of of) {
    std::vector<double> out;
    out.reserve(3 * rows.size());
    for (const SolutionRow& r : rows) {
        const Eigen::Vector3d v = of(r);
        out.insert(out.end(), v.data(), v.data() + 3);
    }
    return array_of(std::move(out), 3);
}

py::dict columns(const std::vector<SolutionRow>& rows) {
    std::vector<std::int64_t> times;
    times.reserve(rows.size());
    for (const SolutionRow& r : rows) times.push_back(r.time.ns);
    py::dict out;
    out["time_ns"] = array_of(std::move(times));
    out["position"] =
        gathered(rows, [](const SolutionRow& r) { return Eigen::Vector3d(r.position.lat, r.position.lon, r.position.h); });
    out["velocity"] = gathered(rows, [](const SolutionRow& r) { return r.v_eb_n; });
    out["rpy"] = gathered(rows, [](const SolutionRow& r) { return r.rpy; });
    out["std_position"] = gathered(rows, [](const SolutionRow& r) { return r.std_position; });
    out["std_velocity"] = gathered(rows, [](const SolutionRow& r) { return r.std_velocity; });
    out["std_rpy"] = gathered(rows, [](const SolutionRow& r) { return r.std_rpy; });
    return out;
}

py::list events(const std::vector<NavigatorEvent>& list) {
    py::list out;
    for (const NavigatorEvent& e : list) {
        py::dict item;
        item["time"] = e.time.seconds();
        item["kind"] = e.kind;
        using enum NavigatorEvent::Kind;
        if (e.kind == Phase) item["phase"] = e.phase;
        if (e.kind == Refused) {
            item["source"] = e.source;
            item["status"] = e.status;
        }
        if (e.kind == Measurement || e.kind == Alert) item["aid"] = std::string(filter::info_of(e.measurement).key);
        if (e.kind == Hole) item["seconds"] = e.seconds;
        out.append(item);
    }
    return out;
}

py::object sensor_errors(StreamNavigator& n) {
    const auto row = n.navigator().sensor_errors();
    if (!row) return py::none();
    py::dict out;
    out["time"] = row->time.seconds();
    out["gyro_bias"] = array_of(row->gyro_bias);
    out["std_gyro_bias"] = array_of(row->std_gyro_bias);
    out["accel_bias"] = array_of(row->accel_bias);
    out["std_accel_bias"] = array_of(row->std_accel_bias);
    out["gyro_scale"] = array_of(row->gyro_scale);
    out["std_gyro_scale"] = array_of(row->std_gyro_scale);
    out["accel_scale"] = array_of(row->accel_scale);
    out["std_accel_scale"] = array_of(row->std_accel_scale);
    return out;
}

py::bytes saved(StreamNavigator& n) {
    const std::vector<std::byte> bytes = n.navigator().save();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void restore(StreamNavigator& n, const py::bytes& saved) {
    const std::string_view view(saved);
    const auto status = n.navigator().restore(std::as_bytes(std::span(view.data(), view.size())));
    constexpr std::array reasons{"",
                                 "is too short",
                                 "is nothing that a navigator has saved",
                                 "was saved by another version",
                                 "is damaged",
                                 "was saved by a navigator of other settings"};
    if (status != filter::RestoreStatus::Restored)
        throw input_error(reasons.at(static_cast<std::size_t>(status)), {{}, 0, 0, "saved"});
    n.forget();
}

void bind_words(py::module_& m) {
    using namespace filter;
    py::enum_<FeedStatus>(m, "FeedStatus", "What became of a sample. In blocks: their numbers, uint8.")
        .value("TAKEN", FeedStatus::Taken)
        .value("LATE", FeedStatus::Late)
        .value("DUPLICATE", FeedStatus::Duplicate)
        .value("BAD_VALUE", FeedStatus::BadValue)
        .value("TOO_FAR_AHEAD", FeedStatus::TooFarAhead)
        .value("FULL", FeedStatus::Full)
        .value("NOT_USED", FeedStatus::NotUsed);
    py::enum_<Phase>(m, "Phase", "What a navigator is doing.")
        .value("WAITING_FOR_IMU", Phase::WaitingForImu)
        .value("WAITING_FOR_START", Phase::WaitingForStart)
        .value("WAITING_FOR_POSITION", Phase::WaitingForPosition)
        .value("LEVELLING", Phase::Levelling)
        .value("GYROCOMPASSING", Phase::Gyrocompassing)
        .value("FINDING_HEADING", Phase::FindingHeading)
        .value("NAVIGATING", Phase::Navigating);
    py::enum_<Source>(m, "Source", "The instruments of a navigator.")
        .value("IMU", Source::Imu)
        .value("GNSS", Source::Gnss)
        .value("BARO", Source::Baro)
        .value("MAG", Source::Mag)
        .value("ODOMETER", Source::Odometer)
        .value("HEADING", Source::Heading)
        .value("GAUGES", Source::Gauges)
        .value("BODY_VELOCITY", Source::Log)
        .value("RANGES", Source::Ranges);
    using Kind = NavigatorEvent::Kind;
    py::enum_<Kind>(m, "EventKind", "What has happened in a navigator.")
        .value("PHASE", Kind::Phase)
        .value("REFUSED", Kind::Refused)
        .value("HOLE", Kind::Hole)
        .value("HANG", Kind::Hang)
        .value("AID", Kind::Measurement)
        .value("ALERT", Kind::Alert)
        .value("RECONSIDERED", Kind::Reconsidered)
        .value("DIVERGED", Kind::Diverged)
        .value("RESTARTED", Kind::Restarted);
    py::class_<NavigatorState>(m, "NavigatorState", "Where the body is, with the covariance of its errors. SI units, rad.")
        .def_property_readonly("time", [](const NavigatorState& s) { return s.nav.time.seconds(); })
        .def_property_readonly("time_ns", [](const NavigatorState& s) { return s.nav.time.ns; })
        .def_property_readonly("position",
                               [](const NavigatorState& s) {
                                   return array_of(Eigen::Vector3d(s.nav.position.lat, s.nav.position.lon, s.nav.position.h));
                               })
        .def_property_readonly("velocity", [](const NavigatorState& s) { return array_of(s.nav.v_eb_n); })
        .def_property_readonly("q_nb",
                               [](const NavigatorState& s) {
                                   const Eigen::Quaterniond& q = s.nav.q_nb;
                                   return array_of(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()));
                               })
        .def_property_readonly("rpy", [](const NavigatorState& s) { return array_of(math::rpy_from_quaternion(s.nav.q_nb)); })
        .def_property_readonly("covariance", [](const NavigatorState& s) { return array_of(s.covariance); });
}

}  // namespace

void bind_navigator(py::module_& m) {
    bind_words(m);
    using N = StreamNavigator;
    const py::none none;
    py::class_<N>(m, "Navigator", "The navigation filter fed sample by sample or in blocks.")
        .def(py::init<const py::dict&, double, const py::dict&, double, double, double>(), py::arg("settings") = py::dict(),
             py::kw_only(), py::arg("imu_interval") = 0.01, py::arg("rates") = py::dict(), py::arg("lag") = 0.5,
             py::arg("still_delay") = 0.0, py::arg("longest_hole") = 10.0)
        .def("feed_imu", &N::feed_imu, py::arg("time"), py::arg("gyro"), py::arg("accel"))
        .def("feed_gnss", &N::feed_gnss, py::arg("time"), py::arg("position"), py::arg("velocity") = none,
             py::arg("std_position") = none, py::arg("std_velocity") = none, py::arg("fix") = "unknown",
             py::arg("satellites") = -1)
        .def("feed_baro", &N::feed_baro, py::arg("time"), py::arg("height") = none, py::arg("pressure") = none)
        .def("feed_mag", &N::feed_mag, py::arg("time"), py::arg("field"))
        .def("feed_odometer", &N::feed_odometer, py::arg("time"), py::arg("speed"), py::arg("std") = none)
        .def("feed_heading", &N::feed_heading, py::arg("time"), py::arg("heading"), py::arg("std") = none)
        .def("feed_gauges", &N::feed_gauges, py::arg("time"), py::arg("height"))
        .def("feed_body_velocity", &N::feed_body_velocity, py::arg("time"), py::arg("velocity"))
        .def("feed_ranges", &N::feed_ranges, py::arg("time"), py::arg("names"), py::arg("station"), py::arg("columns"))
        .def("feed_recording", &N::feed, py::arg("recording"))
        .def_property_readonly("phase", [](N& n) { return n.navigator().phase(); })
        .def("state", [](N& n) { return n.navigator().state(); })
        .def("lagged", [](N& n) { return n.navigator().lagged(); })
        .def("sensor_errors", &sensor_errors)
        .def("take_rows", [](N& n) { return columns(n.take_rows()); })
        .def("take_events", [](N& n) { return events(n.take_events()); })
        .def("counters", &N::counters)
        .def("save", &saved)
        .def("restore", &restore, py::arg("saved"))
        .def("restart", [](N& n) { n.navigator().restart(); });
}

}  // namespace schuler::python
