// Whether published sigmas of an attitude cover its errors.
#pragma once

#include "schuler/ahrs/run.h"
#include "schuler/math/rotation.h"

#include <cmath>
#include <vector>

namespace schuler::bench {

/// Epochs beyond three sigma, percent of those added.
struct BeyondThreeSigma {
    std::size_t epochs = 0, tilt = 0, heading = 0;

    void add(const ahrs::AttitudeRow& row, const Eigen::Quaterniond& truth) {
        const Eigen::Vector3d e = math::rotation_vector_from_quaternion(row.q_nb * truth.conjugate());
        const auto beyond = [&](int i) { return std::abs(e(i)) > 3.0 * row.std_phi(i); };
        ++epochs;
        tilt += beyond(0) || beyond(1) ? 1 : 0;
        heading += beyond(2) ? 1 : 0;
    }
    [[nodiscard]] double percent(std::size_t count) const {
        return 100.0 * static_cast<double>(count) / static_cast<double>(epochs);
    }
};

/// At the reference's epochs with movement, the nearest row.
inline BeyondThreeSigma beyond_three_sigma(const std::vector<ahrs::AttitudeRow>& rows,
                                           const std::vector<ReferenceSample>& reference) {
    BeyondThreeSigma out;
    std::size_t k = 0;
    for (const ReferenceSample& r : reference) {
        if (!r.movement || !r.rpy.allFinite()) continue;
        const auto apart = [&](std::size_t i) { return std::abs((rows[i].time - r.time).seconds()); };
        while (k + 1 < rows.size() && apart(k + 1) <= apart(k)) ++k;
        if (apart(k) < 0.01) out.add(rows[k], math::quaternion_from_rpy(r.rpy));
    }
    return out;
}

}  // namespace schuler::bench
