// The sections of the option table, each in its own file.
#pragma once

#include "schuler/app/config.h"

namespace schuler::app {

void add_dataset_options(OptionTable<Config>& table);  ///< name, time, vehicle, earth, files
void add_imu_options(OptionTable<Config>& table);
void add_gnss_options(OptionTable<Config>& table);
void add_raw_gnss_options(OptionTable<Config>& table);  ///< raw measurements
void add_filter_options(OptionTable<Config>& table);   ///< baro, mag, initial, filter
void add_coupling_options(OptionTable<Config>& table); ///< filter.loose, filter.separate, filter.integrity
void add_gravity_options(OptionTable<Config>& table);  ///< gravity, anomaly
void add_aid_options(OptionTable<Config>& table);       ///< gauges, log, compass
void add_ranging_options(OptionTable<Config>& table);  ///< ranges
void add_run_options(OptionTable<Config>& table);      ///< run, outage, output

/// A polynomial of the disturbance needs the sigmas of its coefficients. @throws Error(Input) at the setting of the model.
void check_gravity(const GravityConfig& gravity, const SettingList& settings);

}  // namespace schuler::app
