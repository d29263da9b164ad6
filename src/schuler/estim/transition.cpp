#include "schuler/estim/transition.h"

#include "schuler/estim/detail/vec4.h"

#include <Eigen/LU>

#include <algorithm>

namespace schuler::estim {
namespace {

constexpr int coupled = Transition::coupled;
constexpr int rows_stride = Transition::max_driven;

using detail::broadcast;
using detail::load;
using detail::store;
using detail::Vec4;

double sum(Vec4 v) { return (v[0] + v[1]) + (v[2] + v[3]); }

/// Three rows of T = A P from A's rows a0..a2, for `vectors` vectors of P's columns from v on.
template <int Vectors>
void three_rows(const CovarianceScalar* P, long stride, const double* a0, int driven, int v, double* t0) {
    const double *a1 = a0 + rows_stride, *a2 = a1 + rows_stride;
    Vec4 s[3][Vectors] = {};
    for (int k = 0; k < driven; ++k) {
        const CovarianceScalar* p = P + k * stride + 4 * v;
        const Vec4 b0 = broadcast(a0[k]), b1 = broadcast(a1[k]), b2 = broadcast(a2[k]);
        for (int i = 0; i < Vectors; ++i) {
            const Vec4 x = load(p + 4 * i);
            s[0][i] += b0 * x;
            s[1][i] += b1 * x;
            s[2][i] += b2 * x;
        }
    }
    for (int r = 0; r < 3; ++r)
        for (int i = 0; i < Vectors; ++i) store(t0 + r * max_states + 4 * (v + i), s[r][i]);
}

/// T = A P (row r at T + r max_states), all accumulators in registers.
void coupled_rows(const CovarianceScalar* P, long stride, const Transition& phi, int used, double* T) {
    const int vectors = used / 4;
    for (int r = 0; r < coupled; r += 3) {
        const double* a = phi.rows.data() + r * rows_stride;
        int v = 0;
        for (; v + 3 <= vectors; v += 3) three_rows<3>(P, stride, a, phi.driven, v, T + r * max_states);
        for (; v < vectors; ++v) three_rows<1>(P, stride, a, phi.driven, v, T + r * max_states);
    }
}

/// Entry (r, c) of A P A^T from T = A P.
double corner(const double* T, const Transition& phi, int r, int c) {
    const double *t = T + c * max_states, *a = phi.rows.data() + r * rows_stride;
    Vec4 s{};
    for (int v = 0; v < phi.driven; v += 4) s += load(t + v) * load(a + v);
    return sum(s);
}

/// Transformation of a symmetric matrix by a shear: M <- S M S^T.
void shear(StateMatrix& M, const Transition::Shear& s, int used) {
    add(M.row(s.to).head(used), s.factor * as_double(M.row(s.from).head(used)));
    add(M.col(s.to).head(used), s.factor * as_double(M.col(s.from).head(used)));
}

}  // namespace

StateVector Transition::times(const StateVector& x) const {
    StateVector y = x;
    for (int i = 0; i < shear_count; ++i) {
        const Shear& s = shears[static_cast<std::size_t>(i)];
        y(s.to) += s.factor * y(s.from);
    }
    const Eigen::Matrix<double, coupled, 1> head = rows.topRows(driven).transpose() * y.head(driven);
    y.array() *= diagonal.array();
    y.head<coupled>() = head;
    return y;
}

StateVector Transition::transpose_times(const StateVector& x) const {
    StateVector y = diagonal.cwiseProduct(x);
    y.head<coupled>().setZero();
    y.head(driven).noalias() += rows.topRows(driven) * x.head<coupled>();
    for (int i = shear_count; i-- > 0;) {
        const Shear& s = shears[static_cast<std::size_t>(i)];
        y(s.from) += s.factor * y(s.to);
    }
    return y;
}

void propagate(StateMatrix& P, const Transition& phi, int used) {
    for (int i = 0; i < phi.shear_count; ++i) shear(P, phi.shears[static_cast<std::size_t>(i)], used);
    alignas(32) double T[coupled * max_states];
    const long stride = P.rows();
    CovarianceScalar* p = P.data();
    coupled_rows(p, stride, phi, used, T);
    const double* d = phi.diagonal.data();
    // Columns of the uncoupled states: scaled by both factors. Their first rows are overwritten below.
    for (int c = coupled; c < used; ++c) {
        const Vec4 dc = broadcast(d[c]);
        for (int w = coupled / 4 * 4; w < used; w += 4) store(p + c * stride + w, load(p + c * stride + w) * (dc * load(d + w)));
    }
    for (int c = 0; c < coupled; ++c) {
        const double* t = T + c * max_states;
        CovarianceScalar* column = p + c * stride;
        for (int w = coupled / 4 * 4; w < used; w += 4) store(column + w, load(t + w) * load(d + w));
        for (int r = coupled; r < used; ++r) p[r * stride + c] = column[r];
    }
    for (int c = 0; c < coupled; ++c)
        for (int r = c; r < coupled; ++r)
            p[c * stride + r] = p[r * stride + c] = static_cast<CovarianceScalar>(corner(T, phi, r, c));
}

Eigen::Matrix<double, coupled, coupled> propagated_corner(const StateMatrix& P, const Transition& phi) {
    if (phi.shear_count > 0) {  // A S instead of A
        Transition all = phi;
        all.shear_count = 0;
        for (int i = phi.shear_count; i-- > 0;) {
            const Transition::Shear& s = phi.shears[static_cast<std::size_t>(i)];
            if (s.to < phi.driven && s.from < phi.driven) all.rows.row(s.from) += s.factor * all.rows.row(s.to);
        }
        return propagated_corner(P, all);
    }
    alignas(32) double T[coupled * max_states];
    coupled_rows(P.data(), P.rows(), phi, phi.driven, T);
    Eigen::Matrix<double, coupled, coupled> out;
    for (int c = 0; c < coupled; ++c)
        for (int r = c; r < coupled; ++r) out(r, c) = out(c, r) = corner(T, phi, r, c);
    return out;
}

void propagate_adjoint(StateMatrix& L, const Transition& phi, int used) {
    // U = L Phi: column j is the sum over the coupled rows that reach j, plus the diagonal for j >= 9.
    alignas(32) double U[max_states * max_states];
    const long stride = L.rows();
    CovarianceScalar* l = L.data();
    const double* d = phi.diagonal.data();
    for (int j = 0; j < used; ++j) {
        double* u = U + j * max_states;
        const Vec4 dj = broadcast(j < coupled ? 0.0 : d[j]);
        for (int v = 0; v < used; v += 4) store(u + v, dj * load(l + j * stride + v));
        if (j >= phi.driven) continue;
        for (int k = 0; k < coupled; ++k) {
            const Vec4 b = broadcast(phi.rows(j, k));
            for (int v = 0; v < used; v += 4) store(u + v, load(u + v) + b * load(l + k * stride + v));
        }
    }
    // Phi^T U likewise; only one triangle is computed, so that the result is exactly symmetric.
    for (int c = 0; c < used; ++c) {
        const double* u = U + c * max_states;
        CovarianceScalar* y = l + c * stride;
        const int first = c / 4 * 4;
        for (int v = first; v < used; v += 4) store(y + v, load(d + v) * load(u + v));
        for (int r = first; r < coupled; ++r) y[r] = 0;
        for (int k = 0; k < coupled; ++k) {
            const Vec4 b = broadcast(u[k]);
            const double* a = phi.rows.data() + k * rows_stride;
            for (int v = first; v < phi.driven; v += 4) store(y + v, load(y + v) + b * load(a + v));
        }
    }
    for (int c = 0; c < used; ++c)
        for (int r = 0; r < c; ++r) l[c * stride + r] = l[r * stride + c];
    for (int i = phi.shear_count; i-- > 0;) {
        const Transition::Shear& s = phi.shears[static_cast<std::size_t>(i)];
        shear(L, {s.from, s.to, s.factor}, used);
    }
}

StateVector row_after(const Transition& phi, const StateVector& h) {
    StateVector r = h;
    for (int i = 0; i < phi.shear_count; ++i) {
        const Transition::Shear& shear = phi.shears[static_cast<std::size_t>(i)];
        r(shear.from) -= shear.factor * r(shear.to);
    }
    // column r of rows.topRows<coupled>() is row r of A's square part: its transpose, as required here
    const Eigen::Matrix<double, coupled, 1> y = phi.rows.topRows<coupled>().partialPivLu().solve(r.head<coupled>());
    r.head<coupled>() = y;
    const Eigen::Index driven = std::min<Eigen::Index>(phi.driven, r.size());
    r.segment(coupled, driven - coupled) -= phi.rows.middleRows(coupled, driven - coupled) * y;
    r.tail(r.size() - coupled).array() *= phi.diagonal.tail(r.size() - coupled).array();
    return r;
}

}  // namespace schuler::estim
