#include "schuler/inspect/detail/parts.h"

#include "schuler/io/log_parts.h"
#include "schuler/io/own_files.h"
#include "schuler/io/streams.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

namespace schuler::inspect::detail {
namespace {

namespace fs = std::filesystem;

struct Named {
    fs::path file;
    std::string stream;
    explicit Named(const LoadedFile& f) {
        const io::StreamPath where = io::stream_path(f.path);
        file = where.file;
        stream = where.stream;
    }
};

/// Another file of the folder with the same name except for numbers.
bool is_named_like_a_part(const LoadedFile& a, const LoadedFile& b) {
    const Named x(a), y(b);
    return x.file != y.file && x.file.parent_path() == y.file.parent_path() &&
           io::name_of_parts(x.file) == io::name_of_parts(y.file) && (x.stream == y.stream || !a.table || !b.table);
}

io::FileSpan span_of(const LoadedFile& f) { return {f.report.start_s, f.report.stop_s}; }

bool follows(const LoadedFile& a, const LoadedFile& b) { return io::follows(span_of(a), span_of(b)); }

void append_rows(LoadedFile& file, const LoadedFile& part) {
    const std::int64_t end = file.time_ns.empty() ? INT64_MIN : *std::ranges::max_element(file.time_ns);
    for (std::size_t i = 0; i < part.time_ns.size(); ++i) {
        if (part.time_ns[i] <= end) continue;
        file.time_ns.push_back(part.time_ns[i]);
        for (auto& [name, values] : file.columns) values.push_back(part.has(name) ? part[name][i] : not_given);
        if (!file.fix.empty()) file.fix.push_back(part.fix.empty() ? FixType::Unknown : part.fix[i]);
    }
    file.fix_codes.insert(part.fix_codes.begin(), part.fix_codes.end());
    take_cadence(file);
}

std::string interval_of(const LoadedFile& f) { return fmt::format("{:.1f} to {:.1f} s", f.report.start_s, f.report.stop_s); }

void tell(Study& study, std::string text, const std::string& mend) {
    study.doubts.push_back(fmt::format("{}; {}", text, mend));
    study.problem(Level::Warning, std::move(text), mend);
}

/// A log that could continue the chosen one, or is named like a part of it, and is not joined.
void tell_left_out(Study& study, const LoadedFile& chosen, const LoadedFile& other, const std::string& section) {
    const bool same_columns = chosen.report.columns == other.report.columns && chosen.table == other.table;
    const std::string mend =
        fmt::format("if it is a part of the same log, [{}] parts = [{}]; otherwise give it with its fixes a folder", section,
                    toml_text(other.report.path));
    if (!other.table || other.table != chosen.table || !same_columns) {
        if (!is_named_like_a_part(chosen, other) || (other.table && !follows(chosen, other) && !follows(other, chosen))) return;
        if (other.table ? other.table != chosen.table : other.report.kind != "unknown") return;
        tell(study,
             fmt::format(
                 "{} is named like a part of {}, but {}: it is not used", other.report.path, chosen.report.path,
                 other.table ? "has other columns" : "was not recognised as one (its header line is missing or different)"),
             fmt::format("write the header line of {} into it", chosen.report.path));
        return;
    }
    const bool later = follows(chosen, other);
    if (!later && !follows(other, chosen)) return;
    tell(study,
         fmt::format("{} {} {} ({}, {}): it is not used", other.report.path, later ? "continues" : "precedes", chosen.report.path,
                     interval_of(other), interval_of(chosen)),
         mend);
}

}  // namespace

bool is_result(const LoadedFile& file) {
    const io::StreamPath where = io::stream_path(file.path);
    const std::string name = where.file.filename().string();
    return (name == "run.h5" || name == "solution.csv" || name == "point.csv" || name == "events.csv") &&
           io::may_overwrite(where.file);
}

void draft_parts(Study& study, const std::string& section, const LoadedFile& file) {
    if (!file.parts.empty()) study.draft.set(section, "parts", file.parts, "the same log continued");
}

void join_given(LoadedFile& file, std::vector<LoadedFile> parts) {
    std::ranges::stable_sort(parts, {}, [](const LoadedFile& f) { return f.report.start_s; });
    for (const LoadedFile& part : parts) {
        if (part.time_ns.empty() || file.time_ns.empty()) continue;
        if (part.report.start_s >= file.report.start_s) {
            append_rows(file, part);
            continue;
        }
        LoadedFile before = file;  // the earlier rows first
        file.time_ns = part.time_ns, file.columns = part.columns, file.fix = part.fix;
        append_rows(file, before);
    }
}

LoadedFile* with_parts(Study& study, LoadedFile* chosen, const std::string& section) {
    std::vector<LoadedFile*> candidates{chosen}, others, chain;
    for (LoadedFile& file : study.files) {
        const Named a(*chosen), b(file);
        if (&file == chosen || file.as.kind || file.computed || a.file == b.file ||
            a.file.parent_path() != b.file.parent_path() || is_result(file))
            continue;
        const bool alike = file.table == chosen->table && file.report.columns == chosen->report.columns &&
                           file.report.rows >= 2 && is_named_like_a_part(*chosen, file);
        (alike ? candidates : others).push_back(&file);
    }
    std::vector<io::FileSpan> spans;
    for (const LoadedFile* file : candidates) spans.push_back(span_of(*file));
    for (const std::size_t i : io::chain_of_parts(spans, 0)) chain.push_back(candidates[i]);
    std::ranges::copy_if(candidates, std::back_inserter(others),
                         [&](const LoadedFile* file) { return std::ranges::find(chain, file) == chain.end(); });
    LoadedFile* first = chain.front();
    for (const LoadedFile* other : others) tell_left_out(study, *chosen, *other, section);
    if (chain.size() == 1) return first;
    std::string names = first->report.path, breaks;
    bool pause = false;
    for (std::size_t i = 1; i < chain.size(); ++i) {
        LoadedFile& part = *chain[i];
        const double gap = part.report.start_s - first->report.stop_s;
        const double step = first->cadence.step;
        if (gap <= 0.0)
            breaks += fmt::format("; {:.4g} s of {} are in the part before too and are left out", step - gap, part.report.path);
        if (gap > 3.0 * step) {
            breaks += fmt::format("; {:.4g} s are missing before {}", gap, part.report.path);
            pause = true;
        }
        append_rows(*first, part);
        names += ", " + part.report.path;
        part.report.chosen = true;
        first->parts.push_back(part.report.path);
    }
    first->report.chosen = true;
    const std::string text = fmt::format("{} are parts of one log and are joined{}", names, breaks);
    study.problem(pause ? Level::Warning : Level::Info, text,
                  fmt::format("if they are logs of their own, give each a folder, or [{}] file = {} alone", section,
                              toml_text(first->report.path)));
    if (pause) study.doubts.push_back(text);
    return first;
}

}  // namespace schuler::inspect::detail
