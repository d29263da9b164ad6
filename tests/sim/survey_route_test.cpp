// Surveys as they are flown: every line straight and whole, every crossing there, the bank kept, the ground cleared.
#include "schuler/sim/survey_route.h"
#include "schuler/core/error.h"
#include "schuler/core/units.h"

#include <gtest/gtest.h>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace schuler::sim {
namespace {

using Eigen::Vector2d;

const earth::Ellipsoid ellipsoid = earth::wgs84;

/// Metres along the first line and to the right of it, from the beginning of that line.
struct Axes {
    SurveyPattern p;
    double overrun;
    [[nodiscard]] Vector2d at(const Geodetic& g) const {
        const earth::Radii r = earth::radii(ellipsoid, p.start.lat);
        const double n = (g.lat - p.start.lat) * (r.meridian + p.start.h);
        const double e = (g.lon - p.start.lon) * (r.prime_vertical + p.start.h) * std::cos(p.start.lat);
        return {std::cos(p.heading) * n + std::sin(p.heading) * e - overrun, std::cos(p.heading) * e - std::sin(p.heading) * n};
    }
};

struct Case {
    std::string name;
    double speed, length, spacing, overrun, bank_deg, duration;
    int lines, ties;
};

TEST(SurveyRoute, LinesAndTiesAreWholeAndTheBankIsKept) {
    // Lines nearer to each other than a turn is wide, lines farther apart, and a ship whose turns are bounded by its rate.
    const Case cases[] = {{"close lines", 60.0, 20e3, 1000.0, 1500.0, 15.0, 3600.0, 4, 2},
                          {"wide lines", 60.0, 30e3, 8000.0, 1000.0, 20.0, 5000.0, 3, 3},
                          {"even lines, one tie", 100.0, 40e3, 5000.0, 3000.0, 25.0, 3500.0, 4, 1},
                          {"ship", 6.0, 4000.0, 300.0, 200.0, 15.0, 5200.0, 3, 2}};
    for (const Case& c : cases) {
        SurveyPattern p;
        p.start = {47.0 * units::deg, 9.0 * units::deg, 1200.0};
        p.heading = 0.6;
        p.speed = c.speed;
        p.lines = c.lines;
        p.ties = c.ties;
        p.length = c.length;
        p.spacing = c.spacing;
        p.overrun = c.overrun;
        p.bank = c.bank_deg * units::deg;
        p.duration = c.duration;
        const auto path = make_path(survey_route(p), ellipsoid);
        const Axes axes{p, c.overrun};
        const double width = c.spacing * (c.lines - 1), cell = 500.0;
        std::vector<int> on_line(static_cast<std::size_t>(c.lines * static_cast<int>(c.length / cell)));
        std::vector<int> on_tie(static_cast<std::size_t>(c.ties * static_cast<int>(width / cell)));
        for (double t = 0.0; t <= c.duration; t += 2.0) {
            const Kinematics k = path->at(t);
            ASSERT_LT(std::abs(k.rpy.x()), p.bank) << c.name << " after " << t << " s";
            ASSERT_NEAR(k.v_eb_n.head<2>().norm(), c.speed, 0.02 * c.speed) << c.name << " after " << t << " s";
            if (std::abs(k.rpy.x()) > 0.05 * units::deg) continue;
            const Vector2d at = axes.at(k.position);
            for (int i = 0; i < c.lines; ++i)
                if (std::abs(at.y() - i * c.spacing) < 0.5 && at.x() > 0.0 && at.x() < c.length)
                    ++on_line[static_cast<std::size_t>(i * static_cast<int>(c.length / cell) + static_cast<int>(at.x() / cell))];
            for (int j = 0; j < c.ties; ++j)
                if (std::abs(at.x() - c.length * (2 * j + 1) / (2.0 * c.ties)) < 0.5 && at.y() > 0.0 && at.y() < width)
                    ++on_tie[static_cast<std::size_t>(j * static_cast<int>(width / cell)) +
                             std::min(static_cast<std::size_t>(at.y() / cell), static_cast<std::size_t>(width / cell) - 1)];
        }
        const int fewest = static_cast<int>(cell / c.speed / 2.0) - 1;
        EXPECT_GE(*std::ranges::min_element(on_line), fewest) << c.name;
        EXPECT_GE(*std::ranges::min_element(on_tie), fewest) << c.name;
        EXPECT_LE(*std::ranges::max_element(on_line), 2 * (fewest + 3)) << c.name << ": nothing is flown again and again";
    }
}

TEST(SurveyRoute, DrapeClearsTheGroundWithoutSteepClimbs) {
    SurveyPattern p;
    p.start = {47.0 * units::deg, 9.0 * units::deg, 900.0};
    p.duration = 1500.0;
    RoutePath route = survey_route(p);
    const auto ground = [&p](double lat, double lon) {
        return 500.0 + 400.0 * std::sin((lat - p.start.lat) * 6.37e6 / 1500.0) +
               50.0 * std::cos((lon - p.start.lon) * 4e6 / 700.0);
    };
    route.drape = Drape{ground, 250.0, 0.06, 900.0};
    const auto path = make_path(route, ellipsoid);
    double least = 1e9, steepest = 0.0, highest = -1e9;
    for (double t = 0.0; t <= p.duration; t += 0.5) {
        const Kinematics k = path->at(t);
        const double clear = k.position.h - ground(k.position.lat, k.position.lon);
        least = std::min(least, clear);
        highest = std::max(highest, clear);
        steepest = std::max(steepest, std::abs(k.v_eb_n.z()) / k.v_eb_n.head<2>().norm());
        ASSERT_LT(std::abs(k.dv_eb_n.z()), 1.2) << "after " << t << " s";
    }
    EXPECT_GT(least, 249.0);
    EXPECT_LT(least, 290.0);    // nor higher than it must
    EXPECT_GT(highest, 400.0);  // the valleys are too narrow for the slope
    EXPECT_LT(steepest, 0.0605);
    EXPECT_GT(steepest, 0.05);
}

TEST(SurveyRoute, WhatCannotBeFlownIsRefused) {
    const auto refused = [](auto change) {
        SurveyPattern p;
        p.start = {0.8, 0.1, 500.0};
        change(p);
        EXPECT_THROW((void)survey_route(p), Error);
    };
    refused([](SurveyPattern& p) { p.lines = 0; });
    refused([](SurveyPattern& p) { p.bank = 0.0; });
    refused([](SurveyPattern& p) { p.spacing = -1.0; });
    refused([](SurveyPattern& p) { p.speed = 0.0; });
}

}  // namespace
}  // namespace schuler::sim
