#include "schuler/gravimetry/observability.h"

#include "schuler/core/error.h"
#include "schuler/gravimetry/detail/model_series.h"
#include "schuler/gravimetry/model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace schuler::gravimetry {

using detail::Real;
using detail::Series;

namespace {

constexpr int states = Observability::most;  // states that a model does not have are zero columns
constexpr std::size_t blocks = Series::terms;
const Real zero_pivot("1e-30");

using Row = std::array<Real, states>;
using SeriesRow = std::array<Series, states>;

/// The next block's row: N F + dN/dt, correct in its first `terms` coefficients if N is correct in one more.
SeriesRow next_row(const SeriesRow& N, const std::vector<detail::SeriesEntry>& F, std::size_t terms) {
    SeriesRow out;
    for (std::size_t i = 0; i < states; ++i)
        for (std::size_t n = 0; n < terms; ++n) out[i][n] = N[i][n + 1] * static_cast<int>(n + 1);
    for (const detail::SeriesEntry& entry : F) {
        const Series& left = N[static_cast<std::size_t>(entry.row)];
        Series& sum = out[static_cast<std::size_t>(entry.column)];
        for (std::size_t a = 0; a < terms; ++a) {
            if (left[a].is_zero()) continue;
            for (std::size_t b = 0; a + b < terms; ++b)
                if (!entry.value[b].is_zero()) sum[a + b] += left[a] * entry.value[b];
        }
    }
    return out;
}

/// Row k of all blocks side by side: all at the start of the motion.
std::vector<Row> observability_matrix(std::vector<detail::SeriesEntry> F, bool frozen) {
    if (frozen)
        for (detail::SeriesEntry& entry : F) entry.value = Series(entry.value[0]);
    std::vector<Row> matrix;
    for (const auto& [state, error] : {std::pair{position, gnss_position}, std::pair{velocity, gnss_velocity}}) {
        for (int axis = 0; axis < 3; ++axis) {
            SeriesRow N;
            N[static_cast<std::size_t>(state + axis)] = N[static_cast<std::size_t>(error + axis)] = Series(Real(1));
            for (std::size_t k = 0; k < blocks; ++k) {
                Row now;
                for (std::size_t i = 0; i < states; ++i) now[i] = N[i][0];
                matrix.push_back(now);
                if (k + 1 < blocks) N = next_row(N, F, blocks - 1 - k);
            }
        }
    }
    return matrix;
}

/// Gauss-Jordan with complete pivoting; rows of pivots come first, with 1 in the pivot's column and 0 in those of the others.
struct Elimination {
    std::vector<std::size_t> columns;  ///< of the pivots
    std::vector<double> pivots;
    double next = 0.0;

    Elimination(std::vector<Row>& M, const Real& tolerance) {
        std::array<bool, states> used{};
        for (std::size_t done = 0; done < states; ++done) {
            std::size_t row = done, column = 0;
            Real largest = 0;
            for (std::size_t i = done; i < M.size(); ++i)
                for (std::size_t j = 0; j < states; ++j)
                    if (!used[j] && abs(M[i][j]) > largest) {
                        largest = abs(M[i][j]);
                        row = i;
                        column = j;
                    }
            next = static_cast<double>(largest);
            if (largest <= tolerance) return;
            used[column] = true;
            columns.push_back(column);
            pivots.push_back(next);
            std::swap(M[done], M[row]);
            const Real inverse = Real(1) / M[done][column];
            for (Real& x : M[done]) x *= inverse;
            for (std::size_t i = 0; i < M.size(); ++i) {
                const Real factor = M[i][column];
                if (i == done || factor.is_zero()) continue;
                for (std::size_t j = 0; j < states; ++j) M[i][j] -= factor * M[done][j];
                M[i][column] = 0;
            }
        }
        next = 0.0;
    }
};

void check(const ObservedMotion& m, double tolerance) {
    const auto refuse = [](const char* key, const char* what, const char* hint) {
        throw input_error(what, {{}, 0, 0, key}, hint);
    };
    const double limit = 89.0 * std::numbers::pi / 180.0;
    if (!(std::abs(m.start.lat) <= limit)) refuse("latitude-deg", "must lie between -89 and 89", "give degrees");
    if (!std::isfinite(m.start.lon)) refuse("longitude-deg", "is not a finite number", "give degrees");
    if (!(std::abs(m.start.h) <= 100e3)) refuse("height", "must lie within 100 km", "give metres");
    if (!(m.v_eb_n.norm() <= 5000.0)) refuse("vn", "the speed must be below 5000 m/s", "give m/s");
    if (!m.rpy.allFinite()) refuse("heading-deg", "is not a finite number", "give degrees");
    if (!(std::abs(m.heading_rate) <= 10.0)) refuse("turn-deg-s", "must be below 570 deg/s", "give degrees a second");
    if (!(m.random_rate >= 0.0 && m.random_rate <= 1.0))
        refuse("correlation-time", "the correlation time must be at least 1 s", "give seconds, 0 for a constant");
    if (!(m.degree >= 0 && m.degree <= 2)) refuse("polynomial", "must be 0, 1 or 2", "0 for a constant");
    if (!(tolerance >= 0.0 && tolerance < 1.0))
        refuse("tolerance", "must lie between 0 and 1", "0 for the exact rank, 1e-7 for the paper's");
}

}  // namespace

std::array<std::string, states> state_names() {
    std::array<std::string, states> names;
    constexpr std::array groups{"position",      "velocity",   "attitude", "accel_bias", "gyro_bias", "gnss_position",
                                "gnss_velocity", "systematic", "random",   "slope",      "curvature"};
    for (std::size_t i = 0; i < names.size(); ++i) names[i] = std::string(groups[i / 3]) + "_" + "xyz"[i % 3];
    return names;
}

Observability observability(const earth::Earth& earth, const ObservedMotion& motion, double tolerance) {
    check(motion, tolerance);
    const detail::ModelSeries model = detail::model_series(earth, motion);
    std::vector<Row> matrix = observability_matrix(model.F, motion.frozen);
    const Elimination done(matrix, std::max(zero_pivot, Real(tolerance)));
    const std::array<std::string, states> names = state_names();
    Observability out;
    out.states += 3 * motion.degree;
    out.rank = static_cast<int>(done.columns.size());
    out.pivots = done.pivots;
    out.next = done.next;
    for (std::size_t k = 0; k < done.columns.size(); ++k) {
        const std::size_t pivot = done.columns[k];
        SeenCombination seen{names[pivot], {}};
        for (std::size_t j = 0; j < states; ++j) {
            const auto coefficient = static_cast<double>(matrix[k][j]);
            if (j != pivot && std::abs(coefficient) > 1e-12)
                seen.with.emplace_back(names[j], coefficient * model.scale[pivot] / model.scale[j]);
        }
        out.combinations.push_back(seen);
    }
    return out;
}

}  // namespace schuler::gravimetry
