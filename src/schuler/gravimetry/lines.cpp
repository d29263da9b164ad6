#include "schuler/gravimetry/lines.h"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace schuler::gravimetry {

using Eigen::Vector2d;

namespace {

double turned(double a, double b) { return std::remainder(a - b, 2.0 * std::numbers::pi); }

double length_of(const std::vector<TrackPoint>& track, std::size_t first, std::size_t last) {
    return (track[last].place - track[first].place).norm();
}

/// Every n-th point of a line, including its last one.
std::vector<std::size_t> decimated(const SurveyLine& line) {
    const std::size_t stride = 1 + (line.last - line.first) / 500;
    std::vector<std::size_t> out;
    for (std::size_t i = line.first; i < line.last; i += stride) out.push_back(i);
    out.push_back(line.last);
    return out;
}

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Intersection of the segments p + s d and q + t e: s and t within [0, 1).
bool intersect(const Vector2d& p, const Vector2d& d, const Vector2d& q, const Vector2d& e, double& s, double& t) {
    const double area = cross(d, e);
    if (std::abs(area) < 1e-3 * d.norm() * e.norm()) return false;  // nearly parallel: no well-defined crossover
    s = cross(q - p, e) / area;
    t = cross(q - p, d) / area;
    return s >= 0.0 && s < 1.0 && t >= 0.0 && t < 1.0;
}

}  // namespace

std::vector<SurveyLine> survey_lines(const std::vector<TrackPoint>& track, double shortest, double tolerance) {
    std::vector<SurveyLine> out;
    std::size_t first = 0;
    while (first < track.size()) {
        double mean = track[first].course;
        std::size_t last = first;
        while (last + 1 < track.size() && std::abs(turned(track[last + 1].course, mean)) <= tolerance) {
            ++last;
            mean += turned(track[last].course, mean) / static_cast<double>(last - first + 1);
        }
        if (length_of(track, first, last) >= shortest) out.push_back({first, last, mean, 0.0});
        first = last + 1;
    }
    return out;
}

std::vector<Crossover> crossovers(const std::vector<TrackPoint>& track, const std::vector<SurveyLine>& lines) {
    std::vector<Crossover> out;
    for (std::size_t a = 0; a < lines.size(); ++a) {
        const std::vector<std::size_t> pa = decimated(lines[a]);
        for (std::size_t b = a + 1; b < lines.size(); ++b) {
            const std::vector<std::size_t> pb = decimated(lines[b]);
            for (std::size_t i = 1; i < pa.size(); ++i) {
                const TrackPoint &a0 = track[pa[i - 1]], &a1 = track[pa[i]];
                for (std::size_t j = 1; j < pb.size(); ++j) {
                    const TrackPoint &b0 = track[pb[j - 1]], &b1 = track[pb[j]];
                    const double reach = (a1.place - a0.place).norm() + (b1.place - b0.place).norm();
                    if ((a0.place - b0.place).squaredNorm() > reach * reach) continue;
                    double s = 0.0, t = 0.0;
                    if (!intersect(a0.place, a1.place - a0.place, b0.place, b1.place - b0.place, s, t)) continue;
                    out.push_back({a, b, a0.place + s * (a1.place - a0.place), a0.value + s * (a1.value - a0.value),
                                   b0.value + t * (b1.value - b0.value)});
                }
            }
        }
    }
    return out;
}

void level(std::vector<SurveyLine>& lines, const std::vector<Crossover>& crossings) {
    for (SurveyLine& line : lines) line.level = 0.0;
    if (crossings.empty()) return;
    const auto rows = static_cast<Eigen::Index>(crossings.size()), columns = static_cast<Eigen::Index>(lines.size());
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(rows, columns);
    Eigen::VectorXd y(rows);
    for (Eigen::Index k = 0; k < rows; ++k) {
        const Crossover& c = crossings[static_cast<std::size_t>(k)];
        A(k, static_cast<Eigen::Index>(c.line_a)) = 1.0;
        A(k, static_cast<Eigen::Index>(c.line_b)) = -1.0;
        y(k) = c.value_a - c.value_b;
    }
    const Eigen::VectorXd levels = Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(A).solve(y);
    for (std::size_t i = 0; i < lines.size(); ++i) lines[i].level = levels(static_cast<Eigen::Index>(i));
}

double crossover_rms(const std::vector<SurveyLine>& lines, const std::vector<Crossover>& crossings) {
    double sum = 0.0;
    for (const Crossover& c : crossings) sum += std::pow(c.difference(lines), 2);
    return crossings.empty() ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(sum / static_cast<double>(crossings.size()));
}

std::vector<RepeatedLine> repeated_lines(const std::vector<TrackPoint>& track, const std::vector<SurveyLine>& lines, double apart,
                                         double shortest) {
    std::vector<RepeatedLine> out;
    for (std::size_t a = 0; a < lines.size(); ++a) {
        const std::vector<std::size_t> pa = decimated(lines[a]);
        for (std::size_t b = a + 1; b < lines.size(); ++b) {
            const double angle = std::abs(std::remainder(lines[a].course - lines[b].course, std::numbers::pi));
            if (angle > 0.1) continue;
            const std::vector<std::size_t> pb = decimated(lines[b]);
            std::vector<double> differences;
            double length = 0.0;
            for (std::size_t i = 0; i < pa.size(); ++i) {
                const TrackPoint& p = track[pa[i]];
                for (std::size_t j = 1; j < pb.size(); ++j) {
                    const TrackPoint &b0 = track[pb[j - 1]], &b1 = track[pb[j]];
                    const Vector2d d = b1.place - b0.place;
                    const double t = d.dot(p.place - b0.place) / std::max(1e-9, d.squaredNorm());
                    if (t < 0.0 || t >= 1.0 || (b0.place + t * d - p.place).norm() > apart) continue;
                    differences.push_back(p.value - (b0.value + t * (b1.value - b0.value)));
                    if (i > 0) length += (p.place - track[pa[i - 1]].place).norm();
                    break;
                }
            }
            if (length < shortest) continue;
            const Eigen::Map<const Eigen::ArrayXd> x(differences.data(), static_cast<Eigen::Index>(differences.size()));
            out.push_back({a, b, length, x.mean(), std::sqrt((x - x.mean()).square().mean())});
        }
    }
    return out;
}

}  // namespace schuler::gravimetry
