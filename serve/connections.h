// The open connections of the server: those that take long to send their request make room for others.
#pragma once

#include <chrono>
#include <cstddef>
#include <list>
#include <mutex>
#include <thread>

#include <sys/types.h>

namespace schuler::serve {

/// A connection is a stranger until its request has shown the token. Strangers have a limit of time to send the head of their request, and
/// a limit of its size; where all threads are taken, the stranger that has been there longest is shut down for each one that comes.
class Connections {
public:
    using Clock = std::chrono::steady_clock;

    /// `most`: connections at once, before strangers have to go.
    explicit Connections(std::size_t most) : most_(most) {}
    Connections(const Connections&) = delete;
    Connections& operator=(const Connections&) = delete;

    class Open;

    /// A connection was accepted and waits for a thread.
    void accepted();
    /// The one of the calling thread belongs to somebody with the token.
    void trust();
    /// Shuts down all of them, and those that still come.
    void end();

private:
    struct Entry {
        int fd;
        std::thread::id thread;
        bool stranger = true, shut = false;
    };
    using Entries = std::list<Entry>;

    const std::size_t most_;
    std::mutex mutex_;
    std::size_t count_ = 0;  ///< with those that wait for a thread
    bool ended_ = false;
    Entries open_;  ///< oldest first
};

/// A connection that a thread has taken up, during its lifetime; closed at its end.
class Connections::Open {
public:
    static constexpr double head_time = 10.0;  ///< s, for the request line and the header
    static constexpr std::size_t head_bytes = 64 << 10;
    static constexpr double read_time = 10.0, write_time = 30.0;  ///< s without any byte

    Open(Connections& all, int fd);
    ~Open();
    Open(const Open&) = delete;
    Open& operator=(const Open&) = delete;

    [[nodiscard]] int fd() const { return entry_->fd; }
    /// Number of bytes; 0: closed; -1: failed, or one of the limits is reached.
    [[nodiscard]] ssize_t read(char* to, std::size_t size);
    [[nodiscard]] ssize_t write(const char* from, std::size_t size) const;
    /// Ready within `seconds`.
    [[nodiscard]] bool ready(short events, double seconds) const;

private:
    Connections& all_;
    Entries::iterator entry_;
    Clock::time_point begin_ = Clock::now();
    std::size_t got_ = 0;
    int ends_ = 0;  ///< how much of the empty line after the head has come
};

}  // namespace schuler::serve
