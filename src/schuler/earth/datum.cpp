#include "schuler/earth/datum.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <array>
#include <string>
#include <utility>

namespace schuler::earth {
namespace {

constexpr double mas = 1e-3 * units::arcsec;

constexpr std::array<std::pair<std::string_view, const Ellipsoid*>, 6> ellipsoids{{{"wgs84", &wgs84},
                                                                                   {"pz90", &pz90},
                                                                                   {"pz90.11", &pz90_11},
                                                                                   {"sk42", &krasovsky},
                                                                                   {"international1924", &international1924},
                                                                                   {"paper_c", &paper_c}}};

struct DatumEntry {
    std::string_view name;
    Datum datum;
    const Ellipsoid* ellipsoid;
};
constexpr std::array<DatumEntry, 5> datums{{{"wgs84", Datum::Wgs84, &wgs84},
                                            {"pz90", Datum::Pz90, &pz90},
                                            {"pz90.11", Datum::Pz90_11, &pz90_11},
                                            {"sk42", Datum::Sk42, &krasovsky},
                                            {"ed50", Datum::Ed50, &international1924}}};

Error unknown_name(std::string_view what, std::string_view name, const char* key, const std::string& known) {
    SourcePlace place;
    place.key = key;
    return input_error(fmt::format("unknown {} \"{}\"", what, name), place, "use one of " + known);
}

std::string listed(std::string list, std::string_view name) {
    return list.empty() ? std::string(name) : fmt::format("{}, {}", list, name);
}

const DatumEntry& entry_of(Datum datum) {
    for (const DatumEntry& e : datums)
        if (e.datum == datum) return e;
    throw computation_error("datum without an entry in the table");
}

Eigen::Matrix3d linear_part(const Helmert& p) {
    Eigen::Matrix3d M;
    // clang-format off
    M << 1.0, p.rotation.z(), -p.rotation.y(),
         -p.rotation.z(), 1.0, p.rotation.x(),
         p.rotation.y(), -p.rotation.x(), 1.0;
    // clang-format on
    return (1.0 + p.scale) * M;
}

Ecef to_wgs84(Datum from, const Ecef& position) {
    switch (from) {
        case Datum::Wgs84: break;
        case Datum::Pz90: return transformed_back(wgs84_to_pz90_11(), transformed(pz90_to_pz90_11(), position));
        case Datum::Pz90_11: return transformed_back(wgs84_to_pz90_11(), position);
        case Datum::Sk42: return transformed_back(wgs84_to_pz90_11(), transformed(sk42_to_pz90_11(), position));
        case Datum::Ed50: return transformed(ed50_to_wgs84(), position);
    }
    return position;
}

Ecef from_wgs84(Datum to, const Ecef& position) {
    switch (to) {
        case Datum::Wgs84: break;
        case Datum::Pz90: return transformed_back(pz90_to_pz90_11(), transformed(wgs84_to_pz90_11(), position));
        case Datum::Pz90_11: return transformed(wgs84_to_pz90_11(), position);
        case Datum::Sk42: return transformed_back(sk42_to_pz90_11(), transformed(wgs84_to_pz90_11(), position));
        case Datum::Ed50: return transformed_back(ed50_to_wgs84(), position);
    }
    return position;
}

}  // namespace

Ellipsoid ellipsoid_from_name(std::string_view name) {
    std::string known;
    for (const auto& [known_name, ellipsoid] : ellipsoids) {
        if (known_name == name) return *ellipsoid;
        known = listed(std::move(known), known_name);
    }
    throw unknown_name("ellipsoid", name, "model", known);
}

Earth earth_from_names(std::string_view ellipsoid, std::string_view gravity) {
    return {ellipsoid_from_name(ellipsoid), gravity_model_from_name(gravity)};
}

// The differences are small relative to the position: adding them last keeps the rounding at an ulp of the position.
Ecef transformed(const Helmert& p, const Ecef& source) {
    const Eigen::Vector3d turned = (1.0 + p.scale) * source.r.cross(p.rotation);
    return {source.r + (p.scale * source.r + turned + p.translation)};
}

Ecef transformed_back(const Helmert& p, const Ecef& target) { return {linear_part(p).inverse() * (target.r - p.translation)}; }

Datum datum_from_name(std::string_view name) {
    std::string known;
    for (const DatumEntry& e : datums) {
        if (e.name == name) return e.datum;
        known = listed(std::move(known), e.name);
    }
    throw unknown_name("datum", name, "datum", known);
}

std::string_view name_of(Datum datum) { return entry_of(datum).name; }
const Ellipsoid& ellipsoid_of(Datum datum) { return *entry_of(datum).ellipsoid; }

const Helmert& pz90_to_pz90_11() {
    static const Helmert p{{-1.443, 0.156, 0.222}, {-2.30 * mas, 3.54 * mas, -134.21 * mas}, -0.228e-6};
    return p;
}

const Helmert& sk42_to_pz90_11() {
    static const Helmert p{{23.557, -140.844, -79.778}, {-2.30 * mas, -346.46 * mas, -794.21 * mas}, -0.228e-6};
    return p;
}

const Helmert& wgs84_to_pz90_11() {
    static const Helmert p{{-0.013, 0.106, 0.022}, {-2.30 * mas, 3.54 * mas, -4.21 * mas}, -0.008e-6};
    return p;
}

const Helmert& ed50_to_wgs84() {
    static const Helmert p{{-87.0, -98.0, -121.0}, {0.0, 0.0, 0.0}, 0.0};
    return p;
}

Ecef datum_changed(Datum from, Datum to, const Ecef& position) {
    return from == to ? position : from_wgs84(to, to_wgs84(from, position));
}

Geodetic datum_changed(Datum from, Datum to, const Geodetic& position) {
    if (from == to) return position;
    return geodetic_from_ecef(ellipsoid_of(to), datum_changed(from, to, ecef_from_geodetic(ellipsoid_of(from), position)));
}

}  // namespace schuler::earth
