#include "serve/workspace.h"

#include "schuler/core/error.h"
#include "schuler/io/own_files.h"
#include "schuler/report/outputs.h"
#include "serve/message.h"
#include "serve/names.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <sstream>

namespace schuler::serve {
namespace {

namespace fs = std::filesystem;
constexpr const char* state_file = "run.json";
constexpr const char* data_folder = "data";
constexpr const char* kept_file = "layouts.json";

Json json_of(const fs::path& file) {
    Json out = Json::parse(text_of(file), nullptr, false);
    return out.is_object() ? out : Json::object();
}

bool is_run(const fs::path& folder) {
    std::error_code ec;
    return fs::is_regular_file(folder / state_file, ec) || fs::is_regular_file(folder / "summary.json", ec);
}

Json member(const Json& object, std::initializer_list<const char*> path) {
    const Json* here = &object;
    for (const char* name : path) {
        if (!here->is_object() || !here->contains(name)) return nullptr;
        here = &(*here)[name];
    }
    return *here;
}

std::int64_t written_at(const fs::path& file) {
    std::error_code ec;
    const auto time = fs::last_write_time(file, ec);
    if (ec) return 0;
    const auto system = std::chrono::file_clock::to_sys(time);
    return std::chrono::duration_cast<std::chrono::seconds>(system.time_since_epoch()).count();
}

/// Changes with the file.
std::string stamp_of(const fs::path& file) {
    std::error_code ec;
    const auto time = fs::last_write_time(file, ec);
    if (ec) return "none;";
    return fmt::format("{}|{};", time.time_since_epoch().count(), fs::file_size(file, ec));
}

std::int64_t now() {
    return std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

Json files_of(const fs::path& folder) {
    Json files = Json::array();
    std::error_code ec;
    constexpr std::size_t most_files = 2000;
    for (auto it = fs::recursive_directory_iterator(folder, ec); !ec && it != fs::recursive_directory_iterator();
         it.increment(ec)) {
        const fs::path& path = it->path();
        if (!it->is_regular_file(ec) || it->is_symlink(ec) || !is_file_name(path.filename().string())) continue;
        if (files.size() >= most_files) break;
        files.push_back({{"name", path.lexically_relative(folder).string()}, {"bytes", it->file_size(ec)}});
    }
    std::sort(files.begin(), files.end(), [](const Json& a, const Json& b) { return a["name"] < b["name"]; });
    return files;
}

}  // namespace

std::string text_of(const fs::path& file, std::uintmax_t limit) {
    std::error_code ec;
    if (fs::is_symlink(file, ec) || !fs::is_regular_file(file, ec) || fs::file_size(file, ec) > limit)
        return {};  // must not leave the folder
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
}

Workspace::Workspace(fs::path root, const fs::path& opened) {
    report::make_folder(root);
    root_ = fs::canonical(root);
    lock_ = open((root_ / ".server").c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (lock_ >= 0 && flock(lock_, LOCK_EX | LOCK_NB) != 0) {
        close(lock_);
        lock_ = -1;
    }
    if (opened.empty()) return;
    std::error_code ec;
    if (!fs::is_directory(opened, ec))
        throw input_error("is not a folder", {opened.string(), 0, 0, "--open"}, "name the folder of a data set");
    opened_ = fs::canonical(opened);
}

Workspace::~Workspace() {
    if (lock_ >= 0) close(lock_);
}

Json Workspace::kept() const {
    Json out = Json::parse(text_of(root_ / kept_file), nullptr, false);
    return out.is_object() ? out : Json(nullptr);
}

void Workspace::keep(const Json& what) {
    io::allow_overwrite(root_ / kept_file);
    report::write_text(root_ / kept_file, what.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

Json Workspace::runs() const {
    std::vector<Json> all;
    std::error_code ec;
    for (const auto& entry : fs::directory_iterator(root_, ec)) {
        const std::string id = entry.path().filename().string();
        if (entry.is_directory(ec) && is_file_name(id) && is_run(entry.path())) all.push_back(run(id));
    }
    std::ranges::stable_sort(all, [](const Json& a, const Json& b) { return a["created"] > b["created"]; });
    return all;
}

Json Workspace::run(const std::string& id) const {
    const fs::path folder = run_folder(id);
    const std::string stamp = stamp_of(folder / state_file) + stamp_of(folder / "summary.json");
    {
        const std::lock_guard lock(read_mutex_);
        if (const auto it = read_.find(id); it != read_.end() && it->second.stamp == stamp) return it->second.run;
    }
    const Json state = json_of(folder / state_file), summary = json_of(folder / "summary.json");
    const auto text = [&](const char* name, const Json& otherwise) { return state.contains(name) ? state[name] : otherwise; };
    Json out{{"id", id},
             {"title", text("title", summary.value("name", id))},
             {"kind", text("kind", summary.value("command", "process"))},
             {"state", text("state", summary.empty() ? "failed" : "done")},
             {"message", text("message", "")},
             {"created", text("created", written_at(folder / "summary.json"))},
             {"dataset", text("dataset", nullptr)},
             {"command", text("command", nullptr)},
             {"order", text("order", nullptr)},
             {"batch", text("batch", nullptr)},
             {"note", text("note", "")},
             {"verdict", member(summary, {"verdict", "word"})},
             {"scheme", member(summary, {"scheme"})},
             {"duration_s", member(summary, {"duration_s"})},
             {"error_m", member(summary, {"errors", "position_m", "horizontal", "rms"})},
             {"reference", member(summary, {"reference"})}};
    const std::lock_guard lock(read_mutex_);
    read_[id] = {stamp, out};
    return out;
}

fs::path Workspace::run_folder(const std::string& id) const {
    const fs::path folder = inside(root_, id);
    if (!is_run(folder)) throw Refusal{404, fmt::format("there is no run {}", id)};
    return folder;
}

fs::path Workspace::temporary_folder(const std::string& name) const {
    const fs::path folder = root_ / fmt::format(".{}-{}", getpid(), name);
    report::make_folder(folder);
    return folder;
}

void Workspace::remove_temporary(const fs::path& folder) const noexcept {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
}

std::string Workspace::new_folder(const fs::path& parent, const std::string& title) const {
    const std::string stem = folder_name(title);
    for (int number = 1; number < 100000; ++number) {
        const std::string name = number == 1 && stem != data_folder ? stem : fmt::format("{}-{}", stem, number);
        std::error_code ec;
        if (fs::create_directory(parent / name, ec)) return name;
        if (ec && !fs::exists(parent / name)) break;
    }
    throw Refusal{507, "the workspace cannot be written", "check its permissions and the disk"};
}

std::string Workspace::new_run(const std::string& title, const Json& fields) {
    const std::string id = new_folder(root_, title);
    Json state{{"title", title}, {"created", now()}};
    state.update(fields);
    report::write_text(root_ / id / state_file, state.dump(1) + "\n");
    return id;
}

void Workspace::note(const std::string& id, const Json& fields) {
    Json state = json_of(run_folder(id) / state_file);
    state.update(fields);
    io::allow_overwrite(root_ / id / state_file);  // regardless of other changes: the state belongs to the server
    report::write_text(root_ / id / state_file, state.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
    const std::lock_guard lock(read_mutex_);
    read_.erase(id);  // within one tick of the clock the file may have the same time and size
}

void Workspace::remove_run(const std::string& id) {
    std::error_code ec;
    fs::remove_all(run_folder(id), ec);
    {
        const std::lock_guard lock(read_mutex_);
        read_.erase(id);
    }
    if (ec) throw Refusal{507, fmt::format("{} cannot be removed: {}", id, ec.message())};
}

void Workspace::clear_results(const std::string& id) {
    std::error_code ec;
    for (const auto& entry : fs::directory_iterator(run_folder(id), ec)) {
        const std::string name = entry.path().filename().string();
        if (name != state_file && name != "scenario.toml" && name != "settings.toml" && name != "log.txt")
            fs::remove_all(entry, ec);
    }
}

Json Workspace::datasets() const {
    Json out = Json::array();
    if (!opened_.empty())
        out.push_back(
            {{"name", opened_name}, {"title", opened_.filename().string()}, {"opened", true}, {"files", files_of(opened_)}});
    std::error_code ec;
    for (const auto& entry : fs::directory_iterator(root_ / data_folder, ec)) {
        const std::string name = entry.path().filename().string();
        if (!entry.is_directory(ec) || !is_file_name(name)) continue;
        out.push_back({{"name", name}, {"title", name}, {"opened", false}, {"files", files_of(entry.path())}});
    }
    return out;
}

fs::path Workspace::dataset_folder(const std::string& name) const {
    if (is_opened(name)) return opened_;
    const fs::path folder = inside(root_ / data_folder, name);
    std::error_code ec;
    if (!fs::is_directory(folder, ec)) throw Refusal{404, fmt::format("there is no data set {}", name)};
    return folder;
}

std::string Workspace::new_dataset(const std::string& title) {
    std::error_code ec;
    fs::create_directory(root_ / data_folder, ec);
    const std::string stem = folder_name(title);
    return new_folder(root_ / data_folder, stem == opened_name ? stem + "-data" : stem);
}

void Workspace::remove_dataset(const std::string& name) {
    if (is_opened(name)) throw Refusal{403, "the opened folder is yours and is never changed"};
    std::error_code ec;
    fs::remove_all(dataset_folder(name), ec);
    if (ec) throw Refusal{507, fmt::format("{} cannot be removed: {}", name, ec.message())};
}

std::uintmax_t Workspace::uploaded_bytes() const {
    std::uintmax_t sum = 0;
    std::error_code ec;
    for (const auto& entry : fs::recursive_directory_iterator(root_ / data_folder, ec))
        if (entry.is_regular_file(ec)) sum += entry.file_size(ec);
    return sum;
}

Upload::Upload(const fs::path& target, std::uintmax_t limit) : target_(target), temporary_(target), limit_(limit) {
    static std::atomic<unsigned> number{0};
    temporary_ = target.parent_path() / fmt::format(".upload-{}", ++number);
    stream_.open(temporary_, std::ios::binary | std::ios::trunc);
    if (!stream_) throw Refusal{507, "the workspace cannot be written", "check its permissions and the disk"};
}

Upload::~Upload() {
    std::error_code ec;
    if (!temporary_.empty()) fs::remove(temporary_, ec);
}

void Upload::write(const char* data, std::size_t size) {
    size_ += size;
    if (size_ > limit_)
        throw Refusal{413, fmt::format("larger than {} MB, the most that an upload may have", limit_ >> 20),
                      "start with --max-upload MB"};
    if (!stream_.write(data, static_cast<std::streamsize>(size))) throw Refusal{507, "the disk is full"};
}

void Upload::commit() {
    stream_.close();
    std::error_code ec;
    if (stream_) fs::rename(temporary_, target_, ec);
    if (!stream_ || ec) throw Refusal{507, "the upload cannot be written"};
    temporary_.clear();
}

}  // namespace schuler::serve
