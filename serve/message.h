// A request and its answer, independent of any HTTP library.
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
    std::vector<std::string> parts;  ///< matches of the braces in the route's path, in order
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
    std::filesystem::path file;           ///< if not empty: this file is sent instead of `body`
    std::string download;                 ///< if not empty: the file name used by the browser for saving
    std::string tag;                      ///< if not empty: the browser keeps it and asks whether it is still this version
    bool page_of_its_own = false;         ///< a report: it may run only its own script
    std::function<std::string()> events;  ///< if not empty: server-sent events; waits at most a second, "" if nothing happened
};

/// A request that is refused or cannot be executed: status, error, remedy, and the form field it refers
/// to.
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
