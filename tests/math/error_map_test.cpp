#include "schuler/math/rotation.h"
#include "support/perturbation.h"

#include <vector>

namespace schuler::math {
namespace {

using test::LinearModel;

SCHULER_JACOBIAN(rpy_error_from_phi, "math.rpy_error_from_phi") {
    std::vector<LinearModel> models;
    for (const Eigen::Vector3d& rpy : {Eigen::Vector3d(0.3, -0.5, 2.1), Eigen::Vector3d(-2.9, 1.2, 5.5)}) {
        const Eigen::MatrixXd J = rpy_error_from_phi(rpy);
        models.push_back({"attitude", J,
                          [rpy](const Eigen::VectorXd& phi) -> Eigen::VectorXd {
                              const Eigen::Vector3d minus = -phi;
                              return rpy_from_dcm(dcm_from_rotation_vector(minus) * dcm_from_rpy(rpy));
                          },
                          Eigen::VectorXd::Constant(3, 1e-3), Eigen::MatrixXd::Constant(3, 3, 1e-9)});
    }
    return models;
}

}  // namespace
}  // namespace schuler::math
