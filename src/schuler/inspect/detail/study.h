// What the judges of one data set share: the files chosen, the series made of them, and what has been found so far.
#pragma once

#include "schuler/inspect/detail/draft.h"
#include "schuler/inspect/detail/loaded_file.h"
#include "schuler/inspect/detail/motion.h"
#include "schuler/inspect/detail/motion_fit.h"
#include "schuler/inspect/detail/mounting.h"
#include "schuler/inspect/detail/still.h"
#include "schuler/inspect/detail/units_by_value.h"
#include "schuler/inspect/inspect.h"

#include <optional>
#include <vector>

namespace schuler::inspect::detail {

struct Study {
    Given given;
    std::vector<LoadedFile> files;
    LoadedFile* imu_file = nullptr;  ///< point into `files`; null where there is none
    LoadedFile* gnss_file = nullptr;
    LoadedFile* baro_file = nullptr;
    LoadedFile* mag_file = nullptr;
    LoadedFile* reference_file = nullptr;

    Time origin;  ///< of the series' seconds
    ImuSeries imu;
    GnssSeries gnss;
    std::vector<ReferenceSample> reference;
    double imu_shift = 0.0;    ///< s that were added to the IMU's times to meet the GNSS (whole weeks)
    double clock_shift = 0.0;  ///< s added beyond that, by motion
    double clock_sigma = 0.0;  ///< s; 0 of a shift that clocks are known to make
    std::string clock_evidence;
    double clock_drift = 0.0;  ///< ppm by which the IMU's clock runs fast; taken out of `imu`
    double clock_drift_sigma = 0.0;
    std::vector<ClockStep> clock_steps;  ///< taken out of `imu` and `gnss`
    std::optional<Refusal> refusal;
    std::vector<std::string> doubts;  ///< what was taken otherwise than written
    double gravity = 9.80665;         ///< m/s^2, local where the position is known
    bool overlap = false;             ///< IMU and GNSS have at least 10 s in common

    StillPeriods still;
    MotionFit velocity_fit, position_fit;
    Agreement velocity_behind_position, down_velocity_behind_height;
    CourseSlope course;
    std::string vehicle;  ///< "car", "air", "hand", "static"
    std::vector<UnitChange> imu_units, gnss_units, baro_units, mag_units;
    Travel travel;
    Mounting mounting;
    bool forward_supposed = false;  ///< of a vehicle that travels, and neither the files nor the filter can show it
    double velocity_age = 0.0, position_age = 0.0;  ///< medians of what the log's own columns state, s
    bool states_velocity_age = false, states_position_age = false;

    std::vector<Finding> findings;
    std::vector<Problem> problems;
    std::vector<Contradiction> contradictions;
    std::vector<Fact> stated;  ///< what the files say beside the settings of the draft
    Draft draft;

    void found(std::string key, std::string value, double confidence, std::string why);
    void problem(Level level, std::string text, std::string hint = {});
    void states(std::string key, FactValue value, std::string note, Known how = Known::File);
    void contradicts(std::string key, std::string text);
    /// Refuted beyond doubt: `better` is used, or what is used where nothing is given.
    void refutes(std::string key, std::string text, std::optional<FactValue> better, double sigma = not_given);
    /// Whether the loader brings the dated fixes of a described data set to the axis of its other logs, instead of them to the fixes.
    [[nodiscard]] bool dated_fixes_move() const { return !given.find_logs && gnss_file != nullptr && gnss_file->gps_time; }
    [[nodiscard]] double confidence_in(const std::string& key) const;
};

/// Each judge reads the study, adds findings, problems and lines of the draft. Order as listed.
void judge_time(Study& study);         ///< scale, overlap, series
void judge_clock_steps(Study& study);  ///< steps of one clock within its log; nothing without time in common, or done before
void judge_clock(Study& study);        ///< shifts the IMU's series where the motion shows it
void study_motion(Study& study);       ///< gyro unit, rest, fits, travel, mounting: what the others read
void judge_vehicle(Study& study);      ///< rest, kind
void judge_imu(Study& study);          ///< axes, mounting, noise, saturation
void judge_gnss(Study& study);         ///< fixes, sigmas, height, outliers
void judge_latency(Study& study);
void judge_baro(Study& study);
void judge_mag(Study& study);
void judge_reference(Study& study);

/// Exchanges latitude and longitude where the velocities say that they are. Before the series are made.
void judge_coordinates(Study& study);
/// Turns gyros round whose signs do not belong to the accelerometers' axes, after the fit to the track. True where it did.
bool judge_gyro_signs(Study& study);
/// Turns one accelerometer round where the force of turns is felt to the wrong side, or nothing fits, and it then does: axes of a mirror, which no
/// turn of gyros mends. Likewise; before the gyros.
bool judge_accel_signs(Study& study);

/// How much of the sideways acceleration of turns, speed times turn rate, the unit feels as sideways force: 1 on wheels, 0 where the
/// vehicle banks into its turns. Not a number where it hardly turns, or does not travel.
[[nodiscard]] double felt_in_turns(const Study& study);

/// Whether a fit shows the lag of the GNSS behind the IMU.
[[nodiscard]] bool shows_lag(const MotionFit& fit);

/// The columns and scale lines of a section, where names or units need saying.
void draft_columns(Study& study, const std::string& section, const LoadedFile& file, const std::vector<UnitChange>& units);

}  // namespace schuler::inspect::detail
