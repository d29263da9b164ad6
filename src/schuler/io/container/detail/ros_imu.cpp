#include "schuler/io/container/detail/ros_imu.h"

#include "schuler/io/container/raw_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace schuler::io::detail {
namespace {

constexpr std::size_t gyro = 0, accel = 3;  // first of three columns

/// No value other than zero in the three columns from `first` on.
bool is_idle(const Stream& s, std::size_t first) {
    for (std::size_t k = first; k < first + 3; ++k)
        if (std::ranges::any_of(s.columns[k].values, [](double v) { return std::isfinite(v) && v != 0.0; })) return false;
    return true;
}

std::vector<double> times_of(const Stream& s) { return {s.time_ns.begin(), s.time_ns.end()}; }

std::size_t common_length(const std::string& a, const std::string& b) {
    return static_cast<std::size_t>(std::ranges::mismatch(a, b).in1 - a.begin());
}

/// Rates of one with the accelerations of the other.
Stream joined(const Stream& rates, const Stream& forces) {
    constexpr double reach = 1e8;  // ns
    const std::vector<double> at = times_of(rates), times = times_of(forces);
    std::array<std::vector<double>, 3> f;
    for (std::size_t k = 0; k < 3; ++k) f[k] = interpolated(at, times, forces.columns[accel + k].values, reach);
    Stream s;
    s.name = rates.name;
    s.source = rates.source + " with " + forces.source;
    for (const Stream::Column& c : rates.columns) s.columns.push_back({c.name, {}});
    for (std::size_t i = 0; i < rates.rows(); ++i) {
        if (!std::isfinite(f[0][i])) continue;
        const auto w = [&](std::size_t k) { return rates.columns[gyro + k].values[i]; };
        s.add(rates.time_ns[i], {w(0), w(1), w(2), f[0][i], f[1][i], f[2][i]});
    }
    return s;
}

/// Rows in which a part is marked as not measured are no samples of a complete unit.
void leave_out_incomplete(Stream& s) {
    const auto complete = [&](std::size_t i) {
        return std::ranges::all_of(s.columns, [&](const Stream::Column& c) { return std::isfinite(c.values[i]); });
    };
    std::size_t kept = 0;
    for (std::size_t i = 0; i < s.rows(); ++i) {
        if (!complete(i)) continue;
        s.time_ns[kept] = s.time_ns[i];
        for (Stream::Column& c : s.columns) c.values[kept] = c.values[i];
        ++kept;
    }
    s.time_ns.resize(kept);
    for (Stream::Column& c : s.columns) c.values.resize(kept);
}

}  // namespace

void complete_imus(std::map<std::string, Stream>& streams, const std::string& file, WarningLog& warnings) {
    std::vector<std::string> rates, forces, neither;
    bool whole = false;
    for (auto& [topic, s] : streams) {
        if (s.kind != TableKind::Imu || s.rows() == 0) continue;
        const bool no_rates = is_idle(s, gyro), no_forces = is_idle(s, accel);
        if (no_rates && no_forces) neither.push_back(topic);
        else if (no_rates) forces.push_back(topic);
        else if (no_forces) rates.push_back(topic);
        else {
            leave_out_incomplete(s);
            whole = true;
        }
    }
    for (const std::string& topic : rates) {
        const auto other = std::ranges::max_element(forces, {}, [&](const std::string& t) { return common_length(t, topic); });
        if (other == forces.end()) {
            neither.push_back(topic);
            continue;
        }
        streams[topic] = joined(streams.at(topic), streams.at(*other));
        streams.erase(*other);
        forces.erase(other);
        whole = true;
    }
    neither.insert(neither.end(), forces.begin(), forces.end());
    for (const std::string& topic : neither) {
        const Stream& s = streams.at(topic);
        const bool no_forces = is_idle(s, accel);
        const std::size_t idle = no_forces ? accel : gyro;
        const bool marked = std::ranges::any_of(s.columns[idle].values, [](double v) { return std::isnan(v); });
        // a robot that never turns, in a simulation without noise, has zeros too
        const bool is_left_out = whole || marked;
        warnings.add(
            file + " ros.half " + topic,
            fmt::format("{}: {}: its {} are {}{}", file, topic, no_forces ? "accelerations" : "angular rates",
                        marked ? "marked as not measured (covariance -1)" : "all zero", is_left_out ? ": left out" : ""));
        if (is_left_out) streams.erase(topic);
    }
}

}  // namespace schuler::io::detail
