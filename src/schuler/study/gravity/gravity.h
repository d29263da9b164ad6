// The gravity disturbance along a track: the command `schuler gravity`.
#pragma once

#include "schuler/filter/states/model.h"
#include "schuler/gravimetry/innovation_runs.h"
#include "schuler/gravimetry/lines.h"
#include "schuler/gravimetry/resolution.h"
#include "schuler/gravimetry/response.h"
#include "schuler/gravimetry/survey_run.h"
#include "schuler/report/outcome.h"
#include "schuler/settings/request.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/loaded_dataset.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace schuler::study {

struct GravityRequest {
    settings::ProcessRequest common;
    int runs = 1;  ///< of a scenario, with consecutive seeds from the first one; 1: one survey with all its files
    int jobs = 0;  ///< number of simultaneous runs, 0: one per core; the result does not depend on it
};

/// Recordings and settings as input of a survey.
struct GravityInput {
    std::unique_ptr<const Recording> recording;  ///< except its IMU: that of `data`
    fusion::RunData data;
    fusion::Settings filter;  ///< gravity27
    fusion::Start start;
    std::vector<Time> steps;              ///< possible changes of the constant part
    gravimetry::SurveySettings settings;  ///< the same assumptions, for covariance analysis
    gravimetry::VerticalMotion motion;    ///< means over the fixes
};

/// Increments, events and the states of gravity27. The start is the given one; otherwise that of the loosely coupled smoother over
/// the same data, whose findings (latencies, noise, mounting) are used. Anomalies in the settings are injected. @throws Error(Input)
[[nodiscard]] GravityInput gravity_input(const solution::LoadedDataset& data, WarningLog& warnings);

/// Attainable accuracy from covariance analysis, and whether it is sufficient.
struct Attainability {
    double vertical = not_given;  ///< sigma of the vertical disturbance at the end, m/s^2
    double horizontal = not_given;
    double prior_vertical = not_given;   ///< before any measurement
    double resolved_period = not_given;  ///< s, full wavelength passed at half its amplitude
    bool usable = false;                 ///< the survey halves the prior sigma, of the level or of the varying part
    std::string statement;               ///< one or two sentences for display
};

/// The fixes compared with the filter's prediction: mean normalised innovation squared per degree of freedom, after settling;
/// near one if the filter's model of its instruments is correct.
struct GravityInnovations {
    double nis = not_given;
    double low = not_given, high = not_given;  ///< 95 % interval for a consistent filter
    std::size_t epochs = 0;
};

/// Difference of the disturbance before and after a possible step. Constant errors of the accelerometers, which mask its level,
/// do not mask a change while the attitude is constant.
struct GravityChange {
    double at = 0.0;                    ///< s after the origin
    Eigen::Vector3d change_n, sigma_n;  ///< north, east, down, m/s^2; errors common to both sides cancel
};

/// Whether the result may be used: evidence of the filter's own fixes, and of a simulated truth.
struct GravityVerdict {
    bool usable = true;
    std::vector<std::string> reasons;  ///< reasons against it
};

/// Forward minus backward filter after settling: north, east, down.
struct GravitySeparation {
    std::size_t epochs = 0;  ///< none without a backward filter
    Eigen::Vector3d rms = not_given3();
    Eigen::Vector3d inside_3sigma = not_given3();  ///< fraction of the epochs
};

/// Errors of the disturbance (estimate minus truth), north, east, down, m/s^2.
struct GravityErrors {
    Eigen::Vector3d rms = not_given3();     ///< of the smoothed (or forward) disturbance after settling
    Eigen::Vector3d spread = not_given3();  ///< the same less its mean: the residual after a crossover adjustment
    Eigen::Vector3d last = not_given3();    ///< at the last fix
};

/// The survey as lines, with the levels that minimise their crossover differences. Values are down, m/s^2. If a simulated anomaly
/// is a function of the track instead of the ground, the crossovers are those of the errors.
struct GravityLines {
    std::vector<gravimetry::SurveyLine> lines;
    std::vector<gravimetry::Crossover> crossings;
    std::vector<gravimetry::RepeatedLine> repeats;
    double rms_before = not_given, rms_after = not_given;  ///< at the crossovers
    double resolved_spread = not_given;  ///< error on the lines less its mean, low-passed at the resolved period; simulated data
    double levelled_spread = not_given;  ///< error of the levelled lines less its mean; simulated data
    std::vector<double> levelled;        ///< at the epochs; NaN off the lines
    std::vector<int> line_of;            ///< index of the line at the epochs; -1 off the lines
};

/// Differentiated fixes with a low-pass filter, at the forward epochs: down, m/s^2.
struct ClassicalGravity {
    double period = not_given;  ///< s, half amplitude
    std::vector<double> down;
    double rms = not_given, spread = not_given;  ///< of the error, and less its mean, ends omitted; simulated data
};

struct GravityBundle {
    solution::ResultBundle run;
    gravimetry::SurveyResult survey;
    std::vector<Eigen::Vector3d> truth;  ///< disturbance at the forward epochs, north, east, down; empty: unknown
    bool over_ground = false;            ///< the simulated disturbance is a function of position alone
    Attainability attainable;
    GravityErrors errors;
    GravityInnovations innovations;
    gravimetry::InnovationRun biased;  ///< stretch of fixes with the most biased innovations
    GravitySeparation separation;
    std::vector<GravityChange> changes;  ///< one per step named in the settings
    GravityVerdict verdict;
    ClassicalGravity classical;
    GravityLines lines;
    [[nodiscard]] const std::vector<gravimetry::SurveyEpoch>& epochs() const {
        return survey.smoothed.empty() ? survey.forward : survey.smoothed;
    }
};

/// A line of gravity.csv: SI units, north, east, down.
struct GravityRow {
    double t = 0.0;         ///< s after the origin of the command line's times
    double distance = 0.0;  ///< along the track, m
    Geodetic position;
    Eigen::Vector3d disturbance_n, sigma_n;
    double free_air = not_given;         ///< free-air anomaly, m/s^2; requires the undulation
    double eotvos = 0.0;                 ///< Eotvos term, m/s^2, positive for a reduction of apparent weight
    double vertical_acceleration = 0.0;  ///< of the vehicle, up, m/s^2
    Eigen::Vector3d truth_n = not_given3();
    double classical = not_given;                                                    ///< of the classical pipeline, down
    double levelled = not_given;                                                     ///< on a line, its level subtracted, down
    int line = -1;                                                                   ///< -1: not on a line
    Eigen::Vector3d separation_n = not_given3(), sigma_separation_n = not_given3();  ///< forward minus backward filter
};
[[nodiscard]] std::vector<GravityRow> gravity_rows(const GravityBundle& bundle);

/// Lines, crossovers and repeated lines of a moving survey.
[[nodiscard]] GravityLines gravity_lines(const GravityBundle& bundle);
/// At the steps of the input. @throws Error
[[nodiscard]] std::vector<GravityChange> gravity_changes(const GravityBundle& bundle, const GravityInput& input);
[[nodiscard]] GravityVerdict gravity_verdict(const GravityBundle& bundle);
/// Judgement of the model by the most biased stretch of innovations.
[[nodiscard]] std::string dependence_of_innovations(const GravityBundle& bundle);
/// The classical pipeline for the same input.
[[nodiscard]] ClassicalGravity classical_gravity(const GravityBundle& bundle, const GravityInput& input);

/// Simulates (a scenario) or reads (a data set), and estimates. @throws Error
[[nodiscard]] GravityBundle gravity_survey(const settings::ProcessRequest& request, WarningLog& warnings, std::string& notice);

[[nodiscard]] GravityBundle gravity_of_scenario(const settings::ScenarioConfig& scenario, const settings::ProcessRequest& request,
                                                WarningLog& warnings);

/// Response of the estimator along a scenario's track to harmonics of the vertical disturbance.
struct GravityResponse {
    struct At {
        double period;  ///< period of the input, s
        gravimetry::HarmonicResponse forward, smoothed;
    };
    /// Errors of the settled half of the survey, less their mean: the filter, the corrected filter, the smoother; mGal.
    struct Correction {
        double forward = not_given, corrected = not_given, smoothed = not_given;
        double period = not_given;  ///< s, of the scenario's own harmonic
        std::vector<double> t, e_forward, e_corrected, e_smoothed;
    };
    std::string name;
    bool by_time = false, smooth = false;
    double pace = 1.0;  ///< metres (or seconds) per second
    std::vector<At> at;
    double resolution = not_given;  ///< width of the impulse response, m or s
    Correction corrected;
};
[[nodiscard]] GravityResponse gravity_response_of(const settings::ScenarioConfig& scenario,
                                                  const settings::ProcessRequest& request);

/// `schuler gravity`: gravity.csv, gravity.geojson, solution.csv, run.h5, track.kml, report.html, summary.json, config.toml.
[[nodiscard]] report::Outcome gravity_command(const GravityRequest& request);

[[nodiscard]] std::string gravity_csv(const GravityBundle& bundle, const std::vector<GravityRow>& rows);
[[nodiscard]] std::string gravity_geojson(const GravityBundle& bundle, const std::vector<GravityRow>& rows);
[[nodiscard]] std::string gravity_summary_json(const GravityBundle& bundle, std::size_t rows);
[[nodiscard]] std::string gravity_tables(const GravityBundle& bundle);
[[nodiscard]] std::string gravity_report_html(const GravityBundle& bundle, const std::vector<GravityRow>& rows);

/// Amplitude and phase of the estimator along a scenario's track, from harmonics and an impulse added to its anomaly (same seed:
/// the difference of two estimates is the response, free of noise); the correction of paper E if the scenario has a harmonic.
[[nodiscard]] report::Outcome gravity_response(const GravityRequest& request);

/// Many seeds of a scenario: medians and consistency. Only summary.json is written.
[[nodiscard]] report::Outcome gravity_campaign(const GravityRequest& request);

}  // namespace schuler::study
