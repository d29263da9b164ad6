// Conversion of the sensor axes named in a data set to the rotation from sensor to body axes.
#pragma once

#include <Eigen/Core>

#include <string_view>

namespace schuler::sensor {

/// C_bs: sensor components to body components (forward-right-down), from
///  - three letters for x, y, z, each of f, b, l, r, u, d (forward, backward, left, right, up, down): "frd", "flu", "fur";
///  - an explicit list: "x=forward, y=left, z=up", in any order, full words or their letters ("back", "rear", "aft" are backward).
/// Case and spaces are ignored. The result is a signed permutation with determinant +1.
/// @throws Error(Input), key "axes", for an unknown word, a missing or repeated axis, two axes along one line, or left-handed axes
///         (the hint gives the direction that makes it right-handed).
[[nodiscard]] Eigen::Matrix3d C_bs_from_axes(std::string_view axes);

}  // namespace schuler::sensor
