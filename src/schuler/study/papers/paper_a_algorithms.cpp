// Paper A, chapters 1 and 2: attitude algorithms, series, estimators.
#include "schuler/core/units.h"
#include "schuler/earth/axes.h"
#include "schuler/earth/gravity.h"
#include "schuler/earth/paper_series.h"
#include "schuler/estim/classical.h"
#include "schuler/ins/integrators.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"
#include "schuler/report/result_table.h"
#include "schuler/sim/inverse_imu.h"
#include "schuler/sim/path.h"
#include "schuler/study/papers/item.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace schuler::study {
namespace {

using namespace ins::paper_a;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// The paper's axes: body forward-up-right, local level north-up-east.
Vector3d body_axes(const Vector3d& frd) { return {frd.x(), -frd.z(), frd.y()}; }
Vector3d level_axes(const Vector3d& ned) { return {ned.x(), -ned.z(), ned.y()}; }
Matrix3d true_matrix(const Vector3d& rpy) { return matrix_from(Angles{-rpy.z(), rpy.y(), rpy.x()}); }
double angle_between(const Matrix3d& a, const Matrix3d& b) {
    return math::rotation_vector_from_quaternion(Quaterniond(a * b.transpose()).normalized()).norm();
}

/// (1.3.5) with the printed signs.
Quaterniond printed_picard(const Quaterniond& q, const Vector3d& b) {
    const double e = 1.0 - b.squaredNorm() / 8.0;
    return {q.w() * e - 0.5 * (q.x() * b.x() + q.y() * b.y() + q.z() * b.z()),
            q.x() * e - 0.5 * (q.w() * b.x() + q.z() * b.y() + q.y() * b.z()),
            q.y() * e - 0.5 * (q.z() * b.x() + q.w() * b.y() + q.x() * b.z()),
            q.z() * e - 0.5 * (q.y() * b.x() + q.x() * b.y() + q.w() * b.z())};
}

/// An algorithm on the flight: its error, and the deviation of its matrix from orthogonality.
struct Flown {
    std::string name;
    double largest = 0.0, last = 0.0, defect = 0.0;  ///< rad, rad, of B^T B - I
    std::vector<double> t{}, error{};                ///< s, arcsec
};
constexpr double flight_time = 800.0;

std::vector<Flown> fly(double rate) {
    const earth::Earth earth;
    const auto path = sim::make_path(sim::PaperAPath{}, earth.ellipsoid);
    const Vector3d rpy0 = path->at(0.0).rpy;
    const Angles start{-rpy0.z(), rpy0.y(), rpy0.x()};
    const double dt = 1.0 / rate;
    Angles euler = start, split = start;
    Matrix3d poisson = matrix_from(start);
    Quaterniond single = quaternion_from(start);
    QuaternionPair pair{quaternion_from(start), Quaterniond::Identity()}, loose = pair;
    std::array<Flown, 6> out{Flown{"Euler angles (1.3.7)"},        Flown{"direction cosines (Poisson)"},
                             Flown{"quaternion (1.3.4)"},          Flown{"Picard pair (1.3.5), normalised"},
                             Flown{"Picard pair, not normalised"}, Flown{"rates split: fast angles, slow level"}};
    Vector3d held = Vector3d::Zero();
    const auto steps = static_cast<long>(std::lround(flight_time * rate));
    const long slow = std::max(1L, std::lround(rate));
    for (long k = 1; k <= steps; ++k) {
        const double t0 = static_cast<double>(k - 1) * dt, t1 = static_cast<double>(k) * dt;
        const Vector3d beta = body_axes(sim::exact_increment(earth, *path, t0, t1).dtheta);
        const sim::Kinematics middle = path->at(0.5 * (t0 + t1));
        const earth::EarthTerms terms = earth::terms_at(earth, middle.position, middle.v_eb_n);
        const Vector3d w_level = level_axes(terms.w_ie_n + terms.w_en_n), zeta = w_level * dt;
        euler = step_angles(euler, beta / dt - matrix_from(euler).transpose() * w_level, dt);
        if ((k - 1) % slow == 0) {
            const sim::Kinematics now = path->at(t0);
            const earth::EarthTerms slow_terms = earth::terms_at(earth, now.position, now.v_eb_n);
            held = level_axes(slow_terms.w_ie_n + slow_terms.w_en_n);
        }
        split = step_angles(split, beta / dt - matrix_from(split).transpose() * held, dt);
        poisson = step_poisson(poisson, beta, zeta, Normalise::Yes);
        single = step_quaternion(single, beta - single.conjugate() * zeta).normalized();
        pair = step_pair(pair, beta, zeta, Normalise::Yes);
        loose = step_pair(loose, beta, zeta, Normalise::No);
        const bool shown = k % slow == 0 || k == steps;
        if (!shown) continue;
        const Matrix3d right = true_matrix(path->at(t1).rpy);
        const std::array<Matrix3d, 6> B{matrix_from(euler), poisson,           single.toRotationMatrix(), matrix_from(pair),
                                        matrix_from(loose), matrix_from(split)};
        for (std::size_t i = 0; i < B.size(); ++i) {
            const double off = angle_between(B[i], right);
            out[i].largest = std::max(out[i].largest, off);
            out[i].last = off;
            out[i].defect = std::max(out[i].defect, (B[i].transpose() * B[i] - Matrix3d::Identity()).cwiseAbs().maxCoeff());
            out[i].t.push_back(t1);
            out[i].error.push_back(off / units::arcsec);
        }
    }
    return {out.begin(), out.end()};
}

/// Largest error of the quaternion pair over a coning motion of 1 deg at 2 Hz, 10 s: reveals the order of the method.
double coning_error(double rate) {
    constexpr double half = 1.0 * units::deg, w = 2.0 * 2.0 * std::numbers::pi;
    const auto attitude = [&](double t) {
        return math::quaternion_from_rotation_vector(half * Vector3d(0.0, std::cos(w * t), std::sin(w * t)));
    };
    Quaterniond q = attitude(0.0);
    double largest = 0.0;
    const double dt = 1.0 / rate;
    const auto steps = static_cast<long>(10.0 * rate);
    for (long k = 0; k < steps; ++k) {
        // output of integrating gyros: the rate integrated over the step, not the rotation vector
        Vector3d beta = Vector3d::Zero();
        constexpr int parts = 64;
        for (int i = 0; i < parts; ++i) {
            const double t0 = (static_cast<double>(k) + static_cast<double>(i) / parts) * dt;
            beta += math::rotation_vector_from_quaternion(attitude(t0).conjugate() * attitude(t0 + dt / parts));
        }
        q = step_picard_second(q, beta, Normalise::Yes);
        largest = std::max(
            largest, math::rotation_vector_from_quaternion(attitude((static_cast<double>(k) + 1.0) * dt).conjugate() * q).norm());
    }
    return largest;
}

PaperResult attitude(const PaperWork&) {
    PaperResult out;
    // clang-format off
    report::ResultTable table{"attitude over the flight of section 4.2, 800 s, perfect gyros", {{"algorithm", "algorithm"}, {"rate_hz", "rate", "Hz"},
                              {"largest_arcsec", "largest error", "arcsec"}, {"end_arcsec", "at the end", "arcsec"}, {"defect", "off orthogonal"}}};
    // clang-format on
    for (const double rate : {10.0, 50.0}) {
        const std::vector<Flown> all = fly(rate);
        report::Panel panel{fmt::format("attitude error at {:g} Hz", rate), "time, s", "angle, arcsec"};
        panel.log_y = true;
        constexpr std::array inks{report::Ink::Blue,   report::Ink::Vermillion, report::Ink::Green,
                                  report::Ink::Purple, report::Ink::Orange,     report::Ink::Sky};
        for (std::size_t i = 0; i < all.size(); ++i) {
            const Flown& f = all[i];
            table.rows.push_back({f.name, rate, f.largest / units::arcsec, f.last / units::arcsec, f.defect});
            panel.series.push_back(paper_curve(f.name, f.t, f.error, inks[i]));
        }
        out.panels.push_back(std::move(panel));
    }
    out.tables.push_back(std::move(table));

    const Vector3d beta = 0.1 * Vector3d(0.36, 0.48, 0.8);
    const Quaterniond one = step_picard_second(Quaterniond::Identity(), beta, Normalise::No);
    out.numbers.emplace_back("orthogonality", one.norm() - 1.0);
    const Quaterniond exact = math::quaternion_from_rotation_vector(beta);
    out.numbers.emplace_back("local error", (one.vec() - exact.vec()).norm() / std::pow(beta.norm(), 3.0));
    out.numbers.emplace_back("order", std::log2(coning_error(50.0) / coning_error(100.0)));

    // one second of the flight with the printed signs
    const earth::Earth earth;
    const auto path = sim::make_path(sim::PaperAPath{}, earth.ellipsoid);
    Vector3d rpy = path->at(150.0).rpy;
    Quaterniond right = quaternion_from({-rpy.z(), rpy.y(), rpy.x()}), wrong = right;
    for (int k = 0; k < 100; ++k) {
        const Vector3d step = body_axes(sim::exact_increment(earth, *path, 150.0 + 0.01 * k, 150.0 + 0.01 * (k + 1)).dtheta);
        right = step_quaternion(right, step);
        wrong = printed_picard(wrong, step).normalized();
    }
    out.numbers.emplace_back("printed signs",
                             math::rotation_vector_from_quaternion(right.conjugate() * wrong).norm() / units::deg);
    const Angles a{40.0 * units::deg, 7.0 * units::deg, -12.0 * units::deg};
    const double sp = std::sin(0.5 * a.psi), cp = std::cos(0.5 * a.psi), st = std::sin(0.5 * a.pitch),
                 ct = std::cos(0.5 * a.pitch), sg = std::sin(0.5 * a.roll), cg = std::cos(0.5 * a.roll);
    const Quaterniond printed(sg * st * sp + cg * ct * cp, -st * sp * cg + sg * ct * cp, sg * ct * sp + st * cg * cp,
                              sp * cg * ct - sg * st * cp);
    out.numbers.emplace_back("initial quaternion", (printed.toRotationMatrix() - matrix_from(a)).cwiseAbs().maxCoeff());
    out.notes =
        "All of them follow the corrected equations. With perfect gyros the angles that integrating gyros give are what limits them: the order\n"
        "of the method shows in vibration (coning of 1 deg at 2 Hz, 50 and 100 Hz). \"Least cost\" is not compared: it depends on the processor.\n";
    return out;
}

PaperResult series(const PaperWork&) {
    struct Largest {
        double meridian = 0, meridian_right = 0, prime = 0, prime_right = 0, l1 = 0, l1_right = 0, l3 = 0, l3_right = 0;
    } m;
    const earth::PaperAGravity p;
    constexpr double a = 6378388.0, f = 1.0 / 297.0, e2 = f * (2.0 - f);
    // Normal gravity of 1930 with second-order free air: the quantity represented by the series.
    const auto reference = [&](double s2, double h) {
        const double g0 = 9.78049 * (1.0 + 0.0052884 * s2 - 0.0000059 * 4.0 * s2 * (1.0 - s2));
        const double mm = 7.292115e-5 * 7.292115e-5 * a * a * a * (1.0 - f) / 3.986004418e14;
        return g0 * (1.0 - 2.0 / a * (1.0 + f + mm - 2.0 * f * s2) * h + 3.0 * h * h / (a * a));
    };
    std::vector<double> lat, printed_error, right_error, printed_gravity, right_gravity;
    for (int i = 0; i <= 90; ++i) {
        const double s = std::sin(i * units::deg), s2 = s * s, S2 = 4.0 * s2 * (1.0 - s2);
        double worst = 0.0, best = 0.0, worst_g = 0.0, best_g = 0.0;
        for (double h = 0.0; h <= 20000.0; h += 2000.0) {
            const double y = h / a, W = 1.0 - e2 * s2;
            const double R1 = a * (1.0 - e2) / std::pow(W, 1.5), R2 = a / std::sqrt(W);
            const double printed = 1.0 - e2 - y - 1.5 * e2 * s2 - 2.0 * e2 * y + 3.0 * e2 * y * s2 + y * y +
                                   e2 * e2 * (1.0 - 3.0 * s2 + 0.375 * s2 * s2);
            const double printed2 = 1.0 - y - 0.5 * e2 * s2 + y * y + e2 * y * s2 + e2 * e2 * (0.25 * s2 - 0.375) * s2;
            const earth::CurvatureSeries right = earth::paper_a_curvature_second_order(e2, s2, y);
            const double off = std::abs(printed * (R1 + h) / a - 1.0), off_right = std::abs(right.meridian * (R1 + h) / a - 1.0);
            worst = std::max(worst, off);
            best = std::max(best, off_right);
            m.prime = std::max(m.prime, std::abs(printed2 * (R2 + h) / a - 1.0));
            m.prime_right = std::max(m.prime_right, std::abs(right.prime_vertical * (R2 + h) / a - 1.0));
            const double g = reference(s2, h);
            const double l1 =
                p.g_e *
                (1.0 - 2.0 * y - (p.e2 + 2.0 * p.q - 3.0 * y) * y +
                 (0.5 * (5.0 * p.q - p.e2) - p.e2 * p.e2 / 8.0 + 17.0 / 18.0 * p.q * p.e2 + (3.0 * p.e2 - 5.0 * p.q) * y) * s2 -
                 0.5 * p.q * p.e2 * s2 * s2 + p.e2 * (0.5 * p.e2 - 7.0 * p.q) / 16.0 * S2);
            const double l3 = p.g_e * (1.0 + 5.2884e-3 * s2) * (1.0 - 2.0 * y * (1.0 - std::sqrt(p.e2) * s2));
            worst_g = std::max(worst_g, std::abs(l1 - g));
            best_g = std::max(best_g, std::abs(earth::paper_a_gravity_l1(p, s2, h).down - g));
            m.l3 = std::max(m.l3, std::abs(l3 - g));
            m.l3_right = std::max(m.l3_right, std::abs(earth::paper_a_gravity_l3(p, s2, h) - g));
        }
        m.meridian = std::max(m.meridian, worst);
        m.meridian_right = std::max(m.meridian_right, best);
        m.l1 = std::max(m.l1, worst_g);
        m.l1_right = std::max(m.l1_right, best_g);
        lat.push_back(i);
        printed_error.push_back(worst);
        right_error.push_back(best);
        printed_gravity.push_back(1e5 * worst_g);
        right_gravity.push_back(1e5 * best_g);
    }
    PaperResult out;
    // clang-format off
    out.numbers = {{"meridian", m.meridian}, {"meridian corrected", m.meridian_right}, {"prime vertical", m.prime}, {"gravity L1", m.l1},
                   {"gravity L1 corrected", m.l1_right}, {"gravity L3", m.l3}, {"gravity L3 corrected", m.l3_right}};
    // clang-format on
    report::Panel radii{"1/(R1 + H): largest relative error over 0 to 20 km", "latitude, deg", "relative error"};
    radii.time_axis = false;
    radii.log_y = true;
    radii.series = {paper_curve("as printed", lat, printed_error, report::Ink::Vermillion),
                    paper_curve("corrected", lat, right_error)};
    report::Panel gravity{"first series of gravity: largest error over 0 to 20 km", "latitude, deg", "mGal"};
    gravity.time_axis = false;
    gravity.series = {paper_curve("as printed", lat, printed_gravity, report::Ink::Vermillion),
                      paper_curve("corrected", lat, right_gravity)};
    out.panels = {std::move(radii), std::move(gravity)};
    out.notes = "Reference: radii of the ellipsoid in closed form; normal gravity of 1930 with free air of the second order.\n";
    return out;
}

PaperResult estimators(const PaperWork& w) {
    constexpr int m = 20;
    const auto root = [](double square, double n) { return std::sqrt(square / n); };
    math::Random random(w.seed, "estimators");
    Eigen::MatrixXd A = Eigen::MatrixXd::Ones(m, 1), R = Eigen::MatrixXd::Zero(m, m), same = Eigen::MatrixXd::Identity(m, m);
    for (int i = 0; i < m; ++i) R(i, i) = std::pow(1.0 + 4.0 * i / (m - 1.0), 2.0);
    double ls = 0.0, ml = 0.0, mean = 0.0, kalman = 0.0, alike = 0.0, recursive = 0.0, walk_mean = 0.0, walk_kalman = 0.0;
    const auto runs = static_cast<double>(w.runs);
    std::vector<double> step, of_mean(200, 0.0), of_kalman(200, 0.0);
    for (std::size_t run = 0; run < w.runs; ++run) {
        Eigen::VectorXd y(m), z(m);
        estim::RecursiveMean r;
        estim::ScalarKalman k{0.0, 1e12, 0.0, 1.0};
        for (int i = 0; i < m; ++i) {
            y(i) = std::sqrt(R(i, i)) * random.normal();
            z(i) = random.normal();
            r.add(y(i));
            k.r = R(i, i);
            static_cast<void>(k.update(y(i)));
        }
        const double least = estim::least_squares(A, y).x(0);
        ls += least * least;
        ml += std::pow(estim::maximum_likelihood(A, y, R).x(0), 2.0);
        mean += r.mean * r.mean;
        kalman += k.x * k.x;
        recursive = std::max(recursive, std::abs(r.mean - y.mean()));
        alike += std::pow(estim::maximum_likelihood(A, z, same).x(0) - estim::least_squares(A, z).x(0), 2.0);
        // a parameter that walks by 0.1 per measurement
        estim::RecursiveMean slow;
        estim::ScalarKalman quick{0.0, 1e12, 0.01, 1.0};
        double truth = 0.0;
        for (std::size_t i = 0; i < of_mean.size(); ++i) {
            truth += 0.1 * random.normal();
            const double measured = truth + random.normal();
            slow.add(measured);
            quick.predict(1.0);
            static_cast<void>(quick.update(measured));
            of_mean[i] += std::pow(slow.mean - truth, 2.0) / runs;
            of_kalman[i] += std::pow(quick.x - truth, 2.0) / runs;
        }
    }
    for (std::size_t i = 0; i < of_mean.size(); ++i) {
        step.push_back(static_cast<double>(i + 1));
        of_mean[i] = std::sqrt(of_mean[i]);
        of_kalman[i] = std::sqrt(of_kalman[i]);
    }
    walk_mean = of_mean.back();
    walk_kalman = of_kalman.back();
    estim::ScalarKalman gain{0.0, 1e12, 0.0, 1.0};
    double tenth = 0.0;
    for (int i = 0; i < 10; ++i) tenth = gain.update(0.0);
    PaperResult out;
    out.numbers = {{"gain", tenth},
                   {"recursive", recursive},
                   {"alike", 1.0 + std::sqrt(alike / runs)},
                   {"unlike", std::sqrt(ml / ls)},
                   {"walk", walk_kalman / walk_mean}};
    const double by_theory_ls = std::sqrt(R.diagonal().sum()) / m,
                 by_theory_ml = 1.0 / std::sqrt(R.diagonal().cwiseInverse().sum());
    report::ResultTable table{
        "root mean square error",
        {{"estimator", "estimator"}, {"constant", "constant, sigmas 1 to 5"}, {"theory", "by theory"}, {"walk", "walking"}}};
    table.rows = {{"least squares", root(ls, runs), by_theory_ls},
                  {"maximum likelihood", root(ml, runs), by_theory_ml},
                  {"recursive mean", root(mean, runs), by_theory_ls, walk_mean},
                  {"Kalman", root(kalman, runs), by_theory_ml, walk_kalman}};
    out.tables.push_back(std::move(table));
    report::Panel panel{"a parameter that walks by 0.1 a measurement of sigma 1", "measurement", "root mean square error"};
    panel.time_axis = false;
    panel.series = {paper_curve("recursive mean, k = 1/(m + 1)", step, of_mean, report::Ink::Vermillion),
                    paper_curve("Kalman filter", step, of_kalman)};
    out.panels.push_back(std::move(panel));
    out.notes = fmt::format(
        "{} instruments measure one constant, {} times; the recursive mean is least squares one by one, the Kalman filter maximum likelihood\n",
        m, w.runs);
    return out;
}

}  // namespace

std::vector<PaperItem> paper_a_algorithms() {
    return {{"A", "series-1.3.1", "series of 1/(R + H) and of gravity, printed and corrected", 0, 0.1, series},
            {"A", "section-1.3", "attitude algorithms compared: Euler, direction cosines, quaternion, Picard pair, rates split",
             0, 2.0, attitude},
            {"A", "chapter-2", "estimators compared: least squares, maximum likelihood, recursive mean, Kalman", 2000, 0.0005,
             estimators}};
}

}  // namespace schuler::study
