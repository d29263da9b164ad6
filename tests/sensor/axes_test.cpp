// Sensor axes: what a data set may write, and what it is told when it is wrong.
#include "schuler/sensor/axes.h"
#include "schuler/core/error.h"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <string>
#include <vector>

namespace {

using schuler::Error;
using schuler::sensor::C_bs_from_axes;

TEST(SensorAxes, NamedAndExplicitFormsAgree) {
    EXPECT_EQ(C_bs_from_axes("frd"), Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
    Eigen::Matrix3d flu = Eigen::Vector3d(1, -1, -1).asDiagonal();
    EXPECT_EQ(C_bs_from_axes("flu"), flu);
    EXPECT_EQ(C_bs_from_axes("x=forward, y=left, z=up"), flu);
    EXPECT_EQ(C_bs_from_axes(" Z = Up ; X=Forward; y = L "), flu);
    Eigen::Matrix3d fur;
    fur << 1, 0, 0, 0, 0, 1, 0, -1, 0;  // sensor y is up: body -z; sensor z is right: body +y
    EXPECT_EQ(C_bs_from_axes("fur"), fur);
    EXPECT_EQ(C_bs_from_axes("FUR"), fur);
    // A sensor mounted backwards: gravity reaction (up) and forward acceleration land on the right body axes.
    const Eigen::Matrix3d back = C_bs_from_axes("x=back, y=right, z=up");
    EXPECT_EQ(Eigen::Vector3d(back * Eigen::Vector3d(0, 0, 9.8)), Eigen::Vector3d(0, 0, -9.8));
    EXPECT_EQ(Eigen::Vector3d(back * Eigen::Vector3d(-2, 0, 0)), Eigen::Vector3d(2, 0, 0));
}

TEST(SensorAxes, EveryAcceptedTripleIsARotationAndHalfAreRefused) {
    const std::string letters = "fbrldu";
    int accepted = 0;
    for (const char x : letters)
        for (const char y : letters)
            for (const char z : letters) {
                try {
                    const Eigen::Matrix3d C = C_bs_from_axes(std::string{x, y, z});
                    ++accepted;
                    EXPECT_EQ(C.determinant(), 1.0);
                    EXPECT_EQ((C * C.transpose()).eval(), Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
                } catch (const Error&) {
                    continue;
                }
            }
    EXPECT_EQ(accepted, 24);
}

void expect_explained(const char* axes, const std::vector<std::string>& words) {
    try {
        (void)C_bs_from_axes(axes);
        FAIL() << "accepted " << axes;
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), schuler::ErrorKind::Input);
        EXPECT_EQ(e.place().key, "axes");
        for (const std::string& word : words) EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
}

TEST(SensorAxes, WrongSpecificationsAreExplained) {
    expect_explained("fld", {"left-handed", "z points up"});
    expect_explained("x=forward, y=right, z=up", {"left-handed", "z points down"});
    expect_explained("x=forward, y=left", {"axis z is missing"});
    expect_explained("x=forward, x=left, z=up", {"axis x is given twice"});
    expect_explained("x=forward, y=backward, z=up", {"one line"});
    expect_explained("ffu", {"one line"});
    expect_explained("x=north, y=left, z=up", {"\"north\"", "not a direction"});
    expect_explained("w=forward, y=left, z=up", {"w=forward"});
    expect_explained("fr", {"three letters"});
    expect_explained("", {"three letters"});
    expect_explained("enu", {"\"e\"", "not a direction"});
    expect_explained("x=forward, y=left, z=", {"z="});
}

}  // namespace
