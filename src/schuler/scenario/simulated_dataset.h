// A simulated data set: the logs exactly as in its files, and the truth, which is in no file.
#pragma once

#include "schuler/core/instrument_logs.h"
#include "schuler/core/samples.h"
#include "schuler/io/text/csv/csv_ranges.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/sim/exact_flight.h"
#include "schuler/sim/simulate.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace schuler::scenario {

class SimulatedSky;

/// Status of a receiver's channels, ten times per second.
struct ReceiverRow {
    Time time;
    double cn0 = not_given;     ///< dB-Hz, true, of the signals present
    double jammed = not_given;  ///< dB, J/S of all jammers; minus infinity without one
    int heard = 0;              ///< number of satellites present
    int code = 0, phase = 0;    ///< channels that track the code, and those that also track the carrier phase
};

/// A simulated data set: the recording exactly as in its files, the settings of its dataset.toml, and the truth, which is in no
/// file.
struct SimulatedDataset {
    std::string name;
    settings::SettingList settings;
    Recording recording;
    sim::SimulatedData truth;
    InstrumentLogs instruments;
    std::shared_ptr<const SimulatedSky> sky;  ///< of a receiver at correlator level; null if there is none
    std::vector<ReceiverRow> receiver_rows;   ///< only for that receiver
    std::vector<io::StationRow> stations;
    std::vector<std::pair<std::string, std::string>> texts;  ///< further files by name
    std::uint64_t seed = 1;
};

/// Simulates and rounds every number to the digits of the files, so that processing the files gives identical bits. `assumed`:
/// the scenario assumed by the filter, if different (the filter then assumes errors that are not simulated). `flown`: see sim::simulate.
[[nodiscard]] SimulatedDataset simulate_dataset(const settings::ScenarioConfig& scenario,
                                                const settings::ScenarioConfig* assumed = nullptr,
                                                const sim::ExactFlight* flown = nullptr);

/// Writes imu.csv, gnss.csv, baro.csv, reference.csv and dataset.toml. @throws Error(Input) if the folder cannot be written.
void write_dataset(const SimulatedDataset& data, const std::filesystem::path& folder);

}  // namespace schuler::scenario
