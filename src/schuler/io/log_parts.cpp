#include "schuler/io/log_parts.h"

#include <algorithm>
#include <cctype>
#include <functional>
#include <numeric>
#include <string_view>

namespace schuler::io {

std::string name_of_parts(const std::filesystem::path& path) {
    std::string out;
    const auto drop = [&](std::string_view end) {
        if (!out.ends_with(end)) return false;
        out.resize(out.size() - end.size());
        return true;
    };
    const auto drop_marks = [&] {
        while (!out.empty() && std::string_view("_-. (").find(out.back()) != std::string_view::npos) out.pop_back();
    };
    bool in_number = false;
    for (const char c : path.filename().string()) {
        if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
            if (!in_number) {
                drop_marks();
                if (drop("part") || drop("Part") || drop("PART")) drop_marks();
            }
            in_number = true;
            continue;
        }
        if (!(in_number && c == ')')) out += c;
        in_number = false;
    }
    return out;
}

bool follows(const FileSpan& a, const FileSpan& b) {
    constexpr double shared = 0.2;
    const double shorter = std::min(a.stop - a.start, b.stop - b.start);
    return b.start >= a.stop - shared * shorter && b.stop > a.stop;
}

std::vector<std::size_t> chain_of_parts(std::span<const FileSpan> files, std::size_t chosen) {
    constexpr double longest_pause = 600.0;  // s
    const auto joins = [&](std::size_t a, std::size_t b) {
        return follows(files[a], files[b]) && files[b].start - files[a].stop <= longest_pause;
    };
    std::vector<std::size_t> order(files.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return files[i].start; });
    std::vector<std::size_t> chain{chosen};
    for (const std::size_t i : order)
        if (joins(chain.back(), i)) chain.push_back(i);
    std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return files[i].stop; });
    for (const std::size_t i : order)
        if (joins(i, chain.front())) chain.insert(chain.begin(), i);
    return chain;
}

}  // namespace schuler::io
