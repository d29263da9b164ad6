// Who may ask: the browser's own page and nobody else's.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace schuler::serve {

struct Refusal;

/// What a request says about where it comes from.
struct Provenance {
    std::string host, origin, fetch_site;  ///< headers Host, Origin, Sec-Fetch-Site; empty where absent
    std::string authorization, cookie;
    bool several_hosts = false;
};

struct GuardSettings {
    std::string address = "127.0.0.1";  ///< that the server is bound to
    int port = 0;
    std::string token;
};

/// A server on this machine alone answers to its own loopback names; one bound elsewhere to any address (not to names, which a
/// foreign page could point here). Every request carries the token, as cookie or in the header Authorization. Requests that a page of another site
/// makes are refused whatever they carry. Nothing: the request is welcome.
[[nodiscard]] std::optional<Refusal> refusal_of(const Provenance& from, const GuardSettings& settings);

[[nodiscard]] bool is_loopback(std::string_view address);

/// Whether two secrets are the same, in a time that does not depend on where they differ.
[[nodiscard]] bool same_secret(std::string_view a, std::string_view b);

/// 32 hexadecimal digits from the system's random source.
[[nodiscard]] std::string random_token();

/// Cookies do not tell ports apart: two servers of one machine need two names.
[[nodiscard]] std::string cookie_name(int port);

}  // namespace schuler::serve
