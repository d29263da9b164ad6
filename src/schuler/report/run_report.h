// Presentation of a navigation run for review: the panels and tables of report.html from plain results.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/core/samples.h"
#include "schuler/report/report.h"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace schuler::report {

/// Estimate minus reference at a reference epoch with the filter's one sigma. NaN members are absent. rpy errors lie in +-pi.
struct ErrorPoint {
    Time time;
    Eigen::Vector3d position = not_given3();  ///< north, east, down, m
    Eigen::Vector3d velocity = not_given3();  ///< north, east, down, m/s
    Eigen::Vector3d rpy = not_given3();       ///< roll, pitch, heading, rad
    Eigen::Vector3d std_position = not_given3();
    Eigen::Vector3d std_velocity = not_given3();
    Eigen::Vector3d std_rpy = not_given3();
};

enum class InnovationStatus { Accepted, Rejected, Withheld };

/// One measurement epoch: estimate minus measured before its own update. NaN components are unused. SI units.
struct InnovationPoint {
    Time time;
    InnovationStatus status = InnovationStatus::Accepted;
    int dof = 0;  ///< number of components in nis
    Eigen::Vector3d innovation = not_given3();
    Eigen::Vector3d sigma = not_given3();  ///< predicted one sigma of the innovation
    double nis = not_given;                ///< normalised innovation squared
};

/// All epochs of one kind of measurement.
struct InnovationGroup {
    std::string name;                     ///< "GNSS position"
    std::string unit;                     ///< of the plots: "m"
    double unit_si = 1.0;                 ///< size of that unit in SI (core/units.h)
    std::vector<std::string> components;  ///< at most three: "north", "east", "down"
    std::vector<InnovationPoint> points;
    double lag1 = not_given;  ///< lag-1 autocorrelation of the normalised innovations
};

/// Estimated sensor errors, body axes, with one sigma; SI units. Scale factors are shown if a sigma is above zero.
struct SensorErrorPoint {
    Time time;
    Eigen::Vector3d gyro_bias = not_given3(), std_gyro_bias = not_given3();      ///< rad/s
    Eigen::Vector3d accel_bias = not_given3(), std_accel_bias = not_given3();    ///< m/s^2
    Eigen::Vector3d gyro_scale = not_given3(), std_gyro_scale = not_given3();    ///< 1
    Eigen::Vector3d accel_scale = not_given3(), std_accel_scale = not_given3();  ///< 1
};

/// One GNSS outage and the errors of the solution in it, m.
struct OutageEntry {
    double start_s = 0.0, duration_s = 0.0;  ///< start on the report's time axis
    double end_horizontal = not_given, max_horizontal = not_given, end_vertical = not_given, max_3d = not_given;
    bool compared = false;                   ///< a comparison was available: inside_3sigma is valid
    bool inside_3sigma = false;              ///< north and east at every epoch
    std::vector<double> into_s, horizontal;  ///< horizontal error against the time since the outage began (may be empty)
};

/// Growth of errors since fixes were withheld, RMS over windows, m, and its stated sigma.
struct GrowthCurve {
    std::string name;
    std::vector<double> since_s, error, sigma;
};

/// An interval in which a source was in one state ("used", "refused", "silent", ...), on the report's time axis.
struct HealthEntry {
    std::string source, state;
    double from_s = 0.0, to_s = 0.0;
};

/// Results from fixes withheld by the program itself.
struct CheckEntry {
    std::string intro;
    std::vector<GrowthCurve> growth;
    std::vector<TableBlock> tables;
};

/// A line of the table of errors. unit as printed; values in that unit. "position horizontal", "position up" and "heading" also
/// appear as cards at the top of the page.
struct AccuracyEntry {
    std::string quantity, unit;
    double rms = not_given, p95 = not_given, max = not_given;
};

struct RunReportData {
    std::string title, subtitle, version;
    std::vector<Card> cards;       ///< additional ones, after those formed here from the accuracy and outages
    Time zero;                     ///< instant of 0 s on the time axes
    double settled_after_s = 0.0;  ///< errors are evaluated from here, on the report's axis; shaded before

    bool smoothed = false;  ///< `solution` and `errors` are those of the smoother
    std::vector<SolutionRow> solution;
    std::vector<GnssFix> gnss;  ///< at the antenna
    std::vector<ReferenceSample> reference;
    std::string reference_name;  ///< "truth", "reference file", "withheld GNSS"
    /// North-east-down of a position in the local-level frame at the map's origin, from the earth room. Without it: no map.
    std::function<Ned(const Geodetic&)> local;

    std::vector<ErrorPoint> errors;          ///< of `solution`
    std::vector<ErrorPoint> forward_errors;  ///< of the filter before smoothing, drawn thin; empty unless smoothed
    std::vector<ErrorPoint> separation;      ///< forward minus backward filter with its sigma; may be empty
    std::vector<AccuracyEntry> accuracy;
    std::vector<InnovationGroup> innovations;  ///< of the forward pass
    std::vector<SensorErrorPoint> sensor_errors;
    std::vector<SensorErrorPoint> sensor_truth;  ///< simulations: the true errors (sigmas not used)
    std::vector<OutageEntry> outages;
    std::string verdict;               ///< "trustworthy", ...: the first card; empty: none
    std::vector<std::string> reasons;  ///< for the verdict, the most severe first
    CheckEntry check;
    std::vector<HealthEntry> health;                            ///< in order of source and time
    std::vector<std::pair<std::string, std::string>> findings;  ///< results of start-up: (quantity, value)
    std::vector<std::string> warnings;
    std::string settings;  ///< config.toml
};

/// The page's content in order of review: track, verdict and self-check, health of the sources, errors (or the uncertainty if there is no reference),
/// separation of the filters forward and backward in time, outages, innovations, sensor errors, motion, findings. Parts not given are omitted.
[[nodiscard]] ReportInput run_report(const RunReportData& data);

}  // namespace schuler::report
