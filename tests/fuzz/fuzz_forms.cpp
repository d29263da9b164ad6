// Bodies of requests to the server of the page: settings as JSON and as TOML, orders of studies.
#include "serve/forms.h"
#include "serve/message.h"
#include "serve/names.h"

#include "schuler/app/command.h"
#include "schuler/core/error.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace serve = schuler::serve;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
    const serve::Form form = data[0] % 2 == 0 ? serve::Form::Scenario : serve::Form::Dataset;
    try {
        switch (data[0] / 2 % 5) {
            case 0: {  // POST /api/settings {settings}
                const auto settings = serve::settings_from_json(serve::Json::parse(text), form);
                serve::check_file_settings(settings);
                (void)serve::toml_of(settings, form);
                (void)serve::settings_json(settings).dump(-1, ' ', false, serve::Json::error_handler_t::replace);
                break;
            }
            case 1: {  // {toml}
                const auto settings = serve::settings_from_toml(text, form);
                serve::check_file_settings(settings);
                // what is written as TOML is read as the same
                if (serve::toml_of(serve::settings_from_toml(serve::toml_of(settings, form), form), form) !=
                    serve::toml_of(settings, form))
                    __builtin_trap();
                break;
            }
            case 2: {  // POST /api/studies
                const auto& commands = schuler::app::commands();
                (void)serve::argument_words(commands[data[0] / 10 % commands.size()].name, serve::Json::parse(text));
                break;
            }
            case 3: serve::check_project_text(text, "project.yaml"); break;
            default:
                if (!serve::is_file_name(serve::folder_name(text))) __builtin_trap();
        }
    } catch (const schuler::Error&) {
    } catch (const serve::Refusal&) {
    } catch (const serve::Json::exception&) {  // the service answers 400
    }
    return 0;
}
