// Gravity against the closed form of normal gravity, tabulated values and numerical derivatives.
#include "schuler/earth/gravity.h"
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"

#include <gtest/gtest.h>
#include <GeographicLib/NormalGravity.hpp>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace {

using namespace schuler;
using namespace schuler::earth;
using units::deg;

constexpr GravityModel every_model[] = {GravityModel::Somigliana, GravityModel::Grs80, GravityModel::KfGins, GravityModel::PaperA,
                                        GravityModel::PaperC};

GravityVector at(GravityModel model, double lat, double h) { return gravity_vector(model, std::sin(lat), std::cos(lat), h); }

void expect_closed_form(GravityModel model, const GeographicLib::NormalGravity& oracle) {
    double worst_down = 0.0, worst_north = 0.0;
    for (double lat_deg = -90; lat_deg <= 90; lat_deg += 2.5)
        for (const double h : {-1000.0, -500.0, 0.0, 100.0, 5000.0, 10000.0, 15000.0, 20000.0}) {
            double north, up;
            oracle.Gravity(lat_deg, h, north, up);
            const GravityVector g = at(model, lat_deg * deg, h);
            worst_down = std::max(worst_down, std::abs(g.down + up));
            worst_north = std::max(worst_north, std::abs(g.north - north));
            if (h == 0.0) {
                EXPECT_NEAR(g.down, -up, 2e-10) << lat_deg;  // ten digits of the tabulated constants
                EXPECT_EQ(g.north, 0.0);
            }
        }
    EXPECT_LT(worst_down, 1.5e-6);
    EXPECT_LT(worst_north, 5e-8);
    EXPECT_GT(worst_down, 1e-7);  // the series is not the closed form: the oracle is independent
}

TEST(Gravity, SomiglianaIsWithinItsBoundOfTheClosedForm) {
    expect_closed_form(GravityModel::Somigliana, GeographicLib::NormalGravity::WGS84());
}
TEST(Gravity, Grs80IsWithinItsBoundOfTheClosedForm) {
    expect_closed_form(GravityModel::Grs80, GeographicLib::NormalGravity::GRS80());
}

struct Sample {
    double lat_deg, h, somigliana, exact_north, paper_a, paper_c;
};
// Made with 40-digit arithmetic from the printed formulas.
const std::vector<Sample> samples{
    {0, 0, 9.7803253359, 0.0, 9.78049, 9.78049},
    {0, 20000, 9.71886002385, 0.0, 9.71902421112, 9.71944073544},
    {15, 1000, 9.78069827909, -4.07395362512e-06, 9.78085119601, 9.78090633253},
    {30, 10000, 9.76245326861, -7.04741968169e-05, 9.76257415704, 9.76285374022},
    {45, 0, 9.80619776938, 0.0, 9.80627522758, 9.80649143267},
    {45, 20000, 9.74477605365, -0.000162517643953, 9.74485315918, 9.74527986864},
    {50.45, 5000, 9.79569537776, -3.99604323569e-05, 9.79575648188, 9.79604364003},
    {60, 10000, 9.78840465232, -7.04315807409e-05, 9.78843873173, 9.78877383261},
    {75, 1000, 9.82561367294, -4.06963682265e-06, 9.82561587675, 9.8259280166},
    {90, 0, 9.83218493786, 0.0, 9.8321754289, 9.83249286533},
    {90, 20000, 9.77080719026, 0.0, 9.77079708099, 9.77111900183},
};

TEST(Gravity, TabulatedSamples) {
    for (const Sample& s : samples) {
        const double lat = s.lat_deg * deg;
        EXPECT_NEAR(gravity_down(GravityModel::Somigliana, lat, s.h), s.somigliana, 1e-10) << s.lat_deg << " " << s.h;
        EXPECT_NEAR(at(GravityModel::Somigliana, lat, s.h).north, s.exact_north, 5e-8) << s.lat_deg << " " << s.h;
        EXPECT_NEAR(gravity_down(GravityModel::PaperA, lat, s.h), s.paper_a, 1e-10) << s.lat_deg << " " << s.h;
        EXPECT_NEAR(at(GravityModel::PaperA, lat, s.h).north, s.exact_north, 7e-7) << s.lat_deg << " " << s.h;
        EXPECT_NEAR(gravity_down(GravityModel::PaperC, lat, s.h), s.paper_c, 1e-10) << s.lat_deg << " " << s.h;
    }
}

TEST(Gravity, PaperAReferenceStateWithDerivatives) {
    EXPECT_NEAR(gravity_down(GravityModel::Somigliana, 50 * deg, 3000), 9.801453121395, 1e-11);
    const GravityGradient g = gravity_gradient(GravityModel::Somigliana, 50 * deg, 3000);
    EXPECT_NEAR(g.by_lat, 0.0511234617233, 1e-12);
    EXPECT_NEAR(g.by_height, -3.08083425896e-06, 1e-16);
}

TEST(Gravity, KfGinsSeriesByHand) {
    // lat 30 deg: s2 = 1/4, so the series is a sum of decimal numbers.
    const double g0 = 9.7803267715 * (1 + 0.0052790414 / 4 + 0.0000232718 / 16 + 1.262e-7 / 64 + 7e-10 / 256);
    EXPECT_NEAR(gravity_down(GravityModel::KfGins, 30 * deg, 0), g0, 4e-15);
    EXPECT_NEAR(gravity_down(GravityModel::KfGins, 30 * deg, 2000), g0 - (3.0877e-6 - 1.075e-9) * 2000 + 0.72e-12 * 4e6, 4e-15);
    EXPECT_EQ(at(GravityModel::KfGins, 0.5, 9000).north, 0.0);
    EXPECT_EQ(at(GravityModel::PaperC, 0.5, 9000).north, 0.0);
}

TEST(Gravity, GradientIsTheDerivativeOfEveryModel) {
    for (const GravityModel model : every_model)
        for (const double lat : {-1.4, -0.3, 0.0, 0.2, 0.8, 1.5})
            for (const double h : {-500.0, 0.0, 3000.0, 20000.0}) {
                const GravityGradient g = gravity_gradient(model, lat, h);
                const double dl = 1e-4, dh = 100.0;
                const double by_lat = (gravity_down(model, lat + dl, h) - gravity_down(model, lat - dl, h)) / (2 * dl);
                const double by_height = (gravity_down(model, lat, h + dh) - gravity_down(model, lat, h - dh)) / (2 * dh);
                EXPECT_NEAR(g.by_lat, by_lat, 2e-9) << name_of(model) << " " << lat << " " << h;
                EXPECT_NEAR(g.by_height, by_height, 3e-15) << name_of(model) << " " << lat << " " << h;
            }
}

TEST(Gravity, SomiglianaFieldHasNoCurlInTheMeridian) {
    // d((M + h) north)/dh = -d(down)/dlat for a field with a potential.
    for (const double lat : {-1.2, -0.4, 0.3, 0.785, 1.3})
        for (const double h : {0.0, 5000.0, 20000.0}) {
            const double m = radii(wgs84, lat).meridian, dh = 50.0;
            const double turned = ((m + h + dh) * at(GravityModel::Somigliana, lat, h + dh).north -
                                   (m + h - dh) * at(GravityModel::Somigliana, lat, h - dh).north) /
                                  (2 * dh);
            EXPECT_NEAR(turned, -gravity_gradient(GravityModel::Somigliana, lat, h).by_lat, 1e-9);
        }
}

TEST(Gravity, NamesGoThereAndBackAndUnknownOnesAreExplained) {
    for (const GravityModel model : every_model) EXPECT_EQ(gravity_model_from_name(name_of(model)), model);
    try {
        (void)gravity_model_from_name("egm96");
        FAIL() << "accepted";
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::Input);
        const std::string text = e.what();
        for (const char* word : {"egm96", "somigliana", "grs80", "kf-gins", "paper_a", "paper_c"})
            EXPECT_NE(text.find(word), std::string::npos) << text;
    }
}

}  // namespace
