#include "schuler/solution/gnss_only.h"

#include "schuler/core/error.h"

#include <cmath>

namespace schuler::solution {
namespace {

/// The log's sigma, or the default if it has none.
Eigen::Vector3d sigma_or(const Eigen::Vector3d& logged, const Eigen::Vector3d& otherwise) {
    Eigen::Vector3d out = otherwise;
    for (int i = 0; i < 3; ++i) {
        if (logged[i] > 0.0) out[i] = logged[i];
    }
    return out;
}

}  // namespace

fusion::Result gnss_solution(const Recording& recording, const fusion::Settings& s) {
    if (recording.gnss.empty())
        throw input_error("there are no GNSS fixes", {{}, 0, 0, "gnss.file"},
                          "name the GNSS log in [gnss] file, or choose --scheme loose");
    fusion::Result out;
    const Time origin = recording.gnss.front().time;
    Time last{INT64_MIN};
    out.counters.imu_epochs = recording.imu.size();
    for (const GnssFix& f : recording.gnss) {
        if ((s.start && f.time < *s.start) || (s.stop && f.time > *s.stop) || !std::isfinite(f.position.lat)) continue;
        ++out.counters.gnss_epochs;
        const Time valid = f.time - Duration::from_seconds(s.gnss.latency + f.position_age);
        if (filter::is_withheld(s.outages, (f.time - origin).seconds())) {
            ++out.counters.gnss_withheld;
            continue;
        }
        if (valid <= last) continue;
        last = valid;
        ++out.counters.gnss_accepted;
        out.forward.rows.push_back({valid, f.position, f.velocity_n, not_given3(),
                                    sigma_or(f.std_position, s.gnss.default_std_position),
                                    sigma_or(f.std_velocity, s.gnss.default_std_velocity), not_given3()});
    }
    out.findings.aligned_at = origin;
    out.findings.alignment = "the receiver's own solution, without inertial data";
    return out;
}

}  // namespace schuler::solution
