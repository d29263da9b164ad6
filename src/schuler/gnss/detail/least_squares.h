// Normal equations of one epoch: three components of position or velocity and one clock per system. Private to the room.
#pragma once

#include "schuler/gnss/ranges.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <array>
#include <optional>

namespace schuler::gnss::detail {

inline constexpr Eigen::Index unknown_count = 3 + static_cast<Eigen::Index>(clock_count);
using Estimate = Eigen::Matrix<double, unknown_count, 1>;

/// Accumulates rows (line of sight, unit entry for the clock). Clocks without a row stay zero.
class NormalEquations {
public:
    [[nodiscard]] static Estimate row_of(const Eigen::Vector3d& line_of_sight, std::size_t clock) {
        Estimate row = Estimate::Zero();
        row.head<3>() = line_of_sight;
        row[static_cast<Eigen::Index>(3 + clock)] = 1.0;
        return row;
    }

    void add(const Eigen::Vector3d& line_of_sight, std::size_t clock, double residual, double weight) {
        const Estimate row = row_of(line_of_sight, clock);
        information_ += weight * row * row.transpose();
        right_ += weight * residual * row;
        present_[clock] = true;
    }

    [[nodiscard]] std::optional<Estimate> solve() const {
        const auto factor = factored();
        if (!factor) return std::nullopt;
        const Estimate x = factor->solve(right_);
        return x.allFinite() ? std::optional<Estimate>(x) : std::nullopt;
    }

    /// Rows of the three components in the inverse: the first three columns are their covariance.
    using Rows = Eigen::Matrix<double, 3, unknown_count>;
    [[nodiscard]] std::optional<Rows> inverse_rows() const {
        const auto factor = factored();
        if (!factor) return std::nullopt;
        const Matrix all = factor->solve(Matrix::Identity());
        return Rows(all.topRows<3>());
    }

    /// Covariance of the three components.
    [[nodiscard]] std::optional<Eigen::Matrix3d> covariance() const {
        const auto rows = inverse_rows();
        if (!rows) return std::nullopt;
        return Eigen::Matrix3d(rows->leftCols<3>());
    }

private:
    using Matrix = Eigen::Matrix<double, unknown_count, unknown_count>;

    [[nodiscard]] std::optional<Eigen::LDLT<Matrix>> factored() const {
        Matrix full = information_;
        const double size = full.diagonal().maxCoeff();
        if (!(size > 0.0)) return std::nullopt;
        for (std::size_t c = 0; c < clock_count; ++c) {
            const auto i = static_cast<Eigen::Index>(3 + c);
            if (!present_[c]) full(i, i) = size;
        }
        Eigen::LDLT<Matrix> factor(full);
        const double smallest = factor.vectorD().minCoeff();
        if (factor.info() != Eigen::Success || !(smallest > 1e-12 * size)) return std::nullopt;
        return factor;
    }

    Matrix information_ = Matrix::Zero();
    Estimate right_ = Estimate::Zero();
    std::array<bool, clock_count> present_{};
};

}  // namespace schuler::gnss::detail
