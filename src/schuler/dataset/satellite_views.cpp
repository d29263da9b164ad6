#include "schuler/dataset/satellite_views.h"

#include "schuler/core/error.h"
#include "schuler/dataset/ranges.h"
#include "schuler/dataset/raw_gnss.h"
#include "schuler/gnss/sampled_ranges.h"

#include <algorithm>
#include <utility>

namespace schuler::dataset {
namespace {

namespace fs = std::filesystem;

/// Selection of the epochs.
class Chosen {
public:
    Chosen(const ViewSpan& span, Time first) {
        if (span.start) from_ = first + Duration::from_seconds(*span.start);
        if (span.stop) to_ = first + Duration::from_seconds(*span.stop);
    }
    [[nodiscard]] bool has(Time t) const { return (!from_ || t >= *from_) && (!to_ || t <= *to_); }

private:
    std::optional<Time> from_, to_;
};

void look_at_raw(const fs::path& folder, const Description& d, const ViewSpan& span, double missed_detection,
                 const std::function<void(double)>& progress, SatelliteViews& out, WarningLog& warnings) {
    const auto [navigation, logs] = read_raw_logs(folder, d.raw, warnings);
    const auto source = satellites(folder, d.raw, navigation, warnings);
    const gnss::BroadcastIonosphere ionosphere = gnss::broadcast_ionosphere(navigation);
    warn_of_missing_ionosphere(ionosphere, d.raw, warnings);
    gnss::EpochViewer viewer(*source, ionosphere, d.raw.solver, missed_detection);
    std::size_t all = 0, done = 0;
    std::optional<Time> first;
    for (const gnss::ObservationLog& log : logs) {
        all += log.epochs.size();
        if (!log.epochs.empty() && (!first || log.epochs.front().time < *first)) first = log.epochs.front().time;
    }
    if (all == 0)
        throw input_error("has no raw measurements", {d.raw.observations.front(), 0, 0, "gnss.observations"},
                          "log RXM-RAWX (u-blox) or MSM4 to MSM7 (RTCM 3), or name a RINEX observation file");
    const Chosen chosen(span, *first);
    for (const gnss::ObservationLog& log : logs) {
        for (const gnss::ObservationEpoch& e : log.epochs) {
            if (chosen.has(e.time)) out.epochs.push_back(viewer.view(log.of(e), e.time, log.channels));
            if (progress && ++done % 64 == 0) progress(static_cast<double>(done) / static_cast<double>(all));
        }
    }
    std::ranges::stable_sort(out.epochs, {}, &gnss::EpochView::tag);
}

void look_at_table(const fs::path& folder, const Description& d, const ViewSpan& span, double missed_detection,
                   SatelliteViews& out, WarningLog& warnings) {
    const RangingLog log = ranges_from_csv(folder, d, warnings);
    gnss::Navigation navigation;  // for the ionosphere; the table contains the satellite positions
    for (const std::string& file : d.raw.navigation) {
        RawGnssConfig one;
        one.navigation = {file};
        navigation.add(read_raw_logs(folder, one, warnings).navigation);
    }
    const gnss::BroadcastSource nobody{gnss::Navigation{}};
    const auto ionosphere = navigation.size() > 0 ? std::optional(gnss::broadcast_ionosphere(navigation)) : std::nullopt;
    gnss::EpochViewer viewer(nobody, ionosphere, d.raw.solver, missed_detection);
    const Chosen chosen(span, log.epochs.front().time);
    std::size_t without = 0;
    for (const RangeEpoch& e : log.epochs) {
        if (!chosen.has(e.time)) continue;
        std::vector<gnss::Range> ranges = gnss::satellite_ranges(log, e);
        if (ranges.empty()) {
            ++without;
            continue;
        }
        out.epochs.push_back(viewer.view(std::move(ranges), e.time));
    }
    if (without > 0) warnings.add("gnss.stations_only", "epochs of ranges without a satellite: left out", without);
}

}  // namespace

SatelliteViews satellite_views(const fs::path& folder, const Description& description, const ViewSpan& span,
                               double missed_detection, const std::function<void(double)>& progress, WarningLog& warnings) {
    SatelliteViews out;
    if (!description.raw.observations.empty()) {
        look_at_raw(folder, description, span, missed_detection, progress, out, warnings);
    } else if (!description.ranges.file.empty()) {
        look_at_table(folder, description, span, missed_detection, out, warnings);
    } else {
        throw input_error(
            "there are no raw measurements of satellites", {{}, 0, 0, "gnss.observations"},
            "name a RINEX, UBX or RTCM 3 log in [gnss] observations with its navigation files, or a table of ranges in [stations] file");
    }
    if (out.epochs.empty())
        throw input_error("no epoch with satellites is left", {{}, 0, 0, "gnss.observations"},
                          "give an earlier --start or a later --stop");
    if (description.base.observations.empty()) return out;
    Description viewed = description;
    viewed.base.settings.views = true;
    out.carrier = carrier_phase(folder, viewed, false, warnings);
    const Time from = out.epochs.front().tag - Duration::from_seconds(0.5),
               to = out.epochs.back().tag + Duration::from_seconds(0.5);
    CarrierPhase inside;
    inside.base = out.carrier->base;
    for (std::size_t i = 0; i < out.carrier->epochs.size(); ++i) {
        if (out.carrier->epochs[i].tag < from || out.carrier->epochs[i].tag > to) continue;
        inside.epochs.push_back(std::move(out.carrier->epochs[i]));
        inside.fixes.push_back(out.carrier->fixes[i]);
    }
    out.carrier = std::move(inside);
    return out;
}

}  // namespace schuler::dataset
