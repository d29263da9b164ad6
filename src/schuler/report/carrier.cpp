#include "schuler/report/carrier.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/io/solution/solution_csv.h"

#include <fmt/format.h>

#include <iterator>

namespace schuler::report {

int quality_number(ppk::Quality quality) { return static_cast<int>(quality); }

std::string carrier_csv(const dataset::CarrierPhase& solution) {
    std::string text = "time_s,q,satellites,ambiguities,fixed,ratio,success_rate,age_s,rejected,north_m,east_m,up_m\n";
    const Geodetic base = earth::geodetic_from_ecef(earth::wgs84, solution.base);
    const Eigen::Matrix3d C_ne = earth::C_en(base.lat, base.lon).transpose();
    for (std::size_t i = 0; i < solution.epochs.size(); ++i) {
        const ppk::EpochSolution& e = solution.epochs[i];
        const Eigen::Vector3d d = C_ne * (e.position.r - solution.base.r);
        fmt::format_to(std::back_inserter(text), "{:.9f},{},{},{},{},{:.1f},{:.6f},{:.3f},{},{:.4f},{:.4f},{:.4f}\n",
                       solution.fixes[i].time.seconds(), quality_number(e.quality), e.satellites, e.ambiguities, e.fixed, e.ratio,
                       e.success, e.age, e.rejected, d.x(), d.y(), -d.z());
    }
    return text;
}

std::string solution_csv_with_quality(std::span<const SolutionRow> rows, const dataset::CarrierPhase& solution, double latency) {
    std::string text = fmt::format("{},q,satellites\n", io::solution_csv_header());
    std::size_t k = 0;
    for (const SolutionRow& row : rows) {
        const Time of_fix = row.time + Duration::from_seconds(latency);
        while (k < solution.fixes.size() && solution.fixes[k].time < of_fix) ++k;
        text += io::solution_csv_row(row);
        if (k < solution.fixes.size() && solution.fixes[k].time == of_fix)
            fmt::format_to(std::back_inserter(text), ",{},{}\n", quality_number(solution.epochs[k].quality),
                           solution.epochs[k].satellites);
        else text += ",,\n";
    }
    return text;
}

}  // namespace schuler::report
