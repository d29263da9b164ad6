#include "schuler/study/allan.h"

#include "schuler/analysis/allan.h"
#include "schuler/core/units.h"
#include "schuler/dataset/recognise.h"
#include "schuler/fusion/timeline.h"
#include "schuler/math/spectrum.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outcome.h"
#include "schuler/report/result_table.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/dataset.h"
#include "schuler/settings/request.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/settings/toml_file.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/fuse.h"
#include "schuler/solution/loaded_dataset.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace schuler::study {
namespace {

constexpr std::size_t least_samples = 64, longest_segment = 16384;
constexpr double lines_per_decade = 48.0;  // of the spectrum in the output

/// Customary units of sensor noise, as divisors of SI.
struct SensorUnits {
    const char *name, *rate, *density, *white, *walk, *ramp, *quantization;
    double si_rate, si_white, si_quantization;
};
constexpr double root_hour = 60.0, hour = 3600.0;
const SensorUnits gyro_units{"gyro",    "deg/h", "deg/h/sqrt(Hz)",    "deg/sqrt(h)",          "deg/h/sqrt(h)",
                             "deg/h/h", "deg",   units::deg_per_hour, units::deg / root_hour, units::deg};
const SensorUnits accel_units{"accel", "mg",  "mg/sqrt(Hz)", "m/s/sqrt(h)",   "mg/sqrt(h)",
                              "mg/h",  "m/s", units::mg,     1.0 / root_hour, 1.0};

struct AxisNoise {
    const SensorUnits& unit;
    char axis;
    analysis::AllanDeviation allan;
    math::Spectrum spectrum;
};

struct ImuLog {
    std::string name;
    solution::LoadedDataset data;
};

bool is_scenario_file(const std::filesystem::path& path) {
    return path.extension() == ".toml" && std::ranges::any_of(settings::read_toml(path), [](const settings::NamedValue& v) {
               return v.first == "trajectory" || v.first == "duration_s";
           });
}

ImuLog imu_of(const settings::ProcessRequest& request, WarningLog& warnings) {
    if (is_scenario_file(request.input)) {
        solution::ResultBundle b =
            solution::simulated_bundle(settings::read_scenario(request.input, request.seed), request.over({}), warnings);
        return {b.name, std::move(b.data)};
    }
    const settings::Dataset dataset = settings::open_dataset(request.input, dataset::Needs::Imu, request.over({}));
    const settings::Config config = settings::config_from(dataset.settings);
    return {config.name.empty() ? dataset.name : config.name, solution::load_dataset(dataset, config, warnings)};
}

/// The spectrum as amplitude densities, averaged for even spacing on a logarithmic axis.
report::Json spectrum_of(const AxisNoise& a) {
    const std::vector<double> density = a.spectrum.density();
    std::vector<double> frequency, amplitude;
    for (std::size_t i = 1; i < density.size();) {
        const double end = a.spectrum.frequency(i) * std::pow(10.0, 1.0 / lines_per_decade);
        double sum = 0.0, middle = 0.0, n = 0.0;
        for (; i < density.size() && (n == 0.0 || a.spectrum.frequency(i) < end); ++i, n += 1.0) {
            sum += density[i];
            middle += a.spectrum.frequency(i);
        }
        frequency.push_back(middle / n);
        amplitude.push_back(std::sqrt(sum / n) / a.unit.si_rate);
    }
    return {{"frequency_hz", frequency}, {"density", amplitude}};
}

report::Json axis_json(const AxisNoise& a) {
    std::vector<double> tau, deviation, relative;
    const std::vector<analysis::AllanPoint> points = a.allan.points();
    for (const analysis::AllanPoint& p : points) {
        tau.push_back(p.tau);
        deviation.push_back(p.deviation / a.unit.si_rate);
        relative.push_back(p.relative_sigma);
    }
    const analysis::AllanCoefficients c = analysis::fitted(points);
    const auto with = [](double value, const char* unit) {
        return report::Json{{"value", report::json_number(value)}, {"unit", unit}};
    };
    return {{"sensor", a.unit.name},
            {"axis", std::string(1, a.axis)},
            {"unit", a.unit.rate},
            {"density_unit", a.unit.density},
            {"quantization", with(c.quantization / a.unit.si_quantization, a.unit.quantization)},
            {"white", with(c.white / a.unit.si_white, a.unit.white)},
            {"bias_instability", with(c.bias_instability / a.unit.si_rate, a.unit.rate)},
            {"random_walk", with(c.random_walk / a.unit.si_rate * root_hour, a.unit.walk)},
            {"ramp", with(c.ramp / a.unit.si_rate * hour, a.unit.ramp)},
            // clang-format off
            {"allan", {{"tau_s", tau}, {"deviation", deviation}, {"relative_sigma", relative}}},
            {"spectrum", spectrum_of(a)}};
    // clang-format on
}

/// The units differ between gyros and accelerometers and are therefore printed with the numbers.
std::string tables_of(const report::Json& out) {
    report::ResultTable table{
        fmt::format("{}: {:.0f} s at {:.6g} Hz, {} gaps", out["name"].get<std::string>(), out["duration_s"].get<double>(),
                    out["rate_hz"].get<double>(), out["gaps"].get<std::size_t>()),
        {{"", "axis"},
         {"quantization", "quantization"},
         {"white", "white noise"},
         {"bias_instability", "bias instability"},
         {"random_walk", "random walk"},
         {"ramp", "ramp"}}};
    for (const report::Json& a : out["axes"]) {
        std::vector<report::Cell>& row = table.rows.emplace_back(
            std::vector<report::Cell>{a["sensor"].get<std::string>() + " " + a["axis"].get<std::string>()});
        for (std::size_t i = 1; i < table.columns.size(); ++i) {
            const report::Json& number = a[table.columns[i].key];
            const double value = number["value"].is_number() ? number["value"].get<double>() : 0.0;
            row.push_back(value > 0.0 ? fmt::format("{:.3g} {}", value, number["unit"].get<std::string>()) : report::Cell{});
        }
    }
    return report::table_text(table) +
           "An instrument at rest shows its noise; of a moving one these are figures of the motion.\n";
}

}  // namespace

report::Outcome analyze_allan(const settings::ProcessRequest& request) {
    WarningLog warnings;
    const ImuLog log = imu_of(request, warnings);
    const fusion::ImuTimeline imu = fusion::make_imu_timeline(log.data.recording.imu, log.data.config.filter.imu, warnings);
    const std::size_t n = imu.increments.size();
    if (n < least_samples)
        throw input_error(fmt::format("{} samples are too few for an Allan deviation", n), {.file = request.input.string()},
                          fmt::format("give at least {}", least_samples));
    const double dt = imu.median_dt;
    // at least about eight segments, so that the density is more than noise
    const std::size_t segment = std::min(longest_segment, std::bit_floor(n / 4));
    std::vector<AxisNoise> axes;
    for (const SensorUnits* unit : {&gyro_units, &accel_units})
        for (const char axis : {'x', 'y', 'z'})
            axes.push_back({*unit, axis, analysis::AllanDeviation(dt), math::Spectrum(1.0 / dt, segment)});
    for (std::size_t i = 0; i < n; ++i) {
        const ImuIncrement& s = imu.increments[i];
        for (Eigen::Index k = 0; k < 3; ++k) {
            const double rates[] = {s.dtheta[k] / s.dt, s.dv[k] / s.dt};
            for (std::size_t sensor = 0; sensor < 2; ++sensor) {
                AxisNoise& a = axes[3 * sensor + static_cast<std::size_t>(k)];
                a.allan.add(rates[sensor]);
                a.spectrum.add(rates[sensor]);
            }
        }
        if (request.progress && i % 65536 == 0) request.progress(static_cast<double>(i) / static_cast<double>(n));
    }
    // clang-format off
    report::Json out{{"name", log.name},     {"rate_hz", 1.0 / dt}, {"duration_s", dt * static_cast<double>(n)},
             {"samples", n},         {"gaps", imu.gaps},    {"segments", axes.front().spectrum.segments()},
             {"axes", report::Json::array()}};
    // clang-format on
    for (const AxisNoise& a : axes) out["axes"].push_back(axis_json(a));
    report::Outcome done;
    done.tables = tables_of(out);
    done.json = report::text_of(out);
    done.warnings = warnings.summary();
    return done;
}

}  // namespace schuler::study
