#include "schuler/app/formats_command.h"

#include "schuler/inspect/explain.h"
#include "schuler/io/formats.h"

namespace schuler::app {

std::string formats_help() { return io::formats_text(); }

std::string explained(const std::filesystem::path& path) { return inspect::explain(path); }

}  // namespace schuler::app
