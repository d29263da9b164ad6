#include "schuler/sensor/axes.h"

#include "schuler/core/error.h"

#include <fmt/format.h>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string>
#include <vector>

namespace schuler::sensor {
namespace {

struct Direction {
    std::string_view word;
    int line;     // 0 forward-backward, 1 right-left, 2 down-up: the body axes
    double sign;  // along the body axis or opposite
};
constexpr std::array<Direction, 6> directions{
    {{"forward", 0, 1.0}, {"backward", 0, -1.0}, {"right", 1, 1.0}, {"left", 1, -1.0}, {"down", 2, 1.0}, {"up", 2, -1.0}}};
constexpr std::string_view axis_names = "xyz";
constexpr std::string_view how = "write three of f, b, l, r, u, d such as \"frd\", or \"x=forward, y=left, z=up\"";

Error axes_error(std::string_view axes, const std::string& what, std::string hint = std::string(how)) {
    SourcePlace place;
    place.key = "axes";
    return input_error(fmt::format("sensor axes \"{}\": {}", axes, what), place, std::move(hint));
}

std::optional<Direction> direction_of(std::string_view word) {
    if (word == "back" || word == "rear" || word == "aft") word = "backward";
    if (word == "front" || word == "fwd") word = "forward";
    for (const Direction& d : directions)
        if (word == d.word || (word.size() == 1 && word[0] == d.word[0])) return d;
    return std::nullopt;
}

/// Lower case without spaces and quotes.
std::string normalised(std::string_view text) {
    std::string result;
    for (const char c : text)
        if (std::isspace(static_cast<unsigned char>(c)) == 0 && c != '"' && c != '\'')
            result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

/// The word of each axis x, y, z; empty if not given.
std::array<std::string, 3> words_of(std::string_view axes, const std::string& text) {
    std::array<std::string, 3> words;
    if (text.find('=') == std::string::npos) {
        if (text.size() != 3) throw axes_error(axes, "neither three letters nor a list");
        for (std::size_t i = 0; i < 3; ++i) words[i] = text[i];
        return words;
    }
    std::size_t begin = 0;
    while (begin < text.size()) {
        const std::size_t end = std::min(text.find_first_of(",;", begin), text.size());
        const std::string item = text.substr(begin, end - begin);
        begin = end + 1;
        if (item.empty()) continue;
        const std::size_t axis = item.size() > 2 && item[1] == '=' ? axis_names.find(item[0]) : std::string_view::npos;
        if (axis == std::string_view::npos) throw axes_error(axes, fmt::format("\"{}\" is not like \"x=forward\"", item));
        if (!words[axis].empty()) throw axes_error(axes, fmt::format("axis {} is given twice", axis_names[axis]));
        words[axis] = item.substr(2);
    }
    return words;
}

}  // namespace

Eigen::Matrix3d C_bs_from_axes(std::string_view axes) {
    const std::array<std::string, 3> words = words_of(axes, normalised(axes));
    Eigen::Matrix3d C_bs = Eigen::Matrix3d::Zero();
    std::array<Direction, 3> found;
    for (std::size_t i = 0; i < 3; ++i) {
        if (words[i].empty()) throw axes_error(axes, fmt::format("axis {} is missing", axis_names[i]));
        const std::optional<Direction> d = direction_of(words[i]);
        if (!d) throw axes_error(axes, fmt::format("\"{}\" is not a direction", words[i]));
        found[i] = *d;
        for (std::size_t j = 0; j < i; ++j)
            if (found[j].line == d->line)
                throw axes_error(axes, fmt::format("{} and {} lie along one line ({}, {})", axis_names[j], axis_names[i],
                                                   found[j].word, d->word));
        C_bs(d->line, static_cast<Eigen::Index>(i)) = d->sign;
    }
    if (C_bs.determinant() < 0.0) {
        std::string_view opposite;
        for (const Direction& d : directions)
            if (d.line == found[2].line && d.sign != found[2].sign) opposite = d.word;
        throw axes_error(axes, "left-handed",
                         fmt::format("with x {} and y {}, z points {} in a right-handed sensor; if one axis of the log really is "
                                     "reversed, change the sign of that column",
                                     found[0].word, found[1].word, opposite));
    }
    return C_bs;
}

}  // namespace schuler::sensor
