// Output files specific to couplings by ranges.
#include "schuler/core/units.h"
#include "schuler/solution/bundle.h"

#include <fmt/format.h>

namespace schuler::report {

std::string protection_csv(const solution::ResultBundle& b) {
    std::string text = "time_s,hpl_m,vpl_m,used,excluded,alarm\n";
    for (const fusion::ProtectionRow& r : b.result.forward.protection) {
        const std::string alarm =
            r.alarm < 0 ? std::string() : b.data.recording.ranges.sources[static_cast<std::size_t>(r.alarm)].name;
        text +=
            fmt::format("{:.9f},{:.4f},{:.4f},{},{},{}\n", r.time.seconds(), r.horizontal, r.vertical, r.used, r.excluded, alarm);
    }
    return text;
}

std::string ambiguities_csv(const solution::ResultBundle& b) {
    std::string text = "time_s,phases,slipped,ambiguities,held,ratio,doubted\n";
    for (const fusion::CarrierRow& r : b.result.forward.carriers)
        text += fmt::format("{:.9f},{},{},{},{},{:.2f},{:d}\n", r.time.seconds(), r.phases, r.slipped, r.ambiguities, r.held,
                            r.ratio, r.doubted);
    return text;
}

std::string receiver_csv(const solution::ResultBundle& b) {
    std::string text =
        "time_s,lat_deg,lon_deg,height_m,vel_n_m_s,vel_e_m_s,vel_d_m_s,std_n_m,std_e_m,std_d_m,difference_n_m,difference_e_m,"
        "difference_d_m,sigma_n_m,sigma_e_m,sigma_d_m,agrees,receiver_leads\n";
    const fusion::Result& r = b.result;
    for (std::size_t i = 0; i < std::min(r.receiver.rows.size(), r.cross_checks.size()); ++i) {
        const SolutionRow& s = r.receiver.rows[i];
        const fusion::CrossCheck& c = r.cross_checks[i];
        text += fmt::format("{:.9f},{:.10f},{:.10f},{:.4f}", s.time.seconds(), s.position.lat / units::deg,
                            s.position.lon / units::deg, s.position.h);
        for (const Eigen::Vector3d& v : {s.v_eb_n, s.std_position, c.difference, c.sigma})
            text += fmt::format(",{:.5f},{:.5f},{:.5f}", v.x(), v.y(), v.z());
        text += fmt::format(",{:d},{:d}\n", c.agrees, c.receiver_leads);
    }
    return text;
}

}  // namespace schuler::report
