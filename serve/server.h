// `schuler ui`: the service behind HTTP.
#pragma once

#include "serve/service.h"

#include <functional>
#include <memory>
#include <string>

namespace schuler::serve {

struct ServerSettings {
    ServiceSettings service;
    std::string address = "127.0.0.1";
    int port = 8080;            ///< 0: any free port
    bool port_is_wish = false;  ///< if it is in use, any other port is acceptable
};

class Server {
public:
    /// Binds. @throws Error(Input) if the address or the workspace cannot be used
    explicit Server(ServerSettings settings);
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    /// The address to open in a browser, with the token.
    [[nodiscard]] std::string url() const;
    /// Serves until stop() is called from another thread. False if listening failed.
    bool serve();
    void stop();

private:
    struct Http;
    std::unique_ptr<Http> http_;
};

}  // namespace schuler::serve
