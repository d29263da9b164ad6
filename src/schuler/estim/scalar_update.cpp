#include "schuler/estim/scalar_update.h"

namespace schuler::estim {

namespace {

/// dx and P after the update u with given gain and innovation variance; ph = P h.
template <int N>
void apply(Eigen::Matrix<double, N, 1>& dx, Eigen::Matrix<double, N, N>& P, ScalarUpdate<N>& u, double innovation,
           const Eigen::Matrix<double, N, 1>& ph) {
    u.innovation = innovation - u.h.dot(dx);
    dx += u.k * u.innovation;
    // P - k ph^T - ph k^T + s k k^T = P - k v^T - v k^T with v = ph - s k / 2; the lower triangle, then its mirror image
    const Eigen::Matrix<double, N, 1> v = ph - 0.5 * u.s * u.k;
    for (int c = 0; c < N; ++c) P.col(c) -= u.k * v(c) + v * u.k(c);
    for (int c = 1; c < N; ++c) {
        for (int r = 0; r < c; ++r) P(r, c) = P(c, r);
    }
}

}  // namespace

template <int N>
ScalarUpdate<N> update_scalar(Eigen::Matrix<double, N, 1>& dx, Eigen::Matrix<double, N, N>& P,
                              const Eigen::Matrix<double, N, 1>& h, double innovation, double r) {
    ScalarUpdate<N> u;
    Eigen::Matrix<double, N, 1> ph;
    ph.setZero();
    for (int c = 0; c < N; ++c) {  // rows are sparse: a measurement of one state needs one column
        if (h(c) != 0.0) ph += P.col(c) * h(c);
    }
    u.h = h;
    u.s = h.dot(ph) + r;
    u.k = ph / u.s;
    apply(dx, P, u, innovation, ph);
    return u;
}

template <int N>
void Adjoint<N>::undo(const ScalarUpdate<N>& u) {
    lambda -= u.h * (u.k.dot(lambda) + u.innovation / u.s);
    Eigen::Matrix<double, N, 1> lk;
    lk.noalias() = Lambda * u.k;
    const double klk = u.k.dot(lk) + 1.0 / u.s;
    for (int c = 0; c < N; ++c) {
        const double hc = u.h(c), a = klk * hc - lk(c);
        // Column c of (I - k h)^T Lambda (I - k h) + h h^T / s.
        if (hc != 0.0 || a != 0.0) Lambda.col(c) += u.h * a - lk * hc;
    }
}

#define SCHULER_INSTANTIATE(N)                                                                            \
    template ScalarUpdate<N> update_scalar<N>(Eigen::Matrix<double, N, 1>&, Eigen::Matrix<double, N, N>&, \
                                              const Eigen::Matrix<double, N, 1>&, double, double);        \
    template struct Adjoint<N>;
SCHULER_INSTANTIATE(7)
SCHULER_INSTANTIATE(30)
SCHULER_INSTANTIATE(36)
#undef SCHULER_INSTANTIATE

}  // namespace schuler::estim
