#include "schuler/ppk/combine.h"

#include <Eigen/Cholesky>

#include <algorithm>

namespace schuler::ppk {
namespace {

int rank(const EpochSolution& s) {
    switch (s.quality) {
        case Quality::Fixed: return 3;
        case Quality::Float: return 2;
        case Quality::Single: return 1;
        default: return 0;
    }
}

}  // namespace

EpochSolution combined(const EpochSolution& a, const EpochSolution& b) {
    if (rank(a) < 2 || rank(b) < 2) return rank(a) >= rank(b) ? a : b;
    const bool first = rank(a) != rank(b) ? rank(a) > rank(b) : a.covariance.trace() <= b.covariance.trace();
    EpochSolution out = first ? a : b;
    const EpochSolution& other = first ? b : a;
    out.code_scale = std::max(out.code_scale, other.code_scale);
    out.phase_scale = std::max(out.phase_scale, other.phase_scale);
    if (other.vertical_weight > out.vertical_weight) out.vertical_ionosphere = other.vertical_ionosphere;
    const Eigen::Vector3d apart = out.position.r - other.position.r;
    const Eigen::Matrix3d both = out.covariance + other.covariance;
    constexpr double gate = 21.1;  // chi-square of three, 1e-4
    if (apart.dot(both.ldlt().solve(apart)) <= gate) return out;
    out.quality = Quality::Float;
    out.covariance += apart * apart.transpose();
    return out;
}

}  // namespace schuler::ppk
