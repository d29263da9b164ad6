#include "schuler/settings/request.h"

#include "schuler/settings/config/config.h"
#include "schuler/settings/toml_file.h"

#include <algorithm>

namespace schuler::settings {

SettingList ProcessRequest::over(const SettingList& base) const {
    SettingList all = base;
    if (!config.empty()) all = overlaid(std::move(all), config_table().read(read_toml(config), config.string()));
    return overlaid(std::move(all), above);
}

bool ProcessRequest::names_a_scheme() const {
    return std::ranges::any_of(over({}), [](const Setting& s) { return s.key == "filter.scheme"; });
}

std::filesystem::path ProcessRequest::folder_for(const std::string& name) const {
    return output.empty() ? std::filesystem::path("out") / name : output;
}

}  // namespace schuler::settings
