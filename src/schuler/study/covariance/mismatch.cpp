#include "schuler/study/covariance/mismatch.h"

#include "schuler/estim/joint_covariance.h"
#include "schuler/filter/states/model.h"
#include "schuler/filter/update/pass.h"
#include "schuler/study/covariance/errorless_run.h"
#include "schuler/study/covariance/range_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::study {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using filter::Layout;
using filter::MeasurementKind;
using Frame = filter::GeographicFrame;
using Filter = filter::InertialFilter<Frame>;
using FilterRun = filter::FilterRun<Frame>;

/// Effect of a source's true processes on the inertial unit's output.
enum class Drive { None, Gyro, Accel, GyroAxes, AccelAxes };

/// True processes beside the filter's states: joint vector (errors of the first nine states, estimates of the others, processes).
struct ErrorSource {
    SourceName name;
    Drive drive = Drive::None;
    VectorXd variance, decay, psd;                                            ///< of each process, initial; 1/s; unit^2/s
    Eigen::Matrix<double, 9, 9> start = Eigen::Matrix<double, 9, 9>::Zero();  ///< of the first nine errors
    double gyro_psd = 0.0, accel_psd = 0.0;
    std::optional<MeasurementKind> slow;  ///< the processes are errors of this measurement
    Vector3d white_position = Vector3d::Zero(), white_velocity = Vector3d::Zero();
    double white_baro = 0.0;
    bool decays_with_speed = false;

    [[nodiscard]] Eigen::Index size() const { return variance.size(); }
    /// True if it causes no errors.
    [[nodiscard]] bool empty() const {
        return variance.isZero(0.0) && psd.isZero(0.0) && start.isZero(0.0) && gyro_psd == 0.0 && accel_psd == 0.0 &&
               white_position.isZero(0.0) && white_velocity.isZero(0.0) && white_baro == 0.0;
    }
    void processes(const VectorXd& sigma, const VectorXd& decay_, const VectorXd& psd_) {
        variance = sigma.array().square();
        decay = decay_;
        psd = psd_;
    }
    /// Adds stationary processes.
    void markov(const VectorXd& sigma, double time) {
        processes(sigma, VectorXd::Constant(sigma.size(), 1.0 / time), 2.0 / time * sigma.array().square());
    }
    [[nodiscard]] double white(MeasurementKind kind, Eigen::Index axis) const {
        const double sigma = kind == MeasurementKind::GnssPosition   ? white_position(axis)
                             : kind == MeasurementKind::GnssVelocity ? white_velocity(axis)
                             : kind == MeasurementKind::Baro         ? white_baro
                                                                     : 0.0;
        return sigma * sigma;
    }
};

VectorXd repeated(double first, double then, Eigen::Index n) {
    VectorXd out(2 * n);
    out << VectorXd::Constant(n, first), VectorXd::Constant(n, then);
    return out;
}

/// The matrix (three rows) of scale factors and misalignments acting on a measured vector.
Eigen::Matrix<double, 3, 9> axes_acting_on(const Vector3d& v) {
    Eigen::Matrix<double, 3, 9> m = Eigen::Matrix<double, 3, 9>::Zero();
    m.leftCols<3>() = v.asDiagonal();
    m.row(0).segment<2>(3) << v.y(), v.z();
    m.row(1).segment<2>(5) << v.x(), v.z();
    m.row(2).segment<2>(7) << v.x(), v.y();
    return m;
}

/// `fixes`: those of a receiver are used.
std::vector<ErrorSource> sources_of(const settings::ScenarioConfig& s, bool fixes) {
    std::vector<ErrorSource> out;
    const auto add = [&](const char* key, const char* title) -> ErrorSource& {
        ErrorSource& source = out.emplace_back();
        source.name = {key, title};
        source.processes(VectorXd(0), VectorXd(0), VectorXd(0));
        return source;
    };
    const sensor::ImuErrorModel& e = s.sim.imu.errors;
    for (const auto& [key, title] : {std::pair{"initial_position", "initial position"},
                                     {"initial_velocity", "initial velocity"},
                                     {"initial_level", "initial level"},
                                     {"initial_heading", "initial heading"}})
        add(key, title);
    const auto bias = [&](const char* key, const char* title, Drive drive, double in_run, double time, double turn_on,
                          double walk) {
        ErrorSource& b = add(key, title);
        b.drive = drive;
        b.processes(repeated(in_run, turn_on, 3), repeated(1.0 / time, 0.0, 3),
                    repeated(2.0 * in_run * in_run / time, walk * walk, 3));
    };
    const auto axes = [&](const char* key, const char* title, Drive drive, double scale, double misalignment) {
        ErrorSource& a = add(key, title);
        a.drive = drive;
        VectorXd sigma(9);
        sigma << Vector3d::Constant(scale), VectorXd::Constant(6, misalignment);
        a.processes(sigma, VectorXd::Zero(9), VectorXd::Zero(9));
    };
    bias("gyro_bias", "gyro bias", Drive::Gyro, e.gyro_bias, e.gyro_bias_time, e.gyro_turn_on_bias, e.gyro_rate_walk);
    add("gyro_noise", "gyro noise").gyro_psd = e.gyro_noise * e.gyro_noise;
    axes("gyro_scale", "gyro scale and axes", Drive::GyroAxes, e.gyro_scale, e.gyro_misalignment);
    bias("accel_bias", "accelerometer bias", Drive::Accel, e.accel_bias, e.accel_bias_time, e.accel_turn_on_bias,
         e.accel_rate_walk);
    add("accel_noise", "accelerometer noise").accel_psd = e.accel_noise * e.accel_noise;
    axes("accel_scale", "accelerometer scale and axes", Drive::AccelAxes, e.accel_scale, e.accel_misalignment);
    if (fixes && s.sim.gnss.rate > 0.0) {
        ErrorSource& white = add("gnss_white", "receiver, white");
        white.white_position = s.sim.gnss.white_position;
        white.white_velocity = s.sim.gnss.white_velocity;
        const sensor::GnssErrorModel& g = s.sim.gnss.errors;
        ErrorSource& position = add("gnss_position", "receiver, slow position");
        position.markov(g.correlated_position, g.correlated_time);
        position.slow = MeasurementKind::GnssPosition;
        position.decays_with_speed = g.correlated_distance > 0.0;
        ErrorSource& velocity = add("gnss_velocity", "receiver, slow velocity");
        velocity.markov(g.correlated_velocity, g.correlated_velocity_time);
        velocity.slow = MeasurementKind::GnssVelocity;
    }
    if (s.sim.baro.rate > 0.0) {
        const sim::BaroSettings& b = s.sim.baro;
        ErrorSource& baro = add("baro", "barometer");
        const VectorXd sigma = VectorXd::Constant(1, b.bias);
        if (b.bias_time > 0.0) {
            baro.markov(sigma, b.bias_time);
        } else {
            baro.processes(sigma, VectorXd::Zero(1), VectorXd::Constant(1, b.bias_walk * b.bias_walk));
        }
        baro.slow = MeasurementKind::Baro;
        baro.white_baro = b.white;
    }
    return out;
}

std::vector<std::string> left_out_of(const settings::ScenarioConfig& s) {
    const sensor::ImuErrorModel& e = s.sim.imu.errors;
    std::vector<std::string> out;
    if (e.gyro_flicker > 0.0 || e.accel_flicker > 0.0) out.emplace_back("flicker of the inertial sensors");
    if ((e.gyro_temperature > 0.0 || e.accel_temperature > 0.0) && s.sim.imu.warm_up != 0.0)
        out.emplace_back("temperature errors");
    if (e.gyro_g > 0.0) out.emplace_back("g-dependent gyro bias");
    if (e.gyro_quantum > 0.0 || e.accel_quantum > 0.0) out.emplace_back("quantization");
    if (!s.sim.gnss.constellation_changes.empty()) out.emplace_back("changes of constellation");
    return out;
}

/// Propagates the sources along a run.
class Follower : public filter::PassObserver<Frame> {
public:
    Follower(const filter::InertialModel& model, const settings::ScenarioConfig& scenario,
             const std::vector<ErrorSource>& sources, Time origin, Mismatch& out)
        : model_(model), scenario_(scenario), sources_(sources), origin_(origin), out_(out) {}

    void begin(const FilterRun& run) {
        const auto states = static_cast<int>(run.filter.P.rows());
        filter_ = &run.filter;
        phi_ = estim::GatheredTransition(states);
        for (const ErrorSource& s : sources_) joint_.emplace_back(states, s.start, s.variance);
        if (model_.layout.clock >= 0) ranges_.emplace(model_.layout, run.filter);
    }
    [[nodiscard]] bool records() const override { return true; }
    void step(const estim::Transition& phi) override { last_ = phi; }
    void propagated(const Filter& f, double span) override {
        const bool sheared = last_.shear_count > 0;  // a state integrates another
        if (sheared) settle();
        const Matrix9x3 by_gyro = columns_of(Layout::gyro_bias), by_accel = columns_of(Layout::accel_bias);
        const Vector3d force = f.previous.dt > 0.0 ? Vector3d(f.previous.dv / f.previous.dt) : Vector3d::Zero();
        const double speed = f.geographic(model_).v_eb_n.head<2>().norm();
        if (!sheared) phi_.add(last_);
        if (ranges_) ranges_->step(model_, f, last_, span);
        for (std::size_t k = 0; k < sources_.size(); ++k) {
            const ErrorSource& s = sources_[k];
            if (s.empty()) continue;
            Joint::Drive drive(9, 0);
            switch (s.drive) {
                case Drive::None: break;
                case Drive::Gyro: drive = repeated(-by_gyro); break;
                case Drive::Accel: drive = repeated(-by_accel); break;
                case Drive::GyroAxes: drive = -by_gyro * axes_acting_on(f.w_ib_b); break;
                case Drive::AccelAxes: drive = -by_accel * axes_acting_on(force); break;
            }
            Joint::Processes decays(s.size()), noise(s.size());
            for (Eigen::Index i = 0; i < s.size(); ++i) {
                const double decay = s.decays_with_speed ? scenario_.sim.gnss.errors.position_decay(speed) : s.decay(i);
                const double psd = s.decays_with_speed ? 2.0 * decay * s.variance(i) : s.psd(i);
                decays(i) = decay > 0.0 ? std::exp(-decay * span) : 1.0;
                noise(i) = decay > 0.0 ? -psd / (2.0 * decay) * std::expm1(-2.0 * decay * span) : psd * span;
            }
            Joint::Matrix9 white;
            if (s.gyro_psd > 0.0) white.noalias() = s.gyro_psd / span * by_gyro.lazyProduct(by_gyro.transpose());
            else if (s.accel_psd > 0.0) white.noalias() = s.accel_psd / span * by_accel.lazyProduct(by_accel.transpose());
            const Joint::Matrix9* added = s.gyro_psd > 0.0 || s.accel_psd > 0.0 ? &white : nullptr;
            if (sheared) joint_[k].step_with_shears(last_, drive, decays, noise, added);
            else joint_[k].step(last_, drive, decays, noise, added);
        }
    }
    void scalar(const estim::RowUpdate& u) override { pending_.push_back(u); }
    void renewed(int state) override {
        settle();
        for (std::size_t k = 0; k < sources_.size(); ++k)
            if (!sources_[k].empty()) joint_[k].renew(state);
        if (ranges_) ranges_->renewed(state, filter_->P(state, state));
    }
    void cloned(int, const std::array<estim::Row, 3>&) override {
        throw unfollowed("phases of carriers are among its measurements");
    }
    void ranges(const FilterRun&, const RangeEpoch&) override {
        settle();
        for (const estim::RowUpdate& u : pending_) {
            for (std::size_t k = 0; k < sources_.size(); ++k)
                if (!sources_[k].empty()) joint_[k].correct(u.h, u.k, -1, 0.0, 0.0);
            ranges_->correct(u, true);
        }
        pending_.clear();
    }
    void corrected() override { throw unfollowed("the corrections of this coupling are not updates of a Kalman filter"); }
    void measurement(const filter::MeasurementRecord& record) override {
        settle();
        for (const estim::RowUpdate& u : pending_) update(record.kind, u);
        pending_.clear();
    }
    void output(const FilterRun& run, Time time) override { out_.rows.push_back(row_at(run, time)); }
    void outage_epoch(const FilterRun& run, const filter::Event& event, const filter::Measurement&,
                      const filter::MeasurementRecord&) override {
        if (event.outage_end) out_.outage_ends.push_back(row_at(run, event.stamp));
    }

private:
    using Joint = estim::JointCovariance;
    using Matrix9x3 = Eigen::Matrix<double, 9, 3>;

    /// Three columns of the first nine rows of the transition.
    [[nodiscard]] Matrix9x3 columns_of(int first) const {
        if (last_.shear_count == 0) return last_.rows.middleRows<3>(first).transpose();
        Matrix9x3 out;
        filter::StateVector unit = filter::StateVector::Zero(phi_.diagonal.size());
        for (int i = 0; i < 3; ++i) {
            unit(first + i) = 1.0;
            out.col(i) = last_.times(unit).head<9>();
            unit(first + i) = 0.0;
        }
        return out;
    }
    static Joint::Drive repeated(const Matrix9x3& once) {
        Joint::Drive out(9, 6);
        out << once, once;
        return out;
    }
    /// Carries out the steps since the last time.
    void settle() {
        for (std::size_t k = 0; k < sources_.size(); ++k)
            if (!sources_[k].empty()) joint_[k].settle(phi_);
        phi_.reset();
    }
    [[nodiscard]] MismatchRow row_at(const FilterRun& run, Time time) {
        settle();
        MismatchRow row;
        row.time_s = (time - origin_).seconds();
        row.filter = run.covariance(model_).diagonal();
        for (Joint& j : joint_) row.sources.push_back(j.variances());
        if (ranges_) row.sources.push_back(ranges_->variances());
        return row;
    }
    void update(MeasurementKind kind, const estim::RowUpdate& u) {
        const bool velocity = kind == MeasurementKind::GnssVelocity;
        Eigen::Index axis = 0;
        if (kind == MeasurementKind::GnssPosition || velocity) u.h.head.segment<3>(velocity ? 3 : 0).cwiseAbs().maxCoeff(&axis);
        const int state = kind == MeasurementKind::GnssPosition ? model_.layout.gnss_position
                          : velocity                            ? model_.layout.gnss_velocity
                          : kind == MeasurementKind::Baro       ? model_.layout.baro_bias
                                                                : -1;
        double seen = -1.0;  // the innovation is estimate minus measured
        if (state >= 0 && u.h(state + static_cast<int>(axis)) != 0.0) seen = -u.h(state + static_cast<int>(axis));
        for (std::size_t k = 0; k < sources_.size(); ++k) {
            const ErrorSource& s = sources_[k];
            if (s.empty()) continue;
            joint_[k].correct(u.h, u.k, s.slow == kind ? static_cast<int>(axis) : -1, seen, s.white(kind, axis));
        }
        if (ranges_) ranges_->correct(u, false);
    }

    const filter::InertialModel& model_;
    const settings::ScenarioConfig& scenario_;
    const std::vector<ErrorSource>& sources_;
    Time origin_;
    Mismatch& out_;
    std::vector<Joint> joint_;  ///< of each source
    std::optional<RangeErrors> ranges_;
    const Filter* filter_ = nullptr;
    estim::Transition last_;
    estim::GatheredTransition phi_;  ///< since the last settle()
    std::vector<estim::RowUpdate> pending_;
};

/// The initial covariance of the first nine errors, from one kind of initial error.
Eigen::Matrix<double, 9, 9> start_covariance(const filter::InertialModel& model, const filter::RunData& data,
                                             const fusion::Settings& settings, filter::Start start,
                                             const settings::InitialError& e, std::size_t which) {
    start.std_position.setConstant(which == 0 ? e.position : 0.0);
    start.std_velocity.setConstant(which == 1 ? e.velocity : 0.0);
    start.std_rpy = which == 2   ? Vector3d(e.level, e.level, 0.0)
                    : which == 3 ? Vector3d(0.0, 0.0, e.heading)
                                 : Vector3d(0.0, 0.0, 0.0);
    start.std_gyro_bias.setZero();
    start.std_accel_bias.setZero();
    start.position_of_fix.setZero();
    start.velocity_of_fix.setZero();
    start.position_rate.setZero();
    start.velocity_rate.setZero();
    start.heading_rate = 0.0;
    start.heading_of_mag = start.heading_of_sensor = false;
    start.undecided_heading = 0.0;
    return filter::first_step<Frame>(model, data, settings, start).filter.P.topLeftCorner<9, 9>();
}

}  // namespace

Variances MismatchRow::all() const {
    Variances sum = Variances::Zero();
    for (const Variances& v : sources) sum += v;
    return sum;
}

std::shared_ptr<const sim::ExactFlight> flight_of_mismatch(const settings::ScenarioConfig& scenario, double rate) {
    sim::Scenario flown = scenario.sim;
    flown.imu.rate = std::min(flown.imu.rate, rate);
    flown.reference_rate = slow_reference;
    return sim::exact_flight(flown);
}

Mismatch mismatch(const settings::ScenarioConfig& scenario, const settings::SettingList& over, double rate,
                  const sim::ExactFlight* flown_before) {
    if (!scenario.initial_error.given())
        throw input_error(
            "the scenario does not give the initial errors of the filter", {.file = {}, .key = "filter.initial_error"},
            "give level_deg and heading_deg: the result of a self-alignment is not a linear function of the errors");
    if (scenario.receiver_channels.rate > 0.0)
        throw input_error("the loops of a receiver are not among the errors of this analysis",
                          {.file = {}, .key = "receiver.rate_hz"}, "use `schuler analyze budget`");
    ErrorlessRun errorless(scenario, over, rate, flown_before);
    const fusion::Settings& settings = errorless.settings;
    const bool tight = settings.coupling == filter::Coupling::Tight;
    if (!tight && settings.coupling != filter::Coupling::Loose)
        throw unfollowed("only the loose and the tight scheme are followed");
    if (!tight && scenario.ranging.rate > 0.0)
        throw input_error("fixes from ranges of single satellites are not among the errors of this analysis",
                          {.file = {}, .key = "ranges.rate_hz"},
                          "choose --set filter.scheme=tight, or use `schuler analyze budget`");
    if (settings.mechanization != fusion::Mechanization::Geographic)
        throw unfollowed("only the geographic mechanization is followed");
    errorless.prepare();
    const filter::RunData& data = errorless.data;
    const filter::Start& start = errorless.start;

    Mismatch out;
    out.name = scenario.name;
    out.left_out = left_out_of(scenario);
    out.settled_s = errorless.bundle.data.config.run.settle.value_or((start.nav.time - data.origin).seconds() + 60.0);
    const filter::InertialModel model = errorless.model();
    std::vector<ErrorSource> sources = sources_of(scenario, !tight);
    for (std::size_t i = 0; i < 4; ++i)
        sources[i].start = start_covariance(model, data, settings, start, scenario.initial_error, i);
    for (const ErrorSource& s : sources) out.sources.push_back(s.name);
    if (tight) out.sources.push_back({"ranges", "ranges and the receiver's clock"});
    FilterRun run = filter::first_step<Frame>(model, data, settings, start);
    Follower follower(model, scenario, sources, data.origin, out);
    follower.begin(run);
    const filter::Pass<Frame> pass(model, data, settings);
    pass.advance(run, data.imu.increments.size() - 1, follower);
    if (tight)
        for (const filter::Outage& o : settings.outages) {  // the last row of each
            const auto after =
                std::ranges::find_if(out.rows, [&](const MismatchRow& r) { return r.time_s > o.start + o.duration; });
            if (after != out.rows.begin() && after != out.rows.end()) out.outage_ends.push_back(*std::prev(after));
        }
    return out;
}

}  // namespace schuler::study
