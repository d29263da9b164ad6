// The navigation filter fed sample by sample: live use and embedding. The same walk as a batch run, a stated lag behind the newest sample.
#pragma once

#include "schuler/filter/navigator_settings.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::filter {

namespace detail {
class NavigatorEngine;
}

struct NavigatorMade;

/// Takes the samples of all instruments in any order within `lag` of the newest sample of the IMU and navigates by them. What comes out
/// depends on the samples, not on the order in which they came; with the start and the thresholds of standing still of a batch run
/// (and still_delay) its rows are the batch's to the last bit, in logs without holes.
///
/// All memory is taken by `make`. No sample makes it throw: a bad one is refused by its status and leaves the state as it is. Where the
/// computation diverges all the same, an event tells it and alignment restarts. Not safe for several threads at once.
class Navigator {
public:
    /// Checks the settings and takes all memory. Does not throw but for want of memory.
    [[nodiscard]] static NavigatorMade make(const NavigatorSettings& settings);
    ~Navigator();
    Navigator(Navigator&&) noexcept;
    Navigator& operator=(Navigator&&) noexcept;

    /// One row of the IMU, in sensor axes, as ImuSettings has it. Moves time on: what is older than the lag is used now.
    FeedStatus feed(const ImuSample& sample);
    FeedStatus feed(const GnssFix& fix);
    FeedStatus feed(const BaroSample& sample);
    FeedStatus feed(const MagSample& sample);
    FeedStatus feed(const OdometerSample& sample);
    FeedStatus feed(const HeadingSample& sample);
    FeedStatus feed(const GaugeSample& sample);
    FeedStatus feed(const BodyVelocitySample& sample);
    /// One epoch of ranges, whose sources are those of range_source(); at most 64.
    FeedStatus feed(Time time, std::span<const RangeSample> samples);
    /// Index of a satellite ("G05") or ground station for RangeSample::source; the name has at most 15 characters. Nothing where the
    /// stated number of sources is used up.
    std::optional<std::uint16_t> range_source(std::string_view name, bool station);

    [[nodiscard]] Phase phase() const;
    /// At the newest sample of the IMU (the end of its interval), predicted from the filter by the inertial measurements since. Nothing
    /// before Phase::Navigating.
    [[nodiscard]] std::optional<NavigatorState> state();
    /// The filter itself, `lag` ago: every measurement until then is in it.
    [[nodiscard]] std::optional<NavigatorState> lagged() const;
    /// Sensor errors as the filter has them.
    [[nodiscard]] std::optional<SensorErrorRow> sensor_errors() const;
    [[nodiscard]] const Layout& layout() const;

    /// The oldest event that was not fetched yet; the last 256 are kept.
    [[nodiscard]] std::optional<NavigatorEvent> poll();
    /// The oldest row of the filter (Settings::output_rate, behind by the lag) that was not fetched yet; the last 512 are kept.
    [[nodiscard]] std::optional<SolutionRow> poll_row();
    [[nodiscard]] const FeedCounters& counters() const;

    /// Everything, as bytes for `restore` in a navigator of the same settings on a machine of the same kind: it goes on with the very
    /// same outputs. Writes nothing where `bytes` is too small; returns the size.
    std::size_t save(std::span<std::byte> bytes) const;
    [[nodiscard]] std::vector<std::byte> save() const;
    /// Takes over what was saved; refused, it stays as it is.
    [[nodiscard]] RestoreStatus restore(std::span<const std::byte> bytes);

    /// Forgets everything and realigns.
    void restart();

private:
    explicit Navigator(std::unique_ptr<detail::NavigatorEngine> engine);
    std::unique_ptr<detail::NavigatorEngine> engine_;
};

/// A navigator, or why there is none.
struct NavigatorMade {
    MakeStatus status = MakeStatus::Made;
    std::string key;  ///< of dataset.toml, or the member of NavigatorSettings
    std::string reason;
    std::optional<Navigator> navigator;

    explicit operator bool() const { return navigator.has_value(); }
};

}  // namespace schuler::filter
