#include "schuler/estim/transition.h"

#include <cstring>

namespace schuler::estim {
namespace {

// Four doubles as one value: the compiler maps it to the registers the processor has.
using Vec4 = double __attribute__((vector_size(32)));

Vec4 load(const double* p) {
    Vec4 v;
    std::memcpy(&v, p, sizeof v);
    return v;
}
void store(double* p, Vec4 v) { std::memcpy(p, &v, sizeof v); }
Vec4 broadcast(double x) { return Vec4{x, x, x, x}; }
double sum(Vec4 v) { return (v[0] + v[1]) + (v[2] + v[3]); }

/// T = P A^T (N x 9): three rows of A and three vectors of P's columns at a time, all accumulators in registers.
template <int N>
void coupled_columns(const double* P, const Transition<N>& phi, const Sparsity<N>& sparsity, double* T) {
    constexpr int vectors = N / 4;
    constexpr int block = 3;
    for (int group = 0; group < 3; ++group) {
        const double* a0 = phi.rows.data() + (3 * group) * N;
        const double* a1 = a0 + N;
        const double* a2 = a1 + N;
        double* t0 = T + (3 * group) * N;
        const auto g = static_cast<std::size_t>(group);
        const int count = sparsity.count[g];
        const std::uint8_t* column = sparsity.column[g].data();
        int v = 0;
        for (; v + block <= vectors; v += block) {
            Vec4 s00{}, s01{}, s02{}, s10{}, s11{}, s12{}, s20{}, s21{}, s22{};
            for (int c = 0; c < count; ++c) {
                const int k = column[c];
                const double* p = P + k * N + 4 * v;
                const Vec4 x0 = load(p), x1 = load(p + 4), x2 = load(p + 8);
                const Vec4 b0 = broadcast(a0[k]), b1 = broadcast(a1[k]), b2 = broadcast(a2[k]);
                s00 += b0 * x0;
                s01 += b0 * x1;
                s02 += b0 * x2;
                s10 += b1 * x0;
                s11 += b1 * x1;
                s12 += b1 * x2;
                s20 += b2 * x0;
                s21 += b2 * x1;
                s22 += b2 * x2;
            }
            double* t = t0 + 4 * v;
            store(t, s00);
            store(t + 4, s01);
            store(t + 8, s02);
            store(t + N, s10);
            store(t + N + 4, s11);
            store(t + N + 8, s12);
            store(t + 2 * N, s20);
            store(t + 2 * N + 4, s21);
            store(t + 2 * N + 8, s22);
        }
        for (; v < vectors; ++v) {
            Vec4 s[3] = {};
            for (int c = 0; c < count; ++c) {
                const int k = column[c];
                const Vec4 x = load(P + k * N + 4 * v);
                s[0] += broadcast(a0[k]) * x;
                s[1] += broadcast(a1[k]) * x;
                s[2] += broadcast(a2[k]) * x;
            }
            for (int r = 0; r < 3; ++r) store(t0 + r * N + 4 * v, s[r]);
        }
    }
}

template <int N>
double dot(const double* a, const double* b) {
    Vec4 s = load(a) * load(b);
#pragma GCC unroll 10
    for (int v = 1; v < N / 4; ++v) s += load(a + 4 * v) * load(b + 4 * v);
    return sum(s);
}

}  // namespace

template <int N>
void propagate(Eigen::Matrix<double, N, N>& P, const Transition<N>& phi, const Sparsity<N>& sparsity,
               const Eigen::Matrix<double, N, 1>& q) {
    constexpr int M = Transition<N>::coupled;
    alignas(32) double T[M * N];
    coupled_columns<N>(P.data(), phi, sparsity, T);

    double* p = P.data();
    alignas(32) double d[N];
    for (int i = 0; i < N; ++i) d[i] = i < M ? 1.0 : phi.diagonal(i);
    // Columns of the uncoupled states: scaled by both factors. Their first rows are overwritten below.
    for (int c = M; c < N; ++c) {
        const Vec4 dc = broadcast(d[c]);
#pragma GCC unroll 10
        for (int v = 0; v < N; v += 4) store(p + c * N + v, load(p + c * N + v) * (dc * load(d + v)));
    }
    for (int c = 0; c < M; ++c) {
        const double* t = T + c * N;
        double* column = p + c * N;
#pragma GCC unroll 10
        for (int v = 0; v < N; v += 4) store(column + v, load(t + v) * load(d + v));
#pragma GCC unroll 31
        for (int r = M; r < N; ++r) p[r * N + c] = column[r];
    }
    for (int c = 0; c < M; ++c) {
        const double* t = T + c * N;
        for (int r = c; r < M; ++r) {
            const double x = dot<N>(t, phi.rows.data() + r * N);
            p[c * N + r] = x;
            p[r * N + c] = x;
        }
    }
    for (int i = 0; i < N; ++i) p[i * N + i] += q(i);
}

template <int N>
void propagate_adjoint(Eigen::Matrix<double, N, N>& L, const Transition<N>& phi, const Sparsity<N>& sparsity) {
    constexpr int M = Transition<N>::coupled;
    // U = L Phi: column j is the sum over the coupled rows that reach j, plus the diagonal for j >= M.
    alignas(32) double U[N * N];
    const double* l = L.data();
    const double* d = phi.diagonal.data();
    for (int j = 0; j < N; ++j)
        for (int i = 0; i < N; ++i) U[j * N + i] = j < M ? 0.0 : l[j * N + i] * d[j];
    for (int group = 0; group < 3; ++group) {
        const auto g = static_cast<std::size_t>(group);
        const double* a = phi.rows.data() + 3 * group * N;
        const double* l0 = l + 3 * group * N;
        for (int c = 0; c < sparsity.count[g]; ++c) {
            const int j = sparsity.column[g][static_cast<std::size_t>(c)];
            const Vec4 b0 = broadcast(a[j]), b1 = broadcast(a[N + j]), b2 = broadcast(a[2 * N + j]);
            double* u = U + j * N;
            for (int v = 0; v < N; v += 4)
                store(u + v, load(u + v) + b0 * load(l0 + v) + b1 * load(l0 + N + v) + b2 * load(l0 + 2 * N + v));
        }
    }
    // Phi^T U: row j likewise; only one triangle is computed, so that the result is exactly symmetric.
    double* out = L.data();
    for (int c = 0; c < N; ++c) {
        const double* u = U + c * N;
        Eigen::Matrix<double, N, 1> y;
        for (int i = 0; i < N; ++i) y(i) = i < M ? 0.0 : d[i] * u[i];
        for (int k = 0; k < M; ++k) {
            const Vec4 b = broadcast(u[k]);
            const double* a = phi.rows.data() + k * N;
            for (int v = 0; v < N; v += 4) store(y.data() + v, load(y.data() + v) + b * load(a + v));
        }
        for (int r = c; r < N; ++r) out[c * N + r] = y(r);
    }
    for (int c = 0; c < N; ++c)
        for (int r = 0; r < c; ++r) out[c * N + r] = out[r * N + c];
}

#define SCHULER_INSTANTIATE(N)                                                                                      \
    template void propagate<N>(Eigen::Matrix<double, N, N>&, const Transition<N>&, const Sparsity<N>&,              \
                               const Eigen::Matrix<double, N, 1>&);                                                 \
    template void propagate_adjoint<N>(Eigen::Matrix<double, N, N>&, const Transition<N>&, const Sparsity<N>&);
SCHULER_INSTANTIATE(16)
SCHULER_INSTANTIATE(24)
SCHULER_INSTANTIATE(44)
#undef SCHULER_INSTANTIATE

}  // namespace schuler::estim
