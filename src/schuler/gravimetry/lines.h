// A survey as lines: their crossovers, the differences there, and the levels that minimise them.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace schuler::gravimetry {

/// A value along a track.
struct TrackPoint {
    Eigen::Vector2d place;  ///< north, east of an arbitrary origin, m
    double course = 0.0;    ///< of the velocity, rad
    double value = 0.0;     ///< in any unit, also that of levels and differences
};

/// A straight stretch of the track, first and last included.
struct SurveyLine {
    std::size_t first = 0, last = 0;
    double course = 0.0;  ///< mean, rad
    double level = 0.0;   ///< to be subtracted from its values
};

/// Segments whose course stays within `tolerance` (rad) of their mean over at least `shortest` m.
[[nodiscard]] std::vector<SurveyLine> survey_lines(const std::vector<TrackPoint>& track, double shortest, double tolerance);

/// A point common to two lines, and their values there.
struct Crossover {
    std::size_t line_a = 0, line_b = 0;  ///< a < b
    Eigen::Vector2d place;
    double value_a = 0.0, value_b = 0.0;
    /// Difference of the levelled values.
    [[nodiscard]] double difference(const std::vector<SurveyLine>& lines) const {
        return (value_a - lines[line_a].level) - (value_b - lines[line_b].level);
    }
};

/// Crossings of different lines; values along a line are interpolated linearly between at most 500 points.
[[nodiscard]] std::vector<Crossover> crossovers(const std::vector<TrackPoint>& track, const std::vector<SurveyLine>& lines);

/// Sets the levels of the lines to minimise the sum of squared differences at the crossovers, with the smallest possible levels
/// (their common part is not determined by crossovers).
void level(std::vector<SurveyLine>& lines, const std::vector<Crossover>& crossings);

/// Root mean square of the levelled differences at crossovers; NaN if there are none.
[[nodiscard]] double crossover_rms(const std::vector<SurveyLine>& lines, const std::vector<Crossover>& crossings);

/// Two lines over the same ground, in either direction.
struct RepeatedLine {
    std::size_t line_a = 0, line_b = 0;
    double length = 0.0;     ///< common length, m
    double mean = 0.0;       ///< of a minus b
    double deviation = 0.0;  ///< root mean square of the difference less its mean; divide by sqrt(2) for a single line
};

/// Pairs of lines that run within `apart` m of each other over at least `shortest` m.
[[nodiscard]] std::vector<RepeatedLine> repeated_lines(const std::vector<TrackPoint>& track, const std::vector<SurveyLine>& lines,
                                                       double apart, double shortest);

}  // namespace schuler::gravimetry
