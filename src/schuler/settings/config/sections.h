// The sections of the option table, each in its own file.
#pragma once

#include "schuler/core/error.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/option_builders.h"

#include <string>
#include <string_view>

namespace schuler::settings {

void add_dataset_options(OptionTable<Config>& table);  ///< name, time, vehicle, earth, files
void add_imu_options(OptionTable<Config>& table);
void add_gnss_options(OptionTable<Config>& table);
void add_raw_gnss_options(OptionTable<Config>& table);    ///< raw measurements
void add_base_options(OptionTable<Config>& table);        ///< a base station
void add_filter_options(OptionTable<Config>& table);      ///< baro, mag, initial, filter
void add_coupling_options(OptionTable<Config>& table);    ///< filter.loose, filter.separate, filter.integrity
void add_gravity_options(OptionTable<Config>& table);     ///< gravity, anomaly
void add_instrument_options(OptionTable<Config>& table);  ///< gauges, log, compass
void add_ranging_options(OptionTable<Config>& table);     ///< ranges
void add_run_options(OptionTable<Config>& table);         ///< run, outage, output

/// One file or a list of them; none means "not given".
template <class Access>
Option<Config> file_list(const std::string& key, const std::string& help, Access access) {
    return special<Config>(
        key, "a file or a list of files", help,
        [=](Config& c, const Value& v) {
            std::vector<std::string>& names = access(c);
            names.clear();
            if (v.text() != nullptr) names.push_back(*v.text());
            for (const Value& item : v.list() != nullptr ? *v.list() : ValueList{}) {
                if (item.text() == nullptr)
                    throw input_error(fmt::format("{} is not a file name", to_toml(item)), {}, "put its name in quotes");
                names.push_back(*item.text());
            }
            if (names.empty())
                throw input_error(fmt::format("{} is not a file or a list of files", to_toml(v)), {},
                                  "give a file or a list of files");
        },
        [=](const Config& c) -> std::optional<Value> {
            const std::vector<std::string>& names = access(c);
            if (names.empty()) return std::nullopt;
            ValueList list;
            for (const std::string& name : names) list.push_back({name});
            return Value{std::move(list)};
        });
}

/// Runs work; an error with only a key receives the place of the corresponding setting.
template <class Work>
void with_places(const SettingList& settings, Work work) {
    try {
        work();
    } catch (const Error& e) {
        if (e.kind() != ErrorKind::Input || e.place().line > 0 || e.place().key.empty()) throw;
        const std::string key = e.place().key, bare = key.substr(0, key.find('['));
        const Setting* best = nullptr;
        for (const Setting& s : settings) {
            if (s.key == bare || (best == nullptr && s.key.starts_with(bare + "."))) best = &s;
        }
        if (best == nullptr) throw;
        throw input_error(e.reason(), {best->place.file, best->place.line, best->place.column, key}, e.hint());
    }
}

/// A polynomial of the disturbance requires the sigmas of its coefficients. @throws Error(Input), gravity.model.
void check_gravity(const GravityConfig& gravity);

}  // namespace schuler::settings
