// The folder the server works in: runs and uploaded data sets, by name.
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace schuler::serve {

using Json = nlohmann::ordered_json;

/// ROOT/NAME is a run (it has run.json of the server or summary.json of the program), ROOT/data/NAME an uploaded data set.
class Workspace {
public:
    /// Creates the folder if missing. `opened`: a user data set, read but never written; may be empty.
    /// @throws Error(Input)
    Workspace(std::filesystem::path root, const std::filesystem::path& opened);

    ~Workspace();
    Workspace(const Workspace&) = delete;
    Workspace& operator=(const Workspace&) = delete;

    [[nodiscard]] const std::filesystem::path& root() const { return root_; }
    /// True if no other server uses this folder; determined when it is opened.
    [[nodiscard]] bool alone() const { return lock_ >= 0; }
    /// Data saved by the page with its runs: plot layouts. JSON; null if there are none.
    [[nodiscard]] Json kept() const;
    void keep(const Json& what);

    /// Newest first: {id, title, kind, state, message, created, dataset, scheme, error_m}.
    [[nodiscard]] Json runs() const;
    [[nodiscard]] Json run(const std::string& id) const;
    [[nodiscard]] std::filesystem::path run_folder(const std::string& id) const;  ///< @throws Refusal 400, 404
    /// Creates a folder for a new run with that title and a run.json with `fields`; returns its id.
    [[nodiscard]] std::string new_run(const std::string& title, const Json& fields);
    /// Adds members to run.json.
    void note(const std::string& id, const Json& fields);
    void remove_run(const std::string& id);
    /// A hidden, empty folder for files passed to a child, until remove_temporary().
    [[nodiscard]] std::filesystem::path temporary_folder(const std::string& name) const;
    void remove_temporary(const std::filesystem::path& folder) const noexcept;
    /// Removes the partial results of a failed run, keeping its input.
    void clear_results(const std::string& id);

    [[nodiscard]] Json datasets() const;  ///< {name, opened, files: [{name, bytes}]}
    [[nodiscard]] std::filesystem::path dataset_folder(const std::string& name) const;  ///< @throws Refusal 400, 404
    [[nodiscard]] std::string new_dataset(const std::string& title);
    void remove_dataset(const std::string& name);
    [[nodiscard]] bool is_opened(const std::string& name) const { return !opened_.empty() && name == opened_name; }
    [[nodiscard]] std::uintmax_t uploaded_bytes() const;

    static constexpr const char* opened_name = "opened";

private:
    [[nodiscard]] std::string new_folder(const std::filesystem::path& parent, const std::string& title) const;
    std::filesystem::path root_, opened_;
    int lock_ = -1;  ///< held during the lifetime of the server
    /// What run() read, by id, with the times and sizes of the files: the list of a thousand runs reads only those that changed.
    struct Read {
        std::string stamp;
        Json run;
    };
    mutable std::mutex read_mutex_;
    mutable std::map<std::string, Read> read_;
};

/// A file received in parts: appears under its name only when complete.
class Upload {
public:
    /// @throws Refusal 507 if the folder cannot be written
    Upload(const std::filesystem::path& target, std::uintmax_t limit);
    ~Upload();
    Upload(const Upload&) = delete;
    Upload& operator=(const Upload&) = delete;

    /// @throws Refusal 413 beyond the limit, 507 if the disk is full
    void write(const char* data, std::size_t size);
    /// @throws Refusal 507
    void commit();

private:
    std::filesystem::path target_, temporary_;
    std::uintmax_t limit_, size_ = 0;
    std::ofstream stream_;
};

/// A text file of at most `limit` bytes; "" if it does not exist.
[[nodiscard]] std::string text_of(const std::filesystem::path& file, std::uintmax_t limit = 16u << 20);

}  // namespace schuler::serve
