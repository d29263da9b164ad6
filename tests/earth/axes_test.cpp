// Axis conventions of the papers: their printed matrices and quaternions against the program's attitude.
#include "schuler/earth/axes.h"
#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>
#include <random>
#include <vector>

namespace {

using namespace schuler;
using namespace schuler::earth;
using units::deg;

constexpr AxisConvention conventions[] = {program_axes, paper_a_chapter1_axes, paper_a_chapter3_axes, paper_b_axes, paper_c_axes};

std::vector<Eigen::Vector3d> attitudes() {
    std::mt19937_64 rng(7);
    std::uniform_real_distribution<double> u(-1, 1);
    std::vector<Eigen::Vector3d> result{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 1.0}};
    for (int i = 0; i < 40; ++i) result.push_back({3.1 * u(rng), 1.5 * u(rng), 3.14 + 3.1 * u(rng)});
    return result;
}

double turned_apart(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
    return math::rotation_vector_from_quaternion(a.conjugate() * b).norm();
}

TEST(Axes, UnitVectorsPointWhereTheirNamesSay) {
    const Eigen::Matrix3d nue = ned_from(LocalLevelAxes::NorthUpEast), enu = ned_from(LocalLevelAxes::EastNorthUp);
    const Eigen::Vector3d north(1, 0, 0), east(0, 1, 0), up(0, 0, -1);
    EXPECT_EQ(nue.col(0), north);
    EXPECT_EQ(nue.col(1), up);
    EXPECT_EQ(nue.col(2), east);
    EXPECT_EQ(enu.col(0), east);
    EXPECT_EQ(enu.col(1), north);
    EXPECT_EQ(enu.col(2), up);
    const Eigen::Matrix3d fur = frd_from(BodyAxes::ForwardUpRight), flu = frd_from(BodyAxes::ForwardLeftUp);
    EXPECT_EQ(fur.col(1), up);
    EXPECT_EQ(fur.col(2), east);
    EXPECT_EQ(flu.col(1), Eigen::Vector3d(-east));
    EXPECT_EQ(flu.col(2), up);
    for (const Eigen::Matrix3d& C : {nue, enu, fur, flu}) EXPECT_EQ(C.determinant(), 1.0);
}

TEST(Axes, MatrixAndQuaternionAgreeAndGoBack) {
    for (const AxisConvention& axes : conventions)
        for (const Eigen::Vector3d& rpy : attitudes()) {
            const Eigen::Matrix3d C_nb = math::dcm_from_rpy(rpy);
            const Eigen::Quaterniond q_nb = math::quaternion_from_rpy(rpy);
            EXPECT_LT((quaternion_in(axes, q_nb).toRotationMatrix() - dcm_in(axes, C_nb)).norm(), 2e-15);
            EXPECT_LT((C_nb_from(axes, dcm_in(axes, C_nb)) - C_nb).norm(), 1e-15);
            EXPECT_LT(turned_apart(q_nb_from(axes, quaternion_in(axes, q_nb)), q_nb), 2e-15);
        }
}

TEST(Axes, PaperAChapter1PrintedMatrixAnglesAndInitialQuaternion) {
    for (const Eigen::Vector3d& rpy : attitudes()) {
        const double psi = -rpy.z(), t = rpy.y(), g = rpy.x();  // psi counter-clockwise: minus the heading
        const double cp = std::cos(psi), sp = std::sin(psi), ct = std::cos(t), st = std::sin(t), cg = std::cos(g),
                     sg = std::sin(g);
        Eigen::Matrix3d B;  // math.md 2.5
        // clang-format off
        B << cp * ct, sp * sg - cp * st * cg, sp * cg + sg * st * cp,
             st, ct * cg, -ct * sg,
             -sp * ct, cp * sg + sp * st * cg, cp * cg - sp * st * sg;
        // clang-format on
        EXPECT_LT((dcm_in(paper_a_chapter1_axes, math::dcm_from_rpy(rpy)) - B).norm(), 2e-15);
        const PaperAngles a = paper_a_chapter1_angles(B);
        EXPECT_NEAR(math::wrap_pi(a.roll - g), 0.0, 1e-13);
        EXPECT_NEAR(a.pitch, t, 1e-13);
        EXPECT_NEAR(math::wrap_pi(a.azimuth - psi), 0.0, 1e-13);
        const double chp = std::cos(psi / 2), shp = std::sin(psi / 2), cht = std::cos(t / 2), sht = std::sin(t / 2);
        const double chg = std::cos(g / 2), shg = std::sin(g / 2);
        const Eigen::Quaterniond l(chp * cht * chg - shp * sht * shg, chp * cht * shg + shp * sht * chg,
                                   shp * cht * chg + chp * sht * shg, chp * sht * chg - shp * cht * shg);
        EXPECT_LT(turned_apart(quaternion_in(paper_a_chapter1_axes, math::quaternion_from_rpy(rpy)), l), 3e-15);
    }
}

TEST(Axes, PaperAChapter3ReferenceMatrixAndAngles) {
    const Eigen::Vector3d rpy(-12 * deg, 7 * deg, 40 * deg);
    Eigen::Matrix3d B;
    // clang-format off
    B << 0.637996368317, -0.235893867532, 0.73301754227,
         0.760334464004, 0.0423258071863, -0.648151239213,
         0.121869343405, 0.970856636846, 0.206361948602;
    // clang-format on
    EXPECT_LT((dcm_in(paper_a_chapter3_axes, math::dcm_from_rpy(rpy)) - B).norm(), 3e-12);
    for (const Eigen::Vector3d& angles : attitudes()) {
        const PaperAngles a = paper_a_chapter3_angles(dcm_in(paper_a_chapter3_axes, math::dcm_from_rpy(angles)));
        EXPECT_NEAR(math::wrap_pi(a.roll - angles.x()), 0.0, 1e-13);
        EXPECT_NEAR(a.pitch, angles.y(), 1e-13);
        EXPECT_NEAR(math::wrap_pi(a.azimuth - angles.z()), 0.0, 1e-13);
    }
}

TEST(Axes, PaperBPrintedMatrixAnglesAndScalarLastQuaternion) {
    for (const Eigen::Vector3d& rpy : attitudes()) {
        const double sA = std::sin(rpy.z()), cA = std::cos(rpy.z()), st = std::sin(rpy.y()), ct = std::cos(rpy.y());
        const double sg = std::sin(rpy.x()), cg = std::cos(rpy.x());
        Eigen::Matrix3d n_to_b;  // math.md 3.1, eq (5)
        // clang-format off
        n_to_b << sA * ct, cA * ct, st,
                  -cA * cg - sA * sg * st, sA * cg - cA * sg * st, ct * sg,
                  cA * sg - sA * cg * st, -sA * sg - cA * cg * st, ct * cg;
        // clang-format on
        const Eigen::Matrix3d C_nb = math::dcm_from_rpy(rpy);
        EXPECT_LT((paper_b_local_to_body(C_nb) - n_to_b).norm(), 2e-15);
        const PaperAngles a = paper_b_angles(n_to_b.transpose());
        EXPECT_NEAR(math::wrap_pi(a.roll - rpy.x()), 0.0, 1e-13);
        EXPECT_NEAR(a.pitch, rpy.y(), 1e-13);
        EXPECT_NEAR(math::wrap_pi(a.azimuth - rpy.z()), 0.0, 1e-13);
        const Eigen::Quaterniond q_nb = math::quaternion_from_rpy(rpy);
        const ScalarLast q = paper_b_quaternion(q_nb);
        const Eigen::Vector3d e = q.head<3>();
        const double q0 = q(3);
        const Eigen::Matrix3d A =
            (q0 * q0 - e.squaredNorm()) * Eigen::Matrix3d::Identity() + 2 * e * e.transpose() - 2 * q0 * math::skew(e);
        EXPECT_LT((A - n_to_b).norm(), 3e-15);
        EXPECT_LT(turned_apart(q_nb_from_paper_b(q), q_nb), 2e-15);
    }
    // The identity of paper B: x points east (math.md 3.1).
    EXPECT_NEAR(math::rpy_from_quaternion(q_nb_from_paper_b({0, 0, 0, 1})).z(), 90 * deg, 1e-15);
}

TEST(Axes, PaperEMatrixIsEarthFixedToBody) {
    const double angle = 0.7;
    for (const Eigen::Vector3d& rpy : attitudes()) {
        const Eigen::Matrix3d C_eb = C_en(0.6, 2.0) * math::dcm_from_rpy(rpy);
        const Eigen::Quaterniond l = paper_e_quaternion(Eigen::Quaterniond(C_eb), angle);
        // The paper's: [.., +2(l1 l2 + l0 l3), ..] times Rz.
        Eigen::Matrix3d q_part, rz;
        // clang-format off
        q_part << 1 - 2 * (l.y() * l.y() + l.z() * l.z()), 2 * (l.x() * l.y() + l.w() * l.z()), 2 * (l.x() * l.z() - l.w() * l.y()),
                  2 * (l.x() * l.y() - l.w() * l.z()), 1 - 2 * (l.x() * l.x() + l.z() * l.z()), 2 * (l.y() * l.z() + l.w() * l.x()),
                  2 * (l.x() * l.z() + l.w() * l.y()), 2 * (l.y() * l.z() - l.w() * l.x()), 1 - 2 * (l.x() * l.x() + l.y() * l.y());
        // clang-format on
        rz << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
        EXPECT_LT((q_part * rz - C_eb.transpose()).norm(), 3e-15);
        EXPECT_LT((C_eb_from_paper_e(l, angle) - C_eb).norm(), 3e-15);
    }
}

}  // namespace
