// The page as bytes: well-formed, self-contained, escaped, complete for odd input, and its curves where the numbers are.
#include "page_reader.h"
#include "schuler/core/error.h"
#include "schuler/report/report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

namespace {

using namespace schuler::report;
using page_reader::attribute;
using page_reader::Element;
using page_reader::Page;

Panel wave(std::size_t n) {
    Panel panel{.title = "Wave", .x_label = "time, s", .y_label = "height, m"};
    Series line{.name = "line", .x = {}, .y = {}};
    Band band{.name = "band", .x = {}, .lo = {}, .hi = {}};
    for (std::size_t i = 0; i < n; ++i) {
        const double t = 0.1 * static_cast<double>(i);
        line.x.push_back(t);
        line.y.push_back(std::sin(t));
        band.lo.push_back(-1.5);
        band.hi.push_back(1.5 + 0.1 * std::cos(t));
    }
    band.x = line.x;
    panel.series = {line};
    panel.bands = {band};
    panel.spans = {{1.0, 3.0, "outage 1", true}};
    return panel;
}

std::string page_with(const Panel& panel) {
    ReportInput input{.title = "t", .subtitle = "", .sections = {{"One", "", {{"", {panel}, {}}}}}};
    return render(input);
}

// Curve i of a page's first panel back in the units of the data, from the path and the panel's data attributes.
std::vector<std::vector<std::pair<double, double>>> curve(const std::string& html, const std::string& name) {
    const Page page = page_reader::read(html);
    EXPECT_EQ(page.problem, "");
    std::vector<std::vector<std::pair<double, double>>> runs;
    double x0 = 0, x1 = 0, y0 = 0, y1 = 0, left = 0, top = 0, width = 1, height = 1;
    for (const Element& e : page.elements) {
        if (!attribute(e, "data-box").empty()) {
            std::istringstream(attribute(e, "data-x")) >> x0 >> x1;
            std::istringstream(attribute(e, "data-y")) >> y0 >> y1;
            std::istringstream(attribute(e, "data-box")) >> left >> top >> width >> height;
        }
        if (attribute(e, "data-n") == name && runs.empty()) runs = page_reader::path_runs(attribute(e, "d"));
    }
    for (auto& run : runs) {
        for (auto& [x, y] : run) {
            x = x0 + x / 100.0 / width * (x1 - x0);
            y = y1 - y / 100.0 / height * (y1 - y0);
        }
    }
    return runs;
}

TEST(ReportPage, TheReaderOfThisTestSeesBrokenPages) {
    EXPECT_EQ(page_reader::read("<a><b x=\"1\"/>&amp;</a>").problem, "");
    for (const char* broken :
         {"<a><b></a></b>", "<a>", "<a></a></a>", "<a>&</a>", "<a x=1></a>", "<a x=\"1\" x=\"2\"></a>", "<a/>text"}) {
        EXPECT_NE(page_reader::read(broken).problem, "") << broken;
    }
}

TEST(ReportPage, IsWellFormedSelfContainedAndNavigable) {
    ReportInput input{.title = "Run",
                      .subtitle = "of today",
                      .cards = {{"Errors", "3 m", "note"}},
                      .warnings = {"w1", "w2"},
                      .settings = "a = 1\n",
                      .version = "1.2.3"};
    for (const char* title : {"Same", "Same", "Größe & <more>"}) {
        input.sections.push_back(
            {title, "Intro.", {{"Group", {wave(5000), wave(3)}, {{"Table", {"a", "b"}, {{"x", "1.5"}, {"y"}}}}}}});
    }
    const std::string html = render(input);
    const Page page = page_reader::read(html);
    EXPECT_EQ(page.problem, "");
    std::set<std::string> ids, links;
    for (const Element& e : page.elements) {
        const std::string id = attribute(e, "id");
        EXPECT_TRUE(id.empty() || ids.insert(id).second) << id;
        if (e.tag == "a") links.insert(attribute(e, "href").substr(1));
        for (const char* loading : {"src", "srcset", "background", "xlink:href", "action"})
            EXPECT_EQ(e.attributes.count(loading), 0U);
        EXPECT_NE(e.tag, "link");
    }
    EXPECT_EQ(links.size(), 5U);
    for (const std::string& link : links) EXPECT_EQ(ids.count(link), 1U) << link;
    for (const Element& e : page.elements) {  // every plot has its title and description
        std::istringstream labels(attribute(e, "aria-labelledby"));
        for (std::string id; labels >> id;) EXPECT_EQ(ids.count(id), 1U) << id;
    }
    EXPECT_EQ(page_reader::with_class(page, "panel").size(), 6U);
    // The only address is a namespace, which nothing fetches.
    std::size_t addresses = 0;
    for (std::size_t i = html.find("://"); i != std::string::npos; i = html.find("://", i + 1)) ++addresses;
    EXPECT_EQ(addresses, 1U);
    EXPECT_NE(html.find("'http://www.w3.org/2000/svg'"), std::string::npos);
    EXPECT_EQ(html.find("@import"), std::string::npos);
}

TEST(ReportPage, TextFromOutsideStaysText) {
    const std::string evil = "\"><script>alert(1)</script>&'<!--]]>";
    Panel panel = wave(10);
    panel.title = panel.x_label = panel.y_label = panel.series[0].name = panel.bands[0].name = panel.spans[0].label = evil;
    ReportInput input{.title = evil,
                      .subtitle = evil,
                      .cards = {{evil, evil, evil}},
                      .sections = {{evil, evil, {{evil, {panel}, {{evil, {evil, evil}, {{evil, evil}}}}}}}},
                      .warnings = {evil},
                      .settings = evil,
                      .version = evil};
    const std::string html = render(input);
    const Page page = page_reader::read(html);
    EXPECT_EQ(page.problem, "");
    EXPECT_EQ(std::count_if(page.elements.begin(), page.elements.end(), [](const Element& e) { return e.tag == "script"; }), 1);
    EXPECT_EQ(html.find("<script>alert"), std::string::npos);
    EXPECT_EQ(html.find("<!--"), std::string::npos);
}

TEST(ReportPage, SameInputSameBytes) {
    ReportInput input{.title = "t", .subtitle = "", .sections = {{"One", "", {{"", {wave(9000), wave(100)}, {}}}}}};
    const ReportInput copy = input;
    EXPECT_EQ(render(input), render(copy));
}

TEST(ReportPage, EmptyInputsGivePagesThatSaySo) {
    EXPECT_EQ(page_reader::read(render({})).problem, "");
    Panel empty{.title = "Nothing", .x_label = "time, s", .y_label = "m"};
    Panel nothing_finite = empty;
    nothing_finite.series = {{.name = "n", .x = {1, 2}, .y = {std::nan(""), INFINITY}}, {.name = "e", .x = {}, .y = {}}};
    nothing_finite.bands = {{.name = "b", .x = {}, .lo = {}, .hi = {}}};
    for (const Panel& panel : {empty, nothing_finite}) {
        const std::string html = page_with(panel);
        EXPECT_EQ(page_reader::read(html).problem, "");
        EXPECT_NE(html.find(">no data<"), std::string::npos);
        EXPECT_EQ(html.find("nan"), std::string::npos);
    }
}

TEST(ReportPage, OddNumbersDoNotSpoilThePage) {
    for (const auto& y : {std::vector<double>{5, 5, 5}, {0, 0, 0}, {1e300, -1e300, 1}, {1e-300, 2e-300, 3e-300}, {7, NAN, NAN}}) {
        for (const bool map : {false, true}) {
            for (const bool log : {false, true}) {
                Panel panel{.title = "Odd", .x_label = "x", .y_label = "y", .time_axis = !map, .equal_axes = map, .log_y = log};
                panel.series = {{.name = "s", .x = {3, 3, 3}, .y = y, .time = {1, 2, 3}}};
                panel.spans = {{NAN, 2, "no"}, {-1e300, 1e300, "all"}};
                const std::string html = page_with(panel);
                EXPECT_EQ(page_reader::read(html).problem, "");
                EXPECT_EQ(html.find("nan"), std::string::npos);
                EXPECT_EQ(html.find("inf "), std::string::npos);
            }
        }
    }
}

TEST(ReportPage, DifferentLengthsAreRefused) {
    Panel panel = wave(10);
    panel.series[0].y.pop_back();
    EXPECT_THROW((void)page_with(panel), schuler::Error);
    panel = wave(10);
    panel.bands[0].hi.pop_back();
    EXPECT_THROW((void)page_with(panel), schuler::Error);
    panel = wave(10);
    panel.series[0].time = {1.0};
    EXPECT_THROW((void)page_with(panel), schuler::Error);
}

TEST(ReportCurve, LiesWhereTheNumbersAre) {
    const Panel panel = wave(1000);  // not decimated
    const auto runs = curve(page_with(panel), "line");
    ASSERT_EQ(runs.size(), 1U);
    ASSERT_EQ(runs[0].size(), 1000U);
    for (std::size_t i = 0; i < 1000; ++i) {  // to 0.01 px of about 1000 and 140
        EXPECT_NEAR(runs[0][i].first, panel.series[0].x[i], 99.9 / 1000 * 0.01);
        EXPECT_NEAR(runs[0][i].second, panel.series[0].y[i], 3.5 / 140 * 0.01);
    }
    const auto band = curve(page_with(panel), "band");
    ASSERT_EQ(band.size(), 1U);
    ASSERT_EQ(band[0].size(), 2000U);  // along hi, back along lo
    EXPECT_NEAR(band[0].front().second, 1.6, 3e-4);
    EXPECT_NEAR(band[0].back().second, -1.5, 3e-4);
    EXPECT_NEAR(band[0].back().first, 0.0, 2e-3);
    EXPECT_NEAR(band[0][1000].first, 99.9, 2e-3);
}

TEST(ReportCurve, GapsSplitTheLineAndALonePointIsADot) {
    Panel panel{.title = "Gaps", .x_label = "x", .y_label = "y"};
    panel.series = {{.name = "line", .x = {0, 1, 2, 3, 4, 5, 6}, .y = {1, 2, NAN, 3, INFINITY, 4, 5}}};
    panel.bands = {{.name = "band", .x = {0, 1, 2, 3}, .lo = {0, 0, NAN, 0}, .hi = {1, 1, 1, 1}}};
    const std::string html = page_with(panel);
    const auto runs = curve(html, "line");
    ASSERT_EQ(runs.size(), 3U);
    EXPECT_EQ(runs[0].size(), 2U);
    EXPECT_EQ(runs[1].size(), 1U);
    EXPECT_EQ(runs[2].size(), 2U);
    EXPECT_NEAR(runs[1][0].second, 3.0, 1e-3);
    EXPECT_EQ(curve(html, "band").size(), 2U);
    // A gap inside a decimated stretch stays a gap.
    Panel large = wave(50000);
    for (std::size_t i = 20000; i < 20100; ++i) large.series[0].y[i] = NAN;
    EXPECT_EQ(curve(page_with(large), "line").size(), 2U);
}

TEST(ReportCurve, LongSeriesBecomeShortFilesWithTheirExtremes) {
    Panel panel = wave(720000);  // an hour at 200 Hz
    panel.series[0].y[123457] = 40.0;
    const std::string html = page_with(panel);
    EXPECT_LT(html.size(), 130000U);
    const auto runs = curve(html, "line");
    ASSERT_EQ(runs.size(), 1U);
    double highest = 0.0;
    for (const auto& [x, y] : runs[0]) highest = std::max(highest, y);
    EXPECT_NEAR(highest, 40.0, 0.01);
}

TEST(ReportCurve, MapsHaveEqualAxesAndLogAxesPositiveValues) {
    for (const auto& [w, h] : {std::pair{1000.0, 10.0}, {10.0, 1000.0}, {500.0, 400.0}}) {
        Panel map{.title = "Map", .x_label = "east, m", .y_label = "north, m", .time_axis = false, .equal_axes = true};
        map.series = {{.name = "track", .x = {0, w, w}, .y = {0, 0, h}, .time = {0, 1, 2.5}}};
        const std::string html = page_with(map);
        double x0 = 0, x1 = 0, y0 = 0, y1 = 0, left = 0, top = 0, width = 0, height = 0;
        for (const Element& e : page_reader::read(html).elements) {
            if (attribute(e, "data-box").empty()) continue;
            std::istringstream(attribute(e, "data-x")) >> x0 >> x1;
            std::istringstream(attribute(e, "data-y")) >> y0 >> y1;
            std::istringstream(attribute(e, "data-box")) >> left >> top >> width >> height;
        }
        EXPECT_NEAR((x1 - x0) / width, (y1 - y0) / height, 1e-4 * (x1 - x0) / width);
        EXPECT_LE(x0, 0.0);
        EXPECT_GE(x1, w);
        EXPECT_LE(y0, 0.0);
        EXPECT_GE(y1, h);
        EXPECT_NE(html.find("data-t=\"0.000 1000 1500\""), std::string::npos);
        EXPECT_NE(html.find("class=\"scale\""), std::string::npos);
    }
    Panel log{.title = "Log", .x_label = "x", .y_label = "y", .log_y = true};
    log.series = {{.name = "s", .x = {0, 1, 2, 3}, .y = {0.01, 0.0, -1.0, 100.0}}};
    const auto runs = curve(page_with(log), "s");
    ASSERT_EQ(runs.size(), 2U);
    EXPECT_NEAR(runs[0][0].second, -2.0, 1e-3);
    EXPECT_NEAR(runs[1][0].second, 2.0, 1e-3);
}

TEST(ReportCurve, ClampedValuesAreDrawnInsideTheEdge) {
    Panel panel{.title = "Clamp", .x_label = "x", .y_label = "y", .y_limits = std::pair{-1.0, 1.0}};
    panel.series = {{.name = "s", .x = {0, 1, 2}, .y = {50, 0.5, -50}, .mark = Mark::Dots, .clamp = true}};
    const auto runs = curve(page_with(panel), "s");
    ASSERT_EQ(runs.size(), 3U);
    EXPECT_NEAR(runs[0][0].second, 1.0, 0.08);
    EXPECT_LT(runs[0][0].second, 1.0);
    EXPECT_NEAR(runs[1][0].second, 0.5, 1e-3);
    EXPECT_GT(runs[2][0].second, -1.0);
}

}  // namespace
