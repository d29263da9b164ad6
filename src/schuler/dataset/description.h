// The components of a data set and the meaning of its numbers, as given by a user or by the files themselves.
#pragma once

#include "schuler/core/position.h"
#include "schuler/core/time.h"
#include "schuler/gnss/single_point.h"
#include "schuler/ppk/settings.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace schuler::dataset {

/// A file of a data set and the names of its columns.
struct FileSource {
    std::string file;                            ///< relative to the data set's folder; $NAME denotes environment variables
    std::map<std::string, std::string> columns;  ///< canonical name = the file's name
    std::map<std::string, double> scale;         ///< canonical name = factor to the canonical unit
    double time_offset = 0.0;                    ///< s, added to the file's times
    std::vector<std::string> parts;              ///< further files of the same log, joined in order of time
};

struct TimeConfig {
    TimeScale scale = TimeScale::Gps;
    std::optional<int> week;  ///< GPS week of seconds of week
    std::string date;         ///< YYYY-MM-DD of seconds of day
};

/// Raw measurements of a receiver and their processing to fixes.
struct RawGnssConfig {
    std::vector<std::string> observations;  ///< files; empty: none
    std::vector<std::string> navigation;
    std::string precise;
    std::string antennas;  ///< file of calibrations; empty: none
    std::string antenna;   ///< type of the receiver's; empty: its header's
    gnss::SinglePointSettings solver;
    bool phase_velocity = false;  ///< velocity from phases instead of Doppler
};

/// A base station for carrier-phase positions.
struct BaseConfig {
    std::vector<std::string> observations;  ///< files; empty: no base
    std::optional<Ecef> position;           ///< of its antenna; empty: the header's
    bool position_is_geodetic = true;       ///< the form in which it was given
    std::string antenna;                    ///< type; empty: the header's
    ppk::Settings settings;
};

enum class Quaternion { BodyToNed, SensorToEnu };

/// The files of a data set and how they are read.
struct Description {
    TimeConfig time;
    FileSource imu, gnss, baro, mag, odometer, heading, reference;
    FileSource ranges;                ///< [stations] file: pseudoranges to satellites and ground stations
    double clock_drift = 0.0;         ///< s/s, rate by which the clock of the IMU and of the logs that share it runs fast
    std::string station_coordinates;  ///< [stations] coordinates: positions of the stations
    RawGnssConfig raw;
    BaseConfig base;
    std::string axes = "frd";  ///< sensor axes of the IMU
    std::string mag_axes;      ///< of the magnetometer; empty: those of the IMU
    std::map<std::string, std::string> fix_codes;
    std::optional<double> undulation;  ///< m, geoid above ellipsoid, for heights above mean sea level
    Quaternion quaternion = Quaternion::BodyToNed;
    double sea_level_pressure = 101325.0;  ///< Pa, for the conversion of barometer pressures to heights
};

}  // namespace schuler::dataset
