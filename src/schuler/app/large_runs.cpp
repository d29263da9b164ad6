#include "schuler/app/large_runs.h"

#include "schuler/core/error.h"
#include "schuler/settings/scenario/scenario.h"

#include <fmt/format.h>

#include <algorithm>

namespace schuler::app {

namespace {

// Measured on one core of 2024, simulation and filter together: examples/uav-mems.toml of one and of three hours.
constexpr double seconds_per_sample = 4e-6, seconds_per_fix = 2e-5, seconds_per_range = 2e-6, seconds_per_other = 1e-5,
                 seconds_per_truth = 4e-6, bytes_per_sample = 420.0;
constexpr double long_time = 20.0, much_memory = 2e9;  // s, bytes: above these a notice is given

const settings::Value* value_of(const settings::SettingList& given, std::string_view key) {
    const auto found = std::ranges::find(given, key, &settings::Setting::key);
    return found == given.end() ? nullptr : &found->value;
}

/// As for a run: the file's settings and those of --set.
settings::ScenarioConfig scenario_of(const settings::SettingList& given, const std::string& file) {
    settings::SettingList list = settings::scenario_settings(file, std::nullopt);
    if (const settings::Value* set = value_of(given, "set"); set != nullptr && set->list() != nullptr)
        for (const settings::Value& text : *set->list())
            if (text.text() != nullptr) list.push_back(settings::setting_from_text(*text.text()));
    return settings::scenario_from(list);
}

std::string time_text(double seconds) {
    if (seconds < 100.0) return fmt::format("{:.0f} s", seconds);
    if (seconds < 6000.0) return fmt::format("{:.0f} minutes", seconds / 60.0);
    return fmt::format("{:.1f} hours", seconds / 3600.0);
}

}  // namespace

std::string notice_of_size(const settings::SettingList& given) {
    const settings::Value* file = value_of(given, "scenario");
    if (file == nullptr || file->text() == nullptr) return {};
    try {
        const settings::ScenarioConfig scenario = scenario_of(given, *file->text());
        double runs = 1.0;
        if (const settings::Value* asked = value_of(given, "runs"); asked != nullptr && asked->is_number())
            runs = asked->number();
        const double duration = scenario.sim.duration, samples = duration * scenario.sim.imu.rate,
                     fixes = duration * scenario.sim.gnss.rate;
        const double ranges = 24.0 * duration * (scenario.ranging.rate + scenario.receiver_channels.rate);
        const sim::InstrumentErrors& instruments = scenario.instruments;
        const double others = duration * (scenario.sim.baro.rate + scenario.sim.mag.rate + instruments.gauges.rate +
                                          instruments.log.rate + instruments.compass.rate);
        const double truth = duration * scenario.sim.reference_rate;
        const double seconds = samples * seconds_per_sample + fixes * seconds_per_fix + ranges * seconds_per_range +
                               others * seconds_per_other + truth * seconds_per_truth;
        const double bytes = (samples + fixes + ranges + others + truth) * bytes_per_sample;
        if (seconds < long_time && bytes < much_memory) return {};
        const auto many = [](double count, const char* what) {  // not what is little beside the samples
            return count > 1e6 ? fmt::format(", {:.2g} {}", count, what) : "";
        };
        return fmt::format("{:.2g} IMU samples, {:.2g} fixes{}{}{} a run: about {} {} and {:.1f} GB of memory", samples, fixes,
                           ranges > 0.0 ? fmt::format(", {:.2g} ranges", ranges) : "",
                           many(others, "samples of other instruments"), many(truth, "epochs of the truth"), time_text(seconds),
                           runs > 1.0 ? "each" : "on one core", bytes / 1e9);
    } catch (const Error&) {
        return {};  // the command itself reports the error
    }
}

}  // namespace schuler::app
