// One complete forward pass of the tight filter.
#pragma once

#include "schuler/fusion/tight_pass.h"

#include <functional>

namespace schuler::fusion {

/// The layout of the inertial part.
[[nodiscard]] Layout tight_inertial_layout(bool with_baro);

/// The model that settings mean.
[[nodiscard]] TightModel make_tight_model(const Settings& settings, bool with_baro);

/// Told after each epoch of ranges: the epoch, the antenna's place, the covariance of the position north, east, down, m^2.
using AfterRanges = std::function<void(const RangeEpoch&, const Geodetic&, const Eigen::Matrix3d&)>;

/// Runs it in the mechanization of the settings. `origin`: zero of the outages' times.
[[nodiscard]] Result run_tight_pass(const RunData& data, const Settings& settings, const Start& start, const PassOptions& options,
                                    Time origin, const AfterRanges& after = {});

}  // namespace schuler::fusion
