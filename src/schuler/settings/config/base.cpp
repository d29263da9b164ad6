#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/settings/config/sections.h"
#include "schuler/settings/option_builders.h"

#include <algorithm>
#include <cmath>

namespace schuler::settings {
namespace {

template <class T>
auto setting(T ppk::Settings::*field) {
    return [=](auto& c) -> auto& { return c.base.settings.*field; };
}

Option<Config> position() {
    constexpr const char* form = "[latitude deg, longitude deg, ellipsoidal height m] or Earth-fixed [x, y, z] m";
    return special<Config>(
        "base.position", form,
        "position of the base's antenna (its reference point with gnss.antennas); default: that of the header with the antenna's height",
        [=](Config& c, const Value& v) {
            const ValueList* list = v.list();
            const bool numbers =
                list != nullptr && list->size() == 3 && std::ranges::all_of(*list, [](const Value& x) { return x.is_number(); });
            if (!numbers) throw input_error(fmt::format("{} is not a position", to_toml(v)), {}, fmt::format("write {}", form));
            const Eigen::Vector3d r((*list)[0].number(), (*list)[1].number(), (*list)[2].number());
            constexpr double least = 6.2e6, most = 7e6;  // m from the Earth's centre
            c.base.position_is_geodetic = std::abs(r.x()) <= 90.0 && std::abs(r.y()) <= 360.0 && r.z() > -1000.0 && r.z() < 1e5;
            if (c.base.position_is_geodetic)
                c.base.position = earth::ecef_from_geodetic(earth::wgs84, {r.x() * units::deg, r.y() * units::deg, r.z()});
            else if (r.norm() > least && r.norm() < most) c.base.position = Ecef{r};
            else
                throw input_error(fmt::format("{} is not a valid position on the Earth", to_toml(v)), {},
                                  fmt::format("write {}", form));
        },
        [](const Config& c) -> std::optional<Value> {
            if (!c.base.position) return std::nullopt;
            const Eigen::Vector3d& r = c.base.position->r;
            if (!c.base.position_is_geodetic) return Value{ValueList{{r.x()}, {r.y()}, {r.z()}}};
            constexpr double micro = 1e6;  // conversion to Earth-fixed axes and back leaves only rounding errors below this
            const Geodetic g = earth::geodetic_from_ecef(earth::wgs84, *c.base.position);
            return Value{
                ValueList{{in_unit(g.lat, units::deg)}, {in_unit(g.lon, units::deg)}, {std::round(g.h * micro) / micro}}};
        });
}

}  // namespace

void add_base_options(OptionTable<Config>& table) {
    table
        .add(file_list("base.observations",
                       "a base station's raw measurements (RINEX, UBX or RTCM 3): positions from carrier phases against it",
                       [](auto& c) -> auto& { return c.base.observations; }))
        .add(position())
        .add(text<Config>("base.antenna_type", "type of the base's antenna, as in gnss.antennas; default: that of the header",
                          [](auto& c) -> auto& { return c.base.antenna; }))
        .add(integer<Config>("base.frequencies", 1, 3, "number of carrier frequencies used of each satellite",
                             setting(&ppk::Settings::frequencies)))
        .add(choice<Config, ppk::Motion>("base.motion", {{"kinematic", ppk::Motion::Kinematic}, {"static", ppk::Motion::Static}},
                                         "whether the rover moves", setting(&ppk::Settings::motion)))
        .add(number<Config>("base.acceleration_m_s_sqrt_s", 1.0, 0.001, 1000,
                            "root power spectral density of the rover's acceleration between epochs",
                            setting(&ppk::Settings::acceleration)))
        .add(choice<Config, ppk::Direction>("base.direction",
                                            {{"forward", ppk::Direction::Forward},
                                             {"backward", ppk::Direction::Backward},
                                             {"combined", ppk::Direction::Combined}},
                                            "direction of processing; combined: both, with the better solution of each epoch",
                                            setting(&ppk::Settings::direction)))
        .add(flag<Config>("base.integers", "fix the ambiguities to integers; otherwise they stay real-valued",
                          [](auto& c) -> auto& { return c.base.settings.integers.use; }))
        .add(number<Config>("base.ratio", 1.0, 1, 100,
                            "minimum ratio of the squared distances of the second best and the best integers",
                            [](auto& c) -> auto& { return c.base.settings.integers.ratio; }))
        .add(number<Config>("base.success_rate", 1.0, 0.5, 0.999999999,
                            "minimum probability, by the covariance, that the integers are correct",
                            [](auto& c) -> auto& { return c.base.settings.integers.success; }))
        .add(number<Config>("base.integer_mask_deg", units::deg, 0, 80, "ambiguities of lower satellites stay real-valued",
                            [](auto& c) -> auto& { return c.base.settings.integers.elevation_mask; }))
        .add(number<Config>("base.phase_std_m", 1.0, 1e-4, 0.1,
                            "one sigma of a strong phase from the zenith; codes: gnss.code_std_m",
                            setting(&ppk::Settings::phase_sigma)))
        .add(number<Config>("base.code_correlated_time_s", 1.0, 0, 1e5, "correlation time of code multipath",
                            setting(&ppk::Settings::code_correlation)))
        .add(number<Config>("base.phase_correlated_time_s", 1.0, 0, 1e5, "correlation time of phase multipath",
                            setting(&ppk::Settings::phase_correlation)))
        .add(number<Config>("base.longest_age_s", 1.0, 0, 3600,
                            "maximum age of an epoch of the base; twice as long between two of them",
                            [](auto& c) -> auto& { return c.base.settings.base.longest_age; }));
}

}  // namespace schuler::settings
