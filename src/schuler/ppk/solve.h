// Carrier-phase positions of a whole log relative to a base station.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/ranging.h"
#include "schuler/ppk/arcs.h"
#include "schuler/ppk/settings.h"
#include "schuler/ppk/solution.h"

#include <optional>
#include <string>
#include <vector>

namespace schuler::ppk {

/// Both receivers' logs, in time order, and known data of the base.
struct Input {
    const gnss::ObservationLog* rover = nullptr;
    const gnss::ObservationLog* base = nullptr;
    std::string rover_name, base_name;  ///< files, for messages
    std::optional<Ecef> base_position;  ///< of its antenna, as given; else the header's, else its own single-point solution
    const gnss::Antenna *rover_antenna = nullptr, *base_antenna = nullptr;  ///< if calibrated
    const gnss::SatelliteSource* source = nullptr;
    gnss::SinglePointSettings single;
    std::optional<gnss::BroadcastIonosphere> ionosphere;
};

enum class PlaceOfBase { Given, Header, SinglePoint };

struct Solution {
    std::vector<EpochSolution> epochs;
    RangingLog ranges;  ///< Settings::ranges: relative to the base (differential_ranges.h)
    Ecef base;
    PlaceOfBase place = PlaceOfBase::Given;
    double base_sigma = 0;        ///< m, of the base position: 0 if given or from the header
    double longest_baseline = 0;  ///< m
    ArcCounts rover_arcs, base_arcs;
    [[nodiscard]] std::size_t count(Quality quality) const;
};

/// The base position is checked against its own single-point solution. @throws Error(Input) with base.observations or
/// base.position: logs without common time or satellites, identical logs, a base that moves or is at another
/// position.
[[nodiscard]] Solution solve(const Input& input, const Settings& settings, WarningLog& warnings);

/// Position of the marker plus the antenna offsets up, east and north, as given in a header.
[[nodiscard]] Ecef antenna_of(const Ecef& marker, const Eigen::Vector3d& up_east_north);

}  // namespace schuler::ppk
