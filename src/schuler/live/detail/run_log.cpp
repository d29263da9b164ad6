#include "schuler/live/detail/run_log.h"

#include "schuler/core/error.h"

#include <fmt/format.h>

#include <poll.h>

#include <chrono>
#include <memory>
#include <utility>
#include <vector>

namespace schuler::live::detail {

RunLog::RunLog(const std::string& place, const std::string& settings_file, double now, std::size_t rotate) {
    if (place == "none") return;
    Endpoint to;
    to.text = place;
    OutputLimits limits;
    if (place == "stderr") {
        to.medium = Medium::Standard;
        to.descriptor = 2;
    } else {
        to.medium = Medium::File;
        to.path = place;
        limits.rotate = rotate;
    }
    const auto reason = std::make_shared<std::string>();  // lives as long as the output that reports it
    output_.emplace(std::move(to), limits, [reason](const std::string& text) { *reason = text; });
    output_->tend(now);
    if (output_->readers() == 0)
        throw input_error(fmt::format("the log cannot be opened: {}", *reason), {settings_file, 0, 0, "live.log"},
                          "name a file in a folder that exists, or write log = \"none\"");
}

RunLog::~RunLog() {
    if (!output_) return;
    using Clock = std::chrono::steady_clock;
    const auto until = Clock::now() + std::chrono::milliseconds(500);
    std::vector<Interest> queued;
    for (output_->interests(queued); !queued.empty() && Clock::now() < until; output_->interests(queued)) {
        pollfd ready{queued.front().fd, POLLOUT, 0};
        (void)poll(&ready, 1, 50);
        output_->ready(ready.fd, 0.0);
        queued.clear();
    }
}

void RunLog::tend(double now) {
    if (!output_) return;
    std::vector<Interest> queued;
    output_->interests(queued);
    for (const Interest& i : queued) output_->ready(i.fd, now);
}

void RunLog::tell(const std::string& text, double now) {
    if (!output_) return;
    output_->tend(now);  // a file that could not be started anew
    output_->send(text + "\n", now);
}

}  // namespace schuler::live::detail
