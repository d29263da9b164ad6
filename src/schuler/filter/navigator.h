// The navigation filter fed sample by sample, for live use and embedding: the batch algorithm at a fixed lag behind the newest sample.
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

/// Accepts the samples of all instruments in any order within `lag` of the newest IMU sample and navigates with them. The output
/// depends on the samples, not on their order of arrival; given the start and the zero-velocity thresholds of a batch run (and
/// still_delay), its rows are bitwise identical to the batch output, for logs without gaps.
///
/// All memory is allocated by `make`. No sample causes an exception: an invalid one is rejected by its status and leaves the
/// state unchanged. If the computation diverges nevertheless, an event reports it and alignment restarts. Not thread-safe.
class Navigator {
public:
    /// Checks the settings and allocates all memory. Does not throw except for lack of memory.
    [[nodiscard]] static NavigatorMade make(const NavigatorSettings& settings);
    ~Navigator();
    Navigator(Navigator&&) noexcept;
    Navigator& operator=(Navigator&&) noexcept;

    /// One IMU sample, in sensor axes, as defined by ImuSettings. Advances time: data older than the lag are now processed.
    FeedStatus feed(const ImuSample& sample);
    FeedStatus feed(const GnssFix& fix);
    FeedStatus feed(const BaroSample& sample);
    FeedStatus feed(const MagSample& sample);
    FeedStatus feed(const OdometerSample& sample);
    FeedStatus feed(const HeadingSample& sample);
    FeedStatus feed(const GaugeSample& sample);
    FeedStatus feed(const BodyVelocitySample& sample);
    /// One epoch of ranges with sources from range_source(); at most 64.
    FeedStatus feed(Time time, std::span<const RangeSample> samples);
    /// Index of a satellite ("G05") or ground station for RangeSample::source; the name has at most 15 characters. Empty if the
    /// stated number of sources is exhausted.
    std::optional<std::uint16_t> range_source(std::string_view name, bool station);

    [[nodiscard]] Phase phase() const;
    /// State at the newest IMU sample (the end of its interval), predicted from the filter with the inertial measurements since.
    /// Empty before Phase::Navigating.
    [[nodiscard]] std::optional<NavigatorState> state();
    /// The filter state, `lag` ago, which includes every measurement until then.
    [[nodiscard]] std::optional<NavigatorState> lagged() const;
    /// Sensor errors estimated by the filter.
    [[nodiscard]] std::optional<SensorErrorRow> sensor_errors() const;
    [[nodiscard]] const Layout& layout() const;

    /// The oldest event not yet fetched; the last 256 are kept.
    [[nodiscard]] std::optional<NavigatorEvent> poll();
    /// The oldest filter row (Settings::output_rate, delayed by the lag) not yet fetched; the last 512 are kept.
    [[nodiscard]] std::optional<SolutionRow> poll_row();
    [[nodiscard]] const FeedCounters& counters() const;

    /// The complete state as bytes for `restore` in a navigator with the same settings on a machine of the same kind, which then
    /// continues with identical outputs. Writes nothing if `bytes` is too small; returns the size.
    std::size_t save(std::span<std::byte> bytes) const;
    [[nodiscard]] std::vector<std::byte> save() const;
    /// Restores a saved state; on failure the navigator is unchanged.
    [[nodiscard]] RestoreStatus restore(std::span<const std::byte> bytes);

    /// Discards the state and realigns.
    void restart();

private:
    explicit Navigator(std::unique_ptr<detail::NavigatorEngine> engine);
    std::unique_ptr<detail::NavigatorEngine> engine_;
};

/// A navigator, or the reason of its absence.
struct NavigatorMade {
    MakeStatus status = MakeStatus::Made;
    std::string key;  ///< of dataset.toml, or the member of NavigatorSettings
    std::string reason;
    std::optional<Navigator> navigator;

    explicit operator bool() const { return navigator.has_value(); }
};

}  // namespace schuler::filter
