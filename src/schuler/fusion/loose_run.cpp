#include "schuler/fusion/loose_run.h"

namespace schuler::fusion {

template <class Frame>
Result run_pass_in(const RunData& data, const Settings& settings, const Layout& layout, const Start& start,
                   const PassOptions& options);
template <class Frame>
StartEstimate smooth_start_in(const RunData& data, const Settings& settings, const Layout& layout, const Start& start,
                              std::size_t last_increment);

Result run_pass(const RunData& data, const Settings& settings, const Start& start, const PassOptions& options) {
    const Layout layout = make_layout(settings, !data.recording->baro.empty(), !data.recording->mag.empty());
    return settings.mechanization == Mechanization::Ecef
               ? run_pass_in<EarthFixedFrame>(data, settings, layout, start, options)
               : run_pass_in<GeographicFrame>(data, settings, layout, start, options);
}

StartEstimate smooth_start(const RunData& data, const Settings& settings, const Start& start, std::size_t last_increment) {
    const Layout layout = make_layout(settings, !data.recording->baro.empty(), !data.recording->mag.empty());
    return smooth_start_in<GeographicFrame>(data, settings, layout, start, last_increment);
}

}  // namespace schuler::fusion
