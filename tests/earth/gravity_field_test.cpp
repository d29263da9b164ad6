// Gravity models in files, against the gradient of one zonal harmonic.
#include "schuler/earth/gravity_field.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/earth/axes.h"
#include "schuler/earth/ellipsoid.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <vector>

namespace schuler::earth {
namespace {

constexpr double GM = 3986004.418e8, a = 6378137.0;

/// A model of degree three and order zero in GeographicLib's format.
void write_model(const std::filesystem::path& folder, const char* name, double c30) {
    std::ofstream(folder / (std::string(name) + ".egm"))
        << "EGMF-1\nName " << name << "\nReleaseDate 2000-01-01\nModelRadius 6378137\nModelMass 3986004.418e8\n"
        << "AngularVelocity 7292115e-11\nReferenceRadius 6378137\nReferenceMass 3986004.418e8\nFlattening 1/298.257223563\n"
        << "HeightOffset 0\nCorrectionMultiplier 1\nNormalization full\nID TESTZ001\n";
    std::ofstream file(folder / (std::string(name) + ".egm.cof"), std::ios::binary);
    const auto put = [&file](const auto& x) { file.write(reinterpret_cast<const char*>(&x), sizeof x); };
    file << "TESTZ001";
    for (const std::int32_t size : {3, 0}) put(size);
    for (const double c : {0.0, 0.0, -4.84e-4, c30}) put(c);
    for (const std::int32_t size : {-1, -1}) put(size);
}

TEST(GravityField, ZonalHarmonicOfDegreeThree) {
    const schuler::test::TemporaryFolder folder("gravity_field");
    const double c30 = 9.57e-7;
    write_model(folder.path(), "without", 0.0);
    write_model(folder.path(), "with", c30);
    const GravityField without("without", folder.path().string()), with("with", folder.path().string());
    for (const double lat : {-70.0, -12.0, 3.0, 56.0, 84.0}) {
        const Geodetic place{lat * units::deg, 0.7, 1500.0};
        // The potential GM/r (a/r)^3 sqrt(7) c30 P3(sin of the geocentric latitude), its derivatives up and north of the sphere.
        const Eigen::Vector3d r = ecef_from_geodetic(wgs84, place).r;
        const double R = r.norm(), sine = r.z() / R, cosine = std::sqrt(1.0 - sine * sine);
        const double scale = GM / (R * R) * std::pow(a / R, 3) * std::sqrt(7.0) * c30;
        const double outward = -4.0 * scale * (2.5 * sine * sine - 1.5) * sine,
                     northward = scale * (7.5 * sine * sine - 1.5) * cosine;
        const double tilt = place.lat - std::asin(sine);  // of the vertical against the radius vector
        const Eigen::Vector3d expected(std::cos(tilt) * northward - std::sin(tilt) * outward, 0.0,
                                       -std::cos(tilt) * outward - std::sin(tilt) * northward);
        EXPECT_LT((with.disturbance_n(place) - without.disturbance_n(place) - expected).norm(), 1e-13) << lat;
        EXPECT_GT(expected.norm(), 1e-6) << lat;
    }
}

TEST(GravityField, MissingModelsAreAnInputError) { EXPECT_THROW(GravityField("egm2008", "/nowhere"), Error); }

}  // namespace
}  // namespace schuler::earth
