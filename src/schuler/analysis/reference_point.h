// A reference of one point of the body as that of another one.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/earth/earth.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace schuler::analysis {

/// The reference at a point `lever_arm_b` (body axes, m) from its own. Samples without attitude are left out. The velocity is that of the
/// point where the attitudes before and after the sample, at most two seconds apart, show the rate of turn; elsewhere it is not given.
[[nodiscard]] std::vector<ReferenceSample> reference_at(const earth::Earth& earth, std::span<const ReferenceSample> reference,
                                                        const Eigen::Vector3d& lever_arm_b);

}  // namespace schuler::analysis
