#include "schuler/fusion/intermediate_run.h"

#include "schuler/earth/earth.h"
#include "schuler/fusion/receiver_filter.h"
#include "schuler/math/rotation.h"

#include <algorithm>
#include <cmath>

namespace schuler::fusion {

using Eigen::Vector3d;

namespace {

/// The receiver's filter over the epochs, and the comparison of the two.
class Beside {
public:
    Beside(const RunData& data, const Settings& settings, Time origin, Result& result)
        : log_(data.recording->ranges), settings_(settings), origin_(origin), result_(result), filter_(settings, log_) {}

    /// An epoch used by the tight filter, with its antenna position and covariance.
    void check(const RangeEpoch& epoch, const Geodetic& antenna, const Eigen::Matrix3d& P) {
        go_to(epoch.time);
        if (result_.receiver.rows.empty() || result_.receiver.rows.back().time != epoch.time) return;
        CrossCheck& c = result_.cross_checks.back();
        c.difference = earth::ned_difference(settings_.earth, antenna, result_.receiver.rows.back().position);
        // at least a tenth: two models of the same ranges are not as nearly optimal as the difference of their covariances indicates
        const Vector3d own = filter_.position_covariance().diagonal();
        c.sigma = (own - P.diagonal()).cwiseMax(0.1 * own).cwiseSqrt();
        if (!filter_.determined()) {
            leads_ = false;  // it has no independent information
            run_ = 0;
            return;
        }
        c.agrees = (c.difference.cwiseAbs().array() <= limit * c.sigma.array()).all();
        run_ = c.agrees == agreed_ ? run_ + 1 : 1;
        agreed_ = c.agrees;
        if (run_ >= patience) leads_ = !agreed_ && !filter_.doubtful();
        c.receiver_leads = leads_;
    }
    /// Processes the epochs up to this time.
    void go_to(Time time) {
        for (; next_ < log_.epochs.size() && log_.epochs[next_].time <= time; ++next_) {
            const RangeEpoch& epoch = log_.epochs[next_];
            std::span<const RangeSample> samples = log_.of(epoch);
            kept_.clear();
            if (is_withheld(settings_.outages, (epoch.time - origin_).seconds())) {
                std::ranges::copy_if(samples, std::back_inserter(kept_),
                                     [&](const RangeSample& m) { return log_.sources[m.source].station; });
                samples = kept_;
            }
            if (!filter_.process(epoch, samples)) continue;
            result_.receiver.rows.push_back(filter_.row());
            CrossCheck& c = result_.cross_checks.emplace_back();
            c.time = epoch.time;
            c.difference = c.sigma = not_given3();
            c.receiver_leads = leads_;
        }
    }

private:
    static constexpr double limit = 5.0;
    static constexpr int patience = 10;

    const RangingLog& log_;
    const Settings& settings_;
    Time origin_;
    Result& result_;
    ReceiverFilter filter_;
    std::vector<RangeSample> kept_;
    std::size_t next_ = 0;
    bool agreed_ = true, leads_ = false;
    int run_ = 0;
};

/// True if the inertial measurements around a time were bridged over a second or more.
class Holes {
public:
    explicit Holes(const ImuTimeline& imu) {
        for (const Bridge& b : imu.bridges) {
            const ImuIncrement& first = imu.increments[b.first];
            const Time begin = first.time - Duration::from_seconds(first.dt), end = imu.increments[b.last].time;
            if ((end - begin).seconds() >= 1.0) spans_.push_back({begin, end});
        }
    }
    [[nodiscard]] bool cover(Time t) const {
        return std::ranges::any_of(spans_, [t](const auto& s) { return t > s.first && t <= s.second; });
    }

private:
    std::vector<std::pair<Time, Time>> spans_;
};

/// The receiver's solution at t, `from_antenna_b` away from its antenna (m), extrapolated from its last epoch by its velocity; false if too old.
bool by_receiver(const Result& result, const Settings& settings, const Vector3d& from_antenna_b, std::size_t& at,
                 SolutionRow& row) {
    const Time t = row.time;
    constexpr double longest = 3.0;  // s
    const std::vector<SolutionRow>& rows = result.receiver.rows;
    while (at + 1 < rows.size() && rows[at + 1].time <= t) ++at;
    if (at >= rows.size() || rows[at].time > t) return false;
    const double since = (t - rows[at].time).seconds();
    if (since > longest) return false;
    Vector3d moved = since * rows[at].v_eb_n;
    if (row.rpy.allFinite()) moved += math::dcm_from_rpy(row.rpy) * from_antenna_b;
    row.position = earth::moved_by_ned(settings.earth, rows[at].position, moved);
    row.v_eb_n = rows[at].v_eb_n;
    row.std_position = (rows[at].std_position.cwiseAbs2() + since * since * rows[at].std_velocity.cwiseAbs2()).cwiseSqrt();
    row.std_velocity = rows[at].std_velocity;
    return true;
}

/// The single solution from the two.
void merge(const RunData& data, const Settings& settings, Result& result) {
    const Holes holes(data.imu);
    const auto take_over = [&](SolutionRow& row, const Vector3d& point_b, std::size_t& at, std::size_t& check) {
        while (check + 1 < result.cross_checks.size() && result.cross_checks[check + 1].time <= row.time) ++check;
        const bool leads = check < result.cross_checks.size() && result.cross_checks[check].time <= row.time &&
                           result.cross_checks[check].receiver_leads;
        if (leads || holes.cover(row.time)) (void)by_receiver(result, settings, point_b - settings.gnss.lever_arm_b, at, row);
    };
    const auto take_over_all = [&](auto& list, const Vector3d& point_b, auto row_of) {
        std::size_t at = 0, check = 0;
        for (auto& item : list) take_over(row_of(item), point_b, at, check);
    };
    const auto itself = [](SolutionRow& row) -> SolutionRow& { return row; };
    const auto of_row = [](InstantRow& r) -> SolutionRow& { return r.row; };
    const bool point = !settings.output_lever_arm_b.isZero(0.0);
    // The direction of a lever arm is no longer known: the position uncertainty is its length.
    const auto away = [&](SolutionRow row, const Vector3d& point_b) {
        row.std_position = (row.std_position.array().square() + (point_b - settings.gnss.lever_arm_b).squaredNorm()).sqrt();
        return row;
    };
    for (Trajectory* t : {&result.forward, &result.smoothed}) {
        if (t->rows.empty()) continue;
        take_over_all(t->rows, Vector3d::Zero(), itself);
        take_over_all(t->point, settings.output_lever_arm_b, itself);
        take_over_all(t->instants, settings.output_lever_arm_b, of_row);
        const Time last = t->rows.back().time;
        for (std::size_t i = 0; i < result.receiver.rows.size(); ++i) {
            const SolutionRow& row = result.receiver.rows[i];
            if (row.time <= last || (settings.stop && row.time > *settings.stop)) continue;
            t->rows.push_back(away(row, Vector3d::Zero()));
            if (point) t->point.push_back(away(row, settings.output_lever_arm_b));
            result.cross_checks[i].receiver_leads = true;
        }
    }
}

}  // namespace

Result run_intermediate_pass(const RunData& data, const Settings& settings, const Start& start, const PassOptions& options) {
    Result both;
    Beside beside(data, settings, data.origin, both);
    PassOptions watched = options;
    watched.after_ranges = [&](const RangeEpoch& epoch, const Geodetic& antenna, const Eigen::Matrix3d& P) {
        beside.check(epoch, antenna, P);
    };
    Result result = run_pass(data, settings, start, watched);
    beside.go_to(Time{INT64_MAX});
    result.receiver = std::move(both.receiver);
    result.cross_checks = std::move(both.cross_checks);
    merge(data, settings, result);
    return result;
}

}  // namespace schuler::fusion
