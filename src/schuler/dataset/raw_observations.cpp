#include "schuler/dataset/raw_observations.h"

#include "schuler/core/error.h"
#include "schuler/dataset/raw_gnss.h"
#include "schuler/io/log_parts.h"
#include "schuler/io/raw_input.h"
#include "schuler/io/text/columns.h"
#include "schuler/io/text/text_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <string_view>

namespace schuler::dataset {
namespace {

namespace fs = std::filesystem;

/// Receiver type in a RINEX header: MARKER TYPE of version 3, without which static receivers cannot be distinguished.
std::string marker_type(const fs::path& file) {
    try {
        io::LineBlocks blocks{io::TextInput(file)};
        if (!blocks.next()) return {};
        std::string_view text(blocks.begin(), static_cast<std::size_t>(blocks.end() - blocks.begin()));
        while (!text.empty()) {
            const std::size_t end = std::min(text.find('\n'), text.size());
            const std::string_view line = text.substr(0, end);
            if (line.find("END OF HEADER") != std::string_view::npos) break;
            if (line.find("MARKER TYPE") != std::string_view::npos) return std::string(line.substr(0, line.find(' ')));
            text.remove_prefix(std::min(end + 1, text.size()));
        }
    } catch (const std::exception&) {
        // an unreadable file gives no information; its reader will report the error
    }
    return {};
}

int points_by_name(const fs::path& file) {
    int points = 0;
    for (const std::string& word : io::words_of_name(file.stem().string())) {
        if (word == "rover" || word == "rov" || word == "kinematic" || word == "mobile") points = 1;
        if (word == "base" || word == "station" || word == "master" || word == "reference" || word == "ref") points = -1;
    }
    return points;
}

/// Evidence that a file is from the receiver to be located rather than a station: positive for a rover.
int rover_points(const fs::path& file) {
    const std::string type = marker_type(file);
    const auto is = [&](std::initializer_list<std::string_view> types) { return std::ranges::find(types, type) != types.end(); };
    // RINEX 3.04, table A2: types of moving carriers, and of monuments
    if (is({"AIRBORNE", "SPACEBORNE", "GROUND_CRAFT", "WATER_CRAFT", "FLOATING_BUOY", "FLOATING_ICE", "GLACIER", "BALLISTIC",
            "ANIMAL", "HUMAN", "NON_GEODETIC"}))
        return 2;
    return type == "GEODETIC" ? -2 : points_by_name(file);
}

/// First and last epoch of a file of raw measurements, Unix time.
std::optional<io::FileSpan> span_of(const fs::path& file) {
    try {
        WarningLog unheard;  // the run that reads it warns
        const io::RawInput raw = io::read_raw_input(file, {}, unheard);
        if (raw.observations.epochs.empty()) return std::nullopt;
        return io::FileSpan{raw.observations.epochs.front().time.seconds(), raw.observations.epochs.back().time.seconds()};
    } catch (const Error&) {
        return std::nullopt;
    }
}

/// The files of the log whose first found part is the first of these.
std::vector<std::string> with_parts(const fs::path& folder, const std::vector<std::string>& names) {
    std::vector<std::string> alike;
    std::ranges::copy_if(names, std::back_inserter(alike),
                         [&](const std::string& name) { return io::name_of_parts(name) == io::name_of_parts(names.front()); });
    if (alike.size() == 1) return alike;
    std::vector<std::string> dated, parts;
    std::vector<io::FileSpan> spans;
    for (const std::string& name : alike)
        if (const auto span = span_of(folder / name)) {
            dated.push_back(name);
            spans.push_back(*span);
        }
    if (dated.empty() || dated.front() != names.front()) return {names.front()};
    for (const std::size_t i : io::chain_of_parts(spans, 0)) parts.push_back(dated[i]);
    return parts;
}

}  // namespace

RawObservations raw_observations(const fs::path& path, bool alone) {
    std::error_code ec;
    const bool folder = fs::is_directory(path, ec);
    const fs::path beside = folder ? path : path.parent_path().empty() ? fs::path(".") : path.parent_path();
    std::vector<std::string> observations, navigation, logs;  // receiver logs contain both
    for (const auto& entry : fs::directory_iterator(beside, ec)) {
        if (!entry.is_regular_file(ec)) continue;
        const io::RawFormat format = io::raw_format(entry.path());
        const std::string name = entry.path().filename().string();
        if (format == io::RawFormat::RinexNavigation) navigation.push_back(name);
        if (format == io::RawFormat::RinexObservations) observations.push_back(name);
        if (format == io::RawFormat::Ubx || format == io::RawFormat::Rtcm3 || format == io::RawFormat::Novatel)
            logs.push_back(name);
    }
    for (auto* names : {&observations, &navigation, &logs}) std::ranges::sort(*names);
    const bool only_logs = observations.empty();
    if (observations.size() > 1)
        std::ranges::stable_sort(observations, std::greater<>{},
                                 [&](const std::string& name) { return rover_points(beside / name); });
    observations.insert(observations.end(), logs.begin(), logs.end());
    if (!folder) {
        const std::string own = path.filename().string();
        if (std::ranges::find(observations, own) == observations.end()) return {};
        observations = {own};
    }
    const bool complete = !observations.empty() && std::ranges::find(logs, observations.front()) != logs.end();
    if (observations.empty() || (navigation.empty() && !complete)) return {};
    if (!alone && points_by_name(observations.front()) < 0) return {};  // a station does not move with the IMU
    RawObservations out;
    const auto fact = [&](const char* key, FactValue value) {
        Fact& f = out.facts.emplace_back();
        f.key = key;
        f.value = std::move(value);
    };
    const std::vector<std::string> parts = with_parts(beside, observations);
    std::erase_if(observations, [&](const std::string& name) { return std::ranges::find(parts, name) != parts.end(); });
    const FactValue value = parts.size() == 1 ? FactValue(parts.front()) : FactValue(parts);
    fact("gnss.observations", value);
    out.files.observations = parts;
    out.files.navigation = navigation;
    out.dataset_toml = fmt::format("# Inferred from the {} files.\n[gnss]\nobservations = {}\n",
                                   only_logs && navigation.empty() ? "receiver's" : "RINEX", to_text(value));
    for (const std::string& other : observations) out.dataset_toml += fmt::format("# or observations = {}\n", toml_text(other));
    if (!navigation.empty()) {
        fact("gnss.navigation", navigation);
        out.dataset_toml += fmt::format("navigation = {}\n", to_text(navigation));
    }
    if (alone) {
        fact("filter.scheme", std::string("gnss"));
        out.dataset_toml += "[filter]\nscheme = \"gnss\"\n";
    }
    if (!observations.empty())  // only the user knows which of them were static at a known point
        out.dataset_toml += fmt::format(
            "# Positions from carrier phases, if this is a base station's log of the same hours:\n# [base]\n# observations = {}\n",
            toml_text(observations.back()));
    return out;
}

inspect::ComputedFixes computed_fixes(const fs::path& folder, const RawGnssConfig& raw) {
    WarningLog unheard;  // whoever loads them warns
    try {
        return {raw.observations.front(), fixes_from_raw(folder, raw, unheard)};
    } catch (const Error&) {
        return {};
    }
}

}  // namespace schuler::dataset
