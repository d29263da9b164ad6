// The receiver's solution from raw measurements, as the program gives it, against the generator's truth.
#include "schuler/dataset/raw_gnss.h"
#include "schuler/app/commands.h"
#include "schuler/earth/earth.h"
#include "schuler/io/solution/rtklib_pos.h"
#include "schuler/report/outcome.h"
#include "schuler/settings/dataset.h"
#include "schuler/settings/request.h"

#include "io/io_fixture.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace schuler::solution {
namespace {

class RawGnss : public io::test::IoTest {};

TEST_F(RawGnss, ProcessGivesTheReceiversSolution) {
    SKIP_WITHOUT_DATA();
    const auto data = io::test::data_folder() / "spirent_rose_noatm";
    const auto toml = write("dataset.toml", "name = \"rose\"\n[time]\nscale = \"gps\"\nweek = 2244\n[gnss]\nobservations = \"" +
                                                (data / "rover.obs").string() + "\"\nnavigation = [\"" +
                                                (data / "gps.nav").string() + "\", \"" + (data / "galileo.nav").string() +
                                                "\"]\nionosphere = \"none\"\ntroposphere = \"none\"\n[reference]\nfile = \"" +
                                                (data / "reference.csv").string() + "\"\n[filter]\nscheme = \"gnss\"\n");
    settings::ProcessRequest request;
    request.input = toml;
    request.output = folder() / "out";
    const report::Outcome outcome = app::process_dataset(request);
    const auto json = nlohmann::json::parse(outcome.json);
    EXPECT_EQ(json.at("scheme"), "gnss");
    EXPECT_EQ(json.at("gnss").at("epochs"), 601);
    EXPECT_LT(json.at("errors").at("position_m").at("horizontal").at("rms").get<double>(), 0.01);
    EXPECT_LT(json.at("errors").at("position_m").at("horizontal").at("max").get<double>(), 0.01);
    EXPECT_LT(json.at("errors").at("velocity_m_s").at("north").at("rms").get<double>(), 0.01);
    // the same folder without a word of description: the program says what it takes it for
    const settings::Dataset inferred = settings::open_dataset(io::test::data_folder() / "rtklib_geonet_pair");
    EXPECT_NE(inferred.inferred_toml.find("observations = \"07590920.05o\""), std::string::npos) << inferred.inferred_toml;
    EXPECT_NE(inferred.inferred_toml.find("30400920.05n"), std::string::npos);
}

/// Handheld u-blox receiver, all its bands, in a yard.
class Walk : public RawGnss {
protected:
    [[nodiscard]] nlohmann::json run(const std::string& gnss, const std::string& scheme, const std::string& more = {},
                                     const std::string& outages = {}) const {
        const auto data = io::test::data_folder() / "walk_0827";
        const std::string log = "\"" + (data / "gnss.ubx").string() + "\"\n";
        settings::ProcessRequest request;
        request.input =
            write("dataset.toml", "name = \"walk\"\n[time]\nscale = \"gps\"\n[imu]\nfile = \"" + (data / "imu.csv").string() +
                                      "\"\n[gnss]\n" + gnss + " = " + log + more + "[reference]\nfile = \"" +
                                      (data / "gnss.csv").string() + "\"\n[filter]\nscheme = \"" + scheme + "\"\n" + outages);
        request.output = folder() / "out";
        return nlohmann::json::parse(app::process_dataset(request).json);
    }
    static double horizontal(const nlohmann::json& j) {
        return j.at("errors").at("position_m").at("horizontal").at("rms").get<double>();
    }
};

/// RMS of the horizontal errors at the ends of outages, m.
double end(const nlohmann::json& j) {
    double sum = 0.0;
    for (const auto& o : j.at("outages")) sum += std::pow(o.at("end_horizontal_m").get<double>(), 2);
    return std::sqrt(sum / static_cast<double>(j.at("outages").size()));
}

TEST_F(Walk, TightUsesTheSatellitesOfAnUntouchedLog) {
    SKIP_WITHOUT_DATA();
    std::string outages;
    for (const int start : {45, 65, 85, 105, 120})
        outages += "[[outage]]\nstart_s = " + std::to_string(start) + "\nduration_s = 10\n";
    const auto tight = run("observations", "tight", "", outages), loose = run("observations", "loose", "", outages);
    for (const char* kind : {"pseudorange", "range_rate"}) {
        const auto& nis = tight.at("consistency").at("nis").at(kind);
        EXPECT_GT(nis.at("accepted").get<double>(), 20.0 * nis.at("rejected").get<double>()) << kind;
    }
    // The log's own base is off by some metres, which only tight's sigmas have room for; both are measured against the same.
    ASSERT_EQ(tight.at("outages").size(), 5U);
    for (const auto& o : tight.at("outages")) EXPECT_TRUE(o.at("inside_3sigma").get<bool>()) << o.dump();
    EXPECT_LT(end(tight), end(loose));
}

TEST_F(Walk, BeiDouAloneAndTheReceiversOwnFixes) {
    SKIP_WITHOUT_DATA();
    const auto beidou = run("observations", "gnss", "systems = \"C\"\n");
    EXPECT_GT(beidou.at("gnss").at("epochs").get<int>(), 300);
    EXPECT_LT(horizontal(beidou), 15.0);
    const auto own = run("file", "gnss");
    EXPECT_GT(own.at("gnss").at("epochs").get<int>(), 500);
    EXPECT_LT(horizontal(own), 0.05);  // they are what the reference was made of
}

}  // namespace
}  // namespace schuler::solution
