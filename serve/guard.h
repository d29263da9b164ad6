// Access control: only the browser's own page is admitted.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace schuler::serve {

struct Refusal;

/// Origin of a request.
struct Provenance {
    std::string host, origin, fetch_site;  ///< headers Host, Origin, Sec-Fetch-Site; empty if absent
    std::string authorization, cookie;
    bool several_hosts = false;
};

struct GuardSettings {
    std::string address = "127.0.0.1";  ///< to which the server is bound
    int port = 0;
    std::string token;
};

/// A server bound to this machine only accepts its own loopback names; one bound elsewhere accepts any address (but no names,
/// which a foreign page could resolve to this address). Every request carries the token, as cookie or in the header
/// Authorization. Requests from pages of other sites are always refused. Empty: the request is accepted.
[[nodiscard]] std::optional<Refusal> refusal_of(const Provenance& from, const GuardSettings& settings);

[[nodiscard]] bool is_loopback(std::string_view address);

/// Compares two secrets in a time independent of the position of the difference.
[[nodiscard]] bool same_secret(std::string_view a, std::string_view b);

/// 32 hexadecimal digits from the system's random source.
[[nodiscard]] std::string random_token();

/// Cookies are not specific to a port: two servers on one machine require different names.
[[nodiscard]] std::string cookie_name(int port);

}  // namespace schuler::serve
