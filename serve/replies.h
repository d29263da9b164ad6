// What several routes of the server share: replies, and fields of the requests.
#pragma once

#include "serve/forms.h"
#include "serve/message.h"

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

}  // namespace schuler::serve
