// Surveys of scenario files: the pattern of lines, terrain following, and the gravity field under the path.
#include "schuler/core/units.h"
#include "schuler/earth/enu.h"
#include "schuler/earth/gravity_field.h"
#include "schuler/io/text/csv/csv_grid.h"
#include "schuler/settings/config/anomaly_options.h"
#include "schuler/settings/option_builders.h"
#include "schuler/settings/scenario/scenario.h"

#include <cmath>
#include <memory>
#include <numbers>

namespace schuler::settings {
namespace {

using S = ScenarioConfig;

GeodeticGrid grid_of(const S& s, const std::string& name, const std::vector<std::string>& columns, double factor) {
    const std::filesystem::path file(name);
    return io::read_grid_csv(io::TextInput(file.is_absolute() ? file : s.folder / file), columns, factor);
}

}  // namespace

void add_survey_options(OptionTable<S>& table) {
    using P = sim::SurveyPattern;
    const auto pattern = [](auto P::*field) { return [=](auto& s) -> auto& { return s.survey.*field; }; };
    const auto drape = [](double SurveyGround::*field) { return [=](auto& s) -> auto& { return s.survey_ground.*field; }; };
    using G = SurveyGround;
    table
        .add(integer<S>("trajectory.survey.lines", 1, 1000, "number of parallel lines, flown back and forth", pattern(&P::lines)))
        .add(integer<S>("trajectory.survey.ties", 0, 1000, "number of tie lines across them", pattern(&P::ties)))
        .add(number<S>("trajectory.survey.length_m", 1.0, 1, 1e6, "length of a line", pattern(&P::length)))
        .add(number<S>("trajectory.survey.spacing_m", 1.0, 1, 1e6, "distance between lines", pattern(&P::spacing)))
        .add(number<S>("trajectory.survey.overrun_m", 1.0, 0, 1e5, "straight lead-in and run-out of every line",
                       pattern(&P::overrun)))
        .add(number<S>("trajectory.survey.bank_deg", units::deg, 1, 60, "largest bank in turns", pattern(&P::bank)))
        .add(number<S>("trajectory.drape.clearance_m", 1.0, -1e4, 1e5, "height over the ground instead of that of the start",
                       drape(&G::clearance)))
        .add(number<S>("trajectory.drape.climb_deg", units::deg, 0.01, 45, "steepest climb and descent over the ground",
                       drape(&G::climb)))
        .add(number<S>("trajectory.drape.smoothing_m", 1.0, 0, 1e5,
                       "length over which the slope changes; default: distance covered in 10 s", drape(&G::smoothing)))
        .add(text<S>("trajectory.drape.file", "grid of the ground: lat_deg, lon_deg, height_m; relative to the scenario",
                     [](auto& s) -> auto& { return s.survey_ground.file; }))
        .add(number<S>("trajectory.drape.height_m", 1.0, -1e4, 1e4, "without a file: mean height of the ground",
                       drape(&G::height)))
        .add(number<S>("trajectory.drape.amplitude_m", 1.0, 0, 1e4,
                       "amplitude of the hills of the ground, a sine north times a sine east", drape(&G::amplitude)))
        .add(number<S>("trajectory.drape.wavelength_m", 1.0, 1, 1e6, "wavelength of the hills", drape(&G::wavelength)))
        .add(text<S>("anomaly_field.file",
                     "disturbance of gravity over the ground, a grid: lat_deg, lon_deg, east_mgal, north_mgal, up_mgal; relative "
                     "to the scenario",
                     [](auto& s) -> auto& { return s.field.file; }))
        .add(text<S>("anomaly_field.model", "disturbance of gravity from a model of GeographicLib (egm96, egm2008, ...) instead",
                     [](auto& s) -> auto& { return s.field.model; }))
        .add(text<S>("anomaly_field.folder", "folder of that model; default: that of GeographicLib's tools",
                     [](auto& s) -> auto& { return s.field.folder; }));
}

std::optional<sim::Drape> drape_of(const S& s, double speed) {
    const SurveyGround& g = s.survey_ground;
    if (std::isnan(g.clearance)) return std::nullopt;
    sim::Drape drape;
    drape.clearance = g.clearance;
    drape.slope = std::tan(g.climb);
    drape.smoothing = std::isnan(g.smoothing) ? 10.0 * speed : g.smoothing;
    if (!g.file.empty()) {
        const auto grid = std::make_shared<const GeodeticGrid>(grid_of(s, g.file, {"height_m"}, 1.0));
        drape.ground = [grid](double lat, double lon) { return grid->at(lat, lon).x(); };
        return drape;
    }
    // Metres on the sphere are sufficiently accurate for synthetic hills.
    const double per_rad = 2.0 * std::numbers::pi / g.wavelength * s.sim.earth.ellipsoid.a;
    drape.ground = [g, per_rad, start = s.start](double lat, double lon) {
        return g.height +
               g.amplitude * std::sin(per_rad * (lat - start.lat)) * std::sin(per_rad * std::cos(start.lat) * (lon - start.lon));
    };
    return drape;
}

sim::GroundField field_of(const S& s) {
    const AnomalyFieldConfig& f = s.field;
    const auto place = [](const char* key) { return SourcePlace{.file = {}, .line = 0, .column = 0, .key = key}; };
    if (!f.file.empty() && !f.model.empty())
        throw input_error("contradicts anomaly_field.file", place("anomaly_field.model"), "leave out one of them");
    if (!f.file.empty()) {
        const auto grid =
            std::make_shared<const GeodeticGrid>(grid_of(s, f.file, {"east_mgal", "north_mgal", "up_mgal"}, units::mgal));
        const auto path = sim::make_path(s.sim.path, s.sim.earth.ellipsoid);
        for (double t = 0.0; t <= s.sim.duration; t += 1.0) {
            const Geodetic p = path->at(t).position;
            if (!grid->covers(p.lat, p.lon))
                throw input_error(fmt::format("does not cover the path: after {:.0f} s it is at {:.5f}, {:.5f} degrees", t,
                                              p.lat / units::deg, p.lon / units::deg),
                                  place("anomaly_field.file"), "give a larger grid or a shorter path");
        }
        return [grid](const Geodetic& p) { return earth::ned_from_enu(grid->at(p.lat, p.lon)); };
    }
    if (f.model.empty()) return {};
    const auto model = std::make_shared<const earth::GravityField>(f.model, f.folder);
    return [model](const Geodetic& p) { return model->disturbance_n(p); };
}

}  // namespace schuler::settings
