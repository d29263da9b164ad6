#include "schuler/study/covariance/path_observability.h"

#include "schuler/core/units.h"
#include "schuler/estim/initial_errors.h"
#include "schuler/filter/update/pass.h"
#include "schuler/study/covariance/errorless_run.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace schuler::study {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Frame = filter::GeographicFrame;
using Filter = filter::InertialFilter<Frame>;
using FilterRun = filter::FilterRun<Frame>;

class InitialErrorFollower : public filter::PassObserver<Frame> {
public:
    struct Instant {
        Time time;
        MatrixXd covariance;
    };
    estim::InitialErrors errors;
    std::vector<Instant> history;  ///< of the initial errors, once per second
    VectorXd last;                 ///< variances of the current errors at the last output
    std::size_t refused = 0;

    InitialErrorFollower(const filter::InertialModel& model, const FilterRun& run)
        : errors(run.filter.P, manoeuvre_count),
          model_(model),
          velocity_(run.filter.geographic(model).v_eb_n),
          manoeuvre_(manoeuvre_of(velocity_, Vector3d::Zero(), 0.0)) {}

    [[nodiscard]] bool records() const override { return true; }
    void step(const estim::Transition& phi) override { errors.step(phi); }
    void propagated(const Filter& f, double span) override {
        const Vector3d velocity = f.geographic(model_).v_eb_n;
        const Manoeuvre now = manoeuvre_of(velocity, (velocity - velocity_) / span, f.w_ib_b.norm());
        velocity_ = velocity;
        manoeuvre_ = measured_ ? now : std::max(manoeuvre_, now);
        measured_ = false;
    }
    void scalar(const estim::RowUpdate& u) override {
        errors.scalar(u, static_cast<std::size_t>(manoeuvre_));
        measured_ = true;
    }
    void renewed(int state) override { errors.renewed(state); }
    void cloned(int, const std::array<estim::Row, 3>&) override {
        throw unfollowed("phases of carriers are among its measurements");
    }
    void corrected() override { throw unfollowed("the corrections of this coupling are not updates of a Kalman filter"); }
    void measurement(const filter::MeasurementRecord& record) override {
        refused += record.status == filter::MeasurementStatus::Rejected ? 1 : 0;
    }
    void output(const FilterRun& run, Time time) override {
        history.push_back({time, errors.covariance()});
        last = run.filter.P.diagonal().cast<double>();
    }

private:
    const filter::InertialModel& model_;
    Vector3d velocity_;
    Manoeuvre manoeuvre_;
    bool measured_ = true;
};

std::vector<StateName> names_of(const filter::Layout& layout) {
    std::vector<StateName> names;
    for (const filter::LayoutBlock& block : layout.blocks()) {
        const bool navigation = block.offset < filter::Layout::navigation;
        for (int i = 0; i < block.size && block.offset + i < layout.without_slots(); ++i) {
            std::string name(block.name);
            constexpr std::array<const char*, 3> level{"_north", "_east", "_down"}, body{"_x", "_y", "_z"};
            if (block.size == 3) name += navigation ? level[static_cast<std::size_t>(i)] : body[static_cast<std::size_t>(i)];
            else if (block.size > 1) name += "_" + std::to_string(i + 1);
            names.push_back({std::move(name), std::string(block.unit)});
        }
    }
    return names;
}

/// A combination v . x of the initial errors.
Observed observed(const InitialErrorFollower& f, const VectorXd& sigma, const VectorXd& weights, Time origin) {
    Observed out;
    out.weights.assign(weights.begin(), weights.end());
    const Eigen::Index n = weights.size();
    VectorXd v = VectorXd::Zero(f.errors.start().rows());
    for (Eigen::Index i = 0; i < n; ++i) v(i) = sigma(i) > 0.0 ? weights(i) / sigma(i) : 0.0;
    const auto variance = [&](const MatrixXd& P) { return v.dot(P * v); };
    const double before = variance(f.errors.start()), after = variance(f.errors.covariance()), gained = before - after;
    out.left = before > 0.0 ? std::sqrt(std::max(0.0, after / before)) : 1.0;
    for (std::size_t k = 0; k < manoeuvre_count; ++k) out.shares[k] = gained > 0.0 ? variance(f.errors.gained(k)) / gained : 0.0;
    const auto half =
        std::ranges::find_if(f.history, [&](const auto& i) { return before - variance(i.covariance) >= 0.5 * gained; });
    out.half_s = half == f.history.end() ? not_given : (half->time - origin).seconds();
    return out;
}

/// The scheme whose Kalman filter takes the same measurements as this one, or null if it is one itself.
const char* optimal_scheme(const fusion::Settings& s) {
    switch (s.coupling) {
        case filter::Coupling::Loose: return s.loose_kind == fusion::LooseKind::Standard ? nullptr : "loose";
        case filter::Coupling::Separate: return "loose";
        case filter::Coupling::Tight: return nullptr;
        default: return "tight";
    }
}

/// What is given, with another scheme.
settings::SettingList with_scheme(settings::SettingList over, const char* scheme) {
    over.push_back({"filter.scheme", {std::string(scheme)}, {}});
    over.push_back({"filter.loose", {std::string("standard")}, {}});
    return over;
}

}  // namespace

std::string_view name_of(Manoeuvre manoeuvre) {
    constexpr std::array<std::string_view, manoeuvre_count> names{"at rest", "straight and level", "climb or descent",
                                                                  "change of speed", "turn"};
    return names[static_cast<std::size_t>(manoeuvre)];
}

Manoeuvre manoeuvre_of(const Vector3d& velocity, const Vector3d& acceleration, double rate) {
    constexpr double turning = 1.0 * units::deg, accelerating = 0.2, climbing = 0.5, resting = 0.1;  // rad/s, m/s^2, m/s, m/s
    const double speed = velocity.norm();
    const Vector3d along = speed > resting ? Vector3d(velocity / speed) : Vector3d::Zero();
    const double in_line = acceleration.dot(along);
    if (rate > turning || (speed > resting && (acceleration - in_line * along).norm() > accelerating)) return Manoeuvre::Turn;
    if (acceleration.norm() > accelerating) return Manoeuvre::SpeedChange;
    if (std::abs(velocity.z()) > climbing) return Manoeuvre::Climb;
    return speed > resting ? Manoeuvre::Straight : Manoeuvre::Rest;
}

Manoeuvre Observed::manoeuvre() const { return static_cast<Manoeuvre>(std::ranges::max_element(shares) - shares.begin()); }

PathObservability path_observability(const settings::ScenarioConfig& scenario, const settings::SettingList& over, double rate) {
    auto errorless_run = std::make_unique<ErrorlessRun>(scenario, over, rate);
    if (errorless_run->bundle.data.config.scheme == settings::Scheme::Gnss)
        throw input_error("the scheme is \"gnss\": there is no filter", {.file = {}, .key = "filter.scheme"},
                          "choose another, as --set filter.scheme=loose");
    const char* scheme = optimal_scheme(errorless_run->settings);
    if (scheme != nullptr) errorless_run = std::make_unique<ErrorlessRun>(scenario, with_scheme(over, scheme), rate);
    ErrorlessRun& errorless = *errorless_run;
    fusion::Settings& settings = errorless.settings;
    // Excluded sources, and slow errors that are considered instead of estimated, are no more observable than without.
    std::vector<std::string> set_aside;
    for (const auto& [flag, key] : {std::pair<bool*, const char*>{&settings.integrity.use, "filter.integrity.use"},
                                    {&settings.ranging.protection.use, "filter.protection.use"},
                                    {&settings.gnss.consider_errors, "gnss.consider_errors"}})
        if (std::exchange(*flag, false)) set_aside.emplace_back(key);
    settings.mechanization = fusion::Mechanization::Geographic;  // the errors are the same
    errorless.prepare();
    const filter::InertialModel model = errorless.model();
    FilterRun run = filter::first_step<Frame>(model, errorless.data, settings, errorless.start);
    InitialErrorFollower follower(model, run);
    const filter::Pass<Frame> pass(model, errorless.data, settings);
    pass.advance(run, errorless.data.imu.increments.size() - 1, follower);
    if (follower.history.empty())
        throw input_error("the path is shorter than a second", {.file = {}, .key = "duration_s"}, "give a longer scenario");

    PathObservability out;
    out.name = scenario.name;
    if (scheme != nullptr) out.scheme = scheme;
    out.set_aside = std::move(set_aside);
    out.names = names_of(model.layout);
    out.refused = follower.refused;
    out.duration_s = (follower.history.back().time - errorless.start.nav.time).seconds();
    const auto n = static_cast<Eigen::Index>(out.names.size());
    const MatrixXd start = follower.errors.start().topLeftCorner(n, n);
    out.start = start.diagonal().cwiseSqrt();
    out.end = follower.last.head(n).cwiseSqrt();
    for (Eigen::Index i = 0; i < n; ++i)
        out.states.push_back(observed(follower, out.start, VectorXd::Unit(n, i), errorless.data.origin));

    // Eigenvectors of the covariance left, in sigmas of the start: states without an initial error have no part.
    MatrixXd left = follower.errors.covariance().topLeftCorner(n, n);
    const VectorXd scale = out.start.unaryExpr([](double s) { return s > 0.0 ? 1.0 / s : 0.0; });
    left = scale.asDiagonal() * left * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(left);
    for (Eigen::Index i = 0; i < n; ++i) {
        VectorXd v = eigen.eigenvectors().col(i);
        if (v.cwiseProduct(out.start).isZero(0.0)) continue;
        Eigen::Index largest = 0;
        v.cwiseAbs().maxCoeff(&largest);
        if (v(largest) < 0.0) v = -v;
        out.combinations.push_back(observed(follower, out.start, v, errorless.data.origin));
    }
    std::ranges::stable_sort(out.combinations, {}, &Observed::left);
    return out;
}

}  // namespace schuler::study
