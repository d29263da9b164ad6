// The list of commands: every door is made of it.
#include "schuler/app/command.h"
#include "schuler/app/commands.h"
#include "schuler/core/error.h"
#include "schuler/settings/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

namespace schuler::app {
namespace {

using settings::OptionSpec;
using settings::Setting;
using settings::SettingList;
using settings::Value;

const OptionSpec& option(const Command& command, std::string_view key) {
    return *std::ranges::find(command.options, key, &OptionSpec::key);
}

TEST(Commands, EveryOptionHasAMeaningAndAFormOfItsOwn) {
    std::set<std::string> names;
    for (const Command& c : commands()) {
        EXPECT_TRUE(names.insert(c.name).second) << c.name << " is there twice";
        EXPECT_FALSE(c.purpose.empty()) << c.name;
        std::set<std::string> keys;
        std::set<char> letters;
        for (const OptionSpec& s : c.options) {
            EXPECT_TRUE(keys.insert(s.key).second) << c.name << " has --" << s.key << " twice";
            EXPECT_FALSE(s.help.empty()) << c.name << " --" << s.key;
            EXPECT_TRUE(s.line.letter == 0 || letters.insert(s.line.letter).second)
                << c.name << " has -" << s.line.letter << " twice";
            const bool number = s.shape == settings::Shape::Number || s.shape == settings::Shape::Integer;
            EXPECT_TRUE(!number || (std::isfinite(s.low) && std::isfinite(s.high)))
                << c.name << " --" << s.key << " has no range";
        }
        for (const Setting& usual : c.defaults)  // what help calls the default is accepted
            EXPECT_NO_THROW(settings::check_value(option(c, usual.key), usual.value, {})) << c.name << " --" << usual.key;
    }
    EXPECT_EQ(command_named("no command"), nullptr);
}

TEST(Commands, WordsOfACommandLineBecomeTheValuesThatTheyName) {
    const Command& equator = *command_named("analyze equator");
    const Command& process = *command_named("process");
    const Command& integrity = *command_named("analyze integrity");
    EXPECT_EQ(settings::value_from_words(option(equator, "speed"), {"-6e2"}).number(), -600.0);
    EXPECT_NE(settings::value_from_words(option(equator, "speed"), {"fast"}).text(), nullptr);
    EXPECT_NE(settings::value_from_words(option(equator, "speed"), {"5 m/s"}).text(), nullptr);
    EXPECT_EQ(settings::value_from_words(option(equator, "misalignment"), {"1", "2", "3"}).list()->size(), 3u);
    EXPECT_EQ(settings::value_from_words(option(integrity, "size"), {"0.1,0.5"}).list()->at(1).number(), 0.5);
    EXPECT_EQ(*settings::value_from_words(option(process, "start"), {"abs:12"}).text(), "abs:12");
    // an outage has commas of its own
    EXPECT_EQ(settings::value_from_words(option(process, "outage"), {"50:15,100:15"}).list()->size(), 1u);
}

TEST(Commands, ValuesBecomeTheWordsThatTheyCameFrom) {
    for (const Command& c : commands()) {
        for (const OptionSpec& s : c.options) {
            if (s.shape == settings::Shape::Flag || s.line.positional) continue;
            const Value* usual = nullptr;
            for (const Setting& d : c.defaults)
                if (d.key == s.key) usual = &d.value;
            if (usual == nullptr) continue;
            std::vector<std::string> words = settings::words_from_value(s, *usual);
            ASSERT_EQ(words.front(), "--" + s.key);
            words.erase(words.begin());
            EXPECT_EQ(settings::to_toml(settings::value_from_words(s, words)), settings::to_toml(*usual))
                << c.name << " --" << s.key;
        }
    }
}

TEST(Commands, RefuseWhatIsOutOfRangeWithTheNameOfTheOption) {
    const Command& equator = *command_named("analyze equator");
    try {
        (void)equator.perform({{"latitude-deg", {91.0}, {"--latitude-deg", 0, 0, {}}}}, {});
        FAIL();
    } catch (const Error& e) {
        EXPECT_THAT(e.what(), testing::HasSubstr("--latitude-deg"));
        EXPECT_EQ(e.kind(), ErrorKind::Input);
    }
    const report::Outcome out = equator.perform({{"speed", {600.0}, {}}, {"dh", {1.0}, {}}}, {});
    EXPECT_THAT(out.tables, testing::HasSubstr("600"));
}

TEST(Commands, TheReferenceOfOptionsIsTheOneInTheDocuments) {
    std::ifstream file(SCHULER_SOURCE_DIR "/docs/options.md");
    std::stringstream text;
    text << file.rdbuf();
    EXPECT_EQ(text.str(), option_reference()) << "write it anew: schuler help --reference >docs/options.md";
}

}  // namespace
}  // namespace schuler::app
