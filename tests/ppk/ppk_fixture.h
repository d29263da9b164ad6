// Pairs of receivers from the data sets, and their errors against what is known of them.
#pragma once

#include "schuler/earth/ellipsoid.h"
#include "schuler/io/rinex/rinex.h"
#include "schuler/ppk/solve.h"

#include "io/io_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace schuler::ppk::test {

/// Two logs and the satellites' messages.
struct PairOfLogs {
    gnss::ObservationLog rover, base;
    gnss::Navigation navigation;

    PairOfLogs(const std::string& folder, const std::string& rover_file, const std::string& base_file,
               const std::vector<std::string>& navigation_files) {
        WarningLog warnings;
        const auto path = io::test::data_folder() / folder;
        rover = io::read_rinex_observations(path / rover_file, warnings).log;
        base = io::read_rinex_observations(path / base_file, warnings).log;
        for (const std::string& name : navigation_files)
            navigation.add(io::read_rinex_navigation(path / name, warnings).navigation);
    }
};

/// The signal generator's sky has no air.
inline gnss::SinglePointSettings without_air() {
    gnss::SinglePointSettings s;
    s.ranges.ionosphere = gnss::IonosphereModel::None;
    s.ranges.troposphere = gnss::TroposphereModel::None;
    return s;
}
inline Settings settings_without_air() {
    Settings s;
    s.air.troposphere = false;
    return s;
}

inline Solution solved(const PairOfLogs& logs, const Settings& settings, const gnss::SinglePointSettings& single,
                       WarningLog& warnings, std::optional<Ecef> base_position = {}) {
    const gnss::BroadcastSource source(logs.navigation);
    Input input;
    input.rover = &logs.rover;
    input.base = &logs.base;
    input.rover_name = "rover.obs";
    input.base_name = "base.obs";
    input.base_position = base_position;
    input.source = &source;
    input.single = single;
    if (settings.air.ionosphere) input.ionosphere = settings.air.ionosphere;
    return solve(input, settings, warnings);
}

/// Errors of a solution, north, east, down.
struct Errors {
    std::size_t epochs = 0, fixed = 0, wrong = 0;  ///< wrong: fixed and farther off than five centimetres
    std::size_t outside = 0;                       ///< beyond three sigma of the horizontal or the vertical
    double first_fixed = 1e9;                      ///< s
    double fixed_until = -1;                       ///< s after which no epoch is unfixed
    Eigen::Vector3d square = Eigen::Vector3d::Zero();
    double largest = 0;

    [[nodiscard]] double horizontal() const {
        return std::sqrt((square[0] + square[1]) / static_cast<double>(std::max<std::size_t>(epochs, 1)));
    }
    [[nodiscard]] double vertical() const { return std::sqrt(square[2] / static_cast<double>(std::max<std::size_t>(epochs, 1))); }
};

/// `from`: s after the first epoch from which squares are summed.
inline Errors errors_of(const Solution& solution, const std::function<Ecef(Time)>& truth, double from = 0) {
    Errors out;
    const Time begin = solution.epochs.front().tag;
    Eigen::Vector3d square = Eigen::Vector3d::Zero();
    for (const EpochSolution& s : solution.epochs) {
        if (s.quality == Quality::None) continue;
        const double t = (s.tag - begin).seconds();
        const Ecef right = truth(s.time);
        const Geodetic g = earth::geodetic_from_ecef(earth::wgs84, right);
        const Eigen::Matrix3d C_ne = earth::C_en(g.lat, g.lon).transpose();
        const Eigen::Vector3d d = C_ne * (s.position.r - right.r);
        const Eigen::Vector3d sigma = (C_ne * s.covariance * C_ne.transpose()).diagonal().cwiseSqrt();
        const bool fixed = s.quality == Quality::Fixed;
        if (fixed) out.first_fixed = std::min(out.first_fixed, t);
        if (!fixed) out.fixed_until = t;
        out.fixed += fixed ? 1 : 0;
        out.wrong += fixed && d.norm() > 0.05 ? 1 : 0;
        out.outside += d.head<2>().norm() > 3.0 * sigma.head<2>().norm() || std::abs(d[2]) > 3.0 * sigma[2] ? 1 : 0;
        if (t < from) continue;
        ++out.epochs;
        square += d.cwiseAbs2();
        out.largest = std::max(out.largest, d.norm());
    }
    out.square = square;
    return out;
}

}  // namespace schuler::ppk::test
