// A navigator with its output not yet fetched.
#pragma once

#include "arrays.h"
#include "recording.h"

#include "schuler/core/nav_state.h"
#include "schuler/filter/navigator.h"

#include <span>
#include <string>
#include <vector>

namespace schuler::python {

/// Status of samples: a single one, or an array as long as the times.
[[nodiscard]] py::object statuses(std::vector<std::uint8_t> list, bool one);

class StreamNavigator {
public:
    /// @throws Error(Input) for invalid settings
    StreamNavigator(const py::dict& settings, double imu_interval, const py::dict& rates, double lag, double still_delay,
                    double longest_hole);

    py::object feed_imu(const py::object& time, const py::object& gyro, const py::object& accel);
    py::object feed_gnss(const py::object& time, const py::object& position, const py::object& velocity,
                         const py::object& std_position, const py::object& std_velocity, const std::string& fix, int satellites);
    py::object feed_baro(const py::object& time, const py::object& height, const py::object& pressure);
    py::object feed_mag(const py::object& time, const py::object& field);
    py::object feed_odometer(const py::object& time, const py::object& speed, const py::object& std);
    py::object feed_heading(const py::object& time, const py::object& heading, const py::object& std);
    py::object feed_gauges(const py::object& time, const py::object& height);
    py::object feed_body_velocity(const py::object& time, const py::object& velocity);
    py::object feed_ranges(const py::object& time, const std::vector<std::string>& names, const std::vector<bool>& station,
                           const py::dict& columns);
    /// All instruments of a recording in time order.
    py::dict feed(const SharedRecording& shared);

    [[nodiscard]] filter::Navigator& navigator() { return navigator_; }
    /// Rows not yet fetched.
    [[nodiscard]] std::vector<SolutionRow> take_rows();
    [[nodiscard]] std::vector<filter::NavigatorEvent> take_events();
    [[nodiscard]] py::dict counters() const;
    void forget();

private:
    /// Feeds sample i of n made by make(i), without the interpreter's lock.
    template <class Make>
    py::object feed_all(py::ssize_t n, bool one, Make make);
    /// Rows and events are stored here, because the navigator keeps only the most recent ones.
    void collect();

    filter::Navigator navigator_;
    std::vector<SolutionRow> rows_;
    std::vector<filter::NavigatorEvent> events_;
};

}  // namespace schuler::python
