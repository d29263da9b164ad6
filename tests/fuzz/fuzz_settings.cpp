// Settings from arbitrary text: TOML, `--set KEY=VALUE`, and what scenarios and data sets make of them.
#include "schuler/settings/config/config.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/settings/toml_file.h"

#include "schuler/core/error.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace {

namespace settings = schuler::settings;

/// "imu.rate_hz" and so on of nested tables, as the readers of files make them.
void flatten(const settings::ValueTable& table, const std::string& above, settings::SettingList& list) {
    for (const auto& [name, value] : table) {
        const std::string key = above.empty() ? name : above + "." + name;
        if (const settings::ValueTable* inner = value.table()) flatten(*inner, key, list);
        else list.push_back({key, value, {}});
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
    try {
        if (data[0] % 4 == 3) {
            (void)settings::setting_from_text(text);
            return 0;
        }
        settings::SettingList list;
        flatten(settings::parse_toml(text, "input"), "", list);
        for (const settings::Setting& s : list) (void)settings::to_toml(s.value);
        if (data[0] % 4 == 1) (void)settings::config_from(list);
        if (data[0] % 4 == 2) (void)settings::scenario_from(list);
    } catch (const schuler::Error&) {}
    return 0;
}
