// The sections of a run's report, one function each; an empty section (no groups) is omitted by the caller.
#pragma once

#include "schuler/report/run_report.h"

namespace schuler::report::detail {

inline constexpr const char* time_label = "time, s";

[[nodiscard]] inline double axis_seconds(const RunReportData& data, Time t) { return (t - data.zero).seconds(); }

/// Inserts entries without values where the time (of the map's points, or x) jumps by far more than its usual step: a straight
/// line across a gap would not represent measurements.
void break_at_gaps(Series& series);
void break_at_gaps(Band& band);

/// A panel over the common time with marked outages (and, with start_up, the time before errors are evaluated).
[[nodiscard]] Panel time_panel(const RunReportData& data, std::string title, std::string y_label, bool start_up = false);

[[nodiscard]] Section track_section(const RunReportData& data);
[[nodiscard]] Section check_section(const RunReportData& data);
[[nodiscard]] Section health_section(const RunReportData& data);
[[nodiscard]] Section error_section(const RunReportData& data);
[[nodiscard]] Section separation_section(const RunReportData& data);
[[nodiscard]] Section uncertainty_section(const RunReportData& data);
[[nodiscard]] Section outage_section(const RunReportData& data);
[[nodiscard]] Section innovation_section(const RunReportData& data);
[[nodiscard]] Section sensor_section(const RunReportData& data);
[[nodiscard]] Section motion_section(const RunReportData& data);

}  // namespace schuler::report::detail
