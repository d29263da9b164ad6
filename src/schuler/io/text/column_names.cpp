#include "schuler/io/text/columns.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <numeric>
#include <utility>

namespace schuler::io {
namespace {

/// Characters outside ASCII that occur in units.
std::string plain(std::string_view name) {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 6> signs = {{{"\xc2\xb0", " deg "},
                                                                                            {"\xc2\xb2", "2"},
                                                                                            {"\xc2\xb5", "u"},
                                                                                            {"\xce\xbc", "u"},
                                                                                            {"\xc2\xb7", " "},
                                                                                            {"\xe2\x88\x9a", "sqrt"}}};
    std::string text(name);
    for (const auto& [from, to] : signs) {
        for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
            text.replace(at, from.size(), to);
    }
    return text;
}

}  // namespace

std::string_view name_of(TableKind kind) {
    switch (kind) {
        case TableKind::Imu: return "imu";
        case TableKind::Gnss: return "gnss";
        case TableKind::Baro: return "baro";
        case TableKind::Mag: return "mag";
        case TableKind::Reference: return "reference";
        case TableKind::Ranges:
        case TableKind::Stations: return "stations";
    }
    return "";
}

std::string_view name_of(Certainty certainty) {
    switch (certainty) {
        case Certainty::Given: return "given";
        case Certainty::Exact: return "exact";
        case Certainty::Synonym: return "synonym";
        case Certainty::Guess: return "guess";
    }
    return "";
}

std::string_view name_of(HeightKind kind) {
    switch (kind) {
        case HeightKind::Unstated: return "unstated";
        case HeightKind::Ellipsoidal: return "ellipsoidal";
        case HeightKind::Msl: return "msl";
        case HeightKind::Relative: return "relative";
        case HeightKind::Autopilot: return "autopilot";
    }
    return "";
}

std::vector<std::string> words_of_name(std::string_view name) {
    const std::string text = plain(name);
    std::vector<std::string> words;
    std::string word;
    bool in_unit = false;
    char before = '\0';
    const auto end_word = [&] {
        if (!word.empty()) words.push_back(std::exchange(word, {}));
    };
    for (const char c : text) {
        if (c == '[' || c == '(') in_unit = true;
        if (c == '^') continue;
        const auto u = static_cast<unsigned char>(c);
        if (u < 0x80 && std::isalnum(u) == 0) {
            end_word();
        } else {
            const auto b = static_cast<unsigned char>(before);
            if (!in_unit && std::isupper(u) != 0 && (std::islower(b) != 0 || std::isdigit(b) != 0)) end_word();
            word += static_cast<char>(std::tolower(u));
        }
        before = c;
    }
    end_word();
    return words;
}

std::string nearest_name(std::string_view name, const std::vector<std::string>& known) {
    std::string best;
    std::size_t best_distance = std::max<std::size_t>(2, name.size() / 3) + 1;
    for (const std::string& candidate : known) {
        std::vector<std::size_t> row(candidate.size() + 1);
        std::iota(row.begin(), row.end(), std::size_t{0});
        for (std::size_t i = 1; i <= name.size(); ++i) {
            std::size_t diagonal = std::exchange(row[0], i);
            for (std::size_t j = 1; j <= candidate.size(); ++j) {
                const std::size_t replaced = diagonal + (name[i - 1] == candidate[j - 1] ? 0 : 1);
                diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, replaced}));
            }
        }
        if (row.back() < best_distance) {
            best_distance = row.back();
            best = candidate;
        }
    }
    return best;
}

}  // namespace schuler::io
