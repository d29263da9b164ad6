// A progress bar on standard error, on a terminal only; or lines for a reading program.
#pragma once

#include <unistd.h>

#include <cstdio>
#include <string_view>

namespace schuler::cli {

/// Draws during its lifetime, and leaves an empty line.
class ProgressBar {
public:
    explicit ProgressBar(bool wanted, bool lines = false)
        : active_(lines || (wanted && isatty(STDERR_FILENO) != 0)), lines_(lines) {}
    ~ProgressBar() {
        if (drawn_ >= 0 && !lines_) std::fputs("\r\033[K", stderr);
    }
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// part in [0, 1].
    void show(double part) {
        const int percent = part <= 0.0 ? 0 : part >= 1.0 ? 100 : static_cast<int>(100.0 * part);
        if (!active_ || percent == drawn_) return;
        drawn_ = percent;
        if (lines_) {
            std::fprintf(stderr, "progress %.2f\n", 0.01 * percent);
            return;
        }
        char bar[51];
        for (int i = 0; i < 50; ++i) bar[i] = i < percent / 2 ? '#' : '.';
        bar[50] = '\0';
        std::fprintf(stderr, "\r[%s] %3d %%", bar, percent);
        std::fflush(stderr);
    }

    /// For a reading program; the bar itself shows none.
    void stage(std::string_view what) const {
        if (lines_) std::fprintf(stderr, "stage %.*s\n", static_cast<int>(what.size()), what.data());
    }

private:
    bool active_, lines_;
    int drawn_ = -1;
};

}  // namespace schuler::cli
