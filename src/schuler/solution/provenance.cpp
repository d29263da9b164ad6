#include "schuler/solution/provenance.h"

#include "schuler/core/units.h"
#include "schuler/math/rotation.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/facts.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/loaded_dataset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

namespace schuler::solution {
namespace {

/// Reported for every run, in this order; further keys of these sections if given or found.
constexpr std::array reported = {"time.scale",
                                 "vehicle.kind",
                                 "imu.file",
                                 "imu.kind",
                                 "imu.stamp",
                                 "imu.axes",
                                 "imu.mounting_deg",
                                 "imu.grade",
                                 "imu.gyro_noise_deg_sqrt_h",
                                 "imu.accel_noise_m_s_sqrt_h",
                                 "gnss.file",
                                 "gnss.observations",
                                 "gnss.lever_arm_m",
                                 "gnss.latency_s",
                                 "gnss.velocity_latency_s",
                                 "gnss.height_latency_s",
                                 "gnss.velocity_down_latency_s",
                                 "gnss.height",
                                 "gnss.default_std_m",
                                 "gnss.default_std_velocity_m_s",
                                 "gnss.correlated_m",
                                 "baro.file",
                                 "baro.white_m",
                                 "baro.bias_walk_m",
                                 "mag.file",
                                 "mag.declination_deg",
                                 "mag.heading_std_deg",
                                 "mag.heading_bias_walk_deg",
                                 "mag.heading_deviation_deg",
                                 "mag.heading_disturbance_deg",
                                 "reference.file"};

bool describes_data(std::string_view key) {
    return std::ranges::any_of(std::array{"time.", "vehicle.", "imu.", "gnss.", "baro.", "mag.", "stations.", "reference.",
                                          "initial.", "filter.mechanization"},
                               [&](std::string_view section) { return key.starts_with(section); });
}

/// The largest of a value's numbers: the reference of a relative sigma.
double size_of(const FactValue& value) {
    if (const double* x = std::get_if<double>(&value)) return std::abs(*x);
    double size = 0.0;
    if (const auto* list = std::get_if<std::vector<double>>(&value))
        for (const double item : *list) size = std::max(size, std::abs(item));
    return size;
}

const Fact* named(const std::vector<Fact>& facts, std::string_view key) {
    const auto it = std::ranges::find(facts, key, &Fact::key);
    return it == facts.end() ? nullptr : &*it;
}

/// A latency that is not set is replaced by another one.
std::optional<double> latency_in_force(const fusion::Findings& f, std::string_view key) {
    if (key == "gnss.latency_s") return f.position_latency;
    if (key == "gnss.velocity_latency_s") return f.velocity_latency;
    if (key == "gnss.height_latency_s") return f.height_latency;
    if (key == "gnss.velocity_down_latency_s") return f.velocity_down_latency;
    return std::nullopt;
}

Fact heading_fact(const ResultBundle& b) {
    const fusion::Findings& f = b.result.findings;
    Fact fact;
    fact.key = "initial.heading_deg";
    fact.value = math::wrap_2pi(f.heading) / units::deg;
    fact.sigma = f.std_heading / units::deg;
    fact.how = b.data.given.contains(fact.key) ? Known::Given : f.heading_found ? Known::Found : Known::Default;
    if (fact.how == Known::Found) {
        fact.from = b.relative(f.started_at);
        fact.to = std::max(b.relative(f.aligned_at), fact.from);
    }
    fact.note = f.alignment;
    return fact;
}

class Reporter {
public:
    explicit Reporter(const ResultBundle& b) : b_(b), used_(settings::config_table().used(b.data.config)) {}

    [[nodiscard]] std::optional<Fact> of(const std::string& key) const {
        const fusion::Findings& f = b_.result.findings;
        const auto value = std::ranges::find(used_, key, &settings::Setting::key);
        const Fact* found = named(b_.data.facts, key);
        const bool given = b_.data.given.contains(key);
        Fact fact;
        fact.key = key;
        const std::optional<double> latency = b_.result.findings.in_force ? latency_in_force(f, key) : std::nullopt;
        if (latency) fact.value = *latency;
        else if (value != used_.end()) fact.value = settings::fact_value_of(value->value);
        else if (found != nullptr) fact.value = found->value;
        else return std::nullopt;
        fact.how = given ? Known::Given : Known::Default;
        if (!given && found != nullptr) {
            fact.how = found->how;
            fact.sigma = found->sigma;
            fact.from = found->from;
            fact.to = found->to;
            fact.note = found->note;
        }
        const auto tuned = std::ranges::find(f.tuned, key, &fusion::TunedSetting::key);
        if (tuned != f.tuned.end()) {
            fact.how = Known::Found;
            fact.sigma = tuned->relative ? tuned->sigma * size_of(fact.value) : tuned->sigma;
            fact.from = b_.relative(f.tuned_from);
            fact.to = b_.relative(f.tuned_to);
            fact.note = tuned->at_floor ? "the innovations would allow less: what such a device reaches at best"
                                        : "fitted to the innovations";
        }
        if (key == "imu.mounting_deg" && f.std_mounting_rpy.norm() > 0.0) {
            fact.how = Known::Found;
            fact.sigma = f.std_mounting_rpy.tail<2>().maxCoeff() / units::deg;
            fact.note = "from the direction of travel";
        }
        if (key.ends_with("_noise_scale") && b_.self_check && b_.self_check->widened) {
            fact.how = Known::Found;
            fact.note = fmt::format("from fixes withheld in windows of {:.0f} s", b_.self_check->length);
        }
        if (latency && value == used_.end()) {  // it follows another one
            const Fact leader = *of(key == "gnss.velocity_down_latency_s" ? "gnss.velocity_latency_s" : "gnss.latency_s");
            fact.how = leader.how == Known::Given ? Known::Default : leader.how;
            fact.sigma = leader.sigma;
            fact.note = "as " + leader.key;
        }
        return fact;
    }

private:
    const ResultBundle& b_;
    settings::SettingList used_;
};

}  // namespace

void take_in_force(settings::Config& c, const fusion::Findings& findings) {
    if (!findings.in_force) return;
    const fusion::Settings& s = *findings.in_force;
    fusion::Settings& f = c.filter;
    f.imu.mounting_rpy = s.imu.mounting_rpy;
    f.imu.mounting_std = s.imu.mounting_std;
    f.imu.found_mounting_std = s.imu.found_mounting_std;
    f.imu.estimate_mounting = f.imu.estimate_noise = false;
    f.imu.errors.gyro_noise = s.imu.errors.gyro_noise;
    f.imu.errors.accel_noise = s.imu.errors.accel_noise;
    f.imu.gyro_noise_scale = s.imu.gyro_noise_scale;
    f.imu.accel_noise_scale = s.imu.accel_noise_scale;
    f.imu.gyro_vibration = s.imu.gyro_vibration;
    f.imu.accel_vibration = s.imu.accel_vibration;
    f.gnss.latency = s.gnss.latency;
    f.gnss.latency_std = s.gnss.latency_std;
    f.gnss.velocity_latency_std = s.gnss.velocity_latency_std;
    f.gnss.jitter = s.gnss.jitter;
    f.gnss.std_scale = s.gnss.std_scale;
    f.gnss.velocity_std_scale = s.gnss.velocity_std_scale;
    f.gnss.velocity_latency = s.gnss.velocity_latency;
    f.gnss.height_latency = s.gnss.height_latency;
    f.gnss.velocity_down_latency = s.gnss.velocity_down_latency;
    f.gnss.default_std_position = s.gnss.default_std_position;
    f.gnss.default_std_velocity = s.gnss.default_std_velocity;
    f.gnss.errors = s.gnss.errors;
    f.gnss.estimate_latency = f.gnss.estimate_std = false;
    f.baro = s.baro;
    f.mag = s.mag;
    f.constraints.nonholonomic = s.constraints.nonholonomic;
    f.constraints.nonholonomic_auto = s.constraints.nonholonomic_auto;
    c.nonholonomic = s.constraints.nonholonomic;
}

std::string config_in_force(const LoadedDataset& data) {
    settings::Config c = data.config;
    c.filter.gnss.height = data.logged_height;  // the log is read again, with its original heights
    settings::SettingList used = settings::config_table().used(c);
    // A default lever arm is not checked against the data; written down, it would be given in a repeated run, and checked.
    const std::string lever_arm = "gnss.lever_arm_m";
    const auto found = [&](const Fact& f) { return f.key == lever_arm && f.how != Known::Default; };
    if (!data.given.contains(lever_arm) && std::ranges::none_of(data.facts, found))
        std::erase_if(used, [&](const settings::Setting& s) { return s.key == lever_arm; });
    return settings::to_toml(used, settings::config_table().specs(), true);
}

std::vector<Fact> facts_of(const ResultBundle& b) {
    const Reporter reporter(b);
    std::vector<std::string> keys(reported.begin(), reported.end());
    const auto add = [&](const std::string& key) {
        if (!describes_data(key) || std::ranges::find(keys, key) != keys.end()) return;
        if (key == "imu.estimate_noise" || key == "gnss.estimate_std") return;  // the facts are what was estimated
        const std::string section = key.substr(0, key.find('.') + 1);           // together with those of its section
        const auto last = std::find_if(keys.rbegin(), keys.rend(), [&](const std::string& k) { return k.starts_with(section); });
        keys.insert(last == keys.rend() ? keys.end() : last.base(), key);
    };
    for (const Fact& fact : b.data.facts) add(fact.key);
    for (const fusion::TunedSetting& tuned : b.result.findings.tuned) add(tuned.key);
    if (b.self_check && b.self_check->widened)
        for (const char* key : {"imu.gyro_noise_scale", "imu.accel_noise_scale"}) add(key);
    for (const std::string& key : b.data.given) add(key);
    std::vector<Fact> facts;
    for (const std::string& key : keys) {
        if (key == "initial.heading_deg") continue;
        if (std::optional<Fact> fact = reporter.of(key)) facts.push_back(std::move(*fact));
    }
    if (std::isfinite(b.result.findings.heading)) facts.push_back(heading_fact(b));
    return facts;
}

bool is_news(const Fact& fact) {
    static const settings::SettingList defaults = settings::config_table().used(settings::Config{});
    if (fact.how != Known::Given) return fact.how != Known::Default;
    const auto plain = std::ranges::find(defaults, fact.key, &settings::Setting::key);
    return plain == defaults.end() || settings::fact_value_of(plain->value) != fact.value;
}

}  // namespace schuler::solution
