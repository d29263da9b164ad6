#include "schuler/theory/requirements.h"
#include "schuler/core/units.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outcome.h"
#include "schuler/report/result_table.h"
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
    report::ResultTable rows{fmt::format("sensors for {} m of position error, each alone", short_number(request.budget)),
                             {{"outage_s", "outage", "s", ".6g"},
                              {"accel_m_s2", "accelerometer", "m/s2", ".6g"},
                              {"accel_ug", "accelerometer", "ug", ".6g"},
                              {"gyro_deg_h", "gyro", "deg/h", ".6g"}}},
        devices{"outage after which a device, started perfectly and calibrated, has used the budget (one sigma an axis)",
                {{"device", "device"}, {"outage_s", "outage", "s"}}};
    with_option_names([&] {
        for (const double t : outages) {
            const theory::Requirement r = theory::requirement(pendulum, request.budget, t);
            rows.rows.push_back({t, r.accel, r.accel / units::ug, r.gyro / units::deg_per_hour});
        }
        return 0;
    });
    std::vector<std::string> names = request.devices;
    if (names.empty())
        for (const std::string_view name : sensor::imu_grade_names())
            if (name != "perfect") names.emplace_back(name);
    for (const std::string& name : names) {
        const sensor::ImuErrorModel m = sensor::imu_grade(name);  // its turn-on errors are assumed calibrated
        const double t =
            theory::longest_outage(pendulum, {m.accel_bias, m.gyro_bias, m.accel_noise, m.gyro_noise}, request.budget);
        devices.rows.push_back({name, t});
    }
    report::Outcome out;
    out.tables = report::table_text(rows) + "\n" + report::table_text(devices);
    out.json = report::text_of(
        report::Json{{"budget_m", request.budget}, {"rows", report::table_json(rows)}, {"devices", report::table_json(devices)}});
    return out;
}

}  // namespace schuler::study
