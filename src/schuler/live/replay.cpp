#include "schuler/live/replay.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/live/detail/descriptor.h"

#include <fmt/format.h>

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <iterator>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

namespace schuler::live {
namespace {

using detail::Descriptor;

/// Numbers with full precision; null if there is none.
void put(std::string& text, const char* key, double x) {
    if (std::isfinite(x)) fmt::format_to(std::back_inserter(text), ",\"{}\":{}", key, x);
}
void put(std::string& text, const char* key, const Eigen::Vector3d& v) {
    if (!v.array().isNaN().all()) {
        fmt::format_to(std::back_inserter(text), ",\"{}\":[", key);
        for (Eigen::Index i = 0; i < 3; ++i) {
            if (i > 0) text += ',';
            if (std::isfinite(v[i])) fmt::format_to(std::back_inserter(text), "{}", v[i]);
            else text += "null";
        }
        text += ']';
    }
}

std::string begin(const char* type, Time t) { return fmt::format("{{\"type\":\"{}\",\"time_ns\":{}", type, t.ns); }

/// A sample of one vector.
std::string line_of(const char* type, Time t, const char* key, const Eigen::Vector3d& v) {
    std::string text = begin(type, t);
    put(text, key, v);
    return text + "}\n";
}
std::string line_of(const ImuSample& s) {
    std::string text = begin("imu", s.time);
    put(text, "gyro_rad_s", s.gyro);
    put(text, "accel_m_s2", s.accel);
    return text + "}\n";
}
std::string line_of(const GnssFix& f) {
    std::string text = begin("gnss", f.time);
    put(text, "lat_rad", f.position.lat);
    put(text, "lon_rad", f.position.lon);
    put(text, "height_m", f.position.h);
    put(text, "velocity_m_s", f.velocity_n);
    put(text, "std_m", f.std_position);
    put(text, "std_velocity_m_s", f.std_velocity);
    fmt::format_to(std::back_inserter(text), ",\"fix\":{},\"satellites\":{}", static_cast<int>(f.fix), f.satellites);
    put(text, "position_age_s", f.position_age);
    put(text, "velocity_age_s", f.velocity_age);
    return text + "}\n";
}
std::string line_of(const BaroSample& s) {
    std::string text = begin("baro", s.time);
    put(text, "height_m", s.height);
    put(text, "pressure_pa", s.pressure);
    return text + "}\n";
}
std::string line_of(const MagSample& s) { return line_of("mag", s.time, "field_t", s.field_b); }
std::string line_of(const OdometerSample& s) {
    std::string text = begin("odometer", s.time);
    put(text, "speed_m_s", s.speed);
    put(text, "std_m_s", s.std);
    return text + "}\n";
}
std::string line_of(const HeadingSample& s) {
    std::string text = begin("heading", s.time);
    put(text, "heading_deg", s.heading / units::deg);
    put(text, "std_deg", s.std / units::deg);
    return text + "}\n";
}

std::string line_of(const GaugeSample& s) { return line_of("gauges", s.time, "height_m", s.height); }
std::string line_of(const BodyVelocitySample& s) { return line_of("log", s.time, "velocity_m_s", s.velocity_b); }

using Pointer = std::variant<const ImuSample*, const GnssFix*, const BaroSample*, const MagSample*, const OdometerSample*,
                             const HeadingSample*, const GaugeSample*, const BodyVelocitySample*>;

/// All samples, those of the IMU last among simultaneous ones.
std::vector<std::pair<Time, Pointer>> in_order(const Recording& r) {
    std::vector<std::pair<Time, Pointer>> out;
    const auto add = [&out](const auto& samples) {
        for (const auto& s : samples) out.emplace_back(s.time, &s);
    };
    add(r.gnss);
    add(r.baro);
    add(r.mag);
    add(r.odometer);
    add(r.heading);
    add(r.gauges);
    add(r.body_velocity);
    add(r.imu);
    std::ranges::stable_sort(out, {}, [](const auto& p) { return p.first; });
    return out;
}

Error failure(const Endpoint& to, const std::string& reason) {
    return {ErrorKind::Computation, reason, {to.text, 0, 0, "--to"}, "check that a program listens there"};
}

Descriptor connected(const Endpoint& to) {
    if (to.medium == Medium::Standard) return Descriptor(dup(1));
    if (to.medium == Medium::Udp) {
        detail::Opened o = detail::open_udp(to, false);
        if (!o.fd.open()) throw failure(to, o.reason);
        return std::move(o.fd);
    }
    if (to.medium == Medium::TcpListen) {
        const detail::Opened listener = detail::listen_tcp(to);
        if (!listener.fd.open()) throw failure(to, listener.reason);
        for (;;) {
            pollfd ready{listener.fd.get(), POLLIN, 0};
            (void)poll(&ready, 1, -1);
            detail::Opened client = detail::accept_client(listener.fd.get());
            if (client.fd.open()) return std::move(client.fd);
        }
    }
    if (to.medium != Medium::Tcp) throw failure(to, "samples are sent to tcp://, tcp-listen://, udp:// or stdout only");
    std::string reason = "no connection";
    for (int trial = 0; trial < 50; ++trial) {
        detail::Opened o = detail::open_tcp(to);
        if (o.fd.open()) {
            pollfd ready{o.fd.get(), POLLOUT, 0};
            (void)poll(&ready, 1, 1000);
            reason = detail::failure_of_connection(o.fd.get());
            if (reason.empty() && (ready.revents & POLLOUT) != 0) return std::move(o.fd);
        } else {
            reason = o.reason;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
    throw failure(to, reason);
}

void send_all(const Endpoint& to, int fd, const std::string& text) {
    const bool stream = to.medium == Medium::Standard;
    for (std::size_t sent = 0; sent < text.size();) {
        const ssize_t n = stream ? write(fd, text.data() + sent, text.size() - sent)
                                 : send(fd, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
        if (n >= 0) {
            sent += static_cast<std::size_t>(n);
        } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
            pollfd ready{fd, POLLOUT, 0};
            (void)poll(&ready, 1, 1000);
        } else if (errno == ECONNREFUSED && to.medium == Medium::Udp) {
            return;
        } else if (errno != EINTR) {
            throw failure(to, detail::text_of_errno(errno));
        }
    }
}

}  // namespace

std::size_t replay(const Recording& recording, const ReplayRequest& request) {
    const auto samples = in_order(recording);
    if (samples.empty()) throw input_error("has no sample", {}, "a data set with an IMU log is needed");
    const Descriptor fd = connected(request.to);
    const auto zero = std::chrono::steady_clock::now();
    const Time first = samples.front().first;
    const std::size_t together = request.speed > 0.0 || request.to.medium == Medium::Udp ? 1 : 64;
    std::string text;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (request.speed > 0.0) {
            const std::chrono::duration<double> due((samples[i].first - first).seconds() / request.speed);
            std::this_thread::sleep_until(zero + std::chrono::duration_cast<std::chrono::steady_clock::duration>(due));
        }
        text += std::visit([](const auto* s) { return line_of(*s); }, samples[i].second);
        if ((i + 1) % together == 0 || i + 1 == samples.size()) {
            send_all(request.to, fd.get(), text);
            text.clear();
        }
        if (request.progress && i % 1024 == 0) request.progress(static_cast<double>(i) / static_cast<double>(samples.size()));
    }
    return samples.size();
}

}  // namespace schuler::live
