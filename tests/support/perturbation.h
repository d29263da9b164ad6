// The one perturbation harness: every analytic Jacobian (F, G, H, graph factors) is compared with the differences of the model it
// linearises. A Jacobian is registered under a name ("ins.error_n"); SCHULER_JACOBIAN makes a test of it.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace schuler::test {

/// A Jacobian at one point, the non-linear model that it belongs to, and how closely they must agree.
struct LinearModel {
    std::string where;                                              ///< the point, for messages
    Eigen::MatrixXd analytic;                                       ///< rows: outputs, columns: errors of the state
    std::function<Eigen::VectorXd(const Eigen::VectorXd&)> output;  ///< outputs for an error dx; output(0) need not be 0
    Eigen::VectorXd step;                                           ///< size of the perturbation of each column, in its unit
    Eigen::MatrixXd tolerance;                                      ///< largest accepted |analytic - numeric| of each entry
};

/// Differences to the fourth order: central ones of two sizes, extrapolated. Error about step^4/30 of the fifth derivative.
inline Eigen::MatrixXd numeric_jacobian(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& output,
                                        const Eigen::VectorXd& step) {
    Eigen::MatrixXd J;
    for (Eigen::Index j = 0; j < step.size(); ++j) {
        const auto difference = [&](double size) {
            Eigen::VectorXd dx = Eigen::VectorXd::Zero(step.size());
            dx(j) = size;
            const Eigen::VectorXd up = output(dx);
            dx(j) = -size;
            return Eigen::VectorXd((up - output(dx)) / (2.0 * size));
        };
        const Eigen::VectorXd column = (4.0 * difference(step(j)) - difference(2.0 * step(j))) / 3.0;
        if (J.size() == 0) J.resize(column.size(), step.size());
        J.col(j) = column;
    }
    return J;
}

/// Tolerance of each entry: relative of the entry plus, for each row and column, a floor row(i) * column(j).
inline Eigen::MatrixXd tolerance_of(const Eigen::MatrixXd& analytic, double relative, const Eigen::VectorXd& row,
                                    const Eigen::VectorXd& column) {
    return relative * analytic.cwiseAbs() + row * column.transpose();
}

/// Non-fatal failures, one for each entry that disagrees.
inline void expect_linearised(const LinearModel& model) {
    const Eigen::MatrixXd numeric = numeric_jacobian(model.output, model.step);
    ASSERT_EQ(numeric.rows(), model.analytic.rows()) << model.where;
    ASSERT_EQ(numeric.cols(), model.analytic.cols()) << model.where;
    for (Eigen::Index i = 0; i < numeric.rows(); ++i)
        for (Eigen::Index j = 0; j < numeric.cols(); ++j) {
            const double error = std::abs(model.analytic(i, j) - numeric(i, j));
            EXPECT_TRUE(error <= model.tolerance(i, j))  // false for NaN as well
                << model.where << ": entry (" << i << ", " << j << ") is " << model.analytic(i, j) << ", by differences "
                << numeric(i, j) << ", tolerance " << model.tolerance(i, j);
        }
}

/// Names of the Jacobians of this test program in the order of their registration.
inline std::vector<std::string>& registered_jacobians() {
    static std::vector<std::string> names;
    return names;
}
inline bool register_jacobian(std::string name) {
    registered_jacobians().push_back(std::move(name));
    return true;
}

/// Defines test JacobianOf.ID for the models that the following body returns:
///     SCHULER_JACOBIAN(error_n, "ins.error_n") { std::vector<LinearModel> models; ...; return models; }
#define SCHULER_JACOBIAN(ID, NAME)                                                                          \
    static std::vector<::schuler::test::LinearModel> schuler_jacobian_##ID();                               \
    [[maybe_unused]] static const bool schuler_registered_##ID = ::schuler::test::register_jacobian(NAME);  \
    TEST(JacobianOf, ID) {                                                                                  \
        const std::vector<::schuler::test::LinearModel> models = schuler_jacobian_##ID();                   \
        ASSERT_FALSE(models.empty());                                                                       \
        for (const ::schuler::test::LinearModel& model : models) ::schuler::test::expect_linearised(model); \
    }                                                                                                       \
    static std::vector<::schuler::test::LinearModel> schuler_jacobian_##ID()

}  // namespace schuler::test
