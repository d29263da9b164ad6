#include "schuler/io/container/compression.h"

#include "schuler/core/error.h"

#include <bzlib.h>
#include <fmt/format.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <memory>

namespace schuler::io {
namespace {

constexpr std::size_t largest = std::size_t{4} << 30, step = std::size_t{1} << 20;

Error damaged(std::string_view method, std::string_view why) {
    return input_error(fmt::format("a block compressed with {} is damaged ({})", method, why), {}, "copy the log completely");
}

/// Space for more output after `used` bytes.
void grow(std::string& out, std::size_t used, std::string_view method) {
    if (used >= largest) throw damaged(method, "more than 4 GB");
    out.resize(std::max(out.size(), used + std::max(step, used / 2)));
}

std::string from_zstd(std::string_view bytes, std::size_t size) {
    const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
    std::string out(std::min(size, std::size_t{64} << 20), '\0');  // a wrong stated size must not cost memory
    ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
    std::size_t used = 0, left = 1;
    while (true) {
        if (used == out.size()) {
            if (left == 0 && in.pos == in.size) break;
            grow(out, used, "zstd");
        }
        ZSTD_outBuffer to{out.data(), out.size(), used};
        const std::size_t before = in.pos;
        left = ZSTD_decompressStream(context.get(), &to, &in);
        if (ZSTD_isError(left) != 0) throw damaged("zstd", ZSTD_getErrorName(left));
        const bool moved = to.pos != used || in.pos != before;
        used = to.pos;
        if (in.pos == in.size && used < out.size()) break;
        if (!moved) break;
    }
    if (left != 0) throw damaged("zstd", "cut");
    out.resize(used);
    return out;
}

std::string from_lz4(std::string_view bytes, std::size_t size) {
    LZ4F_dctx* raw = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0) throw damaged("lz4", "no memory");
    const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(raw, LZ4F_freeDecompressionContext);
    std::string out(std::min(size, std::size_t{64} << 20), '\0');
    std::size_t used = 0, at = 0, left = 1;
    while (left != 0) {
        if (used == out.size()) grow(out, used, "lz4");
        std::size_t room = out.size() - used, given = bytes.size() - at;
        left = LZ4F_decompress(context.get(), out.data() + used, &room, bytes.data() + at, &given, nullptr);
        if (LZ4F_isError(left) != 0) throw damaged("lz4", LZ4F_getErrorName(left));
        if (room == 0 && given == 0 && used < out.size() && left != 0) throw damaged("lz4", "cut");
        used += room;
        at += given;
    }
    out.resize(used);
    return out;
}

std::string from_bzip2(std::string_view bytes, std::size_t size) {
    bz_stream stream{};
    if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw damaged("bz2", "no memory");
    const std::unique_ptr<bz_stream, int (*)(bz_stream*)> closed(&stream, BZ2_bzDecompressEnd);
    std::string in(bytes), out(std::max<std::size_t>(std::min(size, std::size_t{64} << 20), 1), '\0');
    stream.next_in = in.data();
    stream.avail_in = static_cast<unsigned>(in.size());
    std::size_t used = 0;
    for (int state = BZ_OK; state != BZ_STREAM_END;) {
        if (used == out.size()) grow(out, used, "bz2");
        const std::size_t room = std::min<std::size_t>(out.size() - used, 1U << 30);
        stream.next_out = out.data() + used;
        stream.avail_out = static_cast<unsigned>(room);
        const unsigned before = stream.avail_in;
        state = BZ2_bzDecompress(&stream);
        const std::size_t made = room - stream.avail_out;
        if (state != BZ_OK && state != BZ_STREAM_END) throw damaged("bz2", fmt::format("code {}", state));
        if (state == BZ_OK && made == 0 && stream.avail_in == before) throw damaged("bz2", "cut");
        used += made;
    }
    out.resize(used);
    return out;
}

struct Method {
    std::string_view name;
    std::string (*decompressed)(std::string_view bytes, std::size_t size);
};
std::string unpacked(std::string_view bytes, std::size_t) { return std::string(bytes); }
constexpr std::array methods{Method{"", unpacked}, Method{"none", unpacked}, Method{"zstd", from_zstd}, Method{"lz4", from_lz4},
                             Method{"bz2", from_bzip2}};

}  // namespace

bool is_compression(std::string_view method) { return std::ranges::find(methods, method, &Method::name) != methods.end(); }

std::string decompressed(std::string_view bytes, std::string_view method, std::size_t size) {
    const auto it = std::ranges::find(methods, method, &Method::name);
    if (it == methods.end())
        throw input_error(fmt::format("a block is compressed with \"{}\"", method), {}, "zstd, lz4, bz2 and none are read");
    return it->decompressed(bytes, size);
}

}  // namespace schuler::io
