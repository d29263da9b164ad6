// What a run's report shows of given results.
#include "schuler/report/run_report.h"
#include "page_reader.h"
#include "schuler/core/units.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace schuler;
using namespace schuler::report;

constexpr double start = 345600.0;

RunReportData drive() {
    RunReportData data;
    data.title = "drive";
    data.zero = Time::from_seconds(start);
    data.local = [](const Geodetic& p) { return Ned{{p.lat * 6.4e6, p.lon * 6.4e6, -p.h}}; };
    for (int i = 0; i <= 200; ++i) {
        SolutionRow row;
        row.time = Time::from_seconds(start + i);
        row.position = {1e-6 * i, 2e-6 * i, 100.0 + 0.1 * i};
        row.v_eb_n = {6.0, 8.0, -0.5};
        row.rpy = Eigen::Vector3d(1.0, -2.0, std::fmod(350.0 + i, 360.0)) * units::deg;
        row.std_position = {0.1, 0.2, 0.3};
        row.std_velocity = {0.01, 0.02, 0.03};
        row.std_rpy = Eigen::Vector3d(0.1, 0.2, 0.5) * units::deg;
        data.solution.push_back(row);
    }
    return data;
}

void add_reference(RunReportData& data) {
    data.reference_name = "truth";
    data.settled_after_s = 50.0;
    for (std::size_t i = 0; i < data.solution.size(); ++i) {
        const SolutionRow& row = data.solution[i];
        ReferenceSample sample;
        sample.time = row.time;
        sample.position = row.position;
        data.reference.push_back(sample);
        ErrorPoint p;
        p.time = row.time;
        // East stands out of three sigma (0.6 m) in one of the 151 counted epochs and in uncounted ones.
        p.position = {0.05, i < 10 || i == 120 ? 0.7 : 0.1, -0.2};
        p.std_position = row.std_position;
        p.rpy = Eigen::Vector3d(0.05, 0.05, -1.0) * units::deg;
        p.std_rpy = row.std_rpy;
        data.errors.push_back(p);
    }
}

const Section* section(const ReportInput& input, const std::string& title) {
    const auto it =
        std::find_if(input.sections.begin(), input.sections.end(), [&](const Section& s) { return s.title == title; });
    return it == input.sections.end() ? nullptr : &*it;
}

const Panel* panel(const ReportInput& input, const std::string& title) {
    for (const Section& s : input.sections) {
        for (const Group& g : s.groups) {
            for (const Panel& p : g.panels) {
                if (p.title == title) return &p;
            }
        }
    }
    return nullptr;
}

const Series* series(const Panel& p, const std::string& name) {
    const auto it = std::find_if(p.series.begin(), p.series.end(), [&](const Series& s) { return s.name == name; });
    return it == p.series.end() ? nullptr : &*it;
}

TEST(RunReport, NothingGivenIsAPageWithoutSections) {
    const ReportInput input = run_report({});
    EXPECT_TRUE(input.sections.empty());
    EXPECT_EQ(page_reader::read(render(input)).problem, "");
}

TEST(RunReport, WithoutReferenceTheUncertaintyIsShown) {
    const ReportInput input = run_report(drive());
    EXPECT_EQ(section(input, "Errors"), nullptr);
    ASSERT_NE(section(input, "Uncertainty"), nullptr);
    const Panel* attitude = panel(input, "Attitude, one sigma");
    ASSERT_NE(attitude, nullptr);
    EXPECT_NEAR(series(*attitude, "heading")->y[7], 0.5, 1e-12);
    const Panel* map = panel(input, "Track");
    ASSERT_NE(map, nullptr);
    EXPECT_TRUE(map->equal_axes);
    EXPECT_NEAR(series(*map, "solution")->x[100], 2e-4 * 6.4e6, 1e-6);  // x is east
    EXPECT_NEAR(series(*map, "solution")->y[100], 1e-4 * 6.4e6, 1e-6);
    EXPECT_EQ(series(*map, "solution")->time[100], 100.0);
    // sqrt(6^2 + 8^2 + 0.5^2) m/s for 200 s
    EXPECT_EQ(section(input, "Track")->groups[0].tables[0].rows[2][1], "2002.5");
    EXPECT_EQ(page_reader::read(render(input)).problem, "");
}

TEST(RunReport, ErrorsLieInTheirBandsInEastNorthUp) {
    RunReportData data = drive();
    add_reference(data);
    const ReportInput input = run_report(data);
    const Panel* east = panel(input, "East position error");
    const Panel* up = panel(input, "Up position error");
    const Panel* heading = panel(input, "Heading error");
    ASSERT_TRUE(east != nullptr && up != nullptr && heading != nullptr);
    EXPECT_EQ(series(*east, "error")->y[60], 0.1);
    EXPECT_NEAR(east->bands[0].hi[60], 0.6, 1e-12);
    EXPECT_NEAR(east->bands[0].lo[60], -0.6, 1e-12);
    EXPECT_EQ(series(*up, "error")->y[60], 0.2);  // down is -0.2
    EXPECT_NEAR(series(*heading, "error")->y[60], -1.0, 1e-12);
    ASSERT_EQ(east->spans.size(), 1U);  // the start-up, not hatched
    EXPECT_FALSE(east->spans[0].hatched);
    EXPECT_EQ(east->spans[0].stop, 50.0);
    EXPECT_EQ(panel(input, "East velocity error"), nullptr);  // none given
    const TableBlock& inside = section(input, "Errors")->groups.back().tables.back();
    ASSERT_EQ(inside.rows.size(), 6U);
    EXPECT_EQ(inside.rows[0], (std::vector<std::string>{"position", "east", "99.3"}));  // 150 of 151
    EXPECT_EQ(inside.rows[1][2], "100.0");
    EXPECT_EQ(inside.rows[5], (std::vector<std::string>{"attitude", "heading", "100.0"}));
}

TEST(RunReport, OutagesAreMarkedAndLargeErrorsInThemDoNotHideTheRest) {
    RunReportData data = drive();
    add_reference(data);
    data.outages = {{.start_s = 100.0,
                     .duration_s = 10.0,
                     .end_horizontal = 3.0,
                     .max_horizontal = 3.5,
                     .end_vertical = -1.0,
                     .max_3d = 4.0,
                     .compared = true,
                     .inside_3sigma = true,
                     .into_s = {0, 10},
                     .horizontal = {0, 3}},
                    {.start_s = 150.0,
                     .duration_s = 5.0,
                     .end_horizontal = 4.0,
                     .max_horizontal = 4.0,
                     .end_vertical = 1.0,
                     .max_3d = 4.2,
                     .compared = true,
                     .inside_3sigma = false,
                     .into_s = {0, 5},
                     .horizontal = {0, 4}}};
    for (ErrorPoint& p : data.errors) {
        const double t = (p.time - data.zero).seconds();
        if (t > 100.0 && t <= 110.0) p.position = {9.0, 9.0, 9.0};
    }
    const ReportInput input = run_report(data);
    const auto& rows = section(input, "Outages")->groups[0].tables[0].rows;
    EXPECT_EQ(rows[0], (std::vector<std::string>{"1", "100", "10", "3.00", "3.50", "-1.00", "4.00", "yes"}));
    EXPECT_EQ(rows[1].back(), "no");
    const auto card =
        std::find_if(input.cards.begin(), input.cards.end(), [](const Card& c) { return c.label.starts_with("Horizontal at"); });
    ASSERT_NE(card, input.cards.end());
    EXPECT_EQ(card->value, "3.54 m");  // sqrt((3^2 + 4^2) / 2)
    EXPECT_EQ(card->note, "1 of 2 inside 3σ throughout");
    const Panel* large = panel(input, "East position error, enlarged: scale without start-up and outages");
    ASSERT_NE(large, nullptr);
    EXPECT_NEAR(large->y_limits->second, 1.1 * 0.7, 1e-12);
    EXPECT_EQ(panel(input, "Heading error, enlarged: scale without start-up and outages"), nullptr);
    const Series* in_outages = series(*panel(input, "Track"), "solution in outages");
    EXPECT_TRUE(std::isnan(in_outages->y[99]));
    EXPECT_TRUE(std::isfinite(in_outages->y[105]));
    EXPECT_EQ(page_reader::with_class(page_reader::read(render(input)), "hatch").size() % 2, 0U);
}

TEST(RunReport, InnovationsShowGatesAndRejectedOnes) {
    RunReportData data = drive();
    InnovationGroup group{"GNSS position", "m", 1.0, {"north", "east", "down"}, {}, 0.25};
    for (int i = 0; i < 100; ++i) {
        InnovationPoint p;
        p.time = Time::from_seconds(start + i);
        p.dof = 2;
        p.innovation = {0.5, i == 40 ? 90.0 : -0.5, not_given};
        p.sigma = {1.0, 1.0, not_given};
        p.nis = i == 40 ? 8100.25 : i == 41 ? 6.0 : 0.5;
        p.status = i == 40 ? InnovationStatus::Rejected : i < 10 ? InnovationStatus::Withheld : InnovationStatus::Accepted;
        group.points.push_back(p);
    }
    data.innovations = {group};
    const ReportInput input = run_report(data);
    const Panel* east = panel(input, "GNSS position innovation, east");
    ASSERT_NE(east, nullptr);
    ASSERT_NE(series(*east, "rejected"), nullptr);
    EXPECT_EQ(series(*east, "rejected")->x, std::vector<double>{40.0});
    EXPECT_EQ(series(*east, "rejected")->mark, Mark::Squares);
    EXPECT_EQ(series(*east, "accepted")->x.size(), 89U);
    EXPECT_EQ(series(*east, "withheld")->x.size(), 10U);
    EXPECT_EQ(east->bands[0].hi[5], 3.0);
    EXPECT_FALSE(east->y_limits.has_value());
    const Panel* large = panel(input, "GNSS position innovation, east, enlarged: scale of the accepted ones");
    ASSERT_NE(large, nullptr);
    EXPECT_LT(large->y_limits->second, 5.0);  // not stretched by the outlier
    EXPECT_EQ(panel(input, "GNSS position innovation, north, enlarged: scale of the accepted ones"), nullptr);
    EXPECT_EQ(panel(input, "GNSS position innovation, down"), nullptr);  // never measured
    const Panel* nis = panel(input, "GNSS position, normalised innovation squared");
    ASSERT_NE(nis, nullptr);
    EXPECT_NEAR(nis->bands[0].lo[0], 0.0506, 1e-4);  // tables of chi-square, two degrees of freedom, 2.5 % and 97.5 %
    EXPECT_NEAR(nis->bands[0].hi[0], 7.3778, 1e-4);
    // 88 of 0.5 and one of 6.0, which is above the 95 % point 5.991: mean 50/89, and 1/89 above
    const auto& row = section(input, "Innovations")->groups[0].tables[0].rows[0];
    EXPECT_EQ(row, (std::vector<std::string>{"GNSS position", "89", "1", "10", "0.562", "2.00", "0.281", "1.12", "0.25"}));
    EXPECT_EQ(page_reader::read(render(input)).problem, "");
}

TEST(RunReport, LinesBreakWhereHeadingWrapsAndWhereDataAreMissing) {
    RunReportData data = drive();
    add_reference(data);
    data.reference.erase(data.reference.begin() + 60, data.reference.begin() + 100);
    const ReportInput input = run_report(data);
    const std::vector<double>& heading = panel(input, "Heading")->series[0].y;
    ASSERT_EQ(heading.size(), data.solution.size() + 1);
    EXPECT_TRUE(std::isnan(heading[10]));  // 359, gap, 0
    EXPECT_NEAR(heading[11], 0.0, 1e-9);
    const Series* reference = series(*panel(input, "Track"), "truth");
    ASSERT_EQ(reference->y.size(), data.reference.size() + 1);
    EXPECT_TRUE(std::isnan(reference->y[60]));
    EXPECT_TRUE(std::isnan(reference->time[60]));
    EXPECT_EQ(page_reader::read(render(input)).problem, "");
}

TEST(RunReport, SensorErrorsAreInTheUnitsOfTheField) {
    RunReportData data = drive();
    for (int i = 0; i < 50; ++i) {
        SensorErrorPoint p;
        p.time = Time::from_seconds(start + i);
        p.gyro_bias = Eigen::Vector3d(10.0, 0.0, 0.0) * units::deg_per_hour;
        p.std_gyro_bias = Eigen::Vector3d::Constant(2.0) * units::deg_per_hour;
        p.accel_bias = Eigen::Vector3d(0.0, 300.0, 0.0) * units::ug;
        p.std_accel_bias = Eigen::Vector3d::Constant(50.0) * units::ug;
        p.gyro_scale = p.std_gyro_scale = Eigen::Vector3d::Zero();  // not estimated
        data.sensor_errors.push_back(p);
    }
    const ReportInput input = run_report(data);
    const Panel* gyro = panel(input, "Gyro bias, x (forward)");
    ASSERT_NE(gyro, nullptr);
    EXPECT_NEAR(gyro->series[0].y[3], 10.0, 1e-9);
    EXPECT_NEAR(gyro->bands[0].lo[3], 4.0, 1e-9);
    EXPECT_NEAR(panel(input, "Accelerometer bias, y (right)")->series[0].y[3], 300.0, 1e-9);
    EXPECT_EQ(panel(input, "Gyro scale factor, x (forward)"), nullptr);
    EXPECT_EQ(gyro->x_limits, (std::pair<double, double>{0.0, 200.0}));  // the solution's time, as in every time panel
    EXPECT_EQ(section(input, "Sensor errors")->groups[0].tables[0].rows[0][2], "10.00");
}

}  // namespace
