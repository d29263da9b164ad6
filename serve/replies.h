// What several routes of the server share: replies, and fields of the requests.
#pragma once

#include "serve/forms.h"
#include "serve/message.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <string>

namespace schuler::serve {

[[nodiscard]] inline Reply json_reply(const Json& j, int status = 200) {
    Reply reply;
    reply.status = status;
    reply.body = j.dump(-1, ' ', false, Json::error_handler_t::replace);
    return reply;
}

/// `title` of a request, or `otherwise`. @throws Refusal 422 if it is empty or too long
[[nodiscard]] inline std::string title_of(const Json& body, const std::string& otherwise) {
    const std::string title = body.contains("title") ? body["title"].get<std::string>() : otherwise;
    if (title.empty() || title.size() > 200) throw Refusal{422, "a title has 1 to 200 bytes", {}, "title"};
    return title;
}

/// A number of the query. @throws Refusal 422
[[nodiscard]] inline double number_of(const Request& r, const std::string& name, double otherwise) {
    const std::string given = r.asked(name);
    if (given.empty()) return otherwise;
    char* end = nullptr;
    const double x = std::strtod(given.c_str(), &end);
    if (*end != '\0' || !std::isfinite(x)) throw Refusal{422, fmt::format("{} is not a number", name), {}, name};
    return x;
}

/// The number of rows that is asked for; 0: all. @throws Refusal 422
[[nodiscard]] inline std::size_t points_of(const Request& r, std::size_t otherwise) {
    constexpr double most = 20'000.0;
    const double points = number_of(r, "points", static_cast<double>(otherwise));
    if (points < 0.0 || points > most) throw Refusal{422, "points is from 0 to 20000", {}, "points"};
    return static_cast<std::size_t>(points);
}

}  // namespace schuler::serve
