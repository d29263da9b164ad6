// The only part that depends on the HTTP library.
#include "schuler/core/error.h"
#include "serve/assets.h"
#include "serve/connections.h"
#include "serve/guard.h"
#include "serve/server.h"

#include <fmt/format.h>
#include <httplib.h>

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <fstream>

namespace schuler::serve {
namespace {

using Clock = std::chrono::steady_clock;

/// A slow connection occupies a thread. From `most_connections` on strangers make room for those that come (connections.h).
constexpr std::size_t longest_path = 2000, threads = 256, most_connections = 240, most_listeners = 12;
/// Time limit for a body, s, and the addition for each MB.
constexpr double body_time = 20.0, body_time_per_mb = 2.0;
constexpr std::uintmax_t most_drained = 64u << 20;

/// Scripts and styles are loaded from this server only; uPlot and three.js set styles on elements.
constexpr const char* page_policy =
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; connect-src 'self'; "
    "frame-src 'self'; font-src 'self'; form-action 'none'; base-uri 'none'; frame-ancestors 'none'";
/// A file of a run is a separate page without access to the API.
constexpr const char* file_policy =
    "sandbox allow-scripts allow-modals; default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src "
    "data:; "
    "frame-ancestors 'self'";

void set_body(httplib::Response& res, std::string body, const std::string& type) {
    // by a provider: the library would compress a plain body, which costs more than it saves on a local machine
    if (body.empty()) return res.set_content("", type.c_str());
    auto kept = std::make_shared<const std::string>(std::move(body));
    res.set_content_provider(kept->size(), type.c_str(), [kept](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        return sink.write(kept->data() + offset, std::min(length, std::size_t{1} << 16));
    });
}

void set_file(httplib::Response& res, const Reply& reply) {
    auto file = std::make_shared<std::ifstream>(reply.file, std::ios::binary);
    std::error_code ec;
    const auto size = std::filesystem::file_size(reply.file, ec);
    if (!*file || ec) {
        res.status = 404;
        return;
    }
    if (size == 0) return res.set_content("", reply.type.c_str());
    res.set_content_provider(size, reply.type.c_str(), [file](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        char buffer[1 << 16];
        file->clear();
        file->seekg(static_cast<std::streamoff>(offset));
        file->read(buffer, static_cast<std::streamsize>(std::min(length, sizeof buffer)));
        return file->gcount() > 0 && sink.write(buffer, static_cast<std::size_t>(file->gcount()));
    });
}

std::string quoted_name(const std::string& name) {
    std::string out;
    for (const char c : name) out += c == '"' || c == '\\' || (c & 0x80) != 0 ? '_' : c;
    return out;
}

std::string type_of_asset(std::string_view path) {
    if (path.ends_with(".html")) return "text/html; charset=utf-8";
    if (path.ends_with(".js")) return "text/javascript; charset=utf-8";
    if (path.ends_with(".css")) return "text/css; charset=utf-8";
    if (path.ends_with(".svg")) return "image/svg+xml";
    if (path.ends_with(".json")) return "application/json";
    return "text/plain; charset=utf-8";
}

/// Differs where the bytes do (FNV-1a, 64 bits): a mark of a version, no protection.
std::string tag_of(std::string_view bytes) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return fmt::format("\"{:016x}\"", hash);
}

/// The library's view of a connection. It asks for the head byte by byte.
class ConnectionStream final : public httplib::Stream {
public:
    explicit ConnectionStream(Connections::Open& open) : open_(open) {}
    bool is_readable() const override { return begin_ < end_ || open_.ready(POLLIN, Connections::Open::read_time); }
    bool is_writable() const override {
        if (!open_.ready(POLLOUT, Connections::Open::write_time)) return false;
        char byte = 0;  // closed by the other end?
        return !open_.ready(POLLIN, 0.0) || recv(open_.fd(), &byte, 1, MSG_PEEK) > 0;
    }
    ssize_t read(char* to, std::size_t size) override {
        if (begin_ == end_) {
            if (size >= buffer_.size()) return open_.read(to, size);
            const ssize_t got = open_.read(buffer_.data(), buffer_.size());
            if (got <= 0) return got;
            begin_ = 0;
            end_ = static_cast<std::size_t>(got);
        }
        size = std::min(size, end_ - begin_);
        std::copy_n(buffer_.data() + begin_, size, to);
        begin_ += size;
        return static_cast<ssize_t>(size);
    }
    ssize_t write(const char* from, std::size_t size) override { return open_.write(from, size); }
    void get_remote_ip_and_port(std::string&, int&) const override {}
    void get_local_ip_and_port(std::string&, int&) const override {}
    socket_t socket() const override { return open_.fd(); }

private:
    Connections::Open& open_;
    std::array<char, 4096> buffer_{};
    std::size_t begin_ = 0, end_ = 0;
};

/// One request per connection: the unread remainder of a refused request must not be interpreted as the next one.
class OneRequestServer final : public httplib::Server {
public:
    explicit OneRequestServer(Connections& connections) : connections_(connections) {
        new_task_queue = [this] { return new Queue(connections_); };
    }

private:
    /// Threads, before which strangers make room.
    class Queue final : public httplib::TaskQueue {
    public:
        explicit Queue(Connections& connections) : connections_(connections), pool_(threads) {}
        void enqueue(std::function<void()> take_up) override {
            connections_.accepted();
            pool_.enqueue(std::move(take_up));
        }
        void shutdown() override {
            connections_.end();  // the threads are waited for
            pool_.shutdown();
        }

    private:
        Connections& connections_;
        httplib::ThreadPool pool_;
    };

    bool process_and_close_socket(socket_t fd) override {
        Connections::Open open(connections_, fd);
        ConnectionStream stream(open);
        bool closed = false;
        return process_request(stream, true, closed, nullptr);
    }

    Connections& connections_;
};

}  // namespace

struct Server::Http {
    explicit Http(ServerSettings s) : settings(std::move(s)), service(settings.service) {
        guard.address = settings.address;
        guard.token = random_token();  // also required locally: other users of this machine must not have access
        // The library's default options would permit a second server on the same port.
        http.set_socket_options([](socket_t sock) {
            const int yes = 1;
            setsockopt(sock, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        });
        http.set_tcp_nodelay(true);
        http.set_payload_max_length(static_cast<std::size_t>(settings.service.max_upload) + (1u << 20));
        http.set_exception_handler([this](const auto&, httplib::Response& res, std::exception_ptr) {
            give(res, refused({500, "unexpected failure"}));
        });
        http.set_error_handler([this](const httplib::Request&, httplib::Response& res) {
            if (res.body.empty() && !res.has_header("Content-Security-Policy"))
                give(res, refused({res.status, "the request cannot be read", "see /api/openapi.json"}));
        });
        http.set_pre_routing_handler([this](const httplib::Request& req, httplib::Response& res) {
            using Result = httplib::Server::HandlerResponse;
            const bool looking = req.method == "GET" || req.method == "HEAD";
            if (req.path.size() > longest_path ||
                (!looking && req.method != "POST" && req.method != "PUT" && req.method != "PATCH" && req.method != "DELETE")) {
                give(res, refused({req.path.size() > longest_path ? 414 : 405, "the request cannot be read", {}}));
                return Result::Handled;
            }
            if (!looking) return Result::Unhandled;
            look(req, res);
            return Result::Handled;
        });
        const auto change = [this](const httplib::Request& req, httplib::Response& res, const httplib::ContentReader& read) {
            take(req, res, read);
        };
        http.Post("[^]*", change);
        http.Put("[^]*", change);
        http.Patch("[^]*", change);
        http.Delete("[^]*", change);
        bind();
    }

    void bind() {
        int port = settings.port;
        bool bound = false;
        if (port != 0) bound = http.bind_to_port(settings.address, port);
        if (port == 0 || (!bound && settings.port_is_wish)) {
            port = http.bind_to_any_port(settings.address);
            bound = port > 0;
        }
        if (!bound) {
            throw input_error(fmt::format("{} port {} cannot be bound", settings.address, settings.port), {{}, 0, 0, "--port"},
                              "another program has it: give another one with --port, or 0 for any");
        }
        guard.port = port;
    }

    void give(httplib::Response& res, const Reply& reply) {
        res.status = reply.status;
        res.set_header("Content-Security-Policy", reply.page_of_its_own ? file_policy : page_policy);
        res.set_header("X-Content-Type-Options", "nosniff");
        res.set_header("Referrer-Policy", "no-referrer");
        res.set_header("Cross-Origin-Resource-Policy", "same-origin");
        res.set_header("Cross-Origin-Opener-Policy", "same-origin");
        if (!reply.page_of_its_own) res.set_header("X-Frame-Options", "DENY");
        res.set_header("Cache-Control", reply.tag.empty() ? "no-store" : "no-cache");
        if (!reply.tag.empty()) res.set_header("ETag", reply.tag);
        if (!reply.download.empty())
            res.set_header("Content-Disposition", fmt::format("attachment; filename=\"{}\"", quoted_name(reply.download)));
        if (reply.events) return listen(res, reply);
        if (!reply.file.empty()) return set_file(res, reply);
        set_body(res, reply.body, reply.type);
    }

    void listen(httplib::Response& res, const Reply& reply) {
        if (++listeners > static_cast<int>(most_listeners)) {
            --listeners;
            return give(res, refused({503, "too many pages are listening", "close some of them"}));
        }
        res.set_chunked_content_provider(
            "text/event-stream",
            [this, next = reply.events, quiet = 0](std::size_t, httplib::DataSink& sink) mutable {
                const std::string events = next();
                if (stopping || !sink.is_writable()) return false;
                quiet = events.empty() ? quiet + 1 : 0;
                if (!events.empty()) return sink.write(events.data(), events.size());
                return quiet % 10 != 1 || sink.write(":\n\n", 3);  // detects whether the client is still connected
            },
            [this](bool) { --listeners; });
    }

    [[nodiscard]] std::optional<Refusal> refusal(const httplib::Request& req) const {
        Provenance from;
        from.host = req.get_header_value("Host");
        from.several_hosts = req.get_header_value_count("Host") > 1 || req.get_header_value_count("Content-Length") > 1 ||
                             (req.has_header("Content-Length") && req.has_header("Transfer-Encoding"));
        from.origin = req.get_header_value("Origin");
        from.fetch_site = req.get_header_value("Sec-Fetch-Site");
        from.authorization = req.get_header_value("Authorization");
        from.cookie = req.get_header_value("Cookie");
        return refusal_of(from, guard);
    }

    void look(const httplib::Request& req, httplib::Response& res) {
        if (req.has_header("Range")) return give(res, refused({416, "parts of files are not served"}));
        const bool entering = req.path == "/" && req.has_param("token");
        if (const auto no = refusal(req); no && !(entering && no->status == 401)) return give(res, refused(*no));
        if (!entering) connections.trust();
        if (entering) {
            if (!same_secret(req.get_param_value("token"), guard.token)) return give(res, refused({401, "the token is wrong"}));
            Reply on;
            on.status = 303;
            give(res, on);
            res.set_header("Location", "/");
            res.set_header("Set-Cookie",
                           fmt::format("{}={}; HttpOnly; SameSite=Strict; Path=/", cookie_name(guard.port), guard.token));
            return;
        }
        if (req.path.starts_with("/api/")) return give(res, service.answer(request_of(req, {})));
        const std::string path = req.path == "/" ? "/index.html" : req.path;
        for (const Asset& asset : assets()) {
            if (asset.path != path) continue;
            Reply reply;
            reply.type = type_of_asset(path);
            reply.tag = tag_of(asset.bytes);
            // a browser that has it keeps its compiled form too
            if (req.get_header_value("If-None-Match") == reply.tag) reply.status = 304;
            else reply.body = std::string(asset.bytes);
            return give(res, reply);
        }
        give(res, refused({404, "there is no such page"}));
    }

    static Request request_of(const httplib::Request& req, std::string body) {
        Request out;
        out.method = req.method == "HEAD" ? "GET" : req.method;
        out.path = req.path;
        for (const auto& [name, value] : req.params) out.query.emplace(name, value);
        out.body = std::move(body);
        return out;
    }

    /// True if a body, from its start time and the number of bytes received, is too slow.
    [[nodiscard]] static bool too_slow(Clock::time_point begin, std::uintmax_t size) {
        const double allowed = body_time + body_time_per_mb * static_cast<double>(size) / (1 << 20);
        return std::chrono::duration<double>(Clock::now() - begin).count() > allowed;
    }

    /// Reads the body in any case, up to a limit, so that the client receives the answer.
    static void drain(const httplib::Request& req, const httplib::ContentReader& read) {
        std::uintmax_t size = 0;
        const Clock::time_point begin = Clock::now();
        const auto nothing = [&](const char*, std::size_t n) { return (size += n) <= most_drained && !too_slow(begin, size); };
        if (req.is_multipart_form_data()) read([](const httplib::MultipartFormData&) { return true; }, nothing);
        else read(nothing);
    }

    void take(const httplib::Request& req, httplib::Response& res, const httplib::ContentReader& read) {
        std::optional<Refusal> no = refusal(req);
        if (!no && req.is_multipart_form_data())
            no = Refusal{415, "forms of several parts are not taken",
                         "send one file as the body of PUT /api/datasets/{dataset}/files/{file}"};
        std::string body;
        try {
            if (!no) connections.trust();
            if (no) {
                drain(req, read);
            } else if (Service::is_upload(req.method, req.path)) {
                return give(res, received(req, read));
            } else {
                bool too_long = false;
                const Clock::time_point begin = Clock::now();
                const bool whole = read([&](const char* data, std::size_t n) {
                    if (too_slow(begin, body.size() + n)) return false;
                    too_long = too_long || body.size() + n > Service::largest_body;
                    if (!too_long) body.append(data, n);
                    return true;
                });
                if (too_long) no = Refusal{413, "the body is too long", "at most 4 MB"};
                else if (!whole) no = Refusal{400, "the body does not arrive as announced"};
            }
        } catch (const Refusal& r) {
            no = r;
        }
        give(res, no ? refused(*no) : service.answer(request_of(req, std::move(body))));
    }

    Reply received(const httplib::Request& req, const httplib::ContentReader& read) {
        std::optional<Refusal> no;
        std::unique_ptr<Upload> upload;
        std::uintmax_t size = 0, beyond = 0;
        try {
            const std::string length = req.get_header_value("Content-Length");
            upload = service.upload(req.path, std::strtoull(length.c_str(), nullptr, 10));
        } catch (const Refusal& r) {
            no = r;
        }
        const Clock::time_point begin = Clock::now();
        const bool whole = read([&](const char* data, std::size_t n) {
            size += n;
            if (too_slow(begin, size)) return false;
            if (no) return (beyond += n) <= most_drained;
            try {
                upload->write(data, n);
            } catch (const Refusal& r) {
                no = r;
            }
            return true;
        });
        if (no) return refused(*no);
        if (!whole) return refused({400, "the upload broke off", "send it again"});
        upload->commit();
        Reply reply;
        reply.status = 201;
        reply.body = Json{{"name", req.path.substr(req.path.rfind('/') + 1)}, {"bytes", size}}.dump(
            -1, ' ', false, Json::error_handler_t::replace);
        return reply;
    }

    ServerSettings settings;
    GuardSettings guard;
    std::atomic<bool> stopping{false};
    std::atomic<int> listeners{0};
    Service service;
    Connections connections{most_connections};
    OneRequestServer http{connections};
};

Server::Server(ServerSettings settings) : http_(std::make_unique<Http>(std::move(settings))) {}
Server::~Server() = default;

std::string Server::url() const {
    const GuardSettings& g = http_->guard;
    const std::string host = g.address.find(':') != std::string::npos ? "[" + g.address + "]" : g.address;
    return fmt::format("http://{}:{}/{}", host, g.port, "?token=" + g.token);
}

bool Server::serve() { return http_->http.listen_after_bind(); }

void Server::stop() {
    http_->stopping = true;
    http_->service.hurry();
    http_->http.stop();
}

}  // namespace schuler::serve
