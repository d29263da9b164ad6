// Four doubles as one value, which the compiler maps to the available vector registers.
#pragma once

#include <cstring>

namespace schuler::estim::detail {

using Vec4 = double __attribute__((vector_size(32)));

inline Vec4 load(const double* p) {
    Vec4 v;
    std::memcpy(&v, p, sizeof v);
    return v;
}
inline void store(double* p, Vec4 v) { std::memcpy(p, &v, sizeof v); }
inline Vec4 broadcast(double x) { return Vec4{x, x, x, x}; }

}  // namespace schuler::estim::detail
