// Sources of samples and destinations of messages, for example "tcp://host:port", "serial:/dev/ttyUSB0?baud=115200", "stdin".
#pragma once

#include <string>

namespace schuler::live {

enum class Medium { Tcp, TcpListen, Udp, Serial, Standard, File, Gpsd, Shared };

struct Endpoint {
    Medium medium = Medium::Standard;
    std::string text;        ///< as given
    std::string host, port;  ///< of sockets; an empty host: all addresses of this machine
    std::string path;        ///< of a serial port or file; name of shared memory
    int baud = 115200;
    int descriptor = 1;  ///< of Medium::Standard as an output: 1 or 2 (standard error)
};

enum class Direction { In, Out };

/// In: tcp://HOST:PORT, tcp-listen://[HOST]:PORT, udp://[HOST]:PORT (bound), serial:PATH[?baud=N], file:PATH (or a pipe), stdin,
/// gpsd://HOST[:PORT]. Out: tcp://, tcp-listen://, udp://HOST:PORT (sent to), serial:, file:, shm:NAME, stdout. @throws Error(Input), `key`
[[nodiscard]] Endpoint endpoint_from(const std::string& text, Direction direction, const std::string& key);

}  // namespace schuler::live
