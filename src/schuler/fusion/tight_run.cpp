#include "schuler/fusion/tight_run.h"

#include "schuler/core/error.h"
#include "schuler/earth/earth.h"
#include "schuler/fusion/detail/loose_run_impl.h"

#include <algorithm>
#include <chrono>

namespace schuler::fusion {

Layout tight_inertial_layout(bool with_baro) {
    Layout layout;
    if (with_baro) layout.baro_bias = TightLayout::baro_bias;
    layout.size = TightLayout::inertial;
    return layout;
}

TightModel make_tight_model(const Settings& settings, bool with_baro) {
    Settings closed = settings;
    closed.loop = Loop::Closed;
    TightModel model{make_model<TightLayout::inertial>(closed, tight_inertial_layout(with_baro)), settings.ranging,
                     settings.gnss.lever_arm_b};
    const sensor::ImuErrorModel& imu = settings.imu.errors;
    model.gyro_gain = std::hypot(imu.gyro_scale, imu.gyro_misalignment);
    model.accel_gain = std::hypot(imu.accel_scale, imu.accel_misalignment);
    const double time = settings.ranging.baro_bias_time, sigma = settings.baro.bias_std;
    if (with_baro && time > 0.0) model.inertial.process[TightLayout::baro_bias] = {1.0 / time, 2.0 * sigma * sigma / time};
    return model;
}

namespace {

/// Collects what a pass reports.
template <class Frame>
struct TightCollector : TightObserver<Frame> {
    TightCollector(const TightModel& model_, const Settings& settings_, Result& result_, Time start)
        : model(model_), settings(settings_), result(result_), next_sensor(start) {}

    void output(const TightFilter<Frame>& f, Time time) override {
        constexpr int n = TightLayout::inertial;
        const NavState nav = f.geographic(model);
        const Matrix9 P = f.local_covariance(model);
        result.forward.rows.push_back(solution_row(nav, P));
        if (time < next_sensor) return;
        while (next_sensor <= time) next_sensor = next_sensor + Duration::from_seconds(sensor_row_spacing);
        if (settings.state_rows) result.forward.states.push_back(state(f, nav, P));
        const Eigen::Matrix<double, n, 1> variances = f.P.diagonal().template head<n>();
        result.forward.sensor_errors.push_back(
            sensor_error_row<n>(time, model.inertial.layout, f.inertial.parameters, variances));
    }
    StateRow state(const TightFilter<Frame>& f, const NavState& nav, const Matrix9& P) const {
        constexpr int n = TightLayout::inertial;
        const Eigen::Matrix<double, n, n> corner = f.P.template topLeftCorner<n, n>();
        StateRow row = state_row<n>(model.inertial.layout, nav, f.inertial.parameters, corner, P);
        row.clock.dof = 2;
        row.clock.value.template head<2>() = f.parameters.template segment<2>(TightLayout::clock);
        row.clock.covariance.template topLeftCorner<2, 2>() = f.P.template block<2, 2>(TightLayout::clock, TightLayout::clock);
        return row;
    }
    void aid(const AidRecord& r) override { result.aids.push_back(r); }
    void ranges(const TightWalk<Frame>& walk, const RangeEpoch& epoch) override {
        ++result.counters.gnss_epochs;
        ++(walk.work.excluded == 0 ? result.counters.gnss_accepted : result.counters.gnss_rejected);
        for (const RangeScalar& s : walk.work.all()) {
            AidRecord r;
            r.time = walk.filter.time();
            r.stamp = epoch.time;
            r.kind = s.is_rate ? AidKind::RangeRate : AidKind::Pseudorange;
            r.source = s.source;
            r.status = s.use ? AidStatus::Accepted : AidStatus::Rejected;
            r.dof = 1;
            r.sigma(0) = s.use ? std::sqrt(s.s) : std::sqrt(s.variance);
            r.innovation(0) = s.use ? s.sequential * r.sigma(0) : s.innovation;
            r.sigma_state(0) = std::sqrt(std::max(0.0, s.s - s.variance));
            r.nis = r.innovation(0) * r.innovation(0) / (r.sigma(0) * r.sigma(0));
            result.aids.push_back(r);
        }
        if (settings.ranging.protection.use) protect(walk, epoch);
        if (!after) return;
        const TightFilter<Frame>& f = walk.filter;
        const NavState nav = f.geographic(model);
        const Eigen::Matrix3d C_nb = nav.q_nb.toRotationMatrix();
        const Eigen::Vector3d lever_n = C_nb * model.lever_arm_b;
        after(epoch, earth::moved_by_ned(model.inertial.earth, nav.position, lever_n), f.local_covariance(model).template topLeftCorner<3, 3>());
    }
    void protect(const TightWalk<Frame>& walk, const RangeEpoch& epoch) {
        const TightFilter<Frame>& f = walk.filter;
        const Matrix9 T = f.inertial.to_local_level(model.inertial);
        const Matrix9 P = f.local_covariance(model);
        const ProtectionLevels l = f.watch.levels(limits, P.template topLeftCorner<3, 3>(), T.template topRows<3>());
        const int used = static_cast<int>(std::ranges::count_if(walk.work.all(), &RangeScalar::use));
        result.forward.protection.push_back({epoch.time, l.horizontal, l.vertical, used, walk.work.excluded, walk.work.alarm});
    }
    void outage_epoch(const TightFilter<Frame>&, const Event& event, const AidRecord& r) override {
        result.forward.outage_epochs.push_back({event.outage, event.stamp, event.outage_end, r.innovation, r.sigma});
    }

    const TightModel& model;
    const Settings& settings;
    Result& result;
    Time next_sensor;
    AfterRanges after{};
    ProtectionLimits limits = settings.ranging.protection.use ? ProtectionLimits(settings.ranging.protection) : ProtectionLimits{};
};

/// What the filter tells a receiver after `last`, which followed `before`: their means tell the force at the end of the last and
/// how it changes.
template <class Frame>
Guide guide_of(const TightModel& model, TightWalk<Frame>& walk, const ImuIncrement& before, const ImuIncrement& last) {
    TightFilter<Frame>& f = walk.filter;
    f.bring_up(model);   // sigmas that do not grow while nothing is received would look for it where it was
    const Estimate e = estimate_of(model.inertial, f.inertial);
    const Eigen::Vector3d mean = last.dv / last.dt, change = (mean - before.dv / before.dt) / (0.5 * (last.dt + before.dt));
    const Eigen::Vector3d f_b = mean + 0.5 * last.dt * change - e.parameters.template segment<3>(Layout::accel_bias);
    Guide g;
    g.time = f.time();
    g.antenna = antenna_motion(model.inertial.earth, e.nav, f_b, e.w_ib_b, model.lever_arm_b);
    g.C_en = earth::C_en(e.nav.position.lat, e.nav.position.lon);
    g.jerk_e = g.C_en * (e.C_nb * (change + e.w_ib_b.cross(f_b)));
    g.P = f.local_covariance(model).template topLeftCorner<6, 6>();
    g.drift = f.parameters(TightLayout::drift);
    g.clock = f.parameters(TightLayout::clock);
    g.std_clock = std::sqrt(std::max(0.0, f.P(TightLayout::clock, TightLayout::clock)));
    g.std_drift = std::sqrt(std::max(0.0, f.P(TightLayout::drift, TightLayout::drift)));
    return g;
}

template <class Frame>
Result run_in(const RunData& data, const Settings& settings, const Start& start, const PassOptions& options, Time origin,
              const AfterRanges& after) {
    const TightModel model = make_tight_model(settings, !data.recording->baro.empty() && settings.baro.use);
    const Walk<Frame, TightLayout::inertial> first =
        first_step<Frame, TightLayout::inertial>(model.inertial, data, settings, start);
    TightWalk<Frame> walk;
    walk.filter.inertial = first.filter;
    walk.filter.start(model, first.filter.P);
    walk.increment = first.increment;
    walk.next_output = first.next_output;
    Result result;
    TightCollector<Frame> collector(model, settings, result, walk.filter.time());
    collector.after = after;
    const TightPass<Frame> pass(model, data, settings, origin);
    const std::size_t end = std::min(options.last_increment, data.imu.increments.size() - 1);
    const auto begin = std::chrono::steady_clock::now();
    const std::size_t block = options.receiver ? 1 : 16 * stretch;
    for (std::size_t last = walk.increment - 1; walk.increment <= end;) {
        last = std::min(last + block, end);
        if (options.receiver) {
            const auto back = [&](std::size_t n) -> const ImuIncrement& { return data.imu.increments[last - std::min(last, n)]; };
            options.receiver(guide_of(model, walk, back(2), back(1)), back(0).time);
        }
        pass.advance(walk, last, collector);
        if (options.progress && (block > 1 || last % stretch == 0))
            options.progress(static_cast<double>(walk.increment) / static_cast<double>(end + 1));
    }
    result.filter_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (options.rows) options.rows(result.forward.rows);
    return result;
}

}  // namespace

Result run_tight_pass(const RunData& data, const Settings& settings, const Start& start, const PassOptions& options, Time origin,
                      const AfterRanges& after) {
    if (data.recording->ranges.empty() && !options.receiver)
        throw input_error("there are no pseudoranges", {.file = {}, .key = "filter.scheme"},
                          "give raw measurements ([gnss] observations or [stations] file), or choose --scheme loose");
    return settings.mechanization == Mechanization::Ecef ? run_in<EarthFixedFrame>(data, settings, start, options, origin, after)
                                                         : run_in<GeographicFrame>(data, settings, start, options, origin, after);
}

}  // namespace schuler::fusion
