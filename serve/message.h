// A request and its answer, free of any HTTP library.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::serve {

struct Request {
    std::string method, path;
    std::vector<std::string> parts;  ///< what the braces of the route's path matched, in order
    std::map<std::string, std::string> query;
    std::string body;

    [[nodiscard]] std::string asked(const std::string& name, std::string_view otherwise = "") const {
        const auto it = query.find(name);
        return it == query.end() ? std::string(otherwise) : it->second;
    }
};

struct Reply {
    int status = 200;
    std::string type = "application/json", body;
    std::filesystem::path file;           ///< not empty: this file is sent instead of `body`
    std::string download;                 ///< not empty: the name under which a browser saves it
    bool page_of_its_own = false;         ///< a report: it may run its own script and nothing else
    std::function<std::string()> events;  ///< not empty: server-sent events; waits a second at most, "" where nothing happened
};

/// A request that is refused or cannot be done, as the door tells it: status, what is wrong, how to mend it, and which field of
/// a form it is about.
struct Refusal {
    int status;
    std::string text;
    std::string hint{};
    std::string key{};
    long line = 0;
};

/// {"error": {"text", "mend", "key", "line"}}
[[nodiscard]] Reply refused(const Refusal& refusal);

}  // namespace schuler::serve
