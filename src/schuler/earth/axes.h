// Axis conventions of the papers: conversions to and from the program's C_nb and q_nb (forward-right-down to north-east-down).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace schuler::earth {

enum class LocalLevelAxes {
    NorthEastDown,  ///< of this program
    NorthUpEast,    ///< paper A ch. 1 ("N, H, E") and paper C
    EastNorthUp,    ///< paper A ch. 3 and paper B
};
enum class BodyAxes {
    ForwardRightDown,  ///< of this program
    ForwardUpRight,    ///< papers A and C
    ForwardLeftUp,     ///< paper B
};
/// A pair of frames: the meaning of "body to local level" in a paper.
struct AxisConvention {
    LocalLevelAxes local;
    BodyAxes body;
};
inline constexpr AxisConvention program_axes{LocalLevelAxes::NorthEastDown, BodyAxes::ForwardRightDown};
inline constexpr AxisConvention paper_a_chapter1_axes{LocalLevelAxes::NorthUpEast, BodyAxes::ForwardUpRight};
inline constexpr AxisConvention paper_a_chapter3_axes{LocalLevelAxes::EastNorthUp, BodyAxes::ForwardUpRight};
inline constexpr AxisConvention paper_b_axes{LocalLevelAxes::EastNorthUp, BodyAxes::ForwardLeftUp};
inline constexpr AxisConvention paper_c_axes = paper_a_chapter1_axes;

/// Takes components in the given local-level axes to north-east-down. A rotation; its transpose goes back.
[[nodiscard]] Eigen::Matrix3d ned_from(LocalLevelAxes axes);
/// Takes components in the given body axes to forward-right-down. A rotation; its transpose goes back.
[[nodiscard]] Eigen::Matrix3d frd_from(BodyAxes axes);

/// Body-to-local-level matrix in a paper's axes from the program's C_nb.
[[nodiscard]] Eigen::Matrix3d dcm_in(const AxisConvention& axes, const Eigen::Matrix3d& C_nb);
/// The program's C_nb from a paper's body-to-local-level matrix.
[[nodiscard]] Eigen::Matrix3d C_nb_from(const AxisConvention& axes, const Eigen::Matrix3d& body_to_local);
/// The same as Hamilton quaternions, body to local level.
[[nodiscard]] Eigen::Quaterniond quaternion_in(const AxisConvention& axes, const Eigen::Quaterniond& q_nb);
[[nodiscard]] Eigen::Quaterniond q_nb_from(const AxisConvention& axes, const Eigen::Quaterniond& body_to_local);

/// Angles as a paper extracts them from its own matrix, rad.
struct PaperAngles {
    double roll;     ///< positive right wing down in all of them (paper B: "left wing up")
    double pitch;    ///< positive nose up
    double azimuth;  ///< of the longitudinal axis; its sense depends on the paper, see the functions
};
/// Paper A ch. 1 (math.md 2.5): psi counter-clockwise about up in (-pi, pi]; the heading is -psi. B: body to local level.
[[nodiscard]] PaperAngles paper_a_chapter1_angles(const Eigen::Matrix3d& B);
/// Paper A ch. 3 (math.md 2.1): psi clockwise from north in (-pi, pi]. B: body to local level, (3.1.1).
[[nodiscard]] PaperAngles paper_a_chapter3_angles(const Eigen::Matrix3d& B);
/// Paper B (math.md 3.1): azimuth clockwise from north in (-pi, pi], from the paper's C_bn, which takes body to local level.
[[nodiscard]] PaperAngles paper_b_angles(const Eigen::Matrix3d& body_to_local);

/// Quaternion with the scalar part last (e1, e2, e3, q0), as in paper B.
using ScalarLast = Eigen::Vector4d;
/// Paper B's quaternion of the program's attitude. Paper B's matrix A(q) = (q0^2 - e.e) I + 2 e e^T - 2 q0 [e x] takes local
/// level to body, so the four numbers are those of the Hamilton quaternion body to local level in its axes.
[[nodiscard]] ScalarLast paper_b_quaternion(const Eigen::Quaterniond& q_nb);
[[nodiscard]] Eigen::Quaterniond q_nb_from_paper_b(const ScalarLast& q);
/// Paper B's matrix "C_nb", eq (5): local level to body in its axes (the transpose of this program's matrix of that name).
[[nodiscard]] Eigen::Matrix3d paper_b_local_to_body(const Eigen::Matrix3d& C_nb);

/// Paper E (math.md 4): the matrix A, Earth-fixed to body axes, is the transpose of C_eb; it is formed from the quaternion of the
/// body against inertial axes (Hamilton, body to inertial) and the angle u0 t (rad) of Earth rotation.
[[nodiscard]] Eigen::Matrix3d C_eb_from_paper_e(const Eigen::Quaterniond& q_ib, double earth_angle);
[[nodiscard]] Eigen::Quaterniond paper_e_quaternion(const Eigen::Quaterniond& q_eb, double earth_angle);

}  // namespace schuler::earth
