// The list of commands: every door is made of it.
#include "schuler/app/command.h"
#include "schuler/app/commands.h"
#include "schuler/core/error.h"
#include "schuler/live/settings.h"
#include "schuler/settings/command_line.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/scenario/scenario.h"

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

bool has_numbers(const OptionSpec& s) {
    return s.shape == settings::Shape::Number || s.shape == settings::Shape::Integer || s.shape == settings::Shape::Numbers;
}

/// The words of units at the end of a key: "deg_h_sqrt_h" of "imu.gyro_rate_walk_deg_h_sqrt_h".
std::string unit_words(std::string key) {
    static const std::set<std::string> known{"deg", "rad", "arcsec", "h",  "s",  "s2", "ms", "m",    "km",  "km2", "cm", "hz",
                                             "mhz", "db",  "g",      "mg", "ug", "k",  "c",  "mgal", "ppm", "pa",  "ut", "sqrt"};
    std::ranges::replace(key, '-', '_');
    std::string out;
    for (std::size_t end = key.size(); end != std::string::npos;) {
        const std::size_t begin = key.find_last_of("_.", end - 1);
        if (begin == std::string::npos || !known.contains(key.substr(begin + 1, end - begin - 1))) break;
        out = key.substr(begin + 1);
        if (key[begin] == '.') break;
        end = begin;
    }
    return out;
}

TEST(Commands, UnitsOfNumbersAreKnown) {
    EXPECT_EQ(unit_words("imu.gyro_rate_walk_deg_h_sqrt_h"), "deg_h_sqrt_h");
    EXPECT_EQ(unit_words("imu.gap_factor"), "");
    for (const Command& c : commands())
        for (const OptionSpec& s : c.options)
            EXPECT_TRUE(unit_words(s.key).empty() || !s.unit.empty()) << c.name << " --" << s.key;
    for (const auto* specs :
         {&settings::config_table().specs(), &settings::scenario_table().specs(), &live::live_table().specs()}) {
        for (const OptionSpec& s : *specs) {
            if (!has_numbers(s)) continue;
            const std::string words = unit_words(s.key);
            std::string ending(settings::unit_of_key(s.key).ending);
            if (ending.starts_with('_')) ending.erase(0, 1);
            EXPECT_TRUE(words.empty() || !s.unit.empty()) << s.key << " has no unit";
            // the whole of the words, "g_deg_h_g" (of the sensitivity to g) apart
            EXPECT_TRUE(words.size() <= ending.size() || words == "g_" + ending) << s.key << " is in more than " << ending;
            EXPECT_TRUE(s.key.find("_walk") == std::string::npos || s.unit.find("√") != std::string::npos)
                << s.key << " in " << s.unit;
        }
    }
}

TEST(Commands, HelpGivesTheRangeOfNumbers) {
    const Command& replay = *command_named("replay");
    EXPECT_THAT(settings::help_of(option(replay, "speed"), replay.defaults), testing::HasSubstr("a number from 0 to 1000000"));
    EXPECT_THAT(settings::help_of(option(replay, "to"), replay.defaults), testing::Not(testing::HasSubstr("from 0")));
}

TEST(Commands, FixedListsAreChoices) {
    const auto refused = [](const char* command, const char* key, const Value& v) {
        try {
            settings::check_value(option(*command_named(command), key), v, {});
        } catch (const Error&) {
            return true;
        }
        return false;
    };
    EXPECT_TRUE(refused("receiver track", "format", {std::string("flac")}));
    EXPECT_FALSE(refused("receiver track", "format", {std::string("ubyte")}));
    EXPECT_TRUE(refused("analyze integrity", "kind", {settings::ValueList{{std::string("step")}, {std::string("melt")}}}));
    EXPECT_FALSE(refused("analyze integrity", "kind", {settings::ValueList{{std::string("step")}, {std::string("freeze")}}}));
    EXPECT_TRUE(refused("analyze requirements", "device", {settings::ValueList{{std::string("hg99")}}}));
    EXPECT_FALSE(refused("analyze requirements", "device", {settings::ValueList{{std::string("HG-9900")}}}));
    EXPECT_TRUE(refused("ahrs", "filter", {std::string("kalman")}));
    EXPECT_THROW((void)command_named("analyze triad")->perform({{"cases", {std::string("az")}, {"--cases", 0, 0, {}}}}, {}),
                 Error);
    for (const double out : {-1.0, 10001.0}) EXPECT_TRUE(refused("analyze triad", "baro", {out}));
}

TEST(Commands, KeysOfLiveAreInHelpAndReference) {
    for (const OptionSpec& s : live::live_table().specs()) {
        EXPECT_THAT(settings_help(s.key), testing::HasSubstr(s.help)) << s.key;
        EXPECT_THAT(option_reference(), testing::HasSubstr("| `" + s.key + "` |"));
    }
}

TEST(Commands, TheReferenceOfOptionsIsTheOneInTheDocuments) {
    std::ifstream file(SCHULER_SOURCE_DIR "/docs/options.md");
    std::stringstream text;
    text << file.rdbuf();
    EXPECT_EQ(text.str(), option_reference()) << "write it anew: schuler help --reference >docs/options.md";
}

}  // namespace
}  // namespace schuler::app
