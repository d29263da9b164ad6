#include "schuler/earth/magnetic_model.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"

#include <gtest/gtest.h>

namespace schuler::earth {
namespace {

// Test values published with the model [ChulliatWmm2025]: year, height km, latitude, longitude, north, east, down nT.
struct Case {
    double year, height, lat, lon, north, east, down;
};
constexpr Case cases[] = {{2025.0, 28, 89, -121, -255.388723, -1482.460628, 56194.288771},
                          {2025.5, 6, -36, -137, 23781.930678, 8786.698927, -32577.518648},
                          {2026.0, 74, -57, 3, 13268.119649, -5498.179626, -23576.062921},
                          {2026.5, 14, 0, 80, 39431.415992, -2133.456168, -12188.838466},
                          {2027.0, 37, -66, -5, 16390.771268, -5079.626554, -28608.243575},
                          {2027.5, 8, 62, 53, 12260.425578, 4315.497527, 54849.810218},
                          {2028.0, 49, 20, 167, 30131.436134, 2689.876669, 15295.611788},
                          {2028.5, 28, 54, -120, 14735.145798, 4066.959949, 52393.678137},
                          {2029.0, 95, -60, -59, 17893.018948, 2700.105868, -26011.845842},
                          {2029.5, 31, 13, -132, 27795.620707, 4421.061344, 17187.983590}};

TEST(MagneticModel, PublishedValuesOf2025) {
    const MagneticModel model("wmm2025", SCHULER_SOURCE_DIR "/data");
    for (const Case& c : cases) {
        const auto f = model.at(c.year, {c.lat * units::deg, c.lon * units::deg, c.height * 1e3});
        EXPECT_LT((f.field_n * 1e9 - Eigen::Vector3d(c.north, c.east, c.down)).norm(), 0.1)
            << c.year << " " << c.lat << " " << c.lon;
    }
    EXPECT_EQ(model.first_year(), 2025.0);
    EXPECT_EQ(model.last_year(), 2030.0);
}

TEST(MagneticModel, MissingFilesAreAnInputError) { EXPECT_THROW(MagneticModel("wmm2025", "/nowhere"), Error); }

}  // namespace
}  // namespace schuler::earth
