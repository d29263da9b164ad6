#include "schuler/study/montecarlo/checkpoint.h"

#include "schuler/io/atomic_file.h"
#include "schuler/io/own_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace schuler::study {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view magic = "schuler campaign 2\n";

/// 0 for "checkpoint-0.bin"; negative for other names.
int rank_in(const std::string& name, std::string_view kind) {
    if (!name.starts_with(kind) || !name.ends_with(".bin") || name.size() < kind.size() + 5) return -1;
    int rank = -1;
    const char* end = name.data() + name.size() - 4;
    const auto result = std::from_chars(name.data() + kind.size(), end, rank);
    return result.ptr == end && result.ec == std::errc{} ? rank : -1;
}

/// Rows, and checkpoints whose writing was interrupted.
bool is_left_over(const std::string& name) {
    return rank_in(name, "rows-") >= 0 || name == "rows.bin" || (name.starts_with(".checkpoint-") && name.ends_with(".part"));
}

Error rows_unwritable(const fs::path& file) {
    return input_error("cannot be written", {.file = file.string()}, "make room on the disk");
}

std::string file_bytes(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

void put_runs(Packer& to, const RunSet& runs) {
    to.put(static_cast<std::uint64_t>(runs.spans().size()));
    for (const auto& [first, end] : runs.spans()) {
        to.put(first);
        to.put(end);
    }
}

RunSet get_runs(Unpacker& from) {
    RunSet out;
    for (std::size_t n = from.count(16); n > 0; --n) {
        const auto first = from.get<std::uint64_t>();
        out.add(first, from.get<std::uint64_t>());
    }
    return out;
}

}  // namespace

CampaignPart::CampaignPart(fs::path folder, int rank, std::string identity, std::size_t row, const CampaignStatistics& empty)
    : folder_(std::move(folder)), rank_(rank), identity_(std::move(identity)), row_(row), empty_(empty), statistics_(empty) {}

fs::path CampaignPart::file(const char* kind, int rank) const { return folder_ / fmt::format("{}-{}.bin", kind, rank); }

std::vector<fs::path> CampaignPart::left_in(const fs::path& folder) {
    std::vector<std::pair<int, fs::path>> found;
    std::error_code ec;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ec))
        if (const int rank = rank_in(entry.path().filename().string(), "checkpoint-"); rank >= 0)
            found.emplace_back(rank, entry.path());
    std::ranges::sort(found);
    std::vector<fs::path> out;
    for (auto& [rank, path] : found) out.push_back(std::move(path));
    return out;
}

void CampaignPart::remove_from(const fs::path& folder) {
    std::vector<fs::path> files = left_in(folder);
    std::error_code ec;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ec))
        if (is_left_over(entry.path().filename().string())) files.push_back(entry.path());
    for (const fs::path& f : files) fs::remove(f, ec);
}

void CampaignPart::append_rows(const fs::path& from, std::uint64_t bytes) {
    std::ifstream in(from, std::ios::binary);
    std::string block(std::size_t{1} << 16U, '\0');
    for (std::uint64_t left = bytes; left > 0;) {
        const auto n = static_cast<std::streamsize>(std::min<std::uint64_t>(left, block.size()));
        if (!in.read(block.data(), n))
            throw input_error("is damaged: it ends too early", {.file = from.string()},
                              "start the campaign again in another folder");
        if (!rows_.write(block.data(), n)) throw rows_unwritable(file("rows", rank_));
        left -= static_cast<std::uint64_t>(n);
    }
    row_bytes_ += bytes;
}

void CampaignPart::take_over() {
    // The part of process 0 comes first: it contains those of the others if they were adopted before, and these are then omitted.
    const std::vector<fs::path> files = left_in(folder_);
    const fs::path own = file("rows", rank_);
    for (const fs::path& path : files) {
        const std::string bytes = file_bytes(path);
        try {
            if (!bytes.starts_with(magic)) throw input_error("is not a checkpoint of this version of the program");
            Unpacker from(std::string_view(bytes).substr(magic.size()));
            if (from.text() != identity_)
                throw input_error(
                    "belongs to a campaign with another scenario, other settings or another version of the program");
            io::allow_overwrite(path);  // it is our file, even if the interruption came before it was recorded
            const auto rows = from.get<std::uint64_t>();
            const RunSet theirs = get_runs(from);
            CampaignStatistics statistics = empty_;
            statistics.unpack(from);
            if (done_.overlaps(theirs)) continue;
            const int rank = rank_in(path.filename().string(), "checkpoint-");
            if (rank == rank_) {
                std::error_code ec;
                if (fs::file_size(own, ec) < rows || ec)
                    throw input_error(fmt::format("the rows of its runs, {}, are not all there", own.filename().string()));
                fs::resize_file(own, rows);
                row_bytes_ = rows;
            } else {
                if (!rows_.is_open()) rows_.open(own, std::ios::binary | std::ios::app);
                append_rows(file("rows", rank), rows);
            }
            statistics_.merge(statistics);
            for (const auto& [first, end] : theirs.spans()) done_.add(first, end);
        } catch (const Error& e) {
            if (!e.place().file.empty()) throw;
            throw input_error(e.reason(), {.file = path.string()}, "start the campaign again in another folder, or delete it");
        }
    }
    if (files.empty()) return;
    save();
    std::error_code ec;
    for (const fs::path& path : files) {
        const int rank = rank_in(path.filename().string(), "checkpoint-");
        if (rank == rank_) continue;
        fs::remove(path, ec);
        fs::remove(file("rows", rank), ec);
    }
}

void CampaignPart::begin() {
    if (!rows_.is_open()) rows_.open(file("rows", rank_), std::ios::binary | (row_bytes_ > 0 ? std::ios::app : std::ios::trunc));
    save();
}

void CampaignPart::add(const MonteCarloRun& run, const RunNumbers& row) {
    statistics_.add(run);
    done_.add(run.run);
    rows_.write(reinterpret_cast<const char*>(row.data()), static_cast<std::streamsize>(row_ * sizeof(double)));
    row_bytes_ += row_ * sizeof(double);
}

void CampaignPart::flush_rows() {
    if (rows_.is_open() && !rows_.flush()) throw rows_unwritable(file("rows", rank_));
}

void CampaignPart::save() {
    flush_rows();
    Packer to;
    to.put(std::string_view(identity_));
    to.put(row_bytes_);
    put_runs(to, done_);
    statistics_.pack(to);
    io::write_file(file("checkpoint", rank_), std::string(magic) + to.take());
}

std::string CampaignPart::packed() const {
    Packer to;
    put_runs(to, done_);
    statistics_.pack(to);
    return to.take();
}

void CampaignPart::merge(std::string_view bytes) {
    Unpacker from(bytes);
    const RunSet theirs = get_runs(from);
    CampaignStatistics statistics = empty_;
    statistics.unpack(from);
    statistics_.merge(statistics);
    for (const auto& [first, end] : theirs.spans()) done_.add(first, end);
}

void CampaignPart::each_row(std::uint64_t first, std::uint64_t end, const std::function<void(const RunNumbers&)>& show) {
    flush_rows();
    const std::size_t bytes = row_ * sizeof(double);
    const fs::path ordered = folder_ / "rows.bin";
    std::fstream place(ordered, std::ios::binary | std::ios::in | std::ios::out | std::ios::trunc);
    RunNumbers row(row_);
    for (const fs::path& part : left_in(folder_)) {
        std::ifstream in(file("rows", rank_in(part.filename().string(), "checkpoint-")), std::ios::binary);
        while (in.read(reinterpret_cast<char*>(row.data()), static_cast<std::streamsize>(bytes))) {
            const auto run = static_cast<std::uint64_t>(row.front());
            if (run < first || run >= end) continue;
            place.seekp(static_cast<std::streamoff>((run - first) * bytes));
            place.write(reinterpret_cast<const char*>(row.data()), static_cast<std::streamsize>(bytes));
        }
    }
    if (!place.flush()) throw rows_unwritable(ordered);
    place.seekg(0);
    for (std::uint64_t run = first; run < end; ++run) {
        if (!place.read(reinterpret_cast<char*>(row.data()), static_cast<std::streamsize>(bytes)))
            throw computation_error(fmt::format("{}: the row of run {} is missing", ordered.string(), run));
        show(row);
    }
}

}  // namespace schuler::study
