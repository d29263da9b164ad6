#include "schuler/dataset/carrier_phase.h"

#include "schuler/core/error.h"
#include "schuler/dataset/paths.h"
#include "schuler/dataset/raw_gnss.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/io/raw_input.h"
#include "schuler/ppk/solve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace schuler::dataset {
namespace {

namespace fs = std::filesystem;

/// Combines hourly files of one receiver.
gnss::ObservationLog joined(std::vector<gnss::ObservationLog> logs) {
    std::ranges::stable_sort(
        logs, {}, [](const gnss::ObservationLog& l) { return l.epochs.empty() ? Time{INT64_MAX} : l.epochs.front().time; });
    gnss::ObservationLog out = std::move(logs.front());
    for (std::size_t i = 1; i < logs.size(); ++i) {
        const std::size_t before = out.observations.size();
        out.observations.insert(out.observations.end(), logs[i].observations.begin(), logs[i].observations.end());
        for (gnss::ObservationEpoch e : logs[i].epochs) {
            e.first += before;
            if (out.epochs.empty() || e.time > out.epochs.back().time) out.epochs.push_back(e);
        }
    }
    return out;
}

std::vector<gnss::ObservationLog> base_logs(const fs::path& folder, const Description& description, std::optional<Time> near,
                                            gnss::Navigation& navigation, WarningLog& warnings) {
    std::vector<gnss::ObservationLog> logs;
    for (const std::string& file : description.base.observations) {
        const fs::path path = resolved(folder, file, "base.observations");
        for (const std::string& rover : description.raw.observations) {
            std::error_code ec;
            if (fs::equivalent(path, resolved(folder, rover, "gnss.observations"), ec))
                throw input_error("is the rover's own log too", {file, 0, 0, "base.observations"},
                                  "name the log of the receiver at the known place");
        }
        io::RawInput input = io::read_raw_input(path, near, warnings);
        navigation.add(input.navigation);
        logs.push_back(std::move(input.observations));
    }
    return logs;
}

ppk::Settings settings_of(const Description& description, const gnss::BroadcastIonosphere& ionosphere) {
    ppk::Settings s = description.base.settings;
    const gnss::RangeSettings& ranges = description.raw.solver.ranges;
    s.code_sigma = ranges.code_sigma;
    s.base.longest_span = 2.0 * s.base.longest_age;
    s.arcs.phase_sigma = s.phase_sigma;
    s.arcs.doppler_sigma = ranges.doppler_sigma;
    s.air.troposphere = ranges.troposphere != gnss::TroposphereModel::None;
    s.air.mapping = ranges.mapping;
    s.air.relative_humidity = ranges.relative_humidity;
    if (ranges.ionosphere != gnss::IonosphereModel::None) s.air.ionosphere = ionosphere;
    return s;
}

GnssFix fix_of(const ppk::EpochSolution& s) {
    GnssFix fix;
    fix.time = s.time;
    fix.position = earth::geodetic_from_ecef(earth::wgs84, s.position);
    const Eigen::Matrix3d C_ne = earth::C_en(fix.position.lat, fix.position.lon).transpose();
    fix.std_position = (C_ne * s.covariance * C_ne.transpose()).diagonal().cwiseSqrt();
    constexpr double useful = 3.0;  // m/s: above this the value depends on the assumed motion only
    if (s.velocity.allFinite() && s.velocity_covariance.trace() < useful * useful) {
        fix.velocity_n = C_ne * s.velocity;
        fix.std_velocity = (C_ne * s.velocity_covariance * C_ne.transpose()).diagonal().cwiseSqrt();
    }
    fix.fix = s.quality == ppk::Quality::Fixed   ? FixType::RtkFixed
              : s.quality == ppk::Quality::Float ? FixType::RtkFloat
                                                 : FixType::Autonomous;
    fix.satellites = s.satellites;
    return fix;
}

/// The error of a float solution is that of its ambiguities, which codes reveal as slowly as their reflections change, and that of a
/// single-point one what the models of air and orbits leave, which is not learnt beside fixes that do not have it: of many fixes the
/// first counts in full and each further one by what it adds (ppk::BaselineFilter does so with codes).
void weigh_lasting(std::vector<GnssFix>& fixes, FixType kind, double correlation) {
    const GnssFix* before = nullptr;
    for (GnssFix& fix : fixes) {
        if (fix.fix != kind) continue;
        if (before != nullptr) fix.lasting = ppk::lasting((fix.time - before->time).seconds(), correlation);
        before = &fix;
    }
}

/// A receiver's antenna: of the type given, else of its header's.
const gnss::Antenna* antenna_of(const gnss::Antennas& antennas, const std::string& given, const gnss::ObservationLog& log,
                                const std::string& file, const char* key, WarningLog& warnings) {
    const std::string& type = given.empty() ? log.antenna : given;
    const gnss::Antenna* found = antennas.of_receiver(type);
    if (found == nullptr)
        warnings.add(key, type.empty() ? fmt::format("{} names no antenna: no calibration is used; give {}", file, key)
                                       : fmt::format("gnss.antennas has no antenna \"{}\" ({}): no calibration is used", type,
                                                     given.empty() ? "of the header of " + file : key));
    return found;
}

void tell(const ppk::Solution& s, const std::string& base, WarningLog& warnings) {
    const std::size_t fixed = s.count(ppk::Quality::Fixed), floating = s.count(ppk::Quality::Float),
                      single = s.count(ppk::Quality::Single);
    if (20 * (s.epochs.size() - fixed) > s.epochs.size())
        warnings.add("base.solution",
                     fmt::format("against {}: {} of {} epochs fixed, {} float, {} without the base; baseline up to {:.1f} km",
                                 base, fixed, s.epochs.size(), floating, single, 1e-3 * s.longest_baseline));
    const std::size_t slips = s.rover_arcs.found() + s.base_arcs.found();
    if (slips > 0) warnings.add("base.slips", "cycle slips found that the receivers did not report", slips);
}

}  // namespace

CarrierPhase carrier_phase(const fs::path& folder, const Description& description, bool ranges, WarningLog& warnings) {
    RawLogs rover = read_raw_logs(folder, description.raw, warnings);
    const std::optional<Time> near =
        rover.logs.front().epochs.empty() ? std::nullopt : std::optional(rover.logs.front().epochs.front().time);
    const gnss::ObservationLog base = joined(base_logs(folder, description, near, rover.navigation, warnings));
    const gnss::Antennas antennas = antennas_of(folder, description.raw, warnings);
    const auto source = satellites(folder, description.raw, rover.navigation, warnings, &antennas);
    ppk::Input input;
    const gnss::ObservationLog whole = joined(std::move(rover.logs));
    input.rover = &whole;
    input.base = &base;
    input.rover_name = description.raw.observations.front();
    input.base_name = description.base.observations.front();
    input.base_position = description.base.position;
    if (!description.raw.antennas.empty()) {
        input.rover_antenna =
            antenna_of(antennas, description.raw.antenna, whole, input.rover_name, "gnss.antenna_type", warnings);
        input.base_antenna = antenna_of(antennas, description.base.antenna, base, input.base_name, "base.antenna_type", warnings);
        // of one alone the whole offset would be in every position, of which much cancels without any
        if (input.rover_antenna == nullptr || input.base_antenna == nullptr) input.rover_antenna = input.base_antenna = nullptr;
    }
    input.source = source.get();
    input.single = description.raw.solver;
    input.ionosphere = gnss::broadcast_ionosphere(rover.navigation);
    ppk::Settings settings = settings_of(description, *input.ionosphere);
    settings.ranges = ranges;
    ppk::Solution found = ppk::solve(input, settings, warnings);
    tell(found, input.base_name, warnings);
    CarrierPhase out;
    out.base = found.base;
    out.ranges = std::move(found.ranges);
    out.base_sigma = found.base_sigma;
    for (const ppk::EpochSolution& e : found.epochs) {
        if (e.quality == ppk::Quality::None) continue;
        out.fixes.push_back(fix_of(e));
        out.epochs.push_back(e);
    }
    constexpr double air = 600.0;  // s
    weigh_lasting(out.fixes, FixType::RtkFloat, settings.code_correlation);
    weigh_lasting(out.fixes, FixType::Autonomous, air);
    return out;
}

}  // namespace schuler::dataset
