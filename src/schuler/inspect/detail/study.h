// Data shared by the judge functions of one data set: the selected files, their series, and the findings so far.
#pragma once

#include "schuler/inspect/detail/draft.h"
#include "schuler/inspect/detail/loaded_file.h"
#include "schuler/inspect/detail/motion/motion.h"
#include "schuler/inspect/detail/motion/motion_fit.h"
#include "schuler/inspect/detail/motion/mounting.h"
#include "schuler/inspect/detail/motion/still.h"
#include "schuler/inspect/detail/units_by_value.h"
#include "schuler/inspect/inspect.h"

#include <optional>
#include <vector>

namespace schuler::inspect::detail {

struct Study {
    Given given;
    std::vector<LoadedFile> files;
    LoadedFile* imu_file = nullptr;  ///< pointers into `files`; null if absent
    LoadedFile* gnss_file = nullptr;
    LoadedFile* baro_file = nullptr;
    LoadedFile* mag_file = nullptr;
    LoadedFile* reference_file = nullptr;

    Time origin;  ///< of the seconds in the series
    ImuSeries imu;
    GnssSeries gnss;
    std::vector<ReferenceSample> reference;
    double imu_shift = 0.0;    ///< s added to the IMU's times to match the GNSS (whole weeks)
    double clock_shift = 0.0;  ///< additional s, from the motion
    double clock_sigma = 0.0;  ///< s; 0 for a known shift between clocks
    std::string clock_evidence;
    double clock_drift = 0.0;  ///< ppm by which the IMU's clock runs fast; removed from `imu`
    double clock_drift_sigma = 0.0;
    std::vector<ClockStep> clock_steps;  ///< removed from `imu` and `gnss`
    std::optional<Refusal> refusal;
    std::vector<std::string> doubts;  ///< data interpreted differently from their description
    double gravity = 9.80665;         ///< m/s^2, local if the position is known
    bool overlap = false;             ///< IMU and GNSS overlap by at least 10 s

    StillPeriods still;
    MotionFit velocity_fit, position_fit;
    Agreement velocity_behind_position, down_velocity_behind_height;
    CourseSlope course;
    std::string vehicle;  ///< "car", "air", "ship", "hand", "static"
    std::vector<UnitChange> imu_units, gnss_units, baro_units, mag_units;
    Travel travel;
    Mounting mounting;
    bool forward_supposed = false;  ///< the vehicle travels, but neither the files nor the filter can determine forward
    double velocity_age = 0.0, position_age = 0.0;  ///< medians of the values in the log's own columns, s
    bool idle_velocity = false;                     ///< the log's velocities were always zero: removed
    std::string velocity_left_out;  ///< why the log's velocities are not used, if they disagree with the positions
    bool states_velocity_age = false, states_position_age = false;

    std::vector<Finding> findings;
    std::vector<Problem> problems;
    std::vector<Contradiction> contradictions;
    std::vector<Fact> stated;  ///< statements of the files other than the settings of the draft
    Draft draft;

    void found(std::string key, std::string value, double confidence, std::string why);
    void problem(Level level, std::string text, std::string hint = {});
    void states(std::string key, FactValue value, std::string note, Known how = Known::File);
    void contradicts(std::string key, std::string text);
    /// Refuted beyond doubt: `better` is used, or without it the result for a setting that is not given.
    void refutes(std::string key, std::string text, std::optional<FactValue> better, double sigma = not_given);
    /// True if the loader converts the dated fixes of a described data set to the axis of its other logs, rather than vice versa.
    [[nodiscard]] bool dated_fixes_move() const { return !given.find_logs && gnss_file != nullptr && gnss_file->gps_time; }
    [[nodiscard]] double confidence_in(const std::string& key) const;
};

/// Each judge reads the study and adds findings, problems and lines of the draft. Called in the order listed.
void judge_time(Study& study);         ///< scale, overlap, series
void judge_clock_steps(Study& study);  ///< clock steps within one log; no effect without common time, or if already done
void judge_clock(Study& study);        ///< shifts the IMU's series as determined from the motion
void study_motion(Study& study);       ///< gyro unit, rest, fits, travel, mounting: input of the others
void judge_vehicle(Study& study);      ///< rest, kind
void judge_imu(Study& study);          ///< axes, mounting, noise, saturation
void judge_gnss(Study& study);         ///< fixes, sigmas, height, outliers
void judge_latency(Study& study);
/// Offset and drift of the clock of the IMU and of the logs that share it.
void draft_clock(Study& study);
void judge_baro(Study& study);
void judge_mag(Study& study);
void judge_reference(Study& study);

/// The rows of a GNSS log in order of time, without the zeros that receivers write before their first fix; rad, m, m/s.
[[nodiscard]] std::vector<GnssFix> gnss_fixes(const LoadedFile& file);
/// Removes velocities of a GNSS log that are always zero while it travels. Called before the series are formed.
void judge_idle_velocity(Study& study);
/// Determines unit, order and signs of the velocities from the displacement of the positions; removes them if nothing makes the two
/// agree. A vehicle that hardly travels shows nothing. Called before the series are formed.
void judge_velocity(Study& study);
/// The velocities of the GNSS log are used neither by the studies nor by the run, unless a setting requires it.
void leave_out_velocities(Study& study, const std::string& why);
/// Exchanges latitude and longitude if the velocities show that they are swapped. Called before the series are formed.
void judge_coordinates(Study& study);
/// Reverses gyros whose signs are inconsistent with the accelerometers' axes, after the fit to the track. True if it did.
bool judge_gyro_signs(Study& study);
/// Reverses one accelerometer or all, or exchanges their columns, if no fit is possible or the force of turns has the wrong sign, and that
/// resolves it: mirrored axes, which no reversal of gyros can correct. Same result; called before the gyros.
bool judge_accelerometers(Study& study);

/// Fraction of the lateral acceleration in turns, speed times turn rate, that the unit measures as lateral force: 1 on wheels, 0
/// for a vehicle that banks in turns. NaN if it hardly turns, or does not travel.
[[nodiscard]] double felt_in_turns(const Study& study);

/// True if a fit determines the lag of the GNSS behind the IMU.
[[nodiscard]] bool shows_lag(const Agreement& a);
[[nodiscard]] bool shows_lag(const MotionFit& fit);

/// The line of the further parts of a log, if it has some.
void draft_parts(Study& study, const std::string& section, const LoadedFile& file);
/// The columns and scale lines of a section, if names or units must be stated.
void draft_columns(Study& study, const std::string& section, const LoadedFile& file, const std::vector<UnitChange>& units);

}  // namespace schuler::inspect::detail
