#include "schuler/dataset/raw_gnss.h"

#include "schuler/dataset/description.h"
#include "schuler/dataset/paths.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/phase_velocity.h"
#include "schuler/io/raw_input.h"
#include "schuler/io/rinex/antex.h"
#include "schuler/io/rinex/sp3.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <memory>

namespace schuler::dataset {
namespace {

namespace fs = std::filesystem;

/// Replaces the velocity of a fix by that from phases, which refers to the middle between two epochs.
void use_phase_velocity(GnssFix& fix, const gnss::PhaseVelocity& v) {
    const Eigen::Matrix3d C_ne = earth::C_en(fix.position.lat, fix.position.lon).transpose();
    fix.velocity_n = C_ne * v.velocity;
    fix.std_velocity = (C_ne * v.covariance * C_ne.transpose()).diagonal().cwiseSqrt();
    fix.velocity_age = 0.5 * v.interval;
}

}  // namespace

std::unique_ptr<gnss::SatelliteSource> satellites(const fs::path& folder, const RawGnssConfig& raw,
                                                  const gnss::Navigation& navigation, WarningLog& warnings,
                                                  const gnss::Antennas* antennas) {
    if (raw.precise.empty()) {
        auto source = std::make_unique<gnss::BroadcastSource>(navigation);
        warn_of_contradictions(navigation, source->navigation(), warnings);
        return source;
    }
    return std::make_unique<gnss::PreciseSource>(io::read_sp3(resolved(folder, raw.precise, "gnss.precise"), warnings).nodes,
                                                 antennas != nullptr ? *antennas : antennas_of(folder, raw, warnings));
}

gnss::Antennas antennas_of(const fs::path& folder, const RawGnssConfig& raw, WarningLog& warnings) {
    if (raw.antennas.empty()) return {};
    return io::read_antex(resolved(folder, raw.antennas, "gnss.antennas"), warnings).antennas;
}

void warn_of_group_delays(const RawGnssConfig& raw, WarningLog& warnings) {
    if (raw.precise.empty() || raw.solver.ranges.ionosphere == gnss::IonosphereModel::Dual) return;
    warnings.add("gnss.precise",
                 "precise clocks hold for two frequencies: with one, group delays of up to some metres remain "
                 "(gnss.ionosphere = \"dual\" avoids them)");
}

void warn_of_contradictions(const gnss::Navigation& all, const gnss::Navigation& used, WarningLog& warnings) {
    std::map<gnss::SatelliteId, int> missing;
    const auto count = [&missing](const auto& ephemerides, int by) {
        for (const auto& e : ephemerides) missing[e.satellite] += by;
    };
    count(all.kepler, 1);
    count(used.kepler, -1);
    count(all.glonass, 1);
    count(used.glonass, -1);
    std::vector<std::string> names;
    for (const auto& [satellite, n] : missing)
        if (n > 0) names.push_back(gnss::name_of(satellite));
    if (names.empty()) return;
    warnings.add("gnss.contradicting_ephemerides",
                 fmt::format("ephemerides that contradict each other are not used: {}", fmt::join(names, " ")));
}

void warn_of_missing_ionosphere(const gnss::BroadcastIonosphere& ionosphere, const RawGnssConfig& raw, WarningLog& warnings) {
    if (raw.solver.ranges.ionosphere != gnss::IonosphereModel::Broadcast || ionosphere.klobuchar || ionosphere.beidou) return;
    warnings.add("gnss.klobuchar",
                 "no satellite's message has coefficients of the ionosphere: a mean one is taken off, and as much is in the "
                 "sigmas (gnss.ionosphere = \"dual\" needs none)");
}

GnssFix fix_from(const gnss::SinglePointSolution& s) {
    GnssFix fix;
    fix.time = s.time;
    fix.position = earth::geodetic_from_ecef(earth::wgs84, s.position);
    const Eigen::Matrix3d C_ne = earth::C_en(fix.position.lat, fix.position.lon).transpose();
    fix.std_position = (C_ne * s.covariance * C_ne.transpose()).diagonal().cwiseSqrt();
    if (s.velocity.allFinite()) {
        fix.velocity_n = C_ne * s.velocity;
        fix.std_velocity = (C_ne * s.velocity_covariance * C_ne.transpose()).diagonal().cwiseSqrt();
    }
    fix.fix = FixType::Autonomous;
    fix.satellites = s.used();
    return fix;
}

RawLogs read_raw_logs(const fs::path& folder, const RawGnssConfig& raw, WarningLog& warnings) {
    RawLogs out;
    for (const std::string& file : raw.navigation)
        out.navigation.add(io::read_raw_input(resolved(folder, file, "gnss.navigation"), {}, warnings).navigation);
    // the ephemerides date RTCM streams without a date
    const std::optional<Time> near =
        out.navigation.kepler.empty() ? std::nullopt : std::optional(out.navigation.kepler.front().toe);
    for (const std::string& file : raw.observations) {
        io::RawInput input = io::read_raw_input(resolved(folder, file, "gnss.observations"), near, warnings);
        out.navigation.add(input.navigation);
        out.logs.push_back(std::move(input.observations));
    }
    if (out.navigation.size() == 0 && raw.precise.empty())
        throw input_error("raw measurements need ephemerides", {{}, 0, 0, "gnss.navigation"},
                          "name the navigation files of the same day");
    return out;
}

std::vector<GnssFix> fixes_from_raw(const fs::path& folder, const RawGnssConfig& raw, WarningLog& warnings) {
    const auto [navigation, logs] = read_raw_logs(folder, raw, warnings);
    const auto source = satellites(folder, raw, navigation, warnings);
    const gnss::BroadcastIonosphere ionosphere = gnss::broadcast_ionosphere(navigation);
    warn_of_missing_ionosphere(ionosphere, raw, warnings);
    warn_of_group_delays(raw, warnings);
    gnss::SinglePoint solver(*source, ionosphere, raw.solver);
    gnss::PhaseDifferences differences(*source, raw.solver.ranges);
    std::vector<GnssFix> fixes;
    std::map<gnss::SinglePointStatus, std::size_t> unsolved;
    std::size_t excluded = 0, epochs = 0;
    for (const gnss::ObservationLog& log : logs) {
        for (const gnss::ObservationEpoch& epoch : log.epochs) {
            const gnss::SinglePointSolution s = solver.solve(log.of(epoch), epoch.time, log.channels);
            ++epochs;
            excluded += static_cast<std::size_t>(s.excluded());
            const auto velocity =
                raw.phase_velocity ? differences.update(log.of(epoch), epoch.time, log.channels, s) : std::nullopt;
            if (s.status != gnss::SinglePointStatus::Solved) {
                ++unsolved[s.status];
                continue;
            }
            fixes.push_back(fix_from(s));
            if (velocity) use_phase_velocity(fixes.back(), *velocity);
        }
    }
    for (const auto& [status, count] : unsolved)
        warnings.add(fmt::format("gnss.unsolved.{}", name_of(status)), fmt::format("epochs without a fix: {}", name_of(status)),
                     count);
    if (excluded > 0) warnings.add("gnss.excluded", "faulty pseudoranges left out", excluded);
    if (fixes.empty())
        throw input_error(fmt::format("none of the {} epochs has a fix", epochs),
                          {raw.observations.front(), 0, 0, "gnss.observations"},
                          "are the navigation files of the same day, and the systems right?");
    std::ranges::stable_sort(fixes, {}, &GnssFix::time);
    return fixes;
}

}  // namespace schuler::dataset
