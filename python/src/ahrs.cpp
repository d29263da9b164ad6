// Attitude and heading without position: the filter fed sample by sample or in blocks, and whole logs.
#include "arrays.h"

#include "schuler/ahrs/mekf.h"
#include "schuler/ahrs/run.h"
#include "schuler/math/rotation.h"

#include <pybind11/stl.h>

#include <cmath>

namespace schuler::python {
namespace {

using ahrs::Mekf;
using ahrs::MekfSettings;

py::array_t<double> wxyz(const Eigen::Quaterniond& q) { return array_of(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z())); }

void append(std::vector<double>& out, const Eigen::Quaterniond& q) { out.insert(out.end(), {q.w(), q.x(), q.y(), q.z()}); }

/// Steps through a block and returns the attitude after each sample. `dt`: one number, or one per row.
py::array_t<double> feed(Mekf& filter, const py::object& dt, const py::object& gyro, const py::object& accel,
                         const py::object& mag) {
    Input step("dt", dt, 1), w("gyro", gyro, 3), f("accel", accel, 3), b("mag", mag, 3);
    const py::ssize_t n = w.rows();
    f.expect_rows(n);
    b.expect_rows(n);
    step.expect_rows(n, true);
    for (py::ssize_t i = 0; i < (step.one() ? 1 : n); ++i)
        if (!(step.at(i) > 0.0 && step.at(i) < 1e9))
            throw input_error(fmt::format("number {} is not positive", i), {{}, 0, 0, "dt"}, "give seconds");
    std::vector<double> out;
    out.reserve(static_cast<std::size_t>(4 * n));
    {
        const py::gil_scoped_release release;
        for (py::ssize_t i = 0; i < n; ++i) {
            filter.step(step.at(i), w.vector(i), f.vector(i));
            if (const Eigen::Vector3d field = b.vector(i); b.given() && !field.hasNaN()) filter.magnetometer(field);
            append(out, filter.q_nb());
        }
    }
    py::array_t<double> q = array_of(std::move(out), 4);
    if (w.one()) return q.reshape({4});
    return q;
}

ahrs::FilterKind filter_from(const std::string& name) {
    using enum ahrs::FilterKind;
    if (name == "mekf") return Mekf;
    if (name == "dcm") return Dcm;
    if (name == "quaternion") return Quaternion;
    if (name == "quaternion-printed") return QuaternionPrinted;
    if (name == "quaternion-coupled") return QuaternionCoupled;
    throw input_error(fmt::format("\"{}\" is not a filter", name), {{}, 0, 0, "filter"},
                      "mekf, dcm, quaternion, quaternion-printed or quaternion-coupled");
}

py::dict attitude(const py::object& time, const py::object& gyro, const py::object& accel, const py::object& mag_time,
                  const py::object& mag, const py::object& speed_time, const py::object& speed, const std::string& filter,
                  bool offline, const MekfSettings& settings) {
    const Times t("time", time);
    Input w("gyro", gyro, 3), f("accel", accel, 3), b("mag", mag, 3), v("speed", speed, 1);
    for (Input* in : {&w, &f}) in->expect_rows(t.rows());
    std::vector<ImuSample> imu;
    std::vector<MagSample> field;
    std::vector<ahrs::SpeedSample> over_ground;
    for (py::ssize_t i = 0; i < t.rows(); ++i) imu.push_back({t.at(i), w.vector(i), f.vector(i)});
    if (b.given()) {
        const Times tm("mag_time", mag_time.is_none() ? time : mag_time);
        b.expect_rows(tm.rows());
        for (py::ssize_t i = 0; i < tm.rows(); ++i) field.push_back({tm.at(i), b.vector(i)});
    }
    if (v.given()) {
        const Times ts("speed_time", speed_time.is_none() ? time : speed_time);
        v.expect_rows(ts.rows());
        for (py::ssize_t i = 0; i < ts.rows(); ++i) over_ground.push_back({ts.at(i), v.at(i)});
    }
    ahrs::RunSettings run;
    run.filter = filter_from(filter);
    run.offline = offline;
    run.mekf = settings;
    run.mekf.six_axis = run.mekf.six_axis || field.empty();
    ahrs::RunResult result;
    {
        const py::gil_scoped_release release;
        result = ahrs::run(imu, field, over_ground, run);
    }
    std::vector<std::int64_t> times;
    std::vector<double> q, rpy, std, bias;
    const auto push = [](std::vector<double>& out, const Eigen::Vector3d& x) { out.insert(out.end(), x.data(), x.data() + 3); };
    for (const ahrs::AttitudeRow& row : result.rows) {
        times.push_back(row.time.ns);
        append(q, row.q_nb);
        push(rpy, math::rpy_from_quaternion(row.q_nb));
        push(std, row.std_phi);
        push(bias, row.gyro_bias);
    }
    py::dict out;
    out["time_ns"] = array_of(std::move(times));
    out["q_nb"] = array_of(std::move(q), 4);
    out["rpy"] = array_of(std::move(rpy), 3);
    out["std_phi"] = array_of(std::move(std), 3);
    out["gyro_bias"] = array_of(std::move(bias), 3);
    return out;
}

void bind_settings(py::module_& m) {
    using namespace ahrs;
    py::class_<TiltSettings>(m, "TiltSettings", "Gyro and accelerometer; SI units.")
        .def(py::init<>())
        .def_readwrite("gyro_noise", &TiltSettings::gyro_noise)
        .def_readwrite("turn_noise", &TiltSettings::turn_noise)
        .def_readwrite("bias_std", &TiltSettings::bias_std)
        .def_readwrite("bias_walk", &TiltSettings::bias_walk)
        .def_readwrite("accel_bias_std", &TiltSettings::accel_bias_std)
        .def_readwrite("velocity_std", &TiltSettings::velocity_std)
        .def_readwrite("velocity_time", &TiltSettings::velocity_time)
        .def_readwrite("force_noise", &TiltSettings::force_noise)
        .def_readwrite("adaptation_time", &TiltSettings::adaptation_time)
        .def_readwrite("gravity", &TiltSettings::gravity);
    py::class_<ahrs::HeadingSettings>(m, "HeadingSettings", "Magnetometer; SI units.")
        .def(py::init<>())
        .def_readwrite("walk", &ahrs::HeadingSettings::walk)
        .def_readwrite("field_noise", &ahrs::HeadingSettings::field_noise)
        .def_readwrite("hard_iron_std", &ahrs::HeadingSettings::hard_iron_std)
        .def_readwrite("hard_iron_walk", &ahrs::HeadingSettings::hard_iron_walk)
        .def_readwrite("place_std", &ahrs::HeadingSettings::place_std)
        .def_readwrite("declination", &ahrs::HeadingSettings::declination);
    py::class_<MekfSettings>(m, "MekfSettings", "Settings of Mekf; SI units.")
        .def(py::init<>())
        .def_readwrite("block", &MekfSettings::block)
        .def_readwrite("six_axis", &MekfSettings::six_axis)
        .def_readwrite("tilt", &MekfSettings::tilt)
        .def_readwrite("heading", &MekfSettings::heading)
        .def("check", &MekfSettings::check, "Raises for a setting that cannot be.");
}

}  // namespace

void bind_ahrs(py::module_& m) {
    bind_settings(m);
    const py::none none;
    py::class_<Mekf>(m, "Mekf",
                     "Attitude and heading from gyro, accelerometer and magnetometer: tilt and heading in channels of their own.")
        .def(py::init([](const std::optional<MekfSettings>& settings) { return Mekf(settings.value_or(MekfSettings{})); }),
             py::arg("settings") = none)
        .def(
            "feed", &feed, py::arg("dt"), py::arg("gyro"), py::arg("accel"), py::arg("mag") = none,
            "q_nb after each sample (n, 4), or (4,) of one. dt: s, one number or (n,); gyro: rad/s, accel: m/s^2, mag: T, body axes "
            "forward-right-down, (n, 3) or (3,); rows of mag with NaN are not samples.")
        .def(
            "forward_speed",
            [](Mekf& f, double speed, double std) {
                if (!std::isfinite(speed) || !(std > 0.0))
                    throw input_error("is not a speed with a positive sigma", {{}, 0, 0, "speed"});
                f.forward_speed(speed, std);
            },
            py::arg("speed"), py::arg("std") = 0.5, "Speed over ground along the body's x axis and its sigma, m/s.")
        .def_property_readonly("started", &Mekf::started)
        .def_property_readonly(
            "q_nb", [](const Mekf& f) { return wxyz(f.q_nb()); }, "Body to local level (4,), scalar first.")
        .def_property_readonly(
            "rpy", [](const Mekf& f) { return array_of(math::rpy_from_quaternion(f.q_nb())); }, "Roll, pitch, heading (3,), rad.")
        .def_property_readonly(
            "std_phi", [](const Mekf& f) { return array_of(f.std_phi()); },
            "One sigma of the small rotation about north, east, down (3,), rad.")
        .def_property_readonly(
            "covariance", [](const Mekf& f) { return array_of(f.covariance_phi()); }, "Of that rotation (3, 3), rad^2.")
        .def_property_readonly(
            "gyro_bias", [](const Mekf& f) { return array_of(f.gyro_bias()); }, "(3,), rad/s.");
    m.def("attitude", &attitude, py::arg("time"), py::arg("gyro"), py::arg("accel"), py::arg("mag_time") = none,
          py::arg("mag") = none, py::arg("speed_time") = none, py::arg("speed") = none, py::arg("filter") = "mekf",
          py::arg("offline") = false, py::arg("settings") = MekfSettings{});
}

}  // namespace schuler::python
