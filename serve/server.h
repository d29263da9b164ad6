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
    int port = 8080;            ///< 0: any that is free
    bool port_is_wish = false;  ///< where it is taken, any other one will do
};

class Server {
public:
    /// Binds. @throws Error(Input) where the address or the workspace cannot be used
    explicit Server(ServerSettings settings);
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    /// What to open in a browser, with the token.
    [[nodiscard]] std::string url() const;
    /// Serves until stop() is called from another thread. False where listening failed.
    bool serve();
    void stop();

private:
    struct Http;
    std::unique_ptr<Http> http_;
};

}  // namespace schuler::serve
