#include "schuler/theory/requirements.h"
#include "schuler/core/units.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outcome.h"
#include "schuler/sensor/grades.h"
#include "schuler/study/parts.h"
#include "schuler/study/studies.h"

#include <fmt/format.h>

#include <algorithm>

namespace schuler::study {

report::Outcome analyze_requirements(const RequirementsRequest& request) {
    const theory::Pendulum pendulum;
    const std::vector<double> outages =
        request.outages.empty() ? std::vector<double>{10, 30, 60, 100, 300, 600, 1800, 3600} : request.outages;
    report::Json rows = report::Json::array(), devices = report::Json::array();
    report::Outcome out;
    out.tables = fmt::format("sensors for {} m of position error, each alone\n", short_number(request.budget)) +
                 table_line("  outage, s", 14, {"accel., m/s2", "accel., ug", "gyro, deg/h"}, 16);
    with_option_names([&] {
        for (const double t : outages) {
            const theory::Requirement r = theory::requirement(pendulum, request.budget, t);
            rows.push_back({{"outage_s", t},
                            {"accel_m_s2", r.accel},
                            {"accel_ug", r.accel / units::ug},
                            {"gyro_deg_h", r.gyro / units::deg_per_hour}});
            out.tables += table_line(
                "  " + short_number(t), 14,
                {short_number(r.accel), short_number(r.accel / units::ug), short_number(r.gyro / units::deg_per_hour)}, 16);
        }
        return 0;
    });
    std::vector<std::string> names = request.devices;
    if (names.empty())
        for (const std::string_view name : sensor::imu_grade_names())
            if (name != "perfect") names.emplace_back(name);
    out.tables += "\noutage after which a device, started perfectly and calibrated, has used the budget (one sigma an axis)\n";
    for (const std::string& name : names) {
        const sensor::ImuErrorModel m = sensor::imu_grade(name);  // its turn-on parts are calibrated away
        const double t =
            theory::longest_outage(pendulum, {m.accel_bias, m.gyro_bias, m.accel_noise, m.gyro_noise}, request.budget);
        devices.push_back({{"device", name}, {"outage_s", t}});
        out.tables += table_line("  " + name, 20, {short_number(t, 4) + " s"}, 14);
    }
    out.json = report::text_of(report::Json{{"budget_m", request.budget}, {"rows", rows}, {"devices", devices}});
    return out;
}

}  // namespace schuler::study
