#include "schuler/filter/detail/navigator_engine.h"

#include "schuler/filter/detail/archive.h"
#include "schuler/filter/measurement/instruments.h"
#include "schuler/filter/outputs.h"
#include "schuler/filter/update/pass.h"
#include "schuler/math/rotation.h"

#include <algorithm>
#include <functional>

namespace schuler::filter::detail {
namespace {

/// What an alignment takes from the sample of an instrument.
struct UseAtStart {
    StartUp& start_up;
    const Eigen::Matrix3d& C_bs;
    double declination;
    double& baro_height;

    void operator()(const BaroSample& s) const { baro_height = s.height; }
    void operator()(const MagSample& s) const { start_up.add_mag(C_bs * s.field_b, declination); }
    void operator()(const HeadingSample& s) const { start_up.add_heading(s); }
    void operator()(const auto&) const {}
};

}  // namespace

NavigatorEngine::NavigatorEngine(const NavigatorSettings& s)
    : settings(s), stream(settings), start_up(settings), given_(s.start.has_value()) {}

FeedStatus NavigatorEngine::told(Source source, Time time, FeedStatus status) {
    if (status == FeedStatus::Taken) return status;
    NavigatorEvent e;
    e.time = time;
    e.kind = NavigatorEvent::Kind::Refused;
    e.source = source;
    e.status = status;
    tell(e);
    return status;
}

void NavigatorEngine::tell(NavigatorEvent event) {
    if (events.push(event)) ++stream.counters.events_lost;
}

void NavigatorEngine::add_row(const SolutionRow& row) {
    if (rows.push(row)) ++stream.counters.rows_lost;
}

void NavigatorEngine::enter(Phase next, Time time) {
    if (next == phase) return;
    phase = next;
    NavigatorEvent e;
    e.time = time;
    e.phase = next;
    tell(e);
}

void NavigatorEngine::restart() {
    stream.clear();
    start_up.memory = {};
    given_ = false;
    baro_height_ = not_given;
    phase = Phase::WaitingForImu;
}

FeedStatus NavigatorEngine::feed(const ImuSample& sample) {
    const FeedStatus status = told(Source::Imu, sample.time, stream.feed(sample));
    if (stream.is_elsewhere()) {
        ++stream.counters.restarts;
        restart();
        NavigatorEvent e;
        e.time = sample.time;
        e.kind = NavigatorEvent::Kind::Restarted;
        tell(e);
        return stream.feed(sample);
    }
    while (status == FeedStatus::Taken && stream.settle()) {
        const auto tell_of = [&](NavigatorEvent::Kind kind, double seconds) {
            NavigatorEvent e;
            e.time = stream.settled();
            e.kind = kind;
            e.seconds = seconds;
            tell(e);
        };
        if (stream.hole() > 0.0) tell_of(NavigatorEvent::Kind::Hole, stream.hole());
        if (stream.hangs()) tell_of(NavigatorEvent::Kind::Hang, stream.hole());
        if (!running()) align();
        if (!running() || advance()) continue;
        const Time time = stream.settled();
        restart();
        NavigatorEvent e;
        e.time = time;
        e.kind = NavigatorEvent::Kind::Diverged;
        tell(e);
        break;
    }
    return status;
}

double NavigatorEngine::baro_height_at(Time time) const {
    for (const Event& e : stream.data().events)
        if (e.kind == MeasurementKind::Baro && e.valid >= time) return stream.data().recording->baro[e.index].height;
    return baro_height_;
}

void NavigatorEngine::align() {
    if (!stream.any_increment() || stream.data().imu.increments.empty()) return;
    const bool found = given_ ? align_as_given() : align_by_samples();
    const RunData& data = stream.data();
    const Time now = data.imu.increments.back().time;
    if (found) {
        enter(Phase::Navigating, now);
        return;
    }
    enter(given_ ? Phase::WaitingForStart : start_up.phase(), now);
}

bool NavigatorEngine::align_as_given() {
    constexpr Duration tolerance{100'000};  // same tolerance as a batch
    const RunData& data = stream.data();
    const std::vector<ImuIncrement>& increments = data.imu.increments;
    const Time from = settings.start->nav.time + tolerance;
    const auto first = std::ranges::find_if(increments, [&](const ImuIncrement& i) { return i.time > from; });
    if (first != increments.end()) {
        Start start = *settings.start;
        start.increment = static_cast<std::size_t>(first - increments.begin());
        if (first != increments.begin()) start.previous = *std::prev(first);
        start.nav.time = first->time - Duration::from_seconds(first->dt);
        given_ = false;
        set_out(start, baro_height_at(start.nav.time));
        return true;
    }
    // data earlier than the start by more than the largest measurement age are not required
    const Time old = increments.back().time - Duration{1'000'000'000};
    const auto before = [&](const auto& list, auto time) {
        const auto at = std::ranges::find_if(list, [&](const auto& x) { return std::invoke(time, x) >= old; });
        return static_cast<std::size_t>(at - list.begin());
    };
    std::size_t increment = increments.size() - 1, bridge = 0;
    std::size_t event = before(data.events, &Event::valid), epoch = before(data.recording->ranges.epochs, &RangeEpoch::time);
    std::size_t still = before(data.still.windows, &StillWindow::end);
    for (std::size_t i = 0; i < event; ++i)
        if (data.events[i].kind == MeasurementKind::Baro) baro_height_ = data.recording->baro[data.events[i].index].height;
    stream.judge_still(increments.back().time);
    while (bridge < data.imu.bridges.size() && data.imu.bridges[bridge].last < increment) ++bridge;
    (void)stream.forget({increment, event, epoch, still, bridge}, true);
    return false;
}

bool NavigatorEngine::align_by_samples() {
    const RunData& data = stream.data();
    const std::vector<ImuIncrement>& increments = data.imu.increments;
    for (std::size_t i = start_up.memory.any_increment ? 1 : 0; i < increments.size(); ++i) {  // one of the earlier ones is kept
        const bool interpolated =
            std::ranges::any_of(data.imu.bridges, [i](const Bridge& b) { return b.first <= i && i <= b.last; });
        start_up.add(increments[i], interpolated);
    }
    const Time now = increments.back().time;
    stream.judge_still(now);
    std::size_t still = 0, event = 0, epoch = 0, bridge = data.imu.bridges.size(), increment = increments.size() - 1;
    for (; still < data.still.windows.size(); ++still) start_up.add_still(data.still.windows[still]);
    const Recording& recording = *data.recording;
    const Eigen::Matrix3d C_bs = math::dcm_from_rpy(settings.filter.imu.mounting_rpy) * settings.filter.imu.C_bs;
    const UseAtStart use{start_up, C_bs, data.declination, baro_height_};
    for (; event < data.events.size() && data.events[event].valid <= now; ++event) {
        const Event& e = data.events[event];
        if (e.kind == MeasurementKind::GnssPosition)
            start_up.add_position(recording.gnss[e.index], data.fix_noise[e.index], e.valid, e.components);
        else if (e.kind == MeasurementKind::GnssVelocity)
            start_up.add_velocity(recording.gnss[e.index], data.fix_noise[e.index], e.components);
        for_each_instrument([&](const auto& instrument) {
            if (instrument.kind == e.kind) use((recording.*instrument.log)[e.index]);
        });
    }
    while (epoch < recording.ranges.epochs.size() && recording.ranges.epochs[epoch].time <= now) ++epoch;
    (void)stream.forget({increment, event, epoch, still, bridge}, true);
    std::optional<Start> start = start_up.ready();
    if (!start) return false;
    start->increment = increments.size();  // one is kept, already processed
    set_out(*start, baro_height_at(now));
    return true;
}

namespace {

template <class Frame>
class EngineIn final : public NavigatorEngine, private PassObserver<Frame> {
public:
    explicit EngineIn(const NavigatorSettings& s)
        : NavigatorEngine(s),
          model_(make_model(settings.filter, layout_with(settings.filter, instruments_of(settings.rates)))),
          pass_(model_, stream.data(), settings.filter, Rivalry::Contest),
          still_delay_(Duration::from_seconds(s.still_delay)) {
        const bool watched = uses_ranges(settings.filter.coupling) && settings.filter.ranging.protection.use;
        for (FilterRun<Frame>* w : {&run_, &run_.rival.room().run}) {
            w->shadows.reserve(2);
            w->openings.reserve(4);
            if (watched) w->ranges.watch.reserve(settings.rates.range_sources);
        }
    }

    std::optional<NavigatorState> state() override {
        if (!running()) return std::nullopt;
        if (stream.reordered() || changed_ || model_.loop != Loop::Closed || ahead_.time() < run_.filter.time())
            ahead_ = run_.filter;
        changed_ = false;
        stream.ahead(run_.increment, [&](const ImuIncrement& increment, const BridgeNoise& noise) {
            if (increment.time <= ahead_.time()) return;
            estim::Transition phi;
            if (ahead_.gathered.is_full(increment.dt)) (void)ahead_.propagate_covariance(model_, phi);
            ahead_.propagate(model_, increment, with_vibration(model_, run_.vibration, noise));  // with the current vibration
        });
        return state_of(ahead_, run_.undecided(model_));
    }
    std::optional<NavigatorState> lagged() const override {
        return running() ? std::optional<NavigatorState>(state_of(run_.filter, run_.undecided(model_))) : std::nullopt;
    }
    std::optional<SensorErrorRow> sensor_errors() const override {
        if (!running()) return std::nullopt;
        return sensor_error_row(run_.filter.time(), model_.layout, run_.filter.estimated_parameters(),
                                estim::as_double(run_.filter.P.diagonal()));
    }
    const InertialModel& model() const override { return model_; }

private:
    NavigatorState state_of(const InertialFilter<Frame>& f, const Matrix9& undecided) const {
        const Reported r = reported(model_, f, undecided);
        return {r.nav, r.P};
    }

    void set_out(const Start& start, double baro_height) override {
        filter::set_out(run_, model_, settings.filter, start, baro_height);
        next_all_states_ = run_.filter.time();
        sides_changed_ = 0;
        changed_ = true;
    }

    bool advance() override {
        const std::vector<ImuIncrement>& increments = stream.data().imu.increments;
        const Time until = stream.settled() - still_delay_;
        std::size_t end = run_.increment;
        while (end < increments.size() && increments[end].time <= until) ++end;
        if (end == run_.increment) return true;
        stream.judge_still(increments[end - 1].time);
        if (!pass_.try_advance(run_, end - 1, *this)) return false;  // the filter state is invalid
        if (run_.sides_changed != sides_changed_) {
            sides_changed_ = run_.sides_changed;
            changed_ = true;
            NavigatorEvent e;
            e.time = run_.filter.time();
            e.kind = NavigatorEvent::Kind::Reconsidered;
            tell(e);
        }
        forget_consumed();
        return true;
    }

    /// Discards the data already processed by both hypotheses of the run.
    void forget_consumed() {
        if (run_.event == 0 && run_.epoch == 0 && run_.still == 0 && run_.bridge == 0 && run_.openings.empty() &&
            run_.rival.empty() && run_.increment < StreamTimeline::idle_increments)
            return;  // after nearly every sample
        const auto places = [](const FilterRun<Frame>& w) {
            return StreamTimeline::Places{w.increment, w.event, w.epoch, w.still, w.bridge};
        };
        StreamTimeline::Places p = places(run_);
        FilterRun<Frame>* other = run_.rival.empty() ? nullptr : &run_.rival.front().run;
        if (other != nullptr) {
            const StreamTimeline::Places q = places(*other);
            p = {std::min(p.increment, q.increment), std::min(p.event, q.event), std::min(p.epoch, q.epoch),
                 std::min(p.still, q.still), std::min(p.bridge, q.bridge)};
        }
        p = stream.forget(p, false);
        for (FilterRun<Frame>* w : {&run_, other}) {
            if (w == nullptr) continue;
            w->increment -= p.increment;
            w->event -= p.event;
            w->epoch -= p.epoch;
            w->still -= p.still;
            w->bridge -= p.bridge;
            w->openings.clear();  // only required by the smoother
        }
    }

    void archive_run(Archive& a) override { a(run_, ahead_, changed_, next_all_states_, sides_changed_); }

    // notifications of the run
    void scalar(const estim::RowUpdate&) override { changed_ = true; }
    void corrected() override { changed_ = true; }
    void ranges(const FilterRun<Frame>&, const RangeEpoch&) override { changed_ = true; }
    bool wants_all_states(Time time) const override { return time >= next_all_states_; }
    void output(const FilterRun<Frame>& run, Time time) override {
        add_row(solution_row(reported(model_, run.filter, run.undecided(model_))));
        while (next_all_states_ <= time) next_all_states_ = next_all_states_ + Duration{1'000'000'000};  // same rows as a batch
    }
    void measurement(const MeasurementRecord& r) override {
        changed_ = true;
        if (r.status == MeasurementStatus::Accepted || r.status == MeasurementStatus::Withheld) return;
        NavigatorEvent e;
        e.time = r.stamp;
        e.kind = NavigatorEvent::Kind::Measurement;
        e.measurement = r.kind;
        e.measurement_status = r.status;
        tell(e);
    }
    void alert(const Alert& alert) override {
        changed_ = true;
        NavigatorEvent e;
        e.time = alert.time;
        e.kind = NavigatorEvent::Kind::Alert;
        e.measurement = alert.kind;
        e.test = alert.test;
        tell(e);
    }

    InertialModel model_;
    Pass<Frame> pass_;
    Duration still_delay_;
    FilterRun<Frame> run_;
    InertialFilter<Frame> ahead_;  // the filter propagated to the newest sample
    bool changed_ = true;          // the run was corrected since then
    int sides_changed_ = 0;
    Time next_all_states_{};
};

}  // namespace

Sensors instruments_of(const FeedRates& r) {
    return {r.baro > 0.0, r.mag > 0.0, r.odometer > 0.0, r.heading > 0.0, r.gauge_count, r.log > 0.0};
}

std::unique_ptr<NavigatorEngine> make_engine(const NavigatorSettings& settings) {
    if (settings.filter.mechanization == Mechanization::Ecef) return std::make_unique<EngineIn<EarthFixedFrame>>(settings);
    return std::make_unique<EngineIn<GeographicFrame>>(settings);
}

}  // namespace schuler::filter::detail
