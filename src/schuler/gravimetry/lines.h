// A survey as lines: where they cross, what they disagree by there, and the levels that make them agree.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace schuler::gravimetry {

/// A value along a track.
struct TrackPoint {
    Eigen::Vector2d place;  ///< north, east of some origin, m
    double course = 0.0;    ///< of the velocity, rad
    double value = 0.0;     ///< of whatever unit: levels and differences have the same
};

/// A straight stretch of the track, first and last included.
struct SurveyLine {
    std::size_t first = 0, last = 0;
    double course = 0.0;  ///< mean, rad
    double level = 0.0;   ///< to be taken off its values
};

/// Stretches whose course stays within `tolerance` (rad) of their mean over at least `shortest` m.
[[nodiscard]] std::vector<SurveyLine> survey_lines(const std::vector<TrackPoint>& track, double shortest, double tolerance);

/// A point that two lines share, and their values there.
struct Crossover {
    std::size_t line_a = 0, line_b = 0;  ///< a < b
    Eigen::Vector2d place;
    double value_a = 0.0, value_b = 0.0;
    /// Of the levelled values.
    [[nodiscard]] double difference(const std::vector<SurveyLine>& lines) const {
        return (value_a - lines[line_a].level) - (value_b - lines[line_b].level);
    }
};

/// Crossings of different lines; along a line values are joined by straight lines between at most 500 points.
[[nodiscard]] std::vector<Crossover> crossovers(const std::vector<TrackPoint>& track, const std::vector<SurveyLine>& lines);

/// Sets the levels of the lines so that the sum of squared differences at the crossovers is least and the levels are as small as
/// they can be (their common part is not determined by crossovers).
void level(std::vector<SurveyLine>& lines, const std::vector<Crossover>& crossings);

/// Root mean square of the differences at crossovers, levels taken off; NaN where there is none.
[[nodiscard]] double crossover_rms(const std::vector<SurveyLine>& lines, const std::vector<Crossover>& crossings);

/// Two lines over the same ground, in either direction.
struct RepeatedLine {
    std::size_t line_a = 0, line_b = 0;
    double length = 0.0;     ///< m in common
    double mean = 0.0;       ///< of a less b
    double deviation = 0.0;  ///< root mean square of the difference less its mean; a single line has this over the root of two
};

/// Pairs of lines that run within `apart` m of each other over at least `shortest` m.
[[nodiscard]] std::vector<RepeatedLine> repeated_lines(const std::vector<TrackPoint>& track, const std::vector<SurveyLine>& lines,
                                                       double apart, double shortest);

}  // namespace schuler::gravimetry
