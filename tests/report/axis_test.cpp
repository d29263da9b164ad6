// Ticks and ranges of the axes; numbers and text as printed.
#include "schuler/report/detail/axis.h"
#include "schuler/io/text/xml_text.h"
#include "schuler/report/detail/markup.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <set>

namespace {

using namespace schuler::report;
using detail::Range;
using detail::Tick;

RC_GTEST_PROP(ReportAxis, TicksAreRoundEvenlySpacedAndLabelledWithTheirValue, ()) {
    const double lo = *rc::gen::inRange(-100000, 100000) * 0.37;
    const double width = *rc::gen::inRange(1, 1000) * std::pow(10.0, *rc::gen::inRange(-6, 7));
    const int target = *rc::gen::inRange(2, 12);
    const Range range{lo, lo + width};
    RC_PRE(width > 1e-9 * std::abs(lo));
    const std::vector<Tick> ticks = detail::linear_ticks(range, target);
    RC_ASSERT(ticks.size() >= 1U);
    RC_ASSERT(ticks.size() <= static_cast<std::size_t>(1.75 * target) + 2);
    RC_ASSERT(ticks.size() + 2 > 0.6 * target);
    std::set<std::string> labels;
    for (const Tick& t : ticks) {
        RC_ASSERT(t.value >= range.lo - 1e-6 * width);
        RC_ASSERT(t.value <= range.hi + 1e-6 * width);
        RC_ASSERT(std::abs(std::stod(t.label) - t.value) <= 1e-3 * width);
        RC_ASSERT(labels.insert(t.label).second);
        RC_ASSERT(t.label != "-0");
    }
    if (ticks.size() < 2) return;
    const double step = ticks[1].value - ticks[0].value;
    const double lead = step / std::pow(10.0, std::floor(std::log10(step) + 1e-6));
    RC_ASSERT(std::abs(lead - 1.0) < 1e-3 || std::abs(lead - 2.0) < 1e-3 || std::abs(lead - 5.0) < 1e-3);
    for (std::size_t k = 2; k < ticks.size(); ++k) RC_ASSERT(std::abs(ticks[k].value - ticks[k - 1].value - step) < 1e-3 * step);
}

TEST(ReportAxis, KnownTicks) {
    const auto labels = [](const std::vector<Tick>& ticks) {
        std::string text;
        for (const Tick& t : ticks) text += t.label + " ";
        return text;
    };
    EXPECT_EQ(labels(detail::linear_ticks({-0.23, 0.23}, 4)), "-0.2 -0.1 0.0 0.1 0.2 ");
    EXPECT_EQ(labels(detail::linear_ticks({0, 1800}, 10)), "0 200 400 600 800 1000 1200 1400 1600 1800 ");
    EXPECT_EQ(labels(detail::linear_ticks({1.3e9, 1.3e9 + 10}, 2)), "1300000000 1300000005 1300000010 ");
    EXPECT_EQ(labels(detail::ticks_every({0, 360}, 90, 0)), "0 90 180 270 360 ");
    EXPECT_EQ(labels(detail::log_ticks({-2.0, 1.0})), "0.01 0.1 1 10 ");
    EXPECT_EQ(labels(detail::log_ticks({-0.1, 1.1})), "1 2 5 10 ");
    EXPECT_TRUE(detail::linear_ticks({}, 5).empty());
}

TEST(ReportAxis, RangeHoldsTheDataAndNotTheUncertaintyOfTheStart) {
    Panel panel{.title = "", .x_label = "", .y_label = ""};
    Band band{.name = "", .x = {}, .lo = {}, .hi = {}};
    Series line{.name = "", .x = {}, .y = {}};
    for (int i = 0; i < 100; ++i) {
        band.x.push_back(i);
        band.hi.push_back(i < 5 ? 1e6 : 3.0);
        band.lo.push_back(-band.hi.back());
        line.x.push_back(i);
        line.y.push_back(i == 2 ? -8.0 : i == 50 ? std::nan("") : 0.1);
    }
    panel.series = {line};
    panel.bands = {band};
    const detail::DataRange range = detail::data_range(panel);
    EXPECT_EQ(range.x.lo, 0.0);
    EXPECT_EQ(range.x.hi, 99.0);
    EXPECT_NEAR(range.y.lo, -8.0 - 0.05 * 11.0, 1e-12);
    EXPECT_NEAR(range.y.hi, 3.0 + 0.05 * 11.0, 1e-12);
    panel.y_limits = {-1.0, 2.0};
    EXPECT_EQ(detail::data_range(panel).y.hi, 2.0);
    panel.series = {};
    panel.bands = {};
    EXPECT_TRUE(detail::data_range(panel).x.empty());
}

TEST(ReportText, Numbers) {
    EXPECT_EQ(number(9.9996), "10.00");
    EXPECT_EQ(number(0.00123456, 3), "0.00123");
    EXPECT_EQ(number(-1234567.0, 3), "-1234567");
    EXPECT_EQ(number(1.5e-7, 2), "1.5e-07");
    EXPECT_EQ(number(-0.0), "0");
    EXPECT_EQ(number(std::nan("")), "–");
    EXPECT_EQ(number(INFINITY), "–");
}

TEST(ReportText, EscapesMarkupAndReplacesWhatIsNotText) {
    const std::string bad = "\xef\xbf\xbd";
    EXPECT_EQ(schuler::io::xml_text("<a href=\"x\">'&'</a>"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
    EXPECT_EQ(schuler::io::xml_text("±3σ µg 𝛘\t\r\n"), "±3σ µg 𝛘\t\n");
    EXPECT_EQ(schuler::io::xml_text(std::string("a\0b\x1b\x7f", 5)), "a" + bad + "b" + bad + bad);
    EXPECT_EQ(schuler::io::xml_text("\xff\xc3"), bad + bad);                      // no lead byte; cut off at the end
    EXPECT_EQ(schuler::io::xml_text("\xc0\xbc"), bad + bad);                      // '<' in an overlong form
    EXPECT_EQ(schuler::io::xml_text("\xed\xa0\x80"), bad + bad + bad);            // a surrogate
    EXPECT_EQ(schuler::io::xml_text("\xf4\x90\x80\x80"), bad + bad + bad + bad);  // beyond Unicode
}

}  // namespace
