// The log of the signal generator: where each satellite was and what a receiver at rest should have measured.
#pragma once

#include "schuler/gnss/atmosphere.h"
#include "schuler/gnss/satellite.h"

#include "io/io_fixture.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace schuler::gnss {

/// One line of the generator's log.
struct Truth {
    SatelliteId satellite;
    Time time;
    Eigen::Vector3d position, velocity;
    Direction direction;
    double range, pseudorange;
};

inline std::vector<Truth> spirent_truth() {
    std::ifstream file(io::test::data_folder() / "spirent_static_4h" / "sat_truth_noatm.csv");
    const std::map<std::string, System> systems = {{"GPS", System::Gps},           {"GLONASS", System::Glonass},
                                                   {"GALILEO", System::Galileo},   {"BeiDou", System::BeiDou},
                                                   {"Quasi-Zenith", System::Qzss}, {"IRNSS", System::Navic}};
    std::vector<Truth> rows;
    std::string line;
    for (int i = 0; std::getline(file, line); ++i) {
        if (i < 5) continue;
        std::vector<std::string> cells;
        std::istringstream cell_stream(line);
        for (std::string cell; std::getline(cell_stream, cell, ',');) cells.push_back(cell);
        const auto system = systems.find(cells.at(2));
        if (system == systems.end()) {
            ADD_FAILURE() << "unknown system " << cells.at(2);
            break;
        }
        const auto number = [&](std::size_t k) { return std::stod(cells.at(k)); };
        Truth t;
        t.satellite = {system->second, static_cast<std::uint8_t>(std::stoi(cells.at(3)))};
        t.time = Time::from_seconds(1357207140.0 + number(0) * 1e-3);
        t.position = {number(6), number(7), number(8)};
        t.velocity = {number(9), number(10), number(11)};
        t.direction = {number(12), number(13)};
        t.range = number(14);
        t.pseudorange = number(15);
        rows.push_back(t);
    }
    return rows;
}

}  // namespace schuler::gnss
