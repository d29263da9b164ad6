// Small logs of autopilots, receivers and robots, put together from their documents' definitions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace schuler::io::test {

template <class T>
void put(std::string& out, T value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    out.append(bytes, sizeof value);
}

/// A PX4 log.
class Ulog {
public:
    Ulog() {
        bytes_ = std::string("ULog\x01\x12\x35\x01", 8);
        put(bytes_, std::uint64_t{1000});
        message('B', std::string(40, '\0'));
    }
    void message(char type, std::string_view body) {
        put(bytes_, static_cast<std::uint16_t>(body.size()));
        bytes_ += type;
        bytes_ += body;
    }
    void define(std::string_view text) { message('F', text); }
    void subscribe(std::uint8_t instance, std::uint16_t id, std::string_view name) {
        std::string body(1, static_cast<char>(instance));
        put(body, id);
        message('A', body.append(name));
    }
    template <class... Values>
    void data(std::uint16_t id, Values... values) {
        std::string body;
        put(body, id);
        (put(body, values), ...);
        message('D', body);
    }
    void dropout(std::uint16_t ms) {
        std::string body;
        put(body, ms);
        message('O', body);
    }
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
};

/// An ArduPilot log.
class Dataflash {
public:
    void define(std::uint8_t type, std::string_view name, std::string_view format, std::string_view columns) {
        std::string body;
        body += static_cast<char>(type);
        std::size_t length = 3;
        for (const char c : format)
            length += c == 'Q' || c == 'd'                                       ? 8U
                      : c == 'L' || c == 'I' || c == 'f' || c == 'i' || c == 'e' ? 4U
                      : c == 'B'                                                 ? 1U
                                                                                 : 2U;
        body += static_cast<char>(length);
        const auto padded = [&](std::string_view text, std::size_t size) { body.append(text).append(size - text.size(), '\0'); };
        padded(name, 4);
        padded(format, 16);
        padded(columns, 64);
        message(128, body);
    }
    void message(std::uint8_t type, std::string_view body) {
        bytes_ += "\xa3\x95";
        bytes_ += static_cast<char>(type);
        bytes_ += body;
    }
    template <class... Values>
    void data(std::uint8_t type, Values... values) {
        std::string body;
        (put(body, values), ...);
        message(type, body);
    }
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
};

/// A u-blox message with its checksum.
inline std::string ubx(unsigned char message_class, unsigned char id, std::string_view payload) {
    std::string m("\xb5\x62", 2);
    m += static_cast<char>(message_class);
    m += static_cast<char>(id);
    put(m, static_cast<std::uint16_t>(payload.size()));
    m += payload;
    unsigned a = 0, b = 0;
    for (std::size_t i = 2; i < m.size(); ++i) {
        a = (a + static_cast<unsigned char>(m[i])) & 0xFFU;
        b = (b + a) & 0xFFU;
    }
    m += static_cast<char>(a);
    m += static_cast<char>(b);
    return m;
}

/// The usual check of 32 bits, bit by bit; NovAtel's begins with zero and ends without inversion.
inline std::uint32_t crc32(std::string_view bytes, std::uint32_t crc = 0xFFFFFFFFU, std::uint32_t inverted = 0xFFFFFFFFU) {
    for (const char c : bytes) {
        crc ^= static_cast<unsigned char>(c);
        for (int k = 0; k < 8; ++k) crc = (crc & 1U) != 0 ? crc >> 1 ^ 0xEDB88320U : crc >> 1;
    }
    return crc ^ inverted;
}
inline std::uint32_t novatel_crc(std::string_view bytes) { return crc32(bytes, 0, 0); }

/// Binary messages of a VectorNav unit, field by field in the order of groups and bits.
class VectorNav {
public:
    template <class... Values>
    VectorNav& field(unsigned group, unsigned bit, Values... values) {
        fields_.at(group) |= static_cast<std::uint16_t>(1U << bit);
        (put(payload_, values), ...);
        return *this;
    }
    [[nodiscard]] std::string message() const {
        std::string body(1, '\0'), masks;
        for (std::size_t g = 0; g < fields_.size(); ++g) {
            if (fields_[g] == 0) continue;
            body[0] = static_cast<char>(body[0] | 1 << g);
            put(masks, fields_[g]);
        }
        body += masks + payload_;
        unsigned crc = 0;  // the manual's form, byte by byte
        for (const char c : body) {
            crc = ((crc >> 8U) | (crc << 8U)) & 0xffffU;
            crc ^= static_cast<unsigned char>(c);
            crc ^= (crc & 0xffU) >> 4U;
            crc ^= (crc << 12U) & 0xffffU;
            crc ^= (crc & 0xffU) << 5U;
        }
        return "\xfa" + body + static_cast<char>(crc >> 8U) + static_cast<char>(crc & 0xffU);
    }

private:
    std::array<std::uint16_t, 7> fields_{};
    std::string payload_;
};

}  // namespace schuler::io::test
