#include "schuler/settings/scenario/built_in.h"

#include "schuler/settings/scenario/scenario.h"

namespace schuler::settings {

std::string_view built_in_scenario(std::string_view name) {
    return name == "demo" ? detail::embedded_file("demo.toml") : std::string_view();
}

}  // namespace schuler::settings
