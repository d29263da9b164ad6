// Windows of a comparison against closed forms, and the place that a wrong window is told at.
#include "schuler/study/comparison/compare_windows.h"

#include "schuler/settings/scenario/comparison.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/settings/toml_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace schuler::study {
namespace {

const settings::CompareWindow window{"jammed", 100.0, 200.0};
const settings::WindowRules rules;

/// A horizontal error once a second where it is known; the vertical one is twice as large.
ErrorCourse course(const std::function<double(double)>& horizontal, double end = 300.0) {
    ErrorCourse out;
    for (double t = 0.0; t <= end; t += 1.0) {
        const double e = horizontal(t);
        if (std::isnan(e)) continue;
        out.t.push_back(t);
        out.horizontal.push_back(e);
        out.vertical.push_back(2.0 * e);
    }
    return out;
}

WindowStatistics of(const std::function<double(double)>& horizontal, double end = 300.0) {
    const ErrorCourse errors = course(horizontal, end);
    return window_statistics(window, rules, errors, errors.t, course([](double) { return 0.0; }).t);
}

// Squares of 0, 1 ... n sum to n (n + 1) (2n + 1) / 6; both ends of the window belong to it.
TEST(CompareWindows, RampHasItsClosedForm) {
    const WindowStatistics s = of([](double t) { return t < 100.0 ? 1e3 : t > 200.0 ? 0.0 : t - 100.0; });
    EXPECT_NEAR(s.horizontal_rms, std::sqrt(100.0 * 201.0 / 6.0), 1e-12);
    EXPECT_EQ(s.horizontal_max, 100.0);
    EXPECT_EQ(s.vertical_max, 200.0);
    EXPECT_EQ(s.share, 1.0);
    EXPECT_EQ(s.recovery, 1.0);
}

TEST(CompareWindows, RecoveryIsWhereTheErrorIsAndStaysBelowTheLimit) {
    // exp decay from 1000 m at the end: below 20 m after tau ln 50 = 39.12 s, at the next epoch
    EXPECT_EQ(of([](double t) { return 1000.0 * std::exp(-(t - 200.0) / 10.0); }).recovery, 40.0);
    // good at the end and after it, whatever was before; the limit itself is not below it
    EXPECT_EQ(of([](double t) { return t < 199.5 ? 50.0 : 19.0; }).recovery, 0.0);
    EXPECT_TRUE(std::isnan(of([](double) { return 20.0; }).recovery));
    // a fall below the limit of 4 s is none, one of 5 s is
    EXPECT_EQ(of([](double t) { return t < 210.0 ? 30.0 : t <= 214.0 ? 1.0 : t < 230.0 ? 30.0 : 1.0; }).recovery, 30.0);
    EXPECT_EQ(of([](double t) { return t < 210.0 ? 30.0 : t <= 215.0 ? 1.0 : t < 230.0 ? 30.0 : 1.0; }).recovery, 10.0);
    // good at the end, but drifting out of the limit before the source is back
    EXPECT_EQ(of([](double t) { return t <= 202.0 ? 19.0 : t < 206.0 ? 21.0 : 1.0; }).recovery, 6.0);
    // the epoch of the end, with the last digits that a time in seconds has
    const std::vector<double> six(6, 1.0);
    const ErrorCourse rounded{{200.0 + 6e-14, 201.0, 202.0, 203.0, 204.0, 205.0}, six, six};
    EXPECT_EQ(window_statistics(window, rules, rounded, {}, {}).recovery, 0.0);
    // the flight ends too early to tell
    EXPECT_TRUE(std::isnan(of([](double) { return 1.0; }, 204.0).recovery));
    EXPECT_EQ(of([](double) { return 1.0; }, 205.0).recovery, 0.0);
}

TEST(CompareWindows, WithoutASolutionThereIsNeitherErrorNorRecovery) {
    // none after 120 s until 210 s: of the 101 instants 21 have one, and the last of those holds for one more
    const auto none = [](double t) { return t > 120.0 && t < 210.0 ? NAN : 3.0; };
    const WindowStatistics s = of(none);
    EXPECT_NEAR(s.share, 22.0 / 101.0, 1e-12);
    EXPECT_EQ(s.horizontal_rms, 3.0);
    EXPECT_EQ(s.recovery, 10.0);
    // a fix every third second holds for half of the time
    EXPECT_EQ(of([&](double t) { return t > 210.0 && t < 240.0 && std::fmod(t, 3.0) != 0.0 ? NAN : none(t); }).recovery, 40.0);
    const WindowStatistics never = of([](double t) { return t >= 100.0 ? NAN : 3.0; });
    EXPECT_NEAR(never.share, 1.0 / 101.0, 1e-12);  // that of 99 s is one second old at 100 s
    EXPECT_TRUE(std::isnan(never.horizontal_rms) && std::isnan(never.horizontal_max) && std::isnan(never.vertical_max));
    EXPECT_TRUE(std::isnan(never.recovery));
}

TEST(CompareWindows, ThinnedCourseKeepsPeaksAndGaps) {
    const auto peaked = [](double t) { return t == 54321.0 ? 1e4 : 1.0 + std::sin(t); };
    const ErrorCourse all = course([&](double t) { return t > 7e4 && t < 8e4 ? NAN : peaked(t); }, 1e5);
    const ErrorCourse few = drawn_course(all, 1.5, 600);
    EXPECT_LT(few.t.size(), 700u);
    EXPECT_EQ(*std::ranges::max_element(few.horizontal), 1e4);
    std::vector<double> gaps;
    for (std::size_t i = 0; i < few.t.size(); ++i)
        if (std::isnan(few.horizontal[i]) && std::isnan(few.vertical[i])) gaps.push_back(few.t[i]);
    EXPECT_EQ(gaps, std::vector<double>{70001.5});
}

TEST(CompareWindows, WrongOnesAreToldAtTheirLine) {
    const std::string head = "duration_s = 20\n[compare]\nschemes = [\"loose\"]\n";
    const std::string good = "[[compare.window]]\nname = \"a\"\nstart_s = 1\nend_s = 5\n";
    const auto parse = [](const std::string& text) {
        return settings::scenario_from(settings::scenario_table().read(settings::parse_toml(text, "s.toml"), "s.toml"));
    };
    const settings::ScenarioConfig s =
        parse(head + good + "[[compare.window]]\nname = \"b\"\nstart_s = 3\nend_s = 20\n");  // they may overlap
    ASSERT_EQ(s.windows.size(), 2u);
    EXPECT_EQ(s.windows[1].name, "b");
    EXPECT_EQ(s.windows[1].end, 20.0);
    const struct {
        std::string text;
        std::vector<const char*> parts;
    } cases[] = {
        {head + "[[compare.window]]\nname = \"a\"\nstart_s = 5\nend_s = 5\n",
         {"s.toml:7: compare.window[0].end_s: 5 s is not after", "write"}},
        {head + good + "[[compare.window]]\nname = \"b\"\nstart_s = 6\nend_s = 21\n",
         {"s.toml:11: compare.window[1].end_s", "duration_s = 20"}},
        {head + good + good, {"s.toml:9: compare.window[1].name", "\"a\" already"}},
        {head + "[[compare.window]]\nstart_s = 1\nend_s = 5\n", {"s.toml:4: compare.window[0]: a window lacks name"}},
        {head + "[[compare.window]]\nname = \"a\"\nend_s = 5\n", {"s.toml:4: compare.window[0]: a window lacks start_s"}},
        {head + "[[compare.window]]\nname = \"\"\nstart_s = 1\nend_s = 5\n", {"s.toml:5: compare.window[0].name"}},
        {head + "[[compare.window]]\nname = \"a,b\"\nstart_s = 1\nend_s = 5\n", {"without commas"}},
        {head + "[[compare.window]]\nname = 3\nstart_s = 1\nend_s = 5\n", {"3 is not a name"}},
        {head + "[[compare.window]]\nname = \"a\"\nstart_s = -1\nend_s = 5\n", {"s.toml:6: compare.window[0].start_s", "-1"}},
        {head + "[[compare.window]]\nname = \"a\"\nstart_s = nan\nend_s = 5\n", {"s.toml:6: compare.window[0].start_s"}},
        {head + good + "stop_s = 5\n", {"s.toml:8: compare.window[0].stop_s: a window has no \"stop_s\""}},
        {"duration_s = 20\n" + good, {"s.toml:2: compare.window[0]", "no schemes", "compare] schemes"}},
        {"reference_rate_hz = 0.5\n" + head + good, {"s.toml:5: compare.window[0]", "every 2 s", "reference_rate_hz"}},
        {head + "window = 3\n", {"s.toml:4: compare.window", "expected"}},
        {head + "limit_m = 0\n", {"s.toml:4: compare.limit_m", "out of range"}},
        {head + "solution_age_s = -1\n", {"s.toml:4: compare.solution_age_s", "out of range"}},
    };
    for (const auto& c : cases) {
        std::string message = "no error";
        try {
            (void)parse(c.text);
        } catch (const Error& e) {
            message = e.what();
        }
        for (const char* part : c.parts) EXPECT_NE(message.find(part), std::string::npos) << c.text << " -> " << message;
    }
}

}  // namespace
}  // namespace schuler::study
