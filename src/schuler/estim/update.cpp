#include "schuler/estim/update.h"

#include "schuler/estim/detail/vec4.h"

#include <cmath>

namespace schuler::estim {

StateVector Row::times(const StateMatrix& P, int used) const {
    StateVector ph = StateVector::Zero(P.rows());
    for (int i = 0; i < dense; ++i)
        if (head(i) != 0.0) ph.head(used) += head(i) * P.col(i).head(used);
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) ph.head(used) += value[k] * P.col(index[k]).head(used);
    return ph;
}

double Row::operator()(int i) const {
    double sum = i < dense ? head(i) : 0.0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
        if (index[k] == i) sum += value[k];
    return sum;
}

RowUpdate update(StateVector& dx, StateMatrix& P, const Row& h, double innovation, double r, int used) {
    RowUpdate u;
    u.h = h;
    const StateVector ph = h.times(P, used);
    u.s = h.dot(ph) + r;
    u.innovation = innovation - h.dot(dx);
    u.k = ph / u.s;
    dx += u.innovation * u.k;
    // Scaled once, so that both triangles get the same products.
    const StateVector g = ph / std::sqrt(u.s);
    for (int c = 0; c < used; ++c) {
        const double gc = g(c);
        if (gc != 0.0) P.col(c).head(used) -= gc * g.head(used);
    }
    return u;
}

namespace {

using detail::broadcast;
using detail::load;
using detail::store;
using detail::Vec4;

/// y -= the sum of factor[k] times column k of G, four columns at a time.
void subtract_columns(double* y, const double* G, long stride, const double* factor, int count, int used) {
    int k = 0;
    for (; k + 4 <= count; k += 4) {
        const double *a = G + k * stride, *b = a + stride, *c = b + stride, *d = c + stride;
        const Vec4 fa = broadcast(factor[k]), fb = broadcast(factor[k + 1]), fc = broadcast(factor[k + 2]), fd = broadcast(factor[k + 3]);
        for (int v = 0; v < used; v += 4) store(y + v, load(y + v) - (fa * load(a + v) + fb * load(b + v)) - (fc * load(c + v) + fd * load(d + v)));
    }
    for (; k < count; ++k) {
        const Vec4 f = broadcast(factor[k]);
        for (int v = 0; v < used; v += 4) store(y + v, load(y + v) - f * load(G + k * stride + v));
    }
}

/// Four columns of P from c on, rows r to r + 7: P -= G G^T there, all sums in registers.
void subtract_eight(double* P, const double* G, long stride, int count, int r, int c) {
    Vec4 a0{}, a1{}, b0{}, b1{}, c0{}, c1{}, d0{}, d1{};
    for (int k = 0; k < count; ++k) {
        const double* g = G + k * stride;
        const Vec4 x0 = load(g + r), x1 = load(g + r + 4);
        const Vec4 ya = broadcast(g[c]), yb = broadcast(g[c + 1]), yc = broadcast(g[c + 2]), yd = broadcast(g[c + 3]);
        a0 += x0 * ya;
        a1 += x1 * ya;
        b0 += x0 * yb;
        b1 += x1 * yb;
        c0 += x0 * yc;
        c1 += x1 * yc;
        d0 += x0 * yd;
        d1 += x1 * yd;
    }
    double* p = P + c * stride + r;
    const Vec4 sums[4][2] = {{a0, a1}, {b0, b1}, {c0, c1}, {d0, d1}};
    for (const Vec4(&sum)[2] : sums) {
        store(p, load(p) - sum[0]);
        store(p + 4, load(p + 4) - sum[1]);
        p += stride;
    }
}

/// The same for rows r to r + 3.
void subtract_four(double* P, const double* G, long stride, int count, int r, int c) {
    Vec4 s0{}, s1{}, s2{}, s3{};
    for (int k = 0; k < count; ++k) {
        const double* g = G + k * stride;
        const Vec4 x = load(g + r);
        s0 += x * broadcast(g[c]);
        s1 += x * broadcast(g[c + 1]);
        s2 += x * broadcast(g[c + 2]);
        s3 += x * broadcast(g[c + 3]);
    }
    double* p = P + c * stride + r;
    store(p, load(p) - s0);
    store(p + stride, load(p + stride) - s1);
    store(p + 2 * stride, load(p + 2 * stride) - s2);
    store(p + 3 * stride, load(p + 3 * stride) - s3);
}

}  // namespace

EpochUpdate::EpochUpdate(const StateMatrix& P, int used) : P_(P), used_(used), G_(P.rows(), most) {
    by_state_.leftCols(used).setZero();
}

RowUpdate EpochUpdate::add(StateVector& dx, const Row& h, double innovation, double r) {
    RowUpdate u;
    u.h = h;
    StateVector ph = h.times(P_, used_);
    // h G, for all scalars before this one at once; behind them stands what an epoch that was taken back has left, which is not used.
    alignas(32) double known[most] = {};
    const auto gather = [&](int state, double value) {
        const Vec4 f = broadcast(value);
        const double* g = by_state_.data() + state * most;
        for (int v = 0; v < count_; v += 4) store(known + v, load(known + v) + f * load(g + v));
    };
    for (int i = 0; i < Row::dense; ++i)
        if (h.head(i) != 0.0) gather(i, h.head(i));
    for (std::size_t k = 0; k < static_cast<std::size_t>(h.count); ++k) gather(h.index[k], h.value[k]);
    subtract_columns(ph.data(), G_.data(), G_.rows(), known, count_, used_);
    u.s = h.dot(ph) + r;
    u.innovation = innovation - h.dot(dx);
    u.k = ph / u.s;
    dx += u.innovation * u.k;
    const double scale = 1.0 / std::sqrt(u.s);
    double* column = G_.data() + count_ * G_.rows();
    for (int i = 0; i < used_; ++i) by_state_(count_, i) = column[i] = scale * ph(i);
    ++count_;
    return u;
}

void EpochUpdate::apply(StateMatrix& P) const {
    const long stride = P.rows();
    for (int c = 0; c < used_; c += 4) {
        int r = c;
        for (; r + 8 <= used_; r += 8) subtract_eight(P.data(), G_.data(), stride, count_, r, c);
        if (r < used_) subtract_four(P.data(), G_.data(), stride, count_, r, c);
    }
    for (int c = 0; c < used_; ++c)
        for (int r = c + 1; r < used_; ++r) P(c, r) = P(r, c);
}

RowUpdate update_with_gain(StateVector& dx, StateMatrix& P, const Row& h, double innovation, double r, const StateVector& k,
                              int used) {
    RowUpdate u;
    u.h = h;
    u.k = k;
    const StateVector ph = h.times(P, used);
    u.s = h.dot(ph) + r;
    u.innovation = innovation - h.dot(dx);
    dx += u.innovation * k;
    for (int c = 0; c < used; ++c) {
        const double kc = k(c), a = ph(c) - u.s * kc;
        // Column c of P - k ph^T - ph k^T + s k k^T.
        P.col(c).head(used) -= k.head(used) * a + ph.head(used) * kc;
    }
    for (int c = 0; c < used; ++c)
        for (int i = c + 1; i < used; ++i) P(c, i) = P(i, c) = 0.5 * (P(c, i) + P(i, c));
    return u;
}

void StateAdjoint::undo(const RowUpdate& u, int used) {
    const double correction = u.k.head(used).dot(lambda.head(used)) + u.innovation / u.s;
    StateVector lk = StateVector::Zero(lambda.size());
    lk.head(used).noalias() = Lambda.topLeftCorner(used, used) * u.k.head(used);
    const double klk = u.k.head(used).dot(lk.head(used)) + 1.0 / u.s;
    StateVector h = StateVector::Zero(lambda.size());
    h.head<Row::dense>() = u.h.head;
    for (std::size_t k = 0; k < static_cast<std::size_t>(u.h.count); ++k) h(u.h.index[k]) += u.h.value[k];
    lambda -= h * correction;
    for (int c = 0; c < used; ++c) {
        const double hc = h(c), a = klk * hc - lk(c);
        // Column c of (I - k h)^T Lambda (I - k h) + h h^T / s.
        Lambda.col(c).head(used) += h.head(used) * a - lk.head(used) * hc;
    }
}

void StateAdjoint::forget(int state) {
    lambda(state) = 0.0;
    Lambda.row(state).setZero();
    Lambda.col(state).setZero();
}

}  // namespace schuler::estim
