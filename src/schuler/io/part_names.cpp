#include "schuler/io/part_names.h"

#include <cctype>

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

}  // namespace schuler::io
