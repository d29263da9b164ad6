#include "schuler/io/rinex/compact_rinex.h"

#include "schuler/core/error.h"
#include "schuler/io/place.h"

#include <fmt/format.h>

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>

namespace schuler::io {
namespace {

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using InputFile = std::unique_ptr<std::FILE, CloseFile>;

/// The program in the folders of PATH; empty if not found.
std::string program() {
    const char* path = std::getenv("PATH");
    std::string_view rest = path != nullptr ? path : "";
    while (!rest.empty()) {
        const std::string_view folder = rest.substr(0, rest.find(':'));
        rest.remove_prefix(std::min(folder.size() + 1, rest.size()));
        for (const char* name : {"crx2rnx", "CRX2RNX"}) {
            const std::string candidate = fmt::format("{}/{}", folder, name);
            if (access(candidate.c_str(), X_OK) == 0) return candidate;
        }
    }
    return {};
}

/// Standard output of `command -` with `input` as standard input. False if it fails.
bool run(const std::string& command, int input, int output) {
    const pid_t child = fork();
    if (child < 0) return false;
    if (child == 0) {
        if (dup2(input, STDIN_FILENO) < 0 || dup2(output, STDOUT_FILENO) < 0) _exit(127);
        execl(command.c_str(), command.c_str(), "-", static_cast<char*>(nullptr));
        _exit(127);
    }
    int status = 0;
    while (waitpid(child, &status, 0) < 0) {
        if (errno != EINTR) return false;
    }
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

bool is_compact_rinex(std::string_view text) { return text.substr(0, 80).find("CRINEX VERS   / TYPE") == 60; }

std::string decompact_rinex(std::string_view text, const std::string& name) {
    const std::string command = program();
    if (command.empty())
        throw input_error("is Hatanaka-compressed, and crx2rnx is not installed", place_in(name, 1),
                          "install crx2rnx in a folder of PATH, or decompress the file first");
    const InputFile input(std::tmpfile()), output(std::tmpfile());
    if (!input || !output) throw computation_error(fmt::format("{}: no temporary file for decompression", name));
    const bool written = std::fwrite(text.data(), 1, text.size(), input.get()) == text.size() && std::fflush(input.get()) == 0;
    if (!written || std::fseek(input.get(), 0, SEEK_SET) != 0)
        throw computation_error(fmt::format("{}: the temporary file for decompression cannot be written", name));
    if (!run(command, fileno(input.get()), fileno(output.get())))
        throw input_error(fmt::format("{} could not decompress it", command), place_in(name), "is the file complete?");
    if (std::fseek(output.get(), 0, SEEK_SET) != 0)
        throw computation_error(fmt::format("{}: the decompressed text cannot be read", name));
    std::string result;
    std::array<char, 65536> chunk{};
    for (std::size_t n = 0; (n = std::fread(chunk.data(), 1, chunk.size(), output.get())) > 0;) result.append(chunk.data(), n);
    return result;
}

}  // namespace schuler::io
