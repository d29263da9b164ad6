// A simulated data set: the logs exactly as its files carry them, and the truth that no file has.
#pragma once

#include "schuler/core/aid_samples.h"
#include "schuler/core/samples.h"
#include "schuler/io/text/csv_ranges.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/sim/simulate.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace schuler::scenario {

class SimulatedSky;

/// What became of a receiver's channels, ten times a second.
struct ReceiverRow {
    Time time;
    double cn0 = not_given;     ///< dB-Hz, of the signals that are there, true
    double jammed = not_given;  ///< dB, J/S of all jammers; minus infinity without one
    int heard = 0;              ///< satellites that are there
    int code = 0, phase = 0;    ///< channels that follow the code, and the carrier's phase too
};

/// A simulated data set: the recording exactly as its files carry it, the settings of its dataset.toml, and the truth that no
/// file has.
struct SimulatedDataset {
    std::string name;
    settings::SettingList settings;
    Recording recording;
    sim::SimulatedData truth;
    AidLog aids;
    std::shared_ptr<const SimulatedSky> sky;  ///< of a receiver at correlator level; null without one
    std::vector<ReceiverRow> receiver_rows;   ///< of that receiver alone
    std::vector<io::StationRow> stations;
    std::vector<std::pair<std::string, std::string>> texts;  ///< further files by name
    std::uint64_t seed = 1;
};

/// Simulates and rounds every number to the digits of the files, so that processing the files gives the same bits.
/// `assumed`: the scenario that the filter assumes, where it is another one (the filter then assumes errors that are not simulated).
[[nodiscard]] SimulatedDataset simulate_dataset(const settings::ScenarioConfig& scenario,
                                                const settings::ScenarioConfig* assumed = nullptr);

/// Writes imu.csv, gnss.csv, baro.csv, reference.csv and dataset.toml. @throws Error(Input) where the folder cannot be written.
void write_dataset(const SimulatedDataset& data, const std::filesystem::path& folder);

}  // namespace schuler::scenario
