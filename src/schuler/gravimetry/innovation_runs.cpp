#include "schuler/gravimetry/innovation_runs.h"

#include "schuler/math/chi_square.h"

#include <algorithm>
#include <cmath>

namespace schuler::gravimetry {
namespace {

constexpr std::size_t shortest = 32;

/// Keeps what is less probable; the probability is that of a single test.
void keep_worse(InnovationRun& worst, const InnovationRun& other) {
    ++worst.tests;
    if (other.probability >= worst.probability) return;
    const std::size_t tests = worst.tests;
    worst = other;
    worst.tests = tests;
}

}  // namespace

InnovationRun most_biased_run(const std::vector<filter::MeasurementRecord>& measurements, Time settled) {
    InnovationRun worst;
    for (const filter::MeasurementKind kind : {filter::MeasurementKind::GnssPosition, filter::MeasurementKind::GnssVelocity}) {
        for (int axis = 0; axis < 3; ++axis) {
            std::vector<Time> time;
            std::vector<double> sum{0.0};  // of the normalised innovations before each
            for (const filter::MeasurementRecord& a : measurements) {
                if (a.kind != kind || a.status != filter::MeasurementStatus::Accepted || a.time < settled ||
                    !(a.sigma[axis] > 0.0))
                    continue;
                time.push_back(a.time);
                sum.push_back(sum.back() + a.innovation[axis] / a.sigma[axis]);
            }
            const std::size_t n = time.size();
            for (std::size_t length = shortest; length <= n; length *= 2) {
                double squares = 0.0;
                const double stretches = static_cast<double>(n / length);
                const double seconds = (time[length - 1] - time[0]).seconds();
                for (std::size_t begin = 0; begin + length <= n; begin += length / 2) {
                    const double z = (sum[begin + length] - sum[begin]) / std::sqrt(static_cast<double>(length));
                    if (begin % length == 0) squares += z * z;
                    keep_worse(worst, {kind, axis, time[begin], time[begin + length - 1], seconds, false, std::abs(z),
                                       math::chi_square_survival(z * z, 1.0)});
                }
                keep_worse(worst, {kind, axis, time.front(), time.back(), seconds, true, std::sqrt(squares / stretches),
                                   math::chi_square_survival(squares, stretches)});
            }
        }
    }
    if (worst.tests > 0) worst.probability = std::min(1.0, worst.probability * static_cast<double>(worst.tests));
    return worst;
}

}  // namespace schuler::gravimetry
