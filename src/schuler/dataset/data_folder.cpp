#include "schuler/dataset/data_folder.h"

#include "schuler/dataset/description.h"

#include <cstdio>
#include <cstdlib>

namespace schuler::dataset {

namespace fs = std::filesystem;

fs::path magnetic_model_folder() {
    std::vector<fs::path> places;
    if (const char* named = std::getenv("SCHULER_DATA_DIR")) places.emplace_back(named);
    std::error_code ec;
    const fs::path program = fs::read_symlink("/proc/self/exe", ec).parent_path();
    if (!ec) {
        places.push_back(program / "../share/schuler");
        places.push_back(program / "../../data");
        places.push_back(program / "../data");
    }
    for (const fs::path& place : places) {
        if (fs::exists(place / "wmm2025.wmm.cof", ec)) return place;
    }
    return {};
}

double decimal_year_of(const TimeConfig& time, Time stamp) {
    const double first = stamp.seconds();
    constexpr double dated = 1e8, days_a_year = 365.25, day = 86'400.0;
    Calendar c{0, 1, 1, 0, 0, 0.0};
    if (!time.date.empty()) {
        if (std::sscanf(time.date.c_str(), "%d-%d-%d", &c.year, &c.month, &c.day) != 3) return not_given;
    } else if (time.week) {
        c = utc_from_gps(Time::from_gps(*time.week, first));
    } else if (first > dated && (time.scale == TimeScale::Gps || time.scale == TimeScale::Utc)) {
        const bool since_1970 = time.scale == TimeScale::Utc && first > 1e9;
        c = utc_from_gps(Time::from_seconds(since_1970 ? first - static_cast<double>(unix_time_of_gps_epoch) : first));
    } else {
        return not_given;
    }
    const Calendar new_year{c.year, 1, 1, 0, 0, 0.0};
    return c.year + (gps_from_calendar(c) - gps_from_calendar(new_year)).seconds() / (days_a_year * day);
}

}  // namespace schuler::dataset
