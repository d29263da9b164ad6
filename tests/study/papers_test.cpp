// `schuler paper`: the file of printed numbers, the judgement, and that every quick item reaches what is printed.
#include "schuler/study/papers/papers.h"
#include "schuler/core/error.h"
#include "schuler/math/random.h"
#include "schuler/study/papers/printed.h"
#include "schuler/theory/paper_c_tables.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>

namespace schuler::study {
namespace {

namespace fs = std::filesystem;

TEST(PrintedNumbers, StandInOneFileWithPagesAndBelongToItems) {
    std::set<std::string> in_file, in_program;
    std::size_t numbers = 0;
    for (const PrintedItem& item : printed_items()) {
        EXPECT_TRUE(in_file.insert(item.paper + " " + item.name).second) << item.name << " twice";
        EXPECT_FALSE(item.page.empty());
        std::set<std::string> keys;
        for (const PrintedValue& v : item.values) {
            EXPECT_TRUE(keys.insert(v.key).second) << item.name << ": " << v.key << " twice";
            EXPECT_EQ(v.right.empty(), v.remark.empty()) << item.name << ": " << v.key << ": a right number needs its reason";
            ++numbers;
        }
    }
    for (const PaperItem& item : paper_items()) in_program.insert(std::string(item.paper) + " " + item.name);
    EXPECT_EQ(in_file, in_program);
    EXPECT_GT(numbers, 180U);
}

TEST(PrintedNumbers, HavePagesOfTheirOwn) {
    // sheets of the thesis, pages of the article; B and E are at hand without page numbers
    const std::map<std::string, std::pair<int, int>> span{{"A", {1, 108}}, {"C", {69, 84}}, {"D", {69, 77}}};
    for (const PrintedItem& item : printed_items()) {
        SCOPED_TRACE(item.paper + " " + item.name + ", page " + item.page);
        const auto known = span.find(item.paper);
        if (known == span.end()) {
            EXPECT_TRUE(item.page.starts_with("section \""));
            continue;
        }
        std::smatch m;
        ASSERT_TRUE(std::regex_match(item.page, m, std::regex("([0-9]+)(-([0-9]+))?")));
        const int first = std::stoi(m[1]), last = m[3].matched ? std::stoi(m[3]) : first;
        EXPECT_GE(first, known->second.first);
        EXPECT_LE(last, known->second.second);
        EXPECT_GE(last, first);
        EXPECT_LE(last - first, 5) << "the pages of the paper, not of the item";
    }
}

TEST(PrintedNumbers, OfPaperCAreThoseOfItsOracle) {
    for (const theory::PaperEntry& e : theory::paper_tables()) {
        if (e.set == 0) continue;
        const PrintedItem& item = printed_item("C", e.vehicle == "ship" ? "table-3" : "table-2");
        constexpr const char* sets[] = {"", "I", "II", "III"};
        const std::string key = std::string(sets[e.set]) + " " + e.quantity + " " + e.unit;
        const auto there = std::ranges::find(item.values, key, &PrintedValue::key);
        ASSERT_NE(there, item.values.end()) << key;
        EXPECT_EQ(there->printed, e.printed) << key;
        EXPECT_EQ(there->misprint, !e.agrees) << key;
    }
}

TEST(PrintedNumbers, AreHeldToTheirDigitsKindAndTolerance) {
    const auto judged = [](const char* toml, double ours) {
        const auto items = printed_items_from(
            std::string(
                "[[item]]\npaper=\"A\"\nname=\"x\"\npage=\"1\"\nplace=\"p\"\nvalues=[{key=\"k\",quantity=\"q\",unit=\"m\",") +
                toml + "}]",
            "test");
        return agreement_of(items.front().values.front(), ours);
    };
    EXPECT_EQ(judged("printed=\"84.4\"", 84.44), Agreement::Agrees);
    EXPECT_EQ(judged("printed=\"84.4\"", 84.46), Agreement::Differs);
    EXPECT_EQ(judged("printed=\"1300\",tolerance=0.05", 1353.0), Agreement::Agrees);
    EXPECT_EQ(judged("printed=\"1300\",tolerance=0.05", 1366.0), Agreement::Differs);
    EXPECT_EQ(judged("printed=\"1300\",right=\"12742\",tolerance=0.01,misprint=\"a tenth\"", 12700.0), Agreement::Misprint);
    EXPECT_EQ(judged("printed=\"1300\",right=\"12742\",tolerance=0.01,reason=\"another case\"", 12700.0), Agreement::Explained);
    EXPECT_EQ(judged("printed=\"1300\",right=\"12742\",tolerance=0.01,misprint=\"a tenth\"", 11000.0), Agreement::Differs);
    EXPECT_EQ(judged("printed=\"5\",kind=\"at_most\"", 5.1), Agreement::Differs);
    EXPECT_EQ(judged("printed=\"7\",to=\"8\",kind=\"between\"", 7.5), Agreement::Agrees);
    EXPECT_EQ(judged("printed=\"7\",to=\"8\",kind=\"between\"", 8.5), Agreement::Differs);
    EXPECT_EQ(judged("printed=\"0\",right=\"2e-3\",misprint=\"no\"", 2e-3), Agreement::Misprint);
    EXPECT_EQ(judged("printed=\"5\"", std::nan("")), Agreement::Differs);
}

TEST(PrintedNumbers, MayDeviateByThreeStandardErrorsBeyondTheTolerance) {
    PrintedValue v;
    v.printed = "16";
    v.tolerance = 0.2;
    EXPECT_EQ(agreement_of(v, 21.8), Agreement::Differs);
    EXPECT_EQ(agreement_of(v, 21.8, 0.5), Agreement::Differs);
    EXPECT_EQ(agreement_of(v, 21.8, 1.0), Agreement::Agrees);

    // the mean of n values of unit variance has 1/sqrt(n)
    PaperResult result;
    math::Random random(1, "bootstrap test");
    std::vector<double> x(400);
    for (double& one : x) one = random.normal();
    set_numbers(result, x.size(), [&](const std::vector<std::size_t>& which) {
        double sum = 0.0;
        for (const std::size_t i : which) sum += x[i] / static_cast<double>(which.size());
        return std::vector<std::pair<std::string, double>>{{"mean", sum}};
    });
    // 200 draws: 5 % of it, and 3.5 % of the sample's own variance
    EXPECT_NEAR(result.standard_errors.front().second, 0.05, 0.01);
}

/// Of `schuler paper LETTER all`, by item and key.
nlohmann::json all_of(const std::string& paper) {
    PaperRequest request;
    request.paper = paper;
    request.item = "all";
    const report::Outcome out = make_paper(request);
    EXPECT_TRUE(out.usable) << out.verdict << "\n" << out.tables;
    return nlohmann::json::parse(out.json);
}

/// The numbers are reached; and each of them would be seen to be wrong by a tenth, or by its tolerance twice over.
void expect_reached(const nlohmann::json& made) {
    for (const auto& item : made["items"]) {
        const PrintedItem& printed = printed_item(item["paper"].get<std::string>(), item["item"].get<std::string>());
        ASSERT_EQ(item["rows"].size(), printed.values.size());
        for (std::size_t i = 0; i < printed.values.size(); ++i) {
            const auto& row = item["rows"][i];
            EXPECT_NE(row["agreement"], "DIFFERS") << row;
            PrintedValue other = printed.values[i];
            if (other.kind != PrintedValue::Kind::Equal || !row["ours"].is_number()) continue;
            const double ours = row["ours"].get<double>(), room = 2.5 * std::max(0.1, other.tolerance.value_or(0.0));
            const std::string& expected = row["agreement"] == "agrees" ? other.printed : other.right;
            if (number_of(expected) == 0.0) continue;
            if (theory::printed_number(expected == "pi/2" ? "1.57" : expected).half_unit > 0.1 * std::abs(number_of(expected)))
                continue;  // one digit
            EXPECT_EQ(agreement_of(other, ours * (1.0 + room)), Agreement::Differs) << printed.name << ": " << other.key;
        }
    }
}

TEST(PapersA, EveryQuickItemReachesWhatIsPrinted) { expect_reached(all_of("A")); }
TEST(PapersB, EveryQuickItemReachesWhatIsPrinted) { expect_reached(all_of("B")); }
TEST(PapersC, EveryQuickItemReachesWhatIsPrinted) { expect_reached(all_of("C")); }

TEST(PapersD, FourSatellitesGiveSevenToEightMetres) {
    PaperRequest request;
    request.paper = "D";
    request.item = "figure-2";
    request.runs = 16;
    const report::Outcome out = make_paper(request);
    EXPECT_TRUE(out.usable) << out.tables;
}

TEST(PapersE, CarrierPhaseKnowsTheVerticalToATenthOfAMilligal) {
    PaperRequest request;
    request.paper = "E";
    request.item = "figure-3";
    request.runs = 6;
    const auto json = nlohmann::json::parse(make_paper(request).json);
    for (const auto& row : json["rows"]) EXPECT_NE(row["agreement"], "DIFFERS") << row;
}

TEST(Papers, WriteTheirFilesAndListThemselves) {
    const fs::path folder = fs::temp_directory_path() / "schuler-papers-test";
    fs::remove_all(folder);
    PaperRequest request;
    request.paper = "A";
    request.item = "figure-4.1.1";
    request.output = folder;
    static_cast<void>(make_paper(request));
    for (const char* name : {"report.html", "comparison.csv", "curves.csv", "summary.json"})
        EXPECT_TRUE(fs::exists(folder / name)) << name;
    std::ifstream file(folder / "comparison.csv");
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    EXPECT_NE(text.find("12742,"), std::string::npos) << "the right number beside the misprint";
    EXPECT_NE(text.find(",misprint,"), std::string::npos);
    fs::remove_all(folder);

    request.item.clear();
    const auto listed = nlohmann::json::parse(make_paper(request).json);
    EXPECT_GT(listed["items"].size(), 20U);
    request.item = "figure-9.9";
    EXPECT_THROW(static_cast<void>(make_paper(request)), Error);
}

}  // namespace
}  // namespace schuler::study
