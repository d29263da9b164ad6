#include "schuler/gravimetry/detail/model_series.h"

#include "schuler/earth/gravity.h"
#include "schuler/gravimetry/model.h"

#include <cmath>
#include <tuple>

namespace schuler::gravimetry::detail {
namespace {

using Vector = std::array<Series, 3>;
using Matrix = std::array<Vector, 3>;  ///< rows

Matrix product(const Matrix& A, const Matrix& B) {
    Matrix C;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k) C[i][j] += A[i][k] * B[k][j];
    return C;
}
Vector product(const Matrix& A, const Vector& v) {
    Vector out;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) out[i] += A[i][k] * v[k];
    return out;
}
Matrix skew(const Vector& v) { return {{{Series(), -v[2], v[1]}, {v[2], Series(), -v[0]}, {-v[1], v[0], Series()}}}; }

/// Place along the motion; time in units of `unit` seconds.
struct Track {
    Series sin_lat, cos_lat, sin_lon, cos_lon, height;
    Series meridian, prime_vertical;  ///< radii plus height

    Track(const earth::Ellipsoid& ellipsoid, const ObservedMotion& motion, double unit) {
        const Real a(ellipsoid.a), e2 = Real(ellipsoid.f) * (Real(2) - Real(ellipsoid.f));
        const Eigen::Vector3d v = motion.v_eb_n * unit;
        height = Series::line(Real(motion.start.h), Real(-v.z()));
        Series lat(Real(motion.start.lat)), lon(Real(motion.start.lon));
        // Picard's iteration: each pass adds one correct term.
        const std::size_t passes = v.isZero() ? 1 : Series::terms;
        for (std::size_t pass = 0; pass < passes; ++pass) {
            std::tie(sin_lat, cos_lat) = sin_cos(lat);
            const Series W = Series(Real(1)) - sin_lat * sin_lat * e2;
            prime_vertical = power(W, Real(-0.5)) * a + height;
            meridian = power(W, Real(-1.5)) * (a * (Real(1) - e2)) + height;
            std::tie(sin_lon, cos_lon) = sin_cos(lon);
            lat = integral(lat[0], power(meridian, Real(-1)) * Real(v.x()));
            lon = integral(lon[0], power(prime_vertical * cos_lat, Real(-1)) * Real(v.y()));
        }
        flattening_ = e2;
    }
    [[nodiscard]] Matrix C_en() const {
        return {{{-(sin_lat * cos_lon), -sin_lon, -(cos_lat * cos_lon)},
                 {-(sin_lat * sin_lon), cos_lon, -(cos_lat * sin_lon)},
                 {cos_lat, Series(), -sin_lat}}};
    }
    [[nodiscard]] Vector position() const {
        const Series polar = (prime_vertical - height) * (Real(1) - flattening_) + height;
        return {prime_vertical * cos_lat * cos_lon, prime_vertical * cos_lat * sin_lon, polar * sin_lat};
    }

private:
    Real flattening_;
};

Matrix C_nb(const ObservedMotion& motion, double unit) {
    const auto [sr, cr] = sin_cos(Series(Real(motion.rpy.x())));
    const auto [sp, cp] = sin_cos(Series(Real(motion.rpy.y())));
    const auto [sh, ch] = sin_cos(Series::line(Real(motion.rpy.z()), Real(motion.heading_rate * unit)));
    const Series one(Real(1));
    const Matrix roll{{{one, Series(), Series()}, {Series(), cr, -sr}, {Series(), sr, cr}}};
    const Matrix pitch{{{cp, Series(), sp}, {Series(), one, Series()}, {-sp, Series(), cp}}};
    const Matrix heading{{{ch, -sh, Series()}, {sh, ch, Series()}, {Series(), Series(), one}}};
    return product(heading, product(pitch, roll));
}

/// exp([w x] t), w in radians per unit of time.
Matrix turned_by(const std::array<Real, 3>& w) {
    std::array<std::array<Real, 3>, 3> term{};  // of t^n: [w x]^n / n!
    for (std::size_t i = 0; i < 3; ++i) term[i][i] = 1;
    Matrix out;
    for (std::size_t n = 0; n < Series::terms; ++n) {
        auto next = term;
        for (std::size_t j = 0; j < 3; ++j) {
            for (std::size_t i = 0; i < 3; ++i) {
                out[i][j][n] = term[i][j];
                const std::size_t a = (i + 1) % 3, b = (i + 2) % 3;
                next[i][j] = (w[a] * term[b][j] - w[b] * term[a][j]) / static_cast<int>(n + 1);
            }
        }
        term = next;
    }
    return out;
}

/// The quantities of F along the motion, forces in units of g.
struct Course {
    Matrix C_eb;
    Vector r, f_e;
};

/// A steady turn: at the start the same as `course`, then everything rotates with the radius vector at w = r x v / r^2.
Course steady_turn(const Course& course, const Matrix& C_en, const Vector& v_n, const Matrix& heading, const Real& length) {
    const auto start = [](const Matrix& A) {
        Matrix out;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) out[i][j] = Series(A[i][j][0]);
        return out;
    };
    const auto still = [](const Vector& a) { return Vector{Series(a[0][0]), Series(a[1][0]), Series(a[2][0])}; };
    const Vector r = still(course.r), v_e = product(start(C_en), v_n), cross = product(skew(r), v_e);
    const Real r2 = (r[0] * r[0] + r[1] * r[1] + r[2] * r[2])[0], climb = -v_n[2][0] / sqrt(r2);
    const Matrix turn = turned_by({length * cross[0][0] / r2, length * cross[1][0] / r2, length * cross[2][0] / r2});
    Vector away = product(turn, r);
    for (Series& x : away) x = x * Series::line(Real(1), length * climb);
    return {product(turn, product(start(C_en), heading)), away, product(turn, still(course.f_e))};
}

}  // namespace

ModelSeries model_series(const earth::Earth& earth, const ObservedMotion& motion) {
    const double g = earth::gravity_down(earth.gravity, motion.start.lat, motion.start.h);
    const double distance = earth::ecef_from_geodetic(earth.ellipsoid, motion.start).r.norm();
    const double T = std::sqrt(distance * distance * distance / earth.ellipsoid.gm);  // 1/w0
    ModelSeries model;
    model.time_scale = T;
    for (int i = 0; i < Observability::most; ++i) {
        const int group = i / 3 * 3;
        model.scale[static_cast<std::size_t>(i)] = group == position || group == gnss_position   ? g * T * T
                                                   : group == velocity || group == gnss_velocity ? g * T
                                                   : group == attitude                           ? 1.0
                                                   : group == gyro_bias                          ? 1.0 / T
                                                   : group == slope                              ? 1.0 / (T * T)
                                                   : group == curvature                          ? 1.0 / (g * std::pow(T, 4))
                                                                                                 : g;
    }

    const Track track(earth.ellipsoid, motion, T);
    const Matrix C_en = track.C_en(), heading = C_nb(motion, T);
    const Real u(earth.ellipsoid.w_ie * T);
    const Vector v{Series(Real(motion.v_eb_n.x() / (g * T))), Series(Real(motion.v_eb_n.y() / (g * T))),
                   Series(Real(motion.v_eb_n.z() / (g * T)))};
    // Specific force that keeps the velocity, in units of g: (2 w_ie + w_en) x v - gravity of constant size along the vertical.
    const Real length(g * T * T);
    const Series by_north = power(track.meridian, Real(-1)) * length, by_east = power(track.prime_vertical, Real(-1)) * length;
    const Series east_turn = v[1] * by_east;
    const Vector turn{track.cos_lat * (u * 2) + east_turn, -(v[0] * by_north),
                      -(track.sin_lat * (u * 2)) - east_turn * track.sin_lat * power(track.cos_lat, Real(-1))};
    Vector f_n = product(skew(turn), v);
    f_n[2] += Series(Real(-1));
    Course course{product(C_en, heading), track.position(), product(C_en, f_n)};
    if (!motion.rhumb) course = steady_turn(course, C_en, v, heading, length);
    const Matrix force = skew(course.f_e);
    const Matrix& C_eb = course.C_eb;
    const Vector& r = course.r;
    const Series r2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    const Series strength = power(r2, Real(-1.5)) * Real(earth.ellipsoid.gm * T * T), shape = power(r2, Real(-1)) * Real(3);
    const Series one(Real(1));
    for (int i = 0; i < 3; ++i) {
        const auto row = static_cast<std::size_t>(i);
        const auto add = [&](int to, int from, const Series& value) { model.F.push_back({to + i, from, value}); };
        add(position, velocity + i, one);
        add(velocity, systematic + i, one);
        add(velocity, random + i, one);
        if (motion.degree > 0) add(systematic, slope + i, Series(Real(motion.v_eb_n.norm() / (g * T))));
        if (motion.degree > 1) add(slope, curvature + i, Series(Real(motion.v_eb_n.norm() / (g * T))));
        if (motion.random_rate > 0.0) add(random, random + i, Series(Real(-motion.random_rate * T)));
        for (int j = 0; j < 3; ++j) {
            const auto column = static_cast<std::size_t>(j);
            Series gradient = r[row] * r[column] * shape;
            if (i == j) gradient += Series(Real(-1));
            gradient = gradient * strength;
            if (motion.centrifugal && i == j && i < 2) gradient += Series(u * u);
            add(velocity, position + j, gradient);
            if (i != j) add(velocity, attitude + j, force[row][column]);
            add(velocity, accel_bias + j, -C_eb[row][column]);
            add(attitude, gyro_bias + j, C_eb[row][column]);
        }
    }
    for (const int group : {velocity, attitude}) {  // Coriolis, Earth rotation
        const Real rate = group == velocity ? Real(u * 2) : u;
        model.F.push_back({group, group + 1, Series(rate)});
        model.F.push_back({group + 1, group, Series(Real(-rate))});
    }
    return model;
}

}  // namespace schuler::gravimetry::detail
