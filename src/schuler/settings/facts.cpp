#include "schuler/settings/facts.h"

#include "schuler/dataset/description.h"
#include "schuler/dataset/paths.h"
#include "schuler/settings/config/config.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>

namespace schuler::settings {
namespace {

struct ToValue {
    Value operator()(bool x) const { return {x}; }
    Value operator()(double x) const { return {x}; }
    Value operator()(const std::string& x) const { return {x}; }
    template <class T>
    Value operator()(const std::vector<T>& list) const {
        ValueList out;
        for (const T& x : list) out.push_back((*this)(x));
        return {std::move(out)};
    }
    template <class T>
    Value operator()(const std::map<std::string, T>& table) const {
        ValueTable out;
        for (const auto& [key, x] : table) out.emplace_back(key, (*this)(x));
        return {std::move(out)};
    }
};

inspect::GivenFile file_of(const dataset::FileSource& source, const std::filesystem::path& folder, const std::string& key) {
    if (source.file.empty())  // for the log that takes this role
        return {{}, {}, source.columns, source.scale, source.time_offset, {}};
    inspect::GivenFile given{
        dataset::resolved(folder, source.file, key), source.file, source.columns, source.scale, source.time_offset, {}};
    for (const std::string& part : source.parts) given.parts.push_back(dataset::resolved(folder, part, key));
    return given;
}

std::string vehicle_name(const Config& config) {
    const auto value = config_table().find("vehicle.kind")->get(config);
    return value && value->text() != nullptr ? *value->text() : std::string();
}

}  // namespace

Value value_of(const FactValue& value) { return std::visit(ToValue{}, value); }

FactValue fact_value_of(const Value& value) {
    if (value.flag() != nullptr) return *value.flag();
    if (value.is_number()) return value.number();
    if (value.text() != nullptr) return *value.text();
    if (const ValueList* list = value.list(); list != nullptr) {
        if (std::ranges::all_of(*list, [](const Value& v) { return v.is_number(); })) {
            std::vector<double> numbers;
            for (const Value& v : *list) numbers.push_back(v.number());
            return numbers;
        }
        if (std::ranges::all_of(*list, [](const Value& v) { return v.text() != nullptr; })) {
            std::vector<std::string> texts;
            for (const Value& v : *list) texts.push_back(*v.text());
            return texts;
        }
    }
    if (const ValueTable* table = value.table(); table != nullptr) {
        std::map<std::string, double> numbers;
        std::map<std::string, std::string> texts;
        for (const auto& [key, v] : *table) {
            if (v.is_number()) numbers[key] = v.number();
            if (v.text() != nullptr) texts[key] = *v.text();
        }
        if (numbers.size() == table->size()) return numbers;
        if (texts.size() == table->size()) return texts;
    }
    return to_toml(value);
}

SettingList settings_of(const std::vector<Fact>& facts, const std::string& origin) {
    SettingList out;
    for (const Fact& fact : facts) {
        const auto* option = config_table().find(fact.key);
        if (fact.how == Known::File && option == nullptr) continue;
        Value value = value_of(fact.value);
        // facts do not tell whole numbers from others
        if (option != nullptr && option->spec.shape == Shape::Integer && value.is_number())
            value.data = static_cast<std::int64_t>(std::llround(value.number()));
        out.push_back({fact.key, std::move(value), {origin, 0, 0, fact.key}});
    }
    return out;
}

SettingList completed(SettingList found, SettingList given) {
    for (Setting& s : given) {
        if (s.value.table() == nullptr) continue;
        const auto same = std::ranges::find(found, s.key, &Setting::key);
        if (same == found.end() || same->value.table() == nullptr) continue;
        ValueTable both = *s.value.table();
        for (const NamedValue& entry : *same->value.table())
            if (std::ranges::find(both, entry.first, &NamedValue::first) == both.end()) both.push_back(entry);
        s.value.data = std::move(both);
    }
    return overlaid(std::move(found), given);
}

inspect::Given given_of(const Config& c, const SettingList& given, const std::filesystem::path& folder) {
    inspect::Given g;
    for (const Setting& s : given) g.keys.insert(s.key);
    g.imu = file_of(c.imu, folder, "imu.file");
    g.gnss = file_of(c.gnss, folder, "gnss.file");
    g.baro = file_of(c.baro, folder, "baro.file");
    g.mag = file_of(c.mag, folder, "mag.file");
    g.reference = file_of(c.reference, folder, "reference.file");
    g.find_imu = c.imu.file.empty();
    // with a position at the start the IMU may be meant to navigate alone
    g.find_gnss = c.gnss.file.empty() && c.raw.observations.empty() && c.ranges.file.empty() && !g.has("initial.lat_deg");
    g.find_logs = c.imu.file.empty() && c.gnss.file.empty() && c.raw.observations.empty() && c.ranges.file.empty();
    g.fix_codes = c.fix_codes;
    if (g.has("vehicle.kind")) g.vehicle = vehicle_name(c);
    g.axes = c.axes;
    if (g.has("imu.axes")) g.C_bs = c.filter.imu.C_bs;
    if (g.has("imu.mounting_deg") && !c.filter.imu.estimate_mounting) g.mounting_rpy = c.filter.imu.mounting_rpy;
    if (g.has("imu.grade")) {
        g.gyro_bias = c.filter.imu.errors.gyro_initial_bias();
        g.gyro_noise = c.filter.imu.errors.gyro_noise;
        g.accel_bias = c.filter.imu.errors.accel_initial_bias();
    }
    const fusion::GnssSettings& gnss = c.filter.gnss;
    if (g.has("gnss.latency_s") && !gnss.estimate_latency) g.latency = gnss.latency;
    if (g.has("gnss.use_velocity")) g.use_velocity = gnss.use_velocity;
    g.velocity_latency = gnss.velocity_latency;
    g.height_latency = gnss.height_latency;
    g.velocity_down_latency = gnss.velocity_down_latency;
    return g;
}

}  // namespace schuler::settings
