// Vectors of random numbers, drawn in one order by every compiler: arguments of a call are evaluated in any.
#pragma once

#include <Eigen/Core>

namespace schuler::test {

template <class Distribution, class Generator>
Eigen::Vector3d draw3(Distribution& distribution, Generator& generator) {
    const double x = distribution(generator), y = distribution(generator), z = distribution(generator);
    return {x, y, z};
}

}  // namespace schuler::test
