#include "schuler/estim/update.h"

#include "schuler/estim/detail/vec4.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::estim {

namespace {

using detail::broadcast;
using detail::load;
using detail::store;
using detail::Vec4;

/// The non-zero entries of a row.
struct Entries {
    std::array<int, Row::dense + Row::most> state;
    std::array<double, Row::dense + Row::most> value;
    std::size_t count = 0;

    explicit Entries(const Row& h) {
        for (int i = 0; i < Row::dense; ++i) add(i, h.head(i));
        for (std::size_t k = 0; k < static_cast<std::size_t>(h.count); ++k) add(h.index[k], h.value[k]);
    }
    void add(int i, double x) {
        if (x == 0.0) return;
        state[count] = i;
        value[count++] = x;
    }
};

/// y = the sum of the entries times columns of M, `Vectors` vectors from x on.
template <int Vectors, class Scalar>
void combine_columns(const Entries& h, const Scalar* M, long stride, double* y) {
    Vec4 sum[Vectors] = {};
    for (std::size_t k = 0; k < h.count; ++k) {
        const Vec4 f = broadcast(h.value[k]);
        const Scalar* m = M + h.state[k] * stride;
        for (int i = 0; i < Vectors; ++i) sum[i] += f * load(m + 4 * i);
    }
    for (int i = 0; i < Vectors; ++i) store(y + 4 * i, sum[i]);
}

/// The first `size` (a multiple of four) components of that.
template <class Scalar>
void combine(const Entries& h, const Scalar* M, long stride, int size, double* y) {
    int v = 0;
    for (; v + 16 <= size; v += 16) combine_columns<4>(h, M + v, stride, y + v);
    for (; v < size; v += 4) combine_columns<1>(h, M + v, stride, y + v);
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
        const Vec4 fa = broadcast(f[0]), fb = broadcast(f[1]), fc = broadcast(f[2]), fd = broadcast(f[3]);
        for (int i = 0; i < Vectors; ++i) {
            const Vec4 v = load(x + 4 * i);
            sum[0][i] += v * fa;
            sum[1][i] += v * fb;
            sum[2][i] += v * fc;
            sum[3][i] += v * fd;
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
    for (; r + 8 <= size; r += 8) subtract_product<2>(y, y_stride, x, f, stride, count, r, finish);
    if (r < size) subtract_product<1>(y, y_stride, x, f, stride, count, r, finish);
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
    combine(Entries(*this), P.data(), P.rows(), used, ph.data());
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
    const int k = count_++, lane = k % 4;
    const Entries entries(h);
    double* column = &G_(0, k);
    combine(entries, P_.data(), P_.rows(), used_, column);
    double* of_state = &by_state_(k, 0);
    for (int i = 0; i < used_; ++i, of_state += states_stride) {
        if (lane == 0) store(of_state, Vec4{column[i], 0.0, 0.0, 0.0});
        else *of_state = column[i];
    }
    alignas(32) double products[most];  // h P H^T for all scalars up to this one
    combine(entries, by_state_.data(), states_stride, padded(k + 1), products);
    for (int i = 0; i <= k; ++i) G_(used_ + k, i) = products[i];
    for (int i = k - lane; i < k; ++i) G_(used_ + i, k) = 0.0;
    innovation_[static_cast<std::size_t>(k)] = innovation;
    s_[static_cast<std::size_t>(k)] = r;
}

StateVector EpochUpdate::solve() {
    const int whole = padded(count_), end = used_ + whole;
    G_.block(0, count_, end, whole - count_).setZero();
    G_.block(used_ + count_, 0, whole - count_, count_).setZero();
    double *z = innovation_.data(), *s = s_.data();
    std::fill(z + count_, z + whole, 0.0);
    StateVector dx = StateVector::Zero(P_.rows());
    for (int c = 0; c < whole; c += 4) {
        double *columns = &G_(0, c), *diagonal = &G_(used_ + c, c);
        const double *before = G_.data(), *factors = before + used_ + c;
        subtract_products(diagonal, rows, factors, factors, rows, c, 4, [](int, Vec4*) {});
        FourPivots f;
        for (int k = 0; k < 4 && c + k < count_; ++k) {
            double pivot = diagonal[k * rows + k];
            for (int j = 0; j < k; ++j) {
                pivot -= f.l[k][j] * f.l[k][j];
                z[c + k] -= f.l[k][j] * f.y[j];
            }
            pivot += s[c + k];  // the noise is added last: it may be small relative to the rest
            s[c + k] = pivot;
            f.inverse[k] = 1.0 / std::sqrt(pivot);
            f.y[k] = z[c + k] * f.inverse[k];
            for (int i = k + 1; i < 4; ++i) {
                double l = diagonal[k * rows + i];
                for (int j = 0; j < k; ++j) l -= f.l[i][j] * f.l[k][j];
                f.l[i][k] = l * f.inverse[k];
            }
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
        subtract_products(P.data() + c * stride + c, stride, g, g, rows, count_, used_ - c, [](int, Vec4*) {});
    }
    for (int c = 0; c < used_; ++c)
        for (int r = c + 1; r < used_; ++r) P(c, r) = P(r, c);
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
