// From table rows to samples in time order, with the treatment of bad rows common to all readers. Private to the readers.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/time.h"
#include "schuler/io/text/csv/csv_recording.h"
#include "schuler/io/text/repair_times.h"
#include "schuler/io/text/table.h"

#include <algorithm>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::io::detail {

/// The requested columns of one file: found by name, or known by position.
class SampleColumns {
public:
    static constexpr std::size_t absent = std::numeric_limits<std::size_t>::max();

    SampleColumns(const TextInput& input, TableKind kind, const CsvOptions& options);

    [[nodiscard]] bool has(std::string_view canonical) const { return plan_.find(canonical) != nullptr; }
    /// Requests a column; throws if a required one is missing. `si` converts the canonical unit to SI.
    std::size_t add(const std::string& canonical, bool required, double si = 1.0, FieldKind kind = FieldKind::Number);
    /// Error for a required column that is missing.
    [[nodiscard]] Error missing(const std::string& canonical) const;
    [[nodiscard]] TableReader reader() const { return {input_, layout_, requests_}; }
    [[nodiscard]] const TableLayout& layout() const { return layout_; }
    [[nodiscard]] const ColumnPlan& plan() const { return plan_; }
    /// "[imu] scale = { accel_m_s2 = ... }" and similar.
    [[nodiscard]] std::string section() const { return std::string(name_of(plan_.kind)); }

private:
    TextInput input_;
    TableLayout layout_;
    ColumnPlan plan_;
    std::vector<FieldRequest> requests_;
};

/// Counts the problems of rows, and decides when there are too many.
class RowAudit {
public:
    RowAudit(std::string file, std::string section, WarningLog& log)
        : file_(std::move(file)), section_(std::move(section)), log_(log) {}

    /// A bad row: those before the first good one may be many.
    void bad_row(const TableReader& reader);
    /// A row without a number in a field that not every row has to have.
    void bad_row(const TableReader& reader, std::size_t field);
    /// A row with an impossible value: counted as bad; many of them indicate a wrong unit, which is thrown.
    void absurd(const Error& error, const TableReader& reader);
    void read_row() { ++counts_.read; }
    /// Checks the time order of a used row.
    void time(std::int64_t ns, long line) {
        if (ns < latest_) {
            if (counts_.out_of_order++ == 0) {
                first_back_line_ = line;
                first_back_from_ = latest_;
                first_back_to_ = ns;
            }
        } else {
            latest_ = ns;
        }
        ++counts_.used;
    }
    /// After the last row: throws or warns.
    void finish(const TableReader& reader);
    [[nodiscard]] RowCounts& counts() { return counts_; }
    void stray(long line) {
        if (counts_.strays++ == 0) first_stray_line_ = line;
    }
    void rolled_over(const TimeRepair& repair);
    /// `line`: of the first row that is moved.
    void clock_away(const TimeRepair& repair, long line);
    void warn(std::string_view topic, const std::string& text, std::size_t count) const;

private:
    std::string file_, section_;
    WarningLog& log_;
    RowCounts counts_;
    std::int64_t latest_ = std::numeric_limits<std::int64_t>::min();
    std::int64_t first_back_from_ = 0, first_back_to_ = 0;
    long first_back_line_ = 0;
    long first_bad_line_ = 0;
    long first_stray_line_ = 0;
    std::size_t absurd_ = 0, leading_ = 0;
    std::vector<Error> first_absurd_;
    std::vector<Error> first_bad_;
};

/// Sorts if necessary and drops exact duplicates. `same` compares the values of two samples.
template <class Sample, class Same>
void put_in_time_order(std::vector<Sample>& samples, RowAudit& audit, Same same) {
    RowCounts& counts = audit.counts();
    if (counts.out_of_order > 0) {
        std::stable_sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.time < b.time; });
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (kept > 0 && samples[i].time == samples[kept - 1].time) {
            if (same(samples[i], samples[kept - 1])) {
                ++counts.duplicates;
                continue;
            }
            ++counts.same_time;
        }
        if (kept != i) samples[kept] = samples[i];
        ++kept;
    }
    samples.resize(kept);
    counts.used = kept;
    audit.warn("duplicates", "rows that repeat another row: dropped", counts.duplicates);
    if (counts.same_time > 0) {
        std::vector<std::int64_t> times;
        for (const Sample& s : samples) times.push_back(s.time.ns);
        if (spread_equal_times(times) > 0) {
            for (std::size_t i = 0; i < kept; ++i) samples[i].time.ns = times[i];
            audit.warn("coarse_time", "rows with the time of another row, which is written too coarsely: spread evenly",
                       counts.same_time);
            return;
        }
    }
    audit.warn("same_time", "rows with the time of another row but other values: kept", counts.same_time);
}

/// Omits single rows stamped far from the surrounding ones, and continues time counters that restart.
template <class Sample>
void repair_stamps(std::vector<Sample>& samples, std::vector<long>& lines, RowAudit& audit) {
    std::vector<std::int64_t> times;
    times.reserve(samples.size());
    for (const Sample& s : samples) times.push_back(s.time.ns);
    const TimeRepair repair = repair_times(times);
    if (!repair.any()) return;
    const long first_away = lines[repair.first_away];
    std::size_t kept = 0;
    auto stray = repair.strays.begin();
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (stray != repair.strays.end() && *stray == i) {
            audit.stray(lines[i]);
            ++stray;
            continue;
        }
        samples[kept] = samples[i];
        samples[kept].time.ns = times[i];
        lines[kept++] = lines[i];
    }
    samples.resize(kept);
    lines.resize(kept);
    audit.rolled_over(repair);
    audit.clock_away(repair, first_away);
}

/// Reads all rows. `make(reader, sample)` fills a sample from a row and returns false to omit it (and counts that itself).
template <class Sample, class Make>
[[nodiscard]] std::vector<Sample> read_samples(TableReader& reader, RowAudit& audit, std::size_t expected, Duration offset,
                                               Make make) {
    std::vector<Sample> samples;
    std::vector<long> lines;
    samples.reserve(std::min<std::size_t>(expected, 50'000'000));
    lines.reserve(samples.capacity());
    while (reader.next()) {
        audit.read_row();
        if (!reader.row_ok()) {
            audit.bad_row(reader);
            continue;
        }
        Sample sample;
        sample.time.ns = reader.time_ns(0);
        try {
            if (!make(reader, sample)) continue;
        } catch (const Error& error) {
            audit.absurd(error, reader);
            continue;
        }
        samples.push_back(sample);
        lines.push_back(reader.line());
    }
    repair_stamps(samples, lines, audit);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        samples[i].time = samples[i].time + offset;
        audit.time(samples[i].time.ns, lines[i]);
    }
    audit.finish(reader);
    return samples;
}

/// Equal, with NaN equal to NaN.
inline bool same_value(double a, double b) { return a == b || (a != a && b != b); }
template <class A, class B>
[[nodiscard]] bool same_vector(const A& a, const B& b) {
    for (Eigen::Index i = 0; i < a.size(); ++i) {
        if (!same_value(a(i), b(i))) return false;
    }
    return true;
}

}  // namespace schuler::io::detail
