#include "schuler/study/comparison/compare_windows.h"

#include "schuler/report/decimate.h"
#include "schuler/settings/scenario/comparison.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::study {
namespace {

double recovery_of(const settings::CompareWindow& w, const settings::WindowRules& rules, const ErrorCourse& e) {
    const auto after = std::ranges::upper_bound(e.t, w.end + same_instant);
    std::size_t i = static_cast<std::size_t>(after - e.t.begin());
    if (i > 0) --i;  // the epoch whose error may be valid at the end
    double good_since = std::numeric_limits<double>::quiet_NaN();
    for (; i < e.t.size(); ++i) {
        const bool broken = i > 0 && e.t[i] - e.t[i - 1] > rules.age + same_instant;
        if (!(e.horizontal[i] < rules.limit)) {
            good_since = std::numeric_limits<double>::quiet_NaN();
            continue;
        }
        if (std::isnan(good_since) || broken) good_since = e.t[i] <= w.end + same_instant ? w.end : e.t[i];
        if (e.t[i] - good_since >= rules.hold - same_instant) return good_since - w.end;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

double share_of(const settings::CompareWindow& w, double age, std::span<const double> solution,
                std::span<const double> reference) {
    std::size_t instants = 0, known = 0;
    for (const double t : reference) {
        if (t < w.start - same_instant || t > w.end + same_instant) continue;
        ++instants;
        const auto next = std::ranges::upper_bound(solution, t + same_instant);
        known += next != solution.begin() && t - *(next - 1) <= age + same_instant ? 1 : 0;
    }
    return static_cast<double>(known) / static_cast<double>(instants);
}

}  // namespace

WindowStatistics window_statistics(const settings::CompareWindow& window, const settings::WindowRules& rules,
                                   const ErrorCourse& errors, std::span<const double> solution,
                                   std::span<const double> reference) {
    WindowStatistics out;
    double squares = 0.0;
    std::size_t epochs = 0;
    for (std::size_t i = 0; i < errors.t.size(); ++i) {
        if (errors.t[i] < window.start - same_instant || errors.t[i] > window.end + same_instant) continue;
        ++epochs;
        squares += errors.horizontal[i] * errors.horizontal[i];
        out.horizontal_max = std::fmax(out.horizontal_max, errors.horizontal[i]);
        out.vertical_max = std::fmax(out.vertical_max, errors.vertical[i]);
    }
    if (epochs > 0) out.horizontal_rms = std::sqrt(squares / static_cast<double>(epochs));
    out.share = share_of(window, rules.age, solution, reference);
    out.recovery = recovery_of(window, rules, errors);
    return out;
}

ErrorCourse drawn_course(const ErrorCourse& errors, double age, std::size_t points) {
    const std::array<std::span<const double>, 3> channels{errors.t, errors.horizontal, errors.vertical};
    ErrorCourse out;
    const auto add = [&out](double t, double horizontal, double vertical) {
        out.t.push_back(t);
        out.horizontal.push_back(horizontal);
        out.vertical.push_back(vertical);
    };
    std::size_t before = 0;
    for (const std::size_t i : report::decimate(channels, points)) {
        for (std::size_t k = before; k < i; ++k) {
            if (errors.t[k + 1] - errors.t[k] <= age + same_instant) continue;
            add(errors.t[k] + age, std::nan(""), std::nan(""));
            break;
        }
        add(errors.t[i], errors.horizontal[i], errors.vertical[i]);
        before = i;
    }
    return out;
}

}  // namespace schuler::study
