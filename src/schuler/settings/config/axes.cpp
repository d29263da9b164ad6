#include "schuler/settings/config/config.h"

#include <Eigen/LU>

#include <array>
#include <cctype>

namespace schuler::settings {
namespace {

/// Unit vector in forward-right-down of a direction's name or first letter; zero if unknown.
Eigen::Vector3d direction(const std::string& name) {
    if (name == "f" || name == "forward" || name == "front") return {1, 0, 0};
    if (name == "b" || name == "backward" || name == "back") return {-1, 0, 0};
    if (name == "r" || name == "right") return {0, 1, 0};
    if (name == "l" || name == "left") return {0, -1, 0};
    if (name == "d" || name == "down") return {0, 0, 1};
    if (name == "u" || name == "up") return {0, 0, -1};
    return Eigen::Vector3d::Zero();
}

std::string lower_without_blanks(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (std::isspace(static_cast<unsigned char>(c)) == 0)
            out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    return out;
}

/// The three names in the order x, y, z; empty if not given in the text.
std::array<std::string, 3> names_of(const std::string& text) {
    std::array<std::string, 3> names;
    if (text.size() == 3 && text.find('=') == std::string::npos) {
        for (std::size_t i = 0; i < 3; ++i) names[i] = text.substr(i, 1);
        return names;
    }
    std::size_t begin = 0;
    while (begin < text.size()) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string item = text.substr(begin, end - begin);
        if (item.size() > 2 && item[1] == '=' && item[0] >= 'x' && item[0] <= 'z')
            names[static_cast<std::size_t>(item[0] - 'x')] = item.substr(2);
        begin = end + 1;
    }
    return names;
}

}  // namespace

Eigen::Matrix3d axes_from_text(const std::string& text) {
    const std::array<std::string, 3> names = names_of(lower_without_blanks(text));
    Eigen::Matrix3d C_bs;
    for (int i = 0; i < 3; ++i) C_bs.col(i) = direction(names[static_cast<std::size_t>(i)]);
    const double det = C_bs.determinant();  // entries are 0 and +-1: exact
    if (det > 0.5) return C_bs;
    const std::string hint = "use \"frd\", \"flu\", \"fur\" or for example \"x=forward, y=left, z=up\"";
    if (det < -0.5) throw input_error(fmt::format("axes \"{}\" are left-handed", text), {}, "turn one axis round; " + hint);
    throw input_error(fmt::format("axes \"{}\" are not three perpendicular directions", text), {}, hint);
}

}  // namespace schuler::settings
