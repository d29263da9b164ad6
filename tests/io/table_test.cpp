#include "schuler/io/text/table.h"
#include "schuler/io/text/number.h"
#include "schuler/io/text/split.h"

#include "io/io_fixture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

namespace schuler::io {
namespace {

using test::expect_parts;
using test::message_of;

std::int64_t ns_of(const std::string& text, TimeUnit unit = TimeUnit::Seconds) {
    std::int64_t ns = -1;
    EXPECT_TRUE(nanoseconds_from(text, unit, ns)) << text;
    return ns;
}

TEST(Number, IsTheNearestDouble) {
    // The C library is the oracle; the list has each path: fast, more than 2^53, long exponents, subnormal, leading zeros.
    for (const char* text :
         {"0", "-0.0", "1.5", "+2.25", ".5", "5.", "1e3", "1.234567890123456e-05", "9.876543210123456e-23", "9007199254740993",
          "0.000000000000000000000000000123456789", "123456789012345678901234567890", "4.9e-324", "1.7976931348623157e308",
          "40.1234567", "-105.7654321", "8.41e21", "9007199254740991e22", "3.14159265358979323846264338327950288"}) {
        EXPECT_EQ(number_from(text), std::strtod(text, nullptr)) << text;
        EXPECT_EQ(std::signbit(number_from(text)), std::signbit(std::strtod(text, nullptr))) << text;
    }
    for (const char* text :
         {"", " ", "nan", "inf", "1e999", "1.2.3", "12:30", "1,5", "0x10", "abc", "-", "+", ".", "e5", "1e", "1 2"}) {
        EXPECT_TRUE(std::isnan(number_from(text))) << text;
    }
}

TEST(Number, RandomNumbersAgreeWithTheCLibrary) {
    std::mt19937_64 rng(1);
    std::uniform_real_distribution<double> power(-30.0, 25.0);
    std::normal_distribution<double> unit;
    for (int i = 0; i < 200000; ++i) {
        const double magnitude = std::pow(10.0, power(rng)), value = magnitude * unit(rng);
        char text[128];
        std::snprintf(text, sizeof text, i % 3 == 0 ? "%.15e" : i % 3 == 1 ? "%.9f" : "%.18g", value);
        ASSERT_EQ(number_from(text), std::strtod(text, nullptr)) << text;
    }
}

TEST(Split, KeepsEmptyParts) {
    EXPECT_EQ(split("", ','), std::vector<std::string>{""});
    EXPECT_EQ(split("a,,b,", ','), (std::vector<std::string>{"a", "", "b", ""}));
    EXPECT_EQ(split<std::string_view>("G07:45", ':'), (std::vector<std::string_view>{"G07", "45"}));
}

TEST(TimeParsing, IsExact) {
    EXPECT_EQ(ns_of("243258.499"), 243258499000000);
    EXPECT_EQ(ns_of("1751990400.123456789"), 1751990400123456789);  // a double has 240 ns here
    EXPECT_EQ(ns_of("1.751990400123456789e9"), 1751990400123456789);
    EXPECT_EQ(ns_of("2.432584990000000000e+05"), 243258499000000);  // numpy's savetxt
    EXPECT_EQ(ns_of("-0.0000000005"), -1);                          // halves away from zero
    EXPECT_EQ(ns_of("0.0000000004999999999999999999999"), 0);
    EXPECT_EQ(ns_of("0.00000000050000000000000000000"), 1);
    EXPECT_EQ(ns_of("1234.5", TimeUnit::Milliseconds), 1234500000);
    EXPECT_EQ(ns_of("1234.0625", TimeUnit::Microseconds), 1234063);
    EXPECT_EQ(ns_of("200632654226542", TimeUnit::Nanoseconds), 200632654226542);
    EXPECT_EQ(ns_of("1e-40"), 0);
    std::int64_t ns = 0;
    EXPECT_FALSE(nanoseconds_from("5e9", TimeUnit::Seconds, ns));  // 158 years do not fit
    EXPECT_FALSE(nanoseconds_from("1e300", TimeUnit::Nanoseconds, ns));
    EXPECT_FALSE(nanoseconds_from("12:30", TimeUnit::Seconds, ns));
}

TEST(TimeParsing, WhatIsPrintedIsRead) {
    std::mt19937_64 rng(2);
    for (int i = 0; i < 100000; ++i) {
        const auto ns = static_cast<std::int64_t>(rng() >> (3 + i % 60)) * (i % 2 == 0 ? 1 : -1);
        const auto magnitude = static_cast<unsigned long long>(ns < 0 ? -ns : ns);
        char text[64];
        std::snprintf(text, sizeof text, "%s%llu.%09llu", ns < 0 ? "-" : "", magnitude / 1000000000U, magnitude % 1000000000U);
        ASSERT_EQ(ns_of(text), ns) << text;
    }
}

class Table : public test::IoTest {
protected:
    /// All rows of the first columns as numbers, the first being time in ns.
    static std::vector<std::vector<double>> rows(const TextInput& input, int columns) {
        const TableLayout layout = inspect_table(input);
        std::vector<FieldRequest> fields;
        for (int i = 0; i < columns; ++i) {
            FieldRequest f;
            f.column = i;
            f.required = false;
            f.name = "c" + std::to_string(i);
            fields.push_back(f);
        }
        TableReader reader(input, layout, fields);
        std::vector<std::vector<double>> result;
        while (reader.next()) {
            result.emplace_back();
            for (int i = 0; i < columns; ++i) result.back().push_back(reader.number(static_cast<std::size_t>(i)));
        }
        return result;
    }
};

struct Writing {
    const char* name;
    const char* text;
    char delimiter;
    std::size_t names;
};

class TableWritings : public Table, public testing::WithParamInterface<Writing> {};

TEST_P(TableWritings, SameNumbers) {
    const auto path = write("t.csv", GetParam().text);
    const TableLayout layout = inspect_table(path);
    EXPECT_EQ(layout.delimiter, GetParam().delimiter);
    EXPECT_EQ(layout.names.size(), GetParam().names);
    if (!layout.names.empty()) {
        EXPECT_EQ(layout.names[0], "time");
    }
    EXPECT_EQ(layout.data_columns >= 3, true);
    const auto got = rows(path, 3);
    EXPECT_EQ(got, (std::vector<std::vector<double>>{{1.5, -2.25, 3000.0}, {2.5, 4.0, -5.0}, {3.5, 6.0, 7.0}}));
}

INSTANTIATE_TEST_SUITE_P(
    All, TableWritings,
    testing::Values(Writing{"comma", "time,a,b\n1.5,-2.25,3e3\n2.5,4,-5\n3.5,6,7\n", ',', 3},
                    Writing{"spaces", "time, a, b\n1.5, -2.25, 3e3\n2.5, 4 , -5\n 3.5, 6, 7 \n", ',', 3},
                    Writing{"crlf_bom", "\xef\xbb\xbftime,a,b\r\n1.5,-2.25,3e3\r\n2.5,4,-5\r\n3.5,6,7\r\n", ',', 3},
                    Writing{"cr_only", "time,a,b\r1.5,-2.25,3e3\r2.5,4,-5\r3.5,6,7\r", ',', 3},
                    Writing{"semicolon", "time;a;b\n1.5;-2.25;3e3\n2.5;4;-5\n3.5;6;7\n", ';', 3},
                    Writing{"decimal_comma", "time;a;b\n1,5;-2,25;3e3\n2,5;4;-5\n3,5;6;7\n", ';', 3},
                    Writing{"tab", "time\ta\tb\n1.5\t-2.25\t3e3\n2.5\t4\t-5\n3.5\t6\t7\n", '\t', 3},
                    Writing{"blanks", "  time   a  b\n  1.5  -2.25   3e3\n  2.5  4  -5\n3.5\t6 7  \n", ' ', 3},
                    Writing{"no_header", "1.5 -2.25 3e3\n2.5 4 -5\n3.5 6 7\n", ' ', 0},
                    Writing{"comments", "# made by hand\n\n%\ntime,a,b\n1.5,-2.25,3e3\n# pause\n\n2.5,4,-5\n3.5,6,7\n", ',', 3},
                    Writing{"header_comment", "# time a b\n1.5 -2.25 3e3\n2.5 4 -5\n3.5 6 7\n", ' ', 3},
                    Writing{"quotes", "\"time\",\"a\",\"b\"\n\"1.5\",\"-2.25\",\"3e3\"\n2.5,4,-5\n3.5,6,7\n", ',', 3},
                    Writing{"trailing", "time,a,b,\n1.5,-2.25,3e3,\n2.5,4,-5,\n3.5,6,7,\n", ',', 3},
                    Writing{"units_row", "time,a,b\ns,m/s,deg\n1.5,-2.25,3e3\n2.5,4,-5\n3.5,6,7\n", ',', 3},
                    Writing{"no_last_newline", "time,a,b\n1.5,-2.25,3e3\n2.5,4,-5\n3.5,6,7", ',', 3},
                    Writing{"extra_columns", "time,a,b,note\n1.5,-2.25,3e3,x y\n2.5,4,-5,\"p,q\"\n3.5,6,7,z\n", ',', 4}),
    [](const testing::TestParamInfo<Writing>& writing) { return std::string(writing.param.name); });

TEST_F(Table, BlocksDoNotChangeTheRows) {
    // Lines longer than a block, and line ends at every place of a block.
    std::string text = "a,b\n";
    std::vector<std::string> lines;
    for (int i = 0; i < 300; ++i)
        lines.push_back(std::to_string(i) + "," + std::string(static_cast<std::size_t>(i % 97), '0') + "7.5");
    for (const auto& line : lines) text += line + "\n";
    for (const std::size_t block : {16, 33, 64, 100, 4096}) {
        LineBlocks blocks(TextInput::memory(text, "t"), block);
        std::string joined;
        long line = 1;
        while (blocks.next()) {
            EXPECT_EQ(blocks.first_line(), line);
            EXPECT_EQ(blocks.end()[-1], '\n');
            joined.append(blocks.begin(), blocks.end());
            line += std::count(blocks.begin(), blocks.end(), '\n');
        }
        EXPECT_EQ(joined, text);
    }
}

TEST_F(Table, ReadsGz) {
    std::string text = "time,a\n";
    for (int i = 0; i < 100000; ++i) text += std::to_string(i) + "," + std::to_string(2 * i) + "\n";
    const auto path = write_gz("t.csv.gz", text);
    const auto got = rows(path, 2);
    ASSERT_EQ(got.size(), 100000U);
    EXPECT_EQ(got.back(), (std::vector<double>{99999.0, 199998.0}));
    const std::string whole = content_of(path);
    const auto cut = write("cut.csv.gz", whole.substr(0, whole.size() / 2));
    expect_parts(message_of([&] { (void)rows(cut, 2); }), {"cut.csv.gz", "damaged or cut", "copy"});
}

TEST_F(Table, UnusableFilesAreNamed) {
    expect_parts(message_of([&] { (void)inspect_table(folder() / "none.csv"); }), {"none.csv", "no such file", "check the path"});
    expect_parts(message_of([&] { (void)inspect_table(folder()); }),
                 {folder().string(), "is a directory", "name the file inside"});
    expect_parts(message_of([&] { (void)inspect_table(write("e.csv", "")); }), {"e.csv", "is empty", "check that"});
    expect_parts(message_of([&] { (void)inspect_table(write("c.csv", "# only\n\n")); }), {"c.csv", "no data", "right file"});
    expect_parts(message_of([&] {
                     (void)inspect_table(write("b.bin", std::string("\x7f"
                                                                    "ELF\0\1\2",
                                                                    7)));
                 }),
                 {"b.bin:1", "binary"});
    const auto zeros = write("z.csv", "time,a\n1,2\n2,3\n" + std::string(4096, '\0'));
    expect_parts(message_of([&] { (void)rows(zeros, 2); }), {"z.csv:4", "zero bytes", "delete line 4"});
}

TEST_F(Table, CutLastLine) {
    const std::string head = "time,a,b\n1.500,2.000,3.000\n2.500,4.000,5.000\n";
    expect_parts(message_of([&] { (void)rows(write("cut.csv", head + "3.500,6.0"), 3); }),
                 {"cut.csv:4", "column 2", "2 of 3 columns", "delete line 4"});
    EXPECT_EQ(rows(write("whole.csv", head + "3.500,6.000,7.000"), 3).size(), 3U);
    EXPECT_EQ(rows(write("short.csv", head + "3.500,6.000,7.0"), 3).size(), 2U);  // the last number may be cut: left out
    EXPECT_EQ(rows(write("ended.csv", head + "3.500,6.0\n"), 3).size(), 3U);      // ended: a short row, not a cut file
    // rows that end with a blank, and numbers with an exponent
    const std::string blanks = "1.500 2.000 0.037 \n2.500 4.000 0.039 \n",
                      powers = "1,2.5e+00,-4.903325e-02\n2,2.5e+00,1.25e-01\n";
    EXPECT_EQ(rows(write("blanks.txt", blanks + "3.500 6.000 0.039"), 3).size(), 3U);
    EXPECT_EQ(rows(write("blanks.txt", blanks + "3.500 6.000 0.0"), 3).size(), 2U);
    EXPECT_EQ(rows(write("powers.csv", powers + "3,2.5e+00,-4.9e-02"), 3).size(), 3U);
    for (const char* cut : {"-4.903325e-0", "-4.903325e-", "-4.903325e", "-4.903325"})
        EXPECT_EQ(rows(write("powers.csv", powers + "3,2.5e+00," + cut), 3).size(), 2U) << cut;
}

TEST_F(Table, CommentsBetweenTheRowsAreNoRows) {
    const std::string text =
        "time,a\n// of the lab\n1,2\n# at the lights\n2,3\n\"# quoted, by a spreadsheet\"\n3,4\n % blank\n4,5\n// end";
    EXPECT_EQ(inspect_table(TextInput::memory(text, "a.csv")).comments.size(), 4U);
    EXPECT_EQ(rows(TextInput::memory(text, "a.csv"), 2), (std::vector<std::vector<double>>{{1, 2}, {2, 3}, {3, 4}, {4, 5}}));
}

TEST_F(Table, ProblemsHavePlaceAndName) {
    const auto input = TextInput::memory("time,gx,gy\n1,0.5,0.6\n2,abc,0.6\n3,,\n", "log.csv");
    const TableLayout layout = inspect_table(input);
    FieldRequest gy{2, FieldKind::Number, 2.0, 1.0, TimeUnit::Seconds, false, "gy"};
    FieldRequest gx{1, FieldKind::Number, 1.0, 0.0, TimeUnit::Seconds, true, "gx"};
    TableReader reader(input, layout, {gy, gx, gx});
    ASSERT_TRUE(reader.next());
    EXPECT_TRUE(reader.row_ok());
    EXPECT_EQ(reader.number(0), 0.6 * 2.0 + 1.0);
    EXPECT_EQ(reader.number(1), 0.5);
    EXPECT_EQ(reader.number(2), 0.5);  // one column may serve twice
    ASSERT_TRUE(reader.next());
    EXPECT_FALSE(reader.row_ok());
    EXPECT_EQ(reader.number(0), 0.6 * 2.0 + 1.0);
    EXPECT_TRUE(std::isnan(reader.number(1)));
    EXPECT_STREQ(reader.row_error("mend it").what(), "log.csv:3: column 2 gx: 'abc' is not a number; mend it");
    ASSERT_TRUE(reader.next());
    EXPECT_STREQ(reader.row_error("mend it").what(), "log.csv:4: column 2 gx: the value is missing; mend it");
    EXPECT_TRUE(std::isnan(reader.number(0)));
    EXPECT_FALSE(reader.next());
}

}  // namespace
}  // namespace schuler::io
