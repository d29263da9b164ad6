#include "schuler/core/log.h"

#include <fmt/format.h>

namespace schuler {

void WarningLog::add(const std::string& topic, const std::string& text, std::size_t count) {
    const auto [it, fresh] = entries_.try_emplace(topic, Entry{text, 0});
    if (fresh) order_.push_back(topic);
    it->second.count += count;
}

std::vector<std::string> WarningLog::summary() const {
    std::vector<std::string> lines;
    for (const std::string& topic : order_) {
        const Entry& e = entries_.at(topic);
        lines.push_back(e.count > 1 ? fmt::format("{} ({} times)", e.text, e.count) : e.text);
    }
    return lines;
}

std::size_t WarningLog::count(const std::string& topic) const {
    const auto it = entries_.find(topic);
    return it == entries_.end() ? 0 : it->second.count;
}

}  // namespace schuler
