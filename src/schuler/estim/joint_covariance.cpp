#include "schuler/estim/joint_covariance.h"

#include "schuler/estim/detail/vec4.h"

#include <algorithm>

namespace schuler::estim {
namespace {

constexpr int nine = Transition::coupled;

using detail::broadcast;
using detail::load;
using detail::store;
using detail::Vec4;

/// y += f x over `size` numbers, a multiple of four.
void add_scaled(double* y, double f, const double* x, int size) {
    const Vec4 b = broadcast(f);
    for (int i = 0; i < size; i += 4) store(y + i, load(y + i) + b * load(x + i));
}

/// Adds to each of nine sums its row of `rows` (nine numbers a column) times the columns of a matrix, four of their elements.
void add_columns(const double* columns, int stride, const double* rows, int count, Vec4* sum) {
    for (int k = 0; k < count; ++k, columns += stride, rows += nine) {
        const Vec4 x = load(columns);
        for (int r = 0; r < nine; ++r) sum[r] += broadcast(rows[r]) * x;
    }
}

Eigen::Matrix<double, nine, nine> square_part(const Transition& phi) { return phi.rows.topRows<nine>().transpose(); }

}  // namespace

void GatheredTransition::reset() {
    rows.setZero();
    rows.leftCols<coupled>().setIdentity();
    diagonal.setOnes();
    empty = true;
}

void GatheredTransition::add(const Transition& phi) {
    const Eigen::Index states = rows.cols(), driven = std::min<Eigen::Index>(phi.driven, states);
    const Eigen::Matrix<double, coupled, coupled> A = square_part(phi);
    for (Eigen::Index c = 0; c < states; ++c) {
        const Eigen::Matrix<double, coupled, 1> before = rows.col(c);
        Eigen::Matrix<double, coupled, 1> after;
        if (empty && c >= coupled) after.setZero();
        else after.noalias() = A.lazyProduct(before);
        if (c >= coupled && c < driven) after += diagonal(c) * phi.rows.row(c).transpose();
        rows.col(c) = after;
        if (c >= coupled) diagonal(c) *= phi.diagonal(c);
    }
    empty = false;
}

JointCovariance::JointCovariance(int states, const Matrix9& start, const Processes& variance)
    : states_(states), processes_(static_cast<int>(variance.size())), size_(padded(states_ + processes_)) {
    S_ = Eigen::MatrixXd::Zero(size_, size_);
    S_.topLeftCorner<coupled, coupled>() = start;
    S_.diagonal().segment(states_, processes_) = variance;
    gains_ = halves_ = Eigen::MatrixXd::Zero(size_, most_corrections);
    sh_ = Eigen::VectorXd::Zero(size_);
    rows_of_S_.resize(size_, coupled);
    drive_ = Q_cross_ = Drive::Zero(coupled, processes_);
    decay_ = Processes::Ones(processes_);
    Q_processes_ = Processes::Zero(processes_);
    Q_errors_.setZero();
}

void JointCovariance::step(const Transition& phi, const Drive& drive, const Processes& decay, const Processes& noise,
                           const Matrix9* white) {
    const bool drives = drive.cols() > 0;
    if (drives || white != nullptr) {
        const Matrix9 A = square_part(phi);
        if (noisy_) {
            // [A D; 0 d] Q [A D; 0 d]^T, Q of the processes diagonal
            Matrix9 half;
            half.noalias() = A.lazyProduct(Q_errors_);
            if (drives) half.noalias() += drive.lazyProduct(Q_cross_.transpose());
            Matrix9 errors;
            errors.noalias() = half.lazyProduct(A.transpose());
            if (drives) {
                Drive cross = A.lazyProduct(Q_cross_);
                cross += drive * Q_processes_.asDiagonal();
                errors.noalias() += cross.lazyProduct(drive.transpose());
                Q_cross_ = cross * decay.asDiagonal();
            }
            Q_errors_ = errors;
        }
        if (drives) {
            Drive after = A.lazyProduct(drive_);
            after += drive * decay_.asDiagonal();
            drive_ = after;
            driven_ = true;
        }
        if (white != nullptr) {
            Q_errors_ += *white;
            noisy_ = true;
        }
    }
    if (processes_ == 0) return;
    Q_processes_.array() = decay.array().square() * Q_processes_.array() + noise.array();
    decay_.array() *= decay.array();
    noisy_ = noisy_ || !noise.isZero(0.0);
}

void JointCovariance::settle(const GatheredTransition& phi) {
    if (phi.empty) return;
    carry_out_corrections();
    double* t = rows_of_S_.data();
    for (int i = 0; i < size_; i += 4) {  // nine sums in registers
        Vec4 sum[coupled] = {};
        add_columns(S_.data() + i, size_, phi.rows.data(), states_, sum);
        if (driven_) add_columns(S_.data() + states_ * size_ + i, size_, drive_.data(), processes_, sum);
        for (int r = 0; r < coupled; ++r) store(t + r * size_ + i, sum[r]);
    }
    alignas(32) double d[max_states + most_processes + 4] = {};
    for (int i = coupled; i < states_; ++i) d[i] = phi.diagonal(i);
    for (int i = 0; i < processes_; ++i) d[states_ + i] = decay_(i);
    for (int c = coupled; c < size_; ++c) {
        double* column = S_.data() + c * size_;
        const Vec4 dc = broadcast(d[c]);
        for (int i = coupled / 4 * 4; i < size_; i += 4) store(column + i, load(column + i) * (dc * load(d + i)));
    }
    for (int r = 0; r < coupled; ++r)
        for (int i = coupled; i < size_; ++i) S_(i, r) = S_(r, i) = t[r * size_ + i] * d[i];
    for (int c = 0; c < coupled; ++c) {
        for (int r = c; r < coupled; ++r) {
            double sum = 0.0;
            for (int k = 0; k < states_; ++k) sum += t[c * size_ + k] * phi.rows(r, k);
            if (driven_)
                for (int k = 0; k < processes_; ++k) sum += t[c * size_ + states_ + k] * drive_(r, k);
            S_(r, c) = S_(c, r) = sum;
        }
    }
    add_noise();
    drive_.setZero();
    decay_.setOnes();
    driven_ = false;
}

void JointCovariance::add_noise() {
    if (!noisy_) return;
    S_.topLeftCorner<coupled, coupled>() += Q_errors_;
    S_.block(0, states_, coupled, processes_) += Q_cross_;
    S_.block(states_, 0, processes_, coupled) += Q_cross_.transpose();
    S_.diagonal().segment(states_, processes_) += Q_processes_;
    Q_errors_.setZero();
    Q_cross_.setZero();
    Q_processes_.setZero();
    noisy_ = false;
}

void JointCovariance::step_with_shears(const Transition& phi, const Drive& drive, const Processes& decay, const Processes& noise,
                                       const Matrix9* white) {
    carry_out_corrections();
    const int n = states_, m = processes_;
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n + m, n + m);
    StateVector unit = StateVector::Zero(n);
    for (int i = 0; i < n; ++i) {
        unit(i) = 1.0;
        all.col(i).head(n) = phi.times(unit);
        unit(i) = 0.0;
    }
    all.diagonal().tail(m) = decay;
    if (drive.cols() > 0) all.topRightCorner(coupled, m) = drive;
    const Eigen::MatrixXd half = all * S_.topLeftCorner(n + m, n + m);
    S_.topLeftCorner(n + m, n + m).noalias() = half * all.transpose();
    S_.diagonal().segment(n, m) += noise;
    if (white != nullptr) S_.topLeftCorner<coupled, coupled>() += *white;
}

void JointCovariance::correct(const Row& h, const StateVector& k, int process, double seen, double white) {
    if (corrections_ == most_corrections) carry_out_corrections();
    double* sh = sh_.data();
    sh_.setZero();
    const auto dot = [&](const auto& x) { return h.dot(x) + (process >= 0 ? seen * x(states_ + process) : 0.0); };
    for (int i = 0; i < Row::dense; ++i)
        if (h.head(i) != 0.0) add_scaled(sh, h.head(i), S_.data() + i * size_, size_);
    for (std::size_t i = 0; i < static_cast<std::size_t>(h.count); ++i)
        add_scaled(sh, h.value[i], S_.data() + h.index[i] * size_, size_);
    if (process >= 0) add_scaled(sh, seen, S_.data() + (states_ + process) * size_, size_);
    for (int j = 0; j < corrections_; ++j) {  // what S lacks
        add_scaled(sh, -dot(halves_.col(j)), gains_.data() + j * size_, size_);
        add_scaled(sh, -dot(gains_.col(j)), halves_.data() + j * size_, size_);
    }
    // S - k (S h)^T - (S h) k^T + v k k^T = S - k a^T - a k^T
    const double v = dot(sh_) + white;
    gains_.col(corrections_).head(states_) = k.head(states_);
    halves_.col(corrections_) = sh_ - 0.5 * v * gains_.col(corrections_);
    ++corrections_;
}

void JointCovariance::renew(int state) {
    carry_out_corrections();
    S_.row(state).setZero();
    S_.col(state).setZero();
}

void JointCovariance::carry_out_corrections() {
    if (corrections_ == 0) return;
    for (int c = 0; c < size_; ++c) {
        double* column = S_.data() + c * size_;
        for (int j = 0; j < corrections_; ++j) {
            const double *k = gains_.data() + j * size_, *a = halves_.data() + j * size_;
            const Vec4 kc = broadcast(k[c]), ac = broadcast(a[c]);
            for (int i = c / 4 * 4; i < size_; i += 4)
                store(column + i, load(column + i) - (load(k + i) * ac + load(a + i) * kc));
        }
    }
    for (int c = 0; c < size_; ++c)
        for (int r = c + 1; r < size_; ++r) S_(c, r) = S_(r, c);
    corrections_ = 0;
}

Eigen::Matrix<double, JointCovariance::coupled, 1> JointCovariance::variances() {
    carry_out_corrections();
    return S_.diagonal().head<coupled>();
}

}  // namespace schuler::estim
