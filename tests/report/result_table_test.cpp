// One table, printed in every way.
#include "schuler/report/result_table.h"

#include "schuler/report/inner/json.h"

#include <gtest/gtest.h>

#include <limits>

namespace schuler::report {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

ResultTable table() {
    return {
        "flight",
        {{"horizontal_m", "horiz., m"}, {"share", "share"}},
        {{.name = "b loose",
          .group = "4 satellites",
          .labels = {{"scheme", "loose"}, {"satellites", "4"}},
          .numbers = {1.23456789012, none}},
         {.name = "c tight", .group = "4 satellites", .labels = {{"scheme", "tight"}, {"satellites", "4"}}, .numbers = {2e-4}}}};
}

TEST(ResultTable, IsAlignedForPeopleUnderItsGroups) {
    EXPECT_EQ(table_text(table()),
              "flight                                  horiz., m        share\n4 satellites\n"
              "  b loose                                   1.235            -\n"
              "  c tight                                2.00e-04            -\n");
}

TEST(ResultTable, HasLabelsAndKeysInCsvAndNothingWhereThereIsNoNumber) {
    EXPECT_EQ(table_csv(table()), "scheme,satellites,horizontal_m,share\nloose,4,1.23456789,\ntight,4,0.0002,\n");
}

TEST(ResultTable, HasNamesAndTitlesOnAPage) {
    const TableBlock block = table_block(table());
    EXPECT_EQ(block.columns, (std::vector<std::string>{"scheme", "satellites", "horiz., m", "share"}));
    EXPECT_EQ(block.rows[0][0], "b loose");
    EXPECT_EQ(block.rows[1][2], "0.0002000");
    EXPECT_EQ(block.rows[1].size(), 4u);
}

TEST(ResultTable, HasKeysInJsonAndNullWhereThereIsNoNumber) {
    Json row;
    put_row(row, table().columns, table().rows[0].numbers);
    EXPECT_EQ(row.dump(), R"({"horizontal_m":1.23456789012,"share":null})");
}

}  // namespace
}  // namespace schuler::report
