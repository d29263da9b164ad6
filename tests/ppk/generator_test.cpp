// A signal generator's base and rover, whose places are known to a tenth of a millimetre: at rest, in a figure, disturbed.
#include "ppk/ppk_fixture.h"

#include "schuler/core/error.h"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

namespace schuler::ppk {
namespace {

using test::Errors;
using test::errors_of;
using test::PairOfLogs;

const Ecef at_rest{{4156857.1195929, 673209.028774142, 4774767.03105544}},
    base_place{{4157177.06580187, 671230.476590636, 4774767.03105544}};

/// The generator's motion, every 0.1 s.
class Path {
public:
    Path() {
        std::ifstream file(io::test::data_folder() / "spirent_rtk_noatm" / "Rover-dynamic_motion_Spirent.csv");
        std::string line;
        for (int i = 0; std::getline(file, line); ++i) {
            if (i < 2) continue;
            std::istringstream cells(line);
            std::string cell;
            Eigen::Vector3d r;
            std::getline(cells, cell, ',');
            for (int k = 0; k < 3 && std::getline(cells, cell, ','); ++k) r[k] = std::stod(cell);
            places_.push_back(r);
        }
    }
    [[nodiscard]] Ecef operator()(Time t) const {
        const double at = (t.seconds() - 1357207200.0) * 10.0;
        const auto k = static_cast<std::size_t>(std::clamp(std::round(at), 0.0, static_cast<double>(places_.size() - 1)));
        return {places_[k]};
    }

private:
    std::vector<Eigen::Vector3d> places_;
};

void print(const std::string& name, const Errors& e) {
    fmt::print(
        "{}: {} epochs, {} fixed, first at {} s, all from {} s on, {} wrong, {} outside three sigma; RMS {:.2f} mm horizontal, {:.2f} mm "
        "vertical, largest {:.1f} mm\n",
        name, e.epochs, e.fixed, e.first_fixed, e.fixed_until, e.wrong, e.outside, 1e3 * e.horizontal(), 1e3 * e.vertical(),
        1e3 * e.largest);
}

PairOfLogs logs(const std::string& rover) {
    return {"spirent_rtk_noatm",
            rover + "_MO_Spirent.obs.gz",
            "Base-static_MO_Spirent.obs.gz",
            {"RINEX_GN_Spirent.23N", "RINEX_EN_Spirent.23L"}};
}

TEST(Generator, RoverAtRest) {
    SKIP_WITHOUT_DATA();
    const PairOfLogs pair = logs("Rover-static-2km-east");
    for (const Direction direction : {Direction::Forward, Direction::Backward, Direction::Combined}) {
        for (const std::size_t frequencies : {2U, 1U}) {
            Settings settings = test::settings_without_air();
            settings.direction = direction;
            settings.frequencies = frequencies;
            WarningLog warnings;
            const Errors e = errors_of(
                test::solved(pair, settings, test::without_air(), warnings), [](Time) { return at_rest; }, 10.0);
            print(fmt::format("at rest, {} frequencies, direction {}", frequencies, static_cast<int>(direction)), e);
            EXPECT_EQ(e.wrong, 0U);
            EXPECT_LE(e.outside, e.epochs / 100);
            if (frequencies < 2) continue;
            EXPECT_LE(e.fixed_until, 10.0);
            EXPECT_LT(e.horizontal(), 0.005);
            EXPECT_LT(e.vertical(), 0.010);
        }
    }
}

TEST(Generator, RoverInAFigure) {
    SKIP_WITHOUT_DATA();
    const PairOfLogs pair = logs("Rover-dynamic");
    const Path path;
    for (const Direction direction : {Direction::Forward, Direction::Combined}) {
        Settings settings = test::settings_without_air();
        settings.direction = direction;
        WarningLog warnings;
        const Errors e = errors_of(test::solved(pair, settings, test::without_air(), warnings), path, 10.0);
        print("figure", e);
        EXPECT_EQ(e.wrong, 0U);
        EXPECT_LE(e.outside, e.epochs / 100);
        EXPECT_LE(e.fixed_until, 10.0);
        EXPECT_LT(e.horizontal(), 0.005);
        EXPECT_LT(e.vertical(), 0.010);
    }
}

}  // namespace
}  // namespace schuler::ppk
