// What the filter believes about ranges, and which of them it uses.
#include "schuler/app/config_sections.h"
#include "schuler/app/range_error_options.h"

namespace schuler::app {

void add_ranging_options(OptionTable<Config>& table) {
    add_range_error_options(table, [](auto& c) -> auto& { return c.filter.ranging.errors; });
    table
        .add(flag<Config>("ranges.use_rates", "tight coupling: use range rates too", [](auto& c) -> auto& { return c.filter.ranging.use_rates; }))
        .add(flag<Config>("ranges.use_stations", "... and ground stations", [](auto& c) -> auto& { return c.filter.ranging.use_stations; }))
        .add(number<Config>("baro.bias_time_s", 1.0, 0, 1e7,
                            "tight coupling: correlation time of the barometer's bias, whose sigma is then stationary; 0 = it walks",
                            [](auto& c) -> auto& { return c.filter.ranging.baro_bias_time; }));
}

}  // namespace schuler::app
