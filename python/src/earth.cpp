// Geodesy of whole arrays, and the scales of time.
#include "arrays.h"

#include "schuler/core/time.h"
#include "schuler/earth/datum.h"
#include "schuler/earth/earth.h"
#include "schuler/earth/gravity.h"

#include <pybind11/stl.h>

namespace schuler::python {
namespace {

/// f(row) for each row of positions; the same rank as given.
template <class F>
py::array_t<double> each(const Input& in, py::ssize_t n, py::ssize_t width, F f) {
    std::vector<double> out(static_cast<std::size_t>(n * width));
    {
        const py::gil_scoped_release release;
        for (py::ssize_t i = 0; i < n; ++i) f(i, out.data() + i * width);
    }
    py::array_t<double> result = array_of(std::move(out), width);
    if (in.one() && n == 1) return result.reshape({width});
    return result;
}

Input needed(const char* name, const py::object& values, py::ssize_t width) {
    Input in(name, values, width);
    if (!in.given()) throw input_error("is missing", {{}, 0, 0, name});
    return in;
}

Geodetic geodetic(const Input& in, py::ssize_t i) { return {in.at(i, 0), in.at(i, 1), in.at(i, 2)}; }
void put_position(const Geodetic& g, double* to) { put_vector({g.lat, g.lon, g.h}, to); }

/// Two arrays row by row; one of them may be a single row that applies to all.
py::ssize_t rows_of_both(Input& a, Input& b) {
    const py::ssize_t n = a.one() ? b.rows() : a.rows();
    a.expect_rows(n, true);
    b.expect_rows(n, true);
    return n;
}

py::array ned_difference(const py::object& to, const py::object& from, const std::string& ellipsoid) {
    Input a = needed("to", to, 3), b = needed("from_", from, 3);
    const earth::Earth earth{earth::ellipsoid_from_name(ellipsoid), {}};
    return each(a.one() ? b : a, rows_of_both(a, b), 3, [&](py::ssize_t i, double* out) {
        put_vector(earth::ned_difference(earth, geodetic(a, i), geodetic(b, i)), out);
    });
}

py::array moved_by_ned(const py::object& from, const py::object& ned, const std::string& ellipsoid) {
    Input a = needed("from_", from, 3), b = needed("ned", ned, 3);
    const earth::Earth earth{earth::ellipsoid_from_name(ellipsoid), {}};
    return each(a.one() ? b : a, rows_of_both(a, b), 3,
                [&](py::ssize_t i, double* out) { put_position(earth::moved_by_ned(earth, geodetic(a, i), b.vector(i)), out); });
}

py::tuple calendar_of(const Calendar& c) { return py::make_tuple(c.year, c.month, c.day, c.hour, c.minute, c.second); }

}  // namespace

void bind_earth(py::module_& m) {
    m.def(
        "ecef_from_geodetic",
        [](const py::object& position, const std::string& ellipsoid) {
            const Input in = needed("position", position, 3);
            const earth::Ellipsoid e = earth::ellipsoid_from_name(ellipsoid);
            return each(in, in.rows(), 3,
                        [&](py::ssize_t i, double* out) { put_vector(earth::ecef_from_geodetic(e, geodetic(in, i)).r, out); });
        },
        py::arg("position"), py::arg("ellipsoid") = "wgs84",
        "Earth-fixed x, y, z (n, 3), m, of latitude, longitude (rad) and ellipsoidal height (m), (n, 3) or (3,).");
    m.def(
        "geodetic_from_ecef",
        [](const py::object& r, const std::string& ellipsoid) {
            const Input in = needed("r", r, 3);
            const earth::Ellipsoid e = earth::ellipsoid_from_name(ellipsoid);
            return each(in, in.rows(), 3,
                        [&](py::ssize_t i, double* out) { put_position(earth::geodetic_from_ecef(e, {in.vector(i)}), out); });
        },
        py::arg("r"), py::arg("ellipsoid") = "wgs84",
        "Latitude, longitude (rad), height (m), (n, 3), of Earth-fixed x, y, z, m, (n, 3) or (3,).");
    m.def("ned_difference", &ned_difference, py::arg("to"), py::arg("from_"), py::arg("ellipsoid") = "wgs84",
          "Metres north, east, down (n, 3) from `from_` to `to` (latitude, longitude, height; rad, m) for nearby points.");
    m.def("moved_by_ned", &moved_by_ned, py::arg("from_"), py::arg("ned"), py::arg("ellipsoid") = "wgs84",
          "Positions (latitude, longitude, height; rad, m) moved by metres north, east, down.");
    m.def(
        "radii",
        [](const py::object& lat, const std::string& ellipsoid) {
            const Input in = needed("lat", lat, 1);
            const earth::Ellipsoid e = earth::ellipsoid_from_name(ellipsoid);
            return each(in, in.rows(), 2, [&](py::ssize_t i, double* out) {
                const earth::Radii radii = earth::radii(e, in.at(i));
                out[0] = radii.meridian;
                out[1] = radii.prime_vertical;
            });
        },
        py::arg("lat"), py::arg("ellipsoid") = "wgs84",
        "Radii of curvature of meridian and prime vertical (n, 2), m, at latitudes (rad).");
    m.def(
        "gravity_vector",
        [](const py::object& position, const std::string& model) {
            const Input in = needed("position", position, 3);
            const earth::GravityModel kind = earth::gravity_model_from_name(model);
            return each(in, in.rows(), 3, [&](py::ssize_t i, double* out) {
                const earth::GravityVector g =
                    earth::gravity_vector(kind, std::sin(in.at(i, 0)), std::cos(in.at(i, 0)), in.at(i, 2));
                put_vector(Eigen::Vector3d(g.north, 0.0, g.down), out);
            });
        },
        py::arg("position"), py::arg("model") = "somigliana",
        "Normal gravity north, east, down (n, 3), m/s^2, at latitude, longitude, height (rad, m). Models: somigliana, grs80, kf-gins, paper_a, paper_c.");
    m.def(
        "C_en", [](double lat, double lon) { return array_of(earth::C_en(lat, lon)); }, py::arg("lat"), py::arg("lon"),
        "(3, 3): north-east-down at a latitude and longitude (rad) to Earth-fixed axes.");
    m.def(
        "datum_changed",
        [](const py::object& position, const std::string& from, const std::string& to) {
            const Input in = needed("position", position, 3);
            const earth::Datum a = earth::datum_from_name(from), b = earth::datum_from_name(to);
            return each(in, in.rows(), 3,
                        [&](py::ssize_t i, double* out) { put_position(earth::datum_changed(a, b, geodetic(in, i)), out); });
        },
        py::arg("position"), py::arg("from_"), py::arg("to"),
        "Latitude, longitude, height (rad, m) in another datum: wgs84, pz90, pz90.11, sk42, ed50.");
    m.def(
        "gps_from_utc",
        [](int year, int month, int day, int hour, int minute, double second) {
            return gps_from_utc({year, month, day, hour, minute, second}).seconds();
        },
        py::arg("year"), py::arg("month"), py::arg("day"), py::arg("hour") = 0, py::arg("minute") = 0, py::arg("second") = 0.0,
        "GPS time, s since 1980-01-06, of a UTC calendar instant.");
    m.def(
        "utc_from_gps", [](double seconds) { return calendar_of(utc_from_gps(Time::from_seconds(seconds))); }, py::arg("seconds"),
        "(year, month, day, hour, minute, second) in UTC of a GPS time, s since 1980-01-06.");
    m.def(
        "gps_from_week", [](int week, double seconds) { return Time::from_gps(week, seconds).seconds(); }, py::arg("week"),
        py::arg("seconds_of_week"), "GPS time, s since 1980-01-06, of a GPS week and its seconds.");
}

}  // namespace schuler::python
