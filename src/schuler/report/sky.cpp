#include "schuler/report/sky.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/solution/bundle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace schuler::report {
namespace {

/// The pseudoranges of an epoch as processed by the filter; records of an epoch have its time as stamp.
const fusion::MeasurementRecord* record_of(std::span<const fusion::MeasurementRecord> all, Time epoch, int source) {
    const auto first = std::ranges::lower_bound(all, epoch, {}, &fusion::MeasurementRecord::stamp);
    for (auto it = first; it != all.end() && it->stamp == epoch; ++it)
        if (it->source == source) return &*it;
    return nullptr;
}

}  // namespace

std::vector<SkyRow> sky_rows(const solution::ResultBundle& b) {
    const RangingLog& log = b.data.recording.ranges;
    const std::vector<SolutionRow>& rows = b.solution().rows;
    if (log.empty() || rows.empty()) return {};
    std::vector<fusion::MeasurementRecord> ranges;
    std::ranges::copy_if(b.result.measurements, std::back_inserter(ranges),
                         [](const fusion::MeasurementRecord& r) { return r.kind == fusion::MeasurementKind::Pseudorange; });
    std::ranges::stable_sort(ranges, {}, &fusion::MeasurementRecord::stamp);
    const earth::Earth& earth = b.data.config.filter.earth;
    const std::size_t stride = (log.epochs.size() + most_sky_epochs - 1) / most_sky_epochs;
    std::vector<SkyRow> out;
    for (std::size_t i = 0; i < log.epochs.size(); i += stride) {
        const RangeEpoch& epoch = log.epochs[i];
        auto at = std::ranges::lower_bound(rows, epoch.time, {}, &SolutionRow::time);
        if (at == rows.end()) --at;
        const Eigen::Vector3d here = earth::ecef_from_geodetic(earth.ellipsoid, at->position).r;
        const Eigen::Matrix3d C_ne = earth::C_en(at->position.lat, at->position.lon).transpose();
        for (const RangeSample& m : log.of(epoch)) {
            if (!m.tx.r.allFinite()) continue;
            const Eigen::Vector3d line_n = (C_ne * (m.tx.r - here)).normalized();
            SkyRow row;
            row.time = epoch.time;
            row.source = m.source;
            row.station = log.sources[m.source].station;
            row.azimuth = std::fmod(std::atan2(line_n.y(), line_n.x()) + 2.0 * std::numbers::pi, 2.0 * std::numbers::pi);
            row.elevation = std::asin(-line_n.z());
            if (const fusion::MeasurementRecord* r = record_of(ranges, epoch.time, m.source)) {
                row.use = r->status == fusion::MeasurementStatus::Accepted ? RangeUse::Used : RangeUse::Rejected;
                row.residual = r->innovation.x();
                row.sigma = r->sigma.x();
            }
            out.push_back(row);
        }
    }
    return out;
}

}  // namespace schuler::report
