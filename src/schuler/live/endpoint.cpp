#include "schuler/live/endpoint.h"

#include "schuler/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <utility>

namespace schuler::live {
namespace {

Error wrong(const std::string& text, const std::string& key, const char* what, Direction direction) {
    const char* forms =
        direction == Direction::In
            ? "write tcp://HOST:PORT, tcp-listen://:PORT, udp://:PORT, serial:/dev/NAME?baud=115200, file:PATH, gpsd://HOST or stdin"
            : "write tcp://HOST:PORT, tcp-listen://:PORT, udp://HOST:PORT, serial:/dev/NAME?baud=115200, file:PATH, shm:NAME or stdout";
    return input_error(fmt::format("\"{}\" {}", text, what), {{}, 0, 0, key}, forms);
}

bool is_number(std::string_view text, int low, int high, int& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() && value >= low && value <= high;
}

}  // namespace

Endpoint endpoint_from(const std::string& text, Direction direction, const std::string& key) {
    Endpoint e;
    e.text = text;
    const bool in = direction == Direction::In;
    if (text == (in ? "stdin" : "stdout")) return e;
    constexpr std::array schemes{std::pair{"tcp://", Medium::Tcp},     std::pair{"tcp-listen://", Medium::TcpListen},
                                 std::pair{"udp://", Medium::Udp},     std::pair{"gpsd://", Medium::Gpsd},
                                 std::pair{"serial:", Medium::Serial}, std::pair{"file:", Medium::File},
                                 std::pair{"shm:", Medium::Shared}};
    std::string_view rest;
    bool known = false;
    for (const auto& [prefix, medium] : schemes) {
        if (!text.starts_with(prefix)) continue;
        e.medium = medium;
        rest = std::string_view(text).substr(std::string_view(prefix).size());
        known = true;
    }
    if (!known || (in ? e.medium == Medium::Shared : e.medium == Medium::Gpsd))
        throw wrong(text, key, "is not a known kind of endpoint", direction);
    if (e.medium == Medium::Shared) {
        e.path = rest;
        constexpr std::size_t longest = 200;
        const bool plain = std::ranges::all_of(rest, [](char c) {
            return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
        });
        if (rest.empty() || rest.size() > longest || !plain || rest.front() == '.')
            throw wrong(text, key, "has no name of letters, digits, \"_\", \"-\" and \".\"", direction);
        return e;
    }
    if (e.medium == Medium::Serial || e.medium == Medium::File) {
        const std::size_t mark = e.medium == Medium::Serial ? rest.find("?baud=") : std::string_view::npos;
        e.path = rest.substr(0, mark);
        if (e.path.empty()) throw wrong(text, key, "missing file", direction);
        if (mark != std::string_view::npos && !is_number(rest.substr(mark + 6), 50, 4'000'000, e.baud))
            throw wrong(text, key, "has no usable baud rate", direction);
        return e;
    }
    const std::size_t colon = rest.rfind(':');
    e.host = rest.substr(0, colon);
    if (e.host.starts_with('[') && e.host.ends_with(']')) e.host = e.host.substr(1, e.host.size() - 2);
    e.port = colon == std::string_view::npos ? "" : rest.substr(colon + 1);
    if (e.medium == Medium::Gpsd && e.port.empty()) e.port = "2947";
    int port = 0;
    if (!is_number(e.port, 1, 65535, port)) throw wrong(text, key, "has no port from 1 to 65535", direction);
    const bool needs_host = e.medium == Medium::Tcp || e.medium == Medium::Gpsd || (e.medium == Medium::Udp && !in);
    if (needs_host && e.host.empty()) throw wrong(text, key, "missing host", direction);
    return e;
}

}  // namespace schuler::live
