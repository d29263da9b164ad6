#include "schuler/estim/update.h"

#include "schuler/estim/detail/vec4.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace schuler::estim {

namespace {

using detail::broadcast;
using detail::load;
using detail::store;
using detail::Vec4;

using Entries = detail::RowEntries;

/// y = the sum of the entries times columns of M, `Vectors` vectors from x on.
template <int Vectors, class Scalar>
void combine_columns(const Entries& h, const Scalar* M, long stride, double* y) {
    Vec4 sum[Vectors];
#pragma GCC unroll 12
    for (int i = 0; i < Vectors; ++i) sum[i] = Vec4{};  // in registers: an initializer would clear memory
    for (std::size_t k = 0; k < h.count; ++k) {
        const Vec4 f = broadcast(h.value[k]);
        const Scalar* m = M + h.state[k] * stride;
#pragma GCC unroll 12
        for (int i = 0; i < Vectors; ++i) sum[i] += f * load(m + 4 * i);
    }
    for (int i = 0; i < Vectors; ++i) store(y + 4 * i, sum[i]);
}

/// The first `size` (a multiple of four) components of that.
template <class Scalar>
void combine(const Entries& h, const Scalar* M, long stride, int size, double* y) {
    constexpr int most = 12;  // sums in registers
    for (; size >= 4 * most; size -= 4 * most, M += 4 * most, y += 4 * most) combine_columns<most>(h, M, stride, y);
    const auto rest = [&]<int... n>(std::integer_sequence<int, n...>) {
        static_cast<void>(((size == 4 * (n + 1) && (combine_columns<n + 1>(h, M, stride, y), true)) || ...));
    };
    rest(std::make_integer_sequence<int, most - 1>{});
}

/// Four columns of Y, `Vectors` vectors of rows: Y - X F^T with `count` columns of X and F, all sums in registers; `finish(row,
/// columns)` may modify the stored values.
template <int Vectors, class Scalar, class Finish>
void subtract_product(Scalar* y, long y_stride, const double* x, const double* f, long stride, int count, int row,
                      Finish& finish) {
    Vec4 sum[4][Vectors] = {};
    x += row;
    y += row;
    for (int k = 0; k < count; ++k, x += stride, f += stride) {
        Vec4 v[Vectors];
        for (int i = 0; i < Vectors; ++i) v[i] = load(x + 4 * i);
        for (int c = 0; c < 4; ++c) {
            const Vec4 factor = broadcast(f[c]);
            for (int i = 0; i < Vectors; ++i) sum[c][i] += v[i] * factor;
        }
    }
    for (int i = 0; i < Vectors; ++i) {
        Vec4 columns[4];
        for (int c = 0; c < 4; ++c) columns[c] = load(y + c * y_stride + 4 * i) - sum[c][i];
        finish(row + 4 * i, columns);
        for (int c = 0; c < 4; ++c) store(y + c * y_stride + 4 * i, columns[c]);
    }
}

/// The same for `size` rows, a multiple of four.
template <class Scalar, class Finish>
void subtract_products(Scalar* y, long y_stride, const double* x, const double* f, long stride, int count, int size,
                       Finish&& finish) {
    int r = 0;
    for (; r + 12 <= size; r += 12) subtract_product<3>(y, y_stride, x, f, stride, count, r, finish);
    for (; r + 8 <= size; r += 8) subtract_product<2>(y, y_stride, x, f, stride, count, r, finish);
    if (r < size) subtract_product<1>(y, y_stride, x, f, stride, count, r, finish);
}

/// Rows become columns.
void transpose(Vec4* x) {
    const Vec4 a = __builtin_shufflevector(x[0], x[1], 0, 4, 2, 6), b = __builtin_shufflevector(x[0], x[1], 1, 5, 3, 7),
               c = __builtin_shufflevector(x[2], x[3], 0, 4, 2, 6), d = __builtin_shufflevector(x[2], x[3], 1, 5, 3, 7);
    x[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
    x[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
    x[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    x[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

/// Four scalars of an epoch: the inverse of the diagonal of L, the elements below it, and their whitened innovations.
struct FourPivots {
    double inverse[4] = {}, l[4][4] = {}, y[4] = {};

    /// Columns of P H^T, or of H P H^T, minus the contributions of the preceding scalars: those of G, or of L.
    void divide(Vec4* x) const {
        x[0] *= broadcast(inverse[0]);
        x[1] = (x[1] - broadcast(l[1][0]) * x[0]) * broadcast(inverse[1]);
        x[2] = (x[2] - broadcast(l[2][0]) * x[0] - broadcast(l[2][1]) * x[1]) * broadcast(inverse[2]);
        x[3] = (x[3] - broadcast(l[3][0]) * x[0] - broadcast(l[3][1]) * x[1] - broadcast(l[3][2]) * x[2]) * broadcast(inverse[3]);
    }
    [[nodiscard]] Vec4 told(const Vec4* x) const {
        return (broadcast(y[0]) * x[0] + broadcast(y[1]) * x[1]) + (broadcast(y[2]) * x[2] + broadcast(y[3]) * x[3]);
    }
};

}  // namespace

StateVector Row::times(const StateMatrix& P, int used) const {
    StateVector ph(P.rows());
    Entries entries;
    entries.assign(*this);
    combine(entries, P.data(), P.rows(), used, ph.data());
    ph.tail(P.rows() - used).setZero();
    return ph;
}

double Row::operator()(int i) const {
    double sum = i < dense ? head(i) : 0.0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
        if (index[k] == i) sum += value[k];
    return sum;
}

StateVector Row::whole(Eigen::Index size) const {
    StateVector h = StateVector::Zero(size);
    h.head<dense>() = head;
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) h(index[k]) += value[k];
    return h;
}

RowUpdate update(StateVector& dx, StateMatrix& P, const Row& h, double innovation, double r, int used) {
    RowUpdate u;
    u.h = h;
    const StateVector ph = h.times(P, used);
    u.s = h.dot(ph) + r;
    u.innovation = innovation - h.dot(dx);
    u.k = ph / u.s;
    dx += u.innovation * u.k;
    // Scaled once, so that both triangles contain identical products.
    const StateVector g = ph / std::sqrt(u.s);
    for (int c = 0; c < used; ++c) {
        const double gc = g(c);
        if (gc != 0.0) subtract(P.col(c).head(used), gc * g.head(used));
    }
    return u;
}

void EpochUpdate::add(const Row& h, double innovation, double r) {
    const int k = count_++;
    Entries& entries = four_[static_cast<std::size_t>(k % 4)];
    entries.assign(h);
    combine(entries, P_.data(), P_.rows(), used_, &G_(0, k));
    innovation_[static_cast<std::size_t>(k)] = innovation;
    s_[static_cast<std::size_t>(k)] = r;
    if (k % 4 == 3) multiply_four(k - 3);
}

void EpochUpdate::multiply_four(int first) {
    const auto place = [](auto& matrix, int row, int column, const Vec4* x) {  // four rows
        for (int k = 0; k < 4; ++k) store(&matrix(row, column + k), x[k]);
    };
    Vec4 x[4];
    for (int i = 0; i < used_; i += 4) {
        for (int k = 0; k < 4; ++k) x[k] = load(&G_(i, first + k));
        transpose(x);
        place(by_state_, first, i, x);
    }
    alignas(32) double products[4][most];  // h P H^T for all scalars up to these
    for (std::size_t k = 0; k < 4; ++k) combine(four_[k], by_state_.data(), states_stride, first + 4, products[k]);
    for (int i = 0; i < first + 4; i += 4) {
        for (int k = 0; k < 4; ++k) x[k] = load(products[k] + i);
        transpose(x);
        place(G_, used_ + first, i, x);
    }
    for (int k = 1; k < 4; ++k)
        for (int i = 0; i < k; ++i) G_(used_ + first + i, first + k) = 0.0;
}

StateVector EpochUpdate::solve() {
    const int whole = padded(count_);
    double *z = innovation_.data(), *s = s_.data();
    if (count_ < whole) {
        G_.block(0, count_, used_, whole - count_).setZero();
        for (int k = count_; k < whole; ++k) four_[static_cast<std::size_t>(k % 4)].count = 0;
        multiply_four(whole - 4);
    }
    std::fill(z + count_, z + whole, 0.0);
    StateVector dx = StateVector::Zero(P_.rows());
    for (int c = 0; c < whole; c += 4) {
        double *columns = &G_(0, c), *diagonal = &G_(used_ + c, c);
        const double *before = G_.data(), *factors = before + used_ + c;
        subtract_products(diagonal, rows, factors, factors, rows, c, 4, [](int, Vec4*) {});
        const int here = std::min(4, count_ - c);
        double below[4][4];  // the elements of L times their pivots' roots: the roots, which take long, are not waited for
        for (int k = 0; k < here; ++k) {
            double pivot = diagonal[k * rows + k], share[4];
            for (int j = 0; j < k; ++j) {
                share[j] = below[k][j] / s[c + j];
                pivot -= share[j] * below[k][j];
                z[c + k] -= share[j] * z[c + j];
            }
            s[c + k] += pivot;  // the noise is added last: it may be small relative to the rest
            for (int i = k + 1; i < here; ++i) {
                below[i][k] = diagonal[k * rows + i];
                for (int j = 0; j < k; ++j) below[i][k] -= below[i][j] * share[j];
            }
        }
        FourPivots f;
        for (int k = 0; k < here; ++k) {
            f.inverse[k] = 1.0 / std::sqrt(s[c + k]);
            f.y[k] = z[c + k] * f.inverse[k];
            for (int i = k + 1; i < here; ++i) f.l[i][k] = below[i][k] * f.inverse[k];
        }
        subtract_products(columns, rows, before, factors, rows, c, used_, [&](int r, Vec4* x) {
            f.divide(x);
            store(dx.data() + r, load(dx.data() + r) + f.told(x));
        });
        const int next = c + 4;
        subtract_products(columns + used_ + next, rows, before + used_ + next, factors, rows, c, whole - next,
                          [&](int r, Vec4* x) {
                              f.divide(x);
                              store(z + next + r, load(z + next + r) - f.told(x));
                          });
    }
    return dx;
}

RowUpdate EpochUpdate::result(const Row& h, int k) const {
    RowUpdate u;
    u.h = h;
    u.k = StateVector::Zero(P_.rows());
    u.k.head(used_) = G_.col(k).head(used_) / std::sqrt(s(k));
    u.innovation = innovation(k);
    u.s = s(k);
    return u;
}

void EpochUpdate::apply(StateMatrix& P) const {
    const long stride = P.rows();
    for (int c = 0; c < used_; c += 4) {
        const double* g = G_.data() + c;
        // blocks of four columns and rows, the first of them on the diagonal, which is symmetric as its products are
        subtract_products(P.data() + c * stride + c, stride, g, g, rows, count_, used_ - c, [&](int r, Vec4* x) {
            if (r == 0) return;
            Vec4 mirrored[4] = {x[0], x[1], x[2], x[3]};
            transpose(mirrored);
            for (int k = 0; k < 4; ++k) store(P.data() + (c + r + k) * stride + c, mirrored[k]);
        });
    }
}

void correct_covariance(StateMatrix& P, const StateVector& k, const StateVector& ph, double s, int used) {
    for (int c = 0; c < used; ++c) {
        const double kc = k(c), a = ph(c) - s * kc;
        // Column c of P - k ph^T - ph k^T + s k k^T.
        subtract(P.col(c).head(used), k.head(used) * a + ph.head(used) * kc);
    }
    for (int c = 0; c < used; ++c)
        for (int i = c + 1; i < used; ++i) P(c, i) = P(i, c) = CovarianceScalar{0.5} * (P(c, i) + P(i, c));
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
    correct_covariance(P, k, ph, u.s, used);
    return u;
}

void clone(StateMatrix& P, const std::array<Row, 3>& rows, int first, int used) {
    std::array<StateVector, 3> by_clone;
    for (std::size_t k = 0; k < 3; ++k) by_clone[k] = rows[k].times(P, used);
    for (int k = 0; k < 3; ++k) {
        StateVector& column = by_clone[static_cast<std::size_t>(k)];
        for (int l = 0; l < 3; ++l)
            column(first + l) =
                rows[static_cast<std::size_t>(std::max(k, l))].dot(by_clone[static_cast<std::size_t>(std::min(k, l))]);
    }
    for (int k = 0; k < 3; ++k) {
        P.col(first + k) = by_clone[static_cast<std::size_t>(k)].cast<CovarianceScalar>();
        P.row(first + k) = P.col(first + k).transpose();
    }
}

void StateAdjoint::undo_clone(const std::array<Row, 3>& rows, int first) {
    // x after = M x before, M the identity except for the rows of the clones: M^T lambda, M^T Lambda M, one clone after the other
    for (int k = 0; k < 3; ++k) {
        const StateVector row = rows[static_cast<std::size_t>(k)].whole(lambda.size());
        const double of_clone = lambda(first + k);
        lambda += row * of_clone;
        lambda(first + k) = 0.0;
        const StateVector column = Lambda.col(first + k).cast<double>();
        Lambda.noalias() += (row * column.transpose() + column * row.transpose()).cast<CovarianceScalar>();
        Lambda.noalias() += (row * row.transpose() * column(first + k)).cast<CovarianceScalar>();
        Lambda.row(first + k).setZero();
        Lambda.col(first + k).setZero();
    }
}

void StateAdjoint::undo(const RowUpdate& u, int used) {
    const double correction = u.k.head(used).dot(lambda.head(used)) + u.innovation / u.s;
    StateVector lk = StateVector::Zero(lambda.size());
    lk.head(used).noalias() = Lambda.topLeftCorner(used, used).cast<double>() * u.k.head(used);
    const double klk = u.k.head(used).dot(lk.head(used)) + 1.0 / u.s;
    const StateVector h = u.h.whole(lambda.size());
    lambda -= h * correction;
    for (int c = 0; c < used; ++c) {
        const double hc = h(c), a = klk * hc - lk(c);
        // Column c of (I - k h)^T Lambda (I - k h) + h h^T / s.
        add(Lambda.col(c).head(used), h.head(used) * a - lk.head(used) * hc);
    }
}

void StateAdjoint::forget(int state) {
    lambda(state) = 0.0;
    Lambda.row(state).setZero();
    Lambda.col(state).setZero();
}

}  // namespace schuler::estim
