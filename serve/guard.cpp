#include "serve/guard.h"

#include "serve/message.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <random>

namespace schuler::serve {
namespace {

/// "[::1]:80" and "127.0.0.1:80" to name and port; an empty port is 80.
std::pair<std::string, std::string> split_host(const std::string& host) {
    const std::size_t bracket = host.rfind(']');
    const std::size_t colon = host.find(':', bracket == std::string::npos ? 0 : bracket);
    if (colon == std::string::npos) return {host, "80"};
    return {host.substr(0, colon), host.substr(colon + 1)};
}

bool is_address(const std::string& name) {
    if (name.size() > 2 && name.front() == '[' && name.back() == ']')
        return name.find_first_not_of("[]0123456789abcdefABCDEF:.") == std::string::npos;
    return !name.empty() && name.find_first_not_of("0123456789.") == std::string::npos;
}

bool own_host(const std::string& host, const GuardSettings& s) {
    const auto [name, port] = split_host(host);
    if (port != std::to_string(s.port)) return false;
    if (name == "127.0.0.1" || name == "localhost" || name == "[::1]" || name == s.address) return true;
    return !is_loopback(s.address) && is_address(name);
}

std::string cookie_value(const std::string& cookies, int port) {
    const std::string wanted = cookie_name(port) + "=";
    for (std::size_t begin = 0; begin < cookies.size();) {
        std::size_t end = std::min(cookies.find(';', begin), cookies.size());
        while (begin < end && cookies[begin] == ' ') ++begin;
        if (cookies.compare(begin, wanted.size(), wanted) == 0)
            return cookies.substr(begin + wanted.size(), end - begin - wanted.size());
        begin = end + 1;
    }
    return {};
}

}  // namespace

std::optional<Refusal> refusal_of(const Provenance& from, const GuardSettings& s) {
    if (from.several_hosts || !own_host(from.host, s)) {
        return Refusal{403, fmt::format("this server does not answer to the host \"{}\"", from.host.substr(0, 100)),
                       "open the address that `schuler ui` printed"};
    }
    if (!from.origin.empty() && from.origin != "http://" + from.host)
        return Refusal{403, "the request comes from a page of another site", "open the address that `schuler ui` printed"};
    if (from.fetch_site == "cross-site" || from.fetch_site == "same-site")
        return Refusal{403, "the request comes from a page of another site", "open the address that `schuler ui` printed"};
    const bool bearer = from.authorization.starts_with("Bearer ") && same_secret(from.authorization.substr(7), s.token);
    if (bearer || same_secret(cookie_value(from.cookie, s.port), s.token)) return std::nullopt;
    return Refusal{401, "the token is missing or wrong", "open the whole address that `schuler ui` printed, with its token"};
}

std::string cookie_name(int port) { return fmt::format("schuler_token_{}", port); }

bool is_loopback(std::string_view address) { return address == "localhost" || address == "::1" || address.starts_with("127."); }

bool same_secret(std::string_view a, std::string_view b) {
    if (a.size() != b.size()) return false;
    unsigned differ = 0;
    for (std::size_t i = 0; i < a.size(); ++i) differ |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
    return differ == 0;
}

std::string random_token() {
    std::random_device source;
    std::string out;
    for (int i = 0; i < 4; ++i) out += fmt::format("{:08x}", source());
    return out;
}

}  // namespace schuler::serve
