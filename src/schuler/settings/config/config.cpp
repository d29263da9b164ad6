#include "schuler/settings/config/config.h"

#include "schuler/sensor/grades.h"
#include "schuler/settings/config/applicability.h"
#include "schuler/settings/config/sections.h"
#include "schuler/settings/toml_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace schuler::settings {
namespace {

OptionTable<Config> make_table() {
    OptionTable<Config> table;
    add_dataset_options(table);
    add_imu_options(table);
    add_gnss_options(table);
    add_raw_gnss_options(table);
    add_base_options(table);
    add_filter_options(table);
    add_coupling_options(table);
    add_gravity_options(table);
    add_instrument_options(table);
    add_ranging_options(table);
    add_run_options(table);
    table.edit_specs([](OptionSpec& spec) {
        if (const Applicability* one = applicability_of(spec.key)) spec.applies = one->condition;
    });
    return table;
}

bool is_imu_number(const std::string& key) { return key.starts_with("imu.gyro_") || key.starts_with("imu.accel_"); }

std::optional<double> whole_number(std::string_view text) {
    double x = 0.0;
    const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), x);
    if (ec != std::errc() || end != text.data() + text.size() || !(std::abs(x) < 1e10)) return std::nullopt;
    return x;
}

}  // namespace

Config::Config() { filter.imu.errors = sensor::imu_grade(grade); }

const OptionTable<Config>& config_table() {
    static const OptionTable<Config> table = make_table();
    return table;
}

Config config_from(const SettingList& settings) {
    Config config;
    config_table().apply(settings, config);
    const auto given = [&](std::string_view key) { return std::ranges::find(settings, key, &Setting::key) != settings.end(); };
    if (!given("imu.estimate_noise")) {
        // a grade alone is only an estimate of the noise
        config.filter.imu.estimate_noise = !given("imu.gyro_noise_deg_sqrt_h") && !given("imu.accel_noise_m_s_sqrt_h");
    }
    fusion::BaroSettings& baro = config.filter.baro;
    baro.fit_std = !given("baro.white_m");
    baro.fit_bias_walk = !given("baro.bias_walk_m");
    fusion::MagSettings& mag = config.filter.mag;
    mag.fit_heading_std = !given("mag.heading_std_deg");
    mag.fit_bias_walk = !given("mag.heading_bias_walk_deg");
    mag.fit_deviation = !given("mag.heading_deviation_deg");
    mag.fit_disturbance = !given("mag.heading_disturbance_deg");
    const sensor::ImuErrorModel& unit = config.filter.imu.errors;
    config.filter.imu.noiseless = unit.gyro_noise == 0.0 && unit.accel_noise == 0.0;
    if (config.preset == "complex22") {
        // The paper's recommended values for a stand-alone receiver, lower ends of its ranges (after (3.2.2)).
        sensor::GnssErrorModel& g = config.filter.gnss.errors;
        if (!given("gnss.correlated_m")) g.correlated_position = {5.0, 5.0, 7.0};
        if (!given("gnss.correlated_velocity_m_s")) g.correlated_velocity.setConstant(0.02);
        if (!given("gnss.correlated_time_s")) g.correlated_time = 2000.0;
        if (!given("gnss.correlated_distance_m")) g.correlated_distance = 250e3;
        if (!given("gnss.correlated_velocity_time_s")) g.correlated_velocity_time = 20.0;
    }
    with_places(settings, [&config] { check_gravity(config.gravity); });
    config.filter.coupling = config.scheme == Scheme::Separate       ? fusion::Coupling::Separate
                             : config.scheme == Scheme::Tight        ? fusion::Coupling::Tight
                             : config.scheme == Scheme::Intermediate ? fusion::Coupling::Intermediate
                             : config.scheme == Scheme::Deep         ? fusion::Coupling::Deep
                                                                     : fusion::Coupling::Loose;
    config.filter.ranging.corrections = config.raw.solver.ranges;
    const bool wheeled = config.filter.vehicle == fusion::VehicleKind::Car;
    config.nonholonomic = config.nonholonomic.value_or(wheeled);
    config.filter.constraints.nonholonomic = *config.nonholonomic;
    // Scale and misalignment errors of a unit cause errors that grow with every turn, not represented by white noise.
    const sensor::ImuErrorModel& imu = config.filter.imu.errors;
    constexpr double telling_scale = 2e-4, telling_misalignment = 1e-3;
    // In a precise unit smaller ones tell: if 100 s of 1 m/s^2, or a radian of rotation, err by four times the random walk of 100 s.
    constexpr double telling_ratio = 4.0, span = 100.0, acceleration = 1.0;
    const bool scale_tells = imu.accel_scale * acceleration * span > telling_ratio * imu.accel_noise * std::sqrt(span),
               misalignment_tells = imu.gyro_misalignment > telling_ratio * imu.gyro_noise * std::sqrt(span);
    config.scale_factors =
        config.scale_factors.value_or(std::max(imu.gyro_scale, imu.accel_scale) >= telling_scale || scale_tells);
    config.filter.scale_factors = *config.scale_factors;
    // on a road, with rotation about one axis only, a cross-axis gyro error resembles a tilt that grows with every bend
    config.misalignments =
        config.misalignments.value_or(wheeled || imu.gyro_misalignment >= telling_misalignment || misalignment_tells);
    config.filter.misalignments = *config.misalignments;
    return config;
}

SettingList overlaid(SettingList base, const SettingList& above) {
    const auto named = [&above](std::string_view key) { return std::ranges::find(above, key, &Setting::key) != above.end(); };
    if (named("imu.grade")) std::erase_if(base, [](const Setting& s) { return is_imu_number(s.key); });
    if (const auto preset = std::ranges::find(above, "filter.preset", &Setting::key);
        preset != above.end() && preset->value.text() != nullptr) {
        const std::string& name = *preset->value.text();
        std::array<std::string_view, 2> implied{"filter.scheme", "filter.loose"};
        if (name == "gravity27") implied = {};
        else if (!coupling_of_preset(name)) implied = {"filter.scale_factors", "filter.misalignments"};
        std::erase_if(base, [&](const Setting& s) { return std::ranges::find(implied, s.key) != implied.end(); });
    }
    if (named("ranges.clock"))
        std::erase_if(base, [](const Setting& s) { return s.key == "ranges.clock_h0_s" || s.key == "ranges.clock_h_minus2_hz"; });
    base.insert(base.end(), above.begin(), above.end());
    return base;
}

Setting setting_from_text(const std::string& text) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
        throw input_error(fmt::format("\"{}\" is not key=value", text), {"--set", 0, 0, {}},
                          "write for example --set imu.grade=tactical");
    }
    std::string key = text.substr(0, equals);
    while (!key.empty() && key.back() == ' ') key.pop_back();
    // uses the same flattening as for a file, so that unknown keys and whole sections give the same messages
    ValueTable root{{key, parse_toml_value(text.substr(equals + 1))}};
    SettingList list = config_table().read(root, "--set");
    if (list.empty()) throw input_error("is a section", {"--set", 0, 0, key}, "name one key of it");
    return list.front();
}

RunTime run_time_from_text(const std::string& text, const std::string& option) {
    const bool absolute = text.starts_with("abs:");
    const std::optional<double> x = whole_number(std::string_view(text).substr(absolute ? 4 : 0));
    if (!x) {
        throw input_error(fmt::format("\"{}\" is not a time", text), {option, 0, 0, {}},
                          "give seconds after the first GNSS epoch, or abs:T on the data set's own axis");
    }
    return {*x, absolute};
}

std::vector<OutageSpan> outages_from_text(const std::string& text) {
    std::vector<OutageSpan> out;
    std::size_t begin = 0;
    while (begin <= text.size()) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string item = text.substr(begin, end - begin);
        const std::size_t colon = item.rfind(':');
        const auto bad = [&] {
            return input_error(fmt::format("\"{}\" is not an outage", item), {"--outage", 0, 0, {}},
                               "write T:DUR[,T:DUR...] in seconds, for example 50:15,100:15");
        };
        if (colon == std::string::npos || colon == 0 || item.substr(0, colon) == "abs") throw bad();
        const std::optional<double> duration = whole_number(std::string_view(item).substr(colon + 1));
        const bool absolute = item.starts_with("abs:");
        const std::optional<double> start = whole_number(std::string_view(item).substr(0, colon).substr(absolute ? 4 : 0));
        if (!duration || !start || !(*duration > 0.0)) throw bad();
        out.push_back({*start, *duration, absolute});
        begin = end + 1;
    }
    return out;
}

std::string_view scheme_name(Scheme scheme) {
    switch (scheme) {
        case Scheme::Gnss: return "gnss";
        case Scheme::Separate: return "separate";
        case Scheme::Tight: return "tight";
        case Scheme::Intermediate: return "intermediate";
        case Scheme::Deep: return "deep";
        default: return "loose";
    }
}

std::string_view loop_name(fusion::Loop loop) {
    return loop == fusion::Loop::Open ? "open" : loop == fusion::Loop::Mixed ? "mixed" : "closed";
}

}  // namespace schuler::settings
