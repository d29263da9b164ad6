#include "serve/guard.h"

#include "serve/message.h"
#include "serve/names.h"
#include "serve/results.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace schuler::serve {
namespace {

int status_of(const Provenance& from, const GuardSettings& settings) {
    const auto no = refusal_of(from, settings);
    return no ? no->status : 200;
}

TEST(Guard, OwnNamesAndOwnPagesOnly) {
    const std::string token(32, 'a');
    const GuardSettings here{"127.0.0.1", 8642, token};
    const auto with = [&](const char* host, const char* origin = "", const char* site = "") {
        Provenance p;
        p.authorization = "Bearer " + token;
        p.host = host;
        p.origin = origin;
        p.fetch_site = site;
        return p;
    };
    EXPECT_EQ(status_of(with("127.0.0.1:8642"), here), 200);
    EXPECT_EQ(status_of(with("localhost:8642", "http://localhost:8642", "same-origin"), here), 200);
    EXPECT_EQ(status_of(with("[::1]:8642"), here), 200);
    for (const char* host :
         {"", "127.0.0.1", "127.0.0.1:80", "evil.example:8642", "127.0.0.1.evil.example:8642", "10.0.0.1:8642", "[::2]:8642"})
        EXPECT_EQ(status_of(with(host), here), 403) << host;
    EXPECT_EQ(status_of(with("127.0.0.1:8642", "http://127.0.0.1:8643"), here), 403);
    EXPECT_EQ(status_of(with("127.0.0.1:8642", "null"), here), 403);
    EXPECT_EQ(status_of(with("127.0.0.1:8642", "", "same-site"), here), 403);

    const GuardSettings everywhere{"0.0.0.0", 8642, token};
    EXPECT_EQ(status_of(with("name.example:8642"), everywhere), 403) << "names may be pointed here by anyone";
    for (const auto& [host, settings] : {std::pair{"192.168.1.5:8642", everywhere}, std::pair{"127.0.0.1:8642", here}}) {
        Provenance p = with(host);
        EXPECT_EQ(status_of(p, settings), 200);
        p.authorization = "Bearer " + std::string(32, 'b');
        EXPECT_EQ(status_of(p, settings), 401);
        p.authorization.clear();
        EXPECT_EQ(status_of(p, settings), 401);
        p.cookie = "other=1; schuler_token_8642=" + token;
        EXPECT_EQ(status_of(p, settings), 200);
        for (const char* other : {"xschuler_token_8642=", "schuler_token_8643=", "schuler_token="}) {
            p.cookie = other + token;
            EXPECT_EQ(status_of(p, settings), 401) << other;
        }
    }
    EXPECT_NE(random_token(), random_token());
    EXPECT_EQ(random_token().size(), 32u);
}

TEST(Names, OneNameInOneFolder) {
    for (const char* name : {"imu.csv", "лог 1.csv", "a..b", "x"}) EXPECT_TRUE(is_file_name(name)) << name;
    for (const char* name : {"", ".", "..", ".x", "a/b", "a\\b", "a\nb", "\xc0\xae", "\xed\xa0\x80", "\xff"})
        EXPECT_FALSE(is_file_name(name)) << name;
    EXPECT_FALSE(is_file_name(std::string("a\0b", 3)));
    EXPECT_EQ(folder_name("  My Drive, 2! "), "my-drive-2");
    EXPECT_EQ(folder_name("Політ"), "run");
}

TEST(Series, ExtremesStayAndGapsAreNull) {
    ColumnTable time{{std::vector<double>(10'000)}, {"time"}, {"s"}};
    std::vector<double> y(10'000);
    for (std::size_t i = 0; i < y.size(); ++i) {
        time.columns[0][i] = 0.01 * static_cast<double>(i);
        y[i] = std::sin(0.01 * static_cast<double>(i));
    }
    y[4321] = 50.0;
    y[17] = std::numeric_limits<double>::quiet_NaN();
    SeriesRequest request;
    request.columns = {"/a/b:c"};
    request.points = 100;
    const Json thin = Json::parse(series_text(time, {&y}, request, {"m"}));
    EXPECT_EQ(thin["rows"], 10'000);
    EXPECT_LT(thin["time_s"].size(), 300u);
    const auto values = thin["columns"]["/a/b:c"];
    EXPECT_EQ(*std::max_element(values.begin(), values.end()), 50.0);
    request.from = 0.1;
    request.to = 0.2;
    request.points = 0;
    const Json part = Json::parse(series_text(time, {&y}, request, {"m"}));
    EXPECT_EQ(part["time_s"].front(), 0.09) << "one row beyond the end";
    EXPECT_TRUE(part["columns"]["/a/b:c"][8].is_null());
    request.from = 1e6;
    request.to = 2e6;
    EXPECT_LE(Json::parse(series_text(time, {&y}, request, {"m"}))["time_s"].size(), 1u);
}

}  // namespace
}  // namespace schuler::serve
