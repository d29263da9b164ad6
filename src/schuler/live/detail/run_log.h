// The log of a live run: one line an event, to standard error or to a file that is started anew from time to time.
#pragma once

#include "schuler/live/output.h"

#include <cstddef>
#include <optional>
#include <string>

namespace schuler::live::detail {

/// Writing never waits for a reader: as with other outputs, the oldest lines are dropped.
class RunLog {
public:
    static constexpr std::size_t usual_size = 10'000'000;  ///< bytes, after which a file is started anew

    /// `place`: "stderr", "none" or a file. Standard error is written to by its descriptor and never rotated: it may be a socket (as the
    /// journal of systemd gives it), which cannot be opened by name, or a file that another program owns.
    /// @throws Error(Input) that names `settings_file` if it cannot be opened
    RunLog(const std::string& place, const std::string& settings_file, double now, std::size_t rotate = usual_size);

    /// What is still queued is written if the reader takes it within half a second: the last lines say why a run ended.
    ~RunLog();
    RunLog(const RunLog&) = delete;
    RunLog& operator=(const RunLog&) = delete;

    void tell(const std::string& text, double now);
    /// Writes what is queued, as far as the reader takes it now.
    void tend(double now);

private:
    std::optional<Output> output_;
};

}  // namespace schuler::live::detail
