// TOML text of unknown origin: nothing that it contains ends the program.
#include "schuler/settings/toml_file.h"

#include "schuler/core/error.h"

#include <gtest/gtest.h>

#include <string>

namespace schuler::settings {
namespace {

std::string repeated(const std::string& part, int times) {
    std::string out;
    for (int i = 0; i < times; ++i) out += part;
    return out;
}

// Parsers of TOML recurse along dotted keys, arrays and inline tables.
TEST(TomlFile, DeepTextIsRefusedWithItsLine) {
    const std::string text[] = {"\n" + repeated("a.", 10'000) + "a=1",
                                "\n[" + repeated("a.", 10'000) + "a]\n",
                                "\n[[" + repeated("a . ", 10'000) + "a]]\n",
                                "\nx." + repeated("a\t.", 10'000) + "a = 1\n",
                                "\nx = " + repeated("[", 10'000),
                                "\nx = " + repeated("{a=", 10'000)};
    for (const std::string& t : text) {
        try {
            (void)parse_toml(t, "deep.toml");
            ADD_FAILURE() << t.substr(0, 20);
        } catch (const Error& e) {
            EXPECT_EQ(e.place().file, "deep.toml");
            EXPECT_EQ(e.place().line, 2) << t.substr(0, 20);
        }
    }
    EXPECT_THROW((void)parse_toml_value("{ " + repeated("a.", 10'000) + "a = 1 }"), Error);
}

// Dots elsewhere are no parts of keys.
TEST(TomlFile, DotsInTextAndCommentsAreTaken) {
    const std::string dots(100, '.');
    const ValueTable t = parse_toml("# " + dots + "\na = \"" + dots + "\"\nb = '" + dots + "'\nc = \"\"\"\n\\\"" + dots +
                                        "\"\"\"\nd = [" + repeated("1.5, ", 100) + "1.5]\n\"" + dots + "\" = 1\n",
                                    "dots.toml");
    ASSERT_EQ(t.size(), 5u);
    EXPECT_EQ(*t[0].second.text(), dots);
    EXPECT_EQ(t[3].second.list()->size(), 101u);
}

}  // namespace
}  // namespace schuler::settings
