// One table, printed in every way.
#include "schuler/report/result_table.h"

#include "schuler/report/inner/json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace schuler::report {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// A column for people alone, one for files alone, and one of everything that a cell may hold.
ResultTable table() {
    return {
        "flight",
        {{"", "scheme"},
         {"scheme", ""},
         {"satellites", "satellites"},
         {"horizontal_m", "horizontal", "m"},
         {"share", "share", "", ".0f%"},
         {"usable", "usable"},
         {"note", "note"}},
        {{"b loose", "loose", 4, 1.23456789012, 0.125, true, "two\nlines, \"so\""}, {"c tight", "tight", 12, 2e-4, none, false}}};
}

TEST(ResultTable, IsAlignedForPeopleUnderHeadingsWithUnits) {
    ResultTable one = table();
    one.rows[0].back() = "µ <b>";
    EXPECT_EQ(table_text(one),
              "flight\n"
              "scheme                      satellites  horizontal, m      share  usable     note\n"
              "  b loose                            4          1.235       12 %  yes        µ <b>\n"
              "  c tight                           12      0.0002000          -  no         -\n");
}

TEST(ResultTable, IsAsWideAsItsCellsAndCountsCharactersNotBytes) {
    const ResultTable one{
        "", {{"", "period", "s", ".1f"}, {"", "what"}, {"", "error", "m"}}, {{10.0, "long enough", 1.0}, {20.25, "µµµ", -2.5}}};
    EXPECT_EQ(table_text(one),
              "  period, s  what          error, m\n"
              "       10.0  long enough      1.000\n"
              "       20.2  µµµ             -2.500\n");
}

TEST(ResultTable, HasKeysInCsvFieldsInQuotesAndNothingWhereThereIsNothing) {
    EXPECT_EQ(table_csv(table()),
              "scheme,satellites,horizontal_m,share,usable,note\n"
              "loose,4,1.23456789,0.125,1,\"two\nlines, \"\"so\"\"\"\n"
              "tight,12,0.0002,,0,\n");
    const ResultTable fixed{"", {{"x_m", "x", "m", "", ".3f"}, {"a,b", ""}}, {{2.0 / 3.0, -0.0}}};
    EXPECT_EQ(table_csv(fixed), "x_m,\"a,b\"\n0.667,-0\n");
}

TEST(ResultTable, HasNumbersInJsonThatComeBackAsTheyWere) {
    const double third = 1.0 / 3.0;
    ResultTable one = table();
    one.rows[0][3] = third;
    const Json rows = Json::parse(table_json(one).dump());
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[0]["horizontal_m"].get<double>(), third);
    EXPECT_TRUE(rows[0]["satellites"].is_number_integer());
    EXPECT_EQ(rows[0]["usable"], true);
    EXPECT_EQ(rows[0]["note"], "two\nlines, \"so\"");
    EXPECT_EQ(rows[0].size(), 6u);
    EXPECT_TRUE(rows[1]["share"].is_null());  // not finite
    EXPECT_TRUE(rows[1]["note"].is_null());   // not there
    EXPECT_EQ(rows[1].begin().key(), "scheme");
    Json nested;
    put_row(nested, std::vector<TableColumn>{{"time_s/median", ""}, {"time_s/q95", ""}, {"n", ""}}, {1.5, none, 3});
    EXPECT_EQ(nested.dump(), R"({"time_s":{"median":1.5,"q95":null},"n":3})");
}

TEST(ResultTable, HasTheSameCellsOnAPageWithItsTextsEscaped) {
    ResultTable one = table();
    one.rows[0].back() = "<b> & 'c'";
    const TableBlock block = table_block(one);
    EXPECT_EQ(block.columns, (std::vector<std::string>{"scheme", "satellites", "horizontal, m", "share", "usable", "note"}));
    EXPECT_EQ(block.rows[0], (std::vector<std::string>{"b loose", "4", "1.235", "12 %", "yes", "<b> & 'c'"}));
    const std::string page = render({.title = "t", .subtitle = "", .sections = {{"s", "", {{"", {}, {block}}}}}});
    EXPECT_NE(page.find("<td>&lt;b&gt; &amp; &#39;c&#39;</td>"), std::string::npos);
    EXPECT_NE(page.find("<th scope=\"col\" class=\"n\">share</th>"), std::string::npos);  // a missing number is one all the same
    EXPECT_NE(page.find("<th scope=\"col\">note</th>"), std::string::npos);
}

TEST(ResultTable, IsMadeOfItemsByItsColumns) {
    struct Item {
        double error;
        int runs;
    };
    static constexpr auto error_of = [](const Item& i) { return Cell(i.error); };
    const std::vector<ColumnOf<Item>> columns{{{"error_m", "error", "m"}, error_of},
                                              {{"runs", "runs"}, [](const Item& i) { return Cell(i.runs); }}};
    EXPECT_EQ(table_csv(table_of<Item>("", columns, {{0.5, 2}, {none, 0}})), "error_m,runs\n0.5,2\n,0\n");
}

}  // namespace
}  // namespace schuler::report
