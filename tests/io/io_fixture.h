// A temporary folder for one test, the place of the real data sets, and a check of what an Error says.
#pragma once

#include "schuler/core/error.h"

#include "support/temporary_folder.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>

namespace schuler::io::test {

class IoTest : public testing::Test {
protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        folder_.emplace(std::string(info->test_suite_name()) + "_" + info->name());
    }
    void TearDown() override { folder_.reset(); }

    std::filesystem::path write(const std::string& name, const std::string& content) const {
        std::ofstream(folder() / name, std::ios::binary) << content;
        return folder() / name;
    }
    /// Compressed by gzip.
    std::filesystem::path write_gz(const std::string& name, const std::string& content) const {
        gzFile gz = gzopen((folder() / name).c_str(), "wb");
        gzwrite(gz, content.data(), static_cast<unsigned>(content.size()));
        gzclose(gz);
        return folder() / name;
    }
    [[nodiscard]] static std::string content_of(const std::filesystem::path& path) { return schuler::test::content_of(path); }
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_->path(); }

private:
    std::optional<schuler::test::TemporaryFolder> folder_;
};

/// The message of the Error that an action throws; a failure of the test if it throws none.
inline std::string message_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::Input);
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << "the message must be one line";
        return e.what();
    }
    ADD_FAILURE() << "no Error was thrown";
    return {};
}

/// The message has all these parts.
inline void expect_parts(const std::string& message, std::initializer_list<std::string> parts) {
    for (const std::string& part : parts)
        EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' is not in: " << message;
}

/// Folder of the real data sets, or an empty path.
inline std::filesystem::path data_folder() {
    const char* given = std::getenv("SCHULER_DATA");
    const std::filesystem::path path =
        given != nullptr ? std::filesystem::path(given) : std::filesystem::path(SCHULER_SOURCE_DIR) / "../shared/data";
    return std::filesystem::is_directory(path) ? path : std::filesystem::path{};
}

}  // namespace schuler::io::test

#define SKIP_WITHOUT_DATA() \
    if (schuler::io::test::data_folder().empty()) GTEST_SKIP() << "no data sets: set SCHULER_DATA to their folder"
