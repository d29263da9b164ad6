// The numbers of a run for drawing: columns of run.h5, limited to a time range and decimated without loss of extremes.
#pragma once

#include <nlohmann/json.hpp>

#include <cstddef>
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace schuler::serve {

using Json = nlohmann::ordered_json;

/// Columns with a common time axis, column by column; a NaN is a gap.
struct ColumnTable {
    std::vector<std::vector<double>> columns;
    std::vector<std::string> names, units;
    [[nodiscard]] std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
};

/// Request of a page. Columns are "PATH:NAME" of channels_of, all from one group.
struct SeriesRequest {
    std::vector<std::string> columns;
    double from = 0.0, to = 0.0;  ///< s on the run's axis; equal: all
    std::size_t points =
        2000;  ///< approximate number of rows returned; 0: every row, or `most_rows` of more than `most_whole_rows`
};

inline constexpr std::size_t most_rows = 20'000, most_whole_rows = 500'000;

/// {group, time_s: [], columns: {"PATH:NAME": []}, units: {}, rows, thinned}: `rows` in the range; "thinned": decimated to fewer.
[[nodiscard]] std::string series_text(const ColumnTable& time, const std::vector<const std::vector<double>*>& values,
                                      const SeriesRequest& request, const std::vector<std::string>& units);

/// Reads run.h5 files with a cache of the most recent ones. One thread at a time reads: the HDF5 library is not reentrant.
class Results {
public:
    /// [{group, rows, start_s, stop_s, columns: [{id, name, unit}]}]. In addition to the tables of the file, every group with
    /// positions has PATH/local: north, east, up in metres from the run's first position. Result tables in CSV are also groups:
    /// /gravity (gravity.csv), /ensemble (epochs.csv of a Monte Carlo campaign).
    [[nodiscard]] Json channels(const std::filesystem::path& folder);

    /// Whether a run has files of which `channels` tells.
    [[nodiscard]] static bool has_tables(const std::filesystem::path& folder);

    /// Reads every table once without keeping it: whether the libraries survive the files. @throws Refusal 404 if one cannot be read
    void read_all(const std::filesystem::path& folder);

    /// A JSON document as above. `origin`: the run whose first position is the origin of "local". @throws Refusal 404, 422
    [[nodiscard]] std::string series(const std::filesystem::path& folder, const SeriesRequest& request,
                                     const std::filesystem::path& origin);

    /// This run minus another one at the times of this one (with interpolation of the other): the same document with the columns
    /// "difference:NAME". Position north, east, down in m, velocity in m/s, attitude in degrees.
    [[nodiscard]] std::string difference(const std::filesystem::path& folder, const std::filesystem::path& other,
                                         const SeriesRequest& request);

private:
    using Table = std::shared_ptr<const ColumnTable>;
    struct Kept {
        std::string key;
        Table table;
    };
    [[nodiscard]] Table table(const std::filesystem::path& folder, const std::string& path);
    [[nodiscard]] Table local(const std::filesystem::path& folder, const std::string& group, const std::filesystem::path& origin);
    [[nodiscard]] Table subtracted(const std::filesystem::path& folder, const std::filesystem::path& other);
    [[nodiscard]] Table kept(const std::string& key);
    Table keep(const std::string& key, ColumnTable table);

    std::mutex mutex_;
    std::list<Kept> kept_;  ///< most recently used first
};

}  // namespace schuler::serve
