// Warnings of the library: collected, counted and summarised by the caller, never printed by the library.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace schuler {

/// Collects warnings. Each topic is stored once, with its first text and a count.
class WarningLog {
public:
    /// topic groups repetitions ("gnss.std.missing"); text is shown for the first of them.
    void add(const std::string& topic, const std::string& text, std::size_t count = 1);
    /// One line per topic in order of first appearance: the text, and "(N times)" if N > 1.
    [[nodiscard]] std::vector<std::string> summary() const;
    /// Topics in order of first appearance, corresponding to the entries of summary().
    [[nodiscard]] const std::vector<std::string>& topics() const { return order_; }
    [[nodiscard]] bool empty() const { return order_.empty(); }
    [[nodiscard]] std::size_t count(const std::string& topic) const;

private:
    struct Entry {
        std::string text;
        std::size_t count;
    };
    std::vector<std::string> order_;
    std::map<std::string, Entry> entries_;
};

}  // namespace schuler
