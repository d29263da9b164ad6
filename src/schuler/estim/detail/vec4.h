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

// Covariances stored in single precision.
using Float4 = float __attribute__((vector_size(16)));

inline Vec4 load(const float* p) {
    Float4 v;
    std::memcpy(&v, p, sizeof v);
    return __builtin_convertvector(v, Vec4);
}
inline void store(float* p, Vec4 v) {
    const Float4 w = __builtin_convertvector(v, Float4);
    std::memcpy(p, &w, sizeof w);
}
inline Vec4 broadcast(double x) { return Vec4{x, x, x, x}; }

}  // namespace schuler::estim::detail
