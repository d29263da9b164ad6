#include "schuler/app/receiver/if_recording.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/receiver/if_file.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outcome.h"
#include "schuler/report/outputs.h"
#include "schuler/study/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

namespace schuler::app {
namespace {

using receiver::ChannelSample;
using receiver::SatelliteRecord;

constexpr double pulling_in = 3.0;  // s from the search to phase lock
constexpr double shown = 4000.0;    // epochs of a satellite in the report

/// tracking.csv, created with the first row, so that a recording without satellites leaves no file.
class TrackingFile {
public:
    explicit TrackingFile(std::filesystem::path folder) : folder_(std::move(folder)) {}

    void add(const ChannelSample& s) {
        open();
        text_ += fmt::format("{:.6f},G{:02},{},{:.2f},{:.3f},{:.5f},{:.4f},{:.4f},{:.3f},{:.3f}\n", s.time, s.prn,
                             name_of(s.state, s.locked), receiver::db_from_cn0(s.cn0), s.doppler, s.code_delay, s.carrier_phase,
                             s.phase_lock, s.prompt.real(), s.prompt.imag());
        if (text_.size() > 1U << 20U) flush();
    }
    void close(report::Outcome& out) {
        open();
        flush();
        file_->commit();
        out.files.push_back(file_->path());
    }

private:
    void open() {
        if (file_) return;
        report::make_folder(folder_);
        file_ = std::make_unique<io::AtomicFile>(folder_ / "tracking.csv");
        text_ =
            "time_s,satellite,state,cn0_db_hz,doppler_hz,code_delay_chips,carrier_phase_cycles,phase_lock,prompt_i,prompt_q\n";
    }
    void flush() {
        file_->write(text_);
        text_.clear();
    }

    std::filesystem::path folder_;
    std::unique_ptr<io::AtomicFile> file_;
    std::string text_;
};

report::Json json_of(const SatelliteRecord& r, int search_periods) {
    report::Json row{{"satellite", fmt::format("G{:02}", r.prn)},
                     {"found", r.found},
                     {"statistic", report::json_number(r.acquired.statistic)},
                     {"threshold", report::json_number(r.acquired.threshold)}};
    if (!r.found) return row;
    row["found_at_s"] = report::json_number(r.found_at);
    row["search"] = {{"doppler_hz", r.acquired.replica.carrier_frequency},
                     {"code_delay_chips", -r.acquired.replica.code_phase},
                     {"cn0_db_hz", report::json_number(receiver::db_from_cn0(r.acquired.cn0(search_periods)))}};
    row["state"] = !r.tracked ? "lost" : r.locked ? "locked" : "not locked";
    row["losses"] = r.losses;
    row["phase_lock_s"] = report::json_number(r.locked_at);
    row["time_s"] = report::json_number(r.last.time);
    row["doppler_hz"] = report::json_number(r.last.doppler);
    row["code_delay_chips"] = report::json_number(r.last.code_delay);
    row["cn0_db_hz"] = report::json_number(receiver::db_from_cn0(r.last.cn0));
    row["symbols"] = {
        {"count", r.symbols}, {"changes", r.changes}, {"sign_changes", r.dump_changes}, {"at_edges", r.edge_changes}};
    return row;
}

std::vector<int> numbers_of(const std::vector<std::string>& names) {
    std::vector<int> out;
    for (const std::string& name : names) out.push_back(gps_number(name));
    return out;
}

report::Outcome tracked(const TrackRequest& request) {
    const auto begun = std::chrono::steady_clock::now();
    const receiver::IfFormat format{request.sample_rate, request.intermediate_frequency};
    receiver::SampleReceiverSettings settings;
    settings.satellites = numbers_of(request.satellites);
    settings.doppler = request.doppler;
    settings.search_periods = request.search_ms;
    receiver::SampleReceiver channels(format, settings);

    const double zero = std::floor(request.start * 1e3 + 1e-6) * 1e-3;
    io::IfFile file(request.file, request.format, static_cast<std::uintmax_t>(std::llround(zero * format.sample_rate)));
    std::uintmax_t wanted = file.size();
    if (request.seconds && *request.seconds * format.sample_rate < static_cast<double>(wanted))
        wanted = static_cast<std::uintmax_t>(std::llround(*request.seconds * format.sample_rate));
    const double seconds = static_cast<double>(wanted) / format.sample_rate;
    if (wanted < channels.piece())
        throw input_error(
            fmt::format("{:.4g} ms of samples are too few to search, {} ms are needed", 1e3 * seconds, request.search_ms),
            {.key = wanted < file.size() ? "--seconds" : "--search-ms"}, "give a longer recording, or a shorter --search-ms");

    report::Outcome out;
    if (seconds < pulling_in)
        out.warnings.push_back(fmt::format(
            "{:.4g} s of samples: pulling in takes about {:g} s, so no phase lock is to be expected", seconds, pulling_in));
    TrackedRecording run;
    run.seconds = seconds;
    run.search_periods = request.search_ms;
    run.title =
        fmt::format("{}: {:.6g} s from {:.6g} s on, {:.9g} samples/s, intermediate frequency {:.9g} Hz, {}",
                    request.file.string(), seconds, zero, format.sample_rate, format.intermediate_frequency, request.format);
    const std::filesystem::path folder =
        request.output.empty() ? std::filesystem::path("out") / request.file.stem() : request.output;
    TrackingFile table(folder);
    const double every = seconds / shown;
    std::array<double, 33> next_shown{};
    const auto sink = [&](ChannelSample s) {
        s.time += zero;
        table.add(s);
        double& next = next_shown[static_cast<std::size_t>(s.prn)];
        if (s.time < next) return;
        next = s.time + 0.999 * every;
        run.decimated.push_back(s);
    };
    std::vector<receiver::IfSample> samples(channels.piece());
    for (std::uintmax_t done = 0; done < wanted;) {
        const auto count = static_cast<std::size_t>(std::min<std::uintmax_t>(samples.size(), wanted - done));
        const std::span piece(samples.data(), count);
        if (!file.read(piece)) throw computation_error(fmt::format("{} cannot be read to its end", request.file.string()));
        channels.process(piece, sink);
        done += count;
        if (request.progress) request.progress(static_cast<double>(done) / static_cast<double>(wanted));
    }
    run.satellites = channels.satellites();
    const auto found = std::ranges::count_if(run.satellites, [](const SatelliteRecord& r) { return r.found; });
    if (found == 0)
        throw computation_error(
            fmt::format("{}: none of {} satellites was found within {:g} Hz of {:g} Hz", request.file.string(),
                        run.satellites.size(), request.doppler, request.intermediate_frequency),
            "look at --sample-rate, --intermediate-frequency and --format, or search wider (--doppler) and longer (--search-ms)");

    table.close(out);
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    report::Json json{{"command", "receiver track"},
                      {"file", request.file.string()},
                      {"format", request.format},
                      {"sample_rate_hz", format.sample_rate},
                      {"intermediate_frequency_hz", format.intermediate_frequency},
                      {"start_s", zero},
                      {"duration_s", seconds},
                      {"search", {{"doppler_hz", request.doppler}, {"duration_ms", request.search_ms}}},
                      {"found", found},
                      {"satellites", report::Json::array()},
                      {"timing", {{"wall_s", wall}, {"times_real_time", report::json_number(seconds / wall)}}}};
    for (SatelliteRecord& r : run.satellites) {
        for (double* time : {&r.found_at, &r.locked_at, &r.last.time}) *time += zero;
        json["satellites"].push_back(json_of(r, request.search_ms));
    }
    out.folder = folder;
    out.json = report::text_of(json);
    report::write_text(out.files.emplace_back(folder / "summary.json"), out.json);
    write_tracking_report(out, run, request.version);
    out.tables = run.title + "\n" + tracking_table(run);
    return out;
}

}  // namespace

report::Outcome track_recording(const TrackRequest& request) {
    try {
        return study::with_option_names([&] { return tracked(request); });
    } catch (const Error& e) {
        if (e.kind() != ErrorKind::Input || !e.place().file.empty()) throw;
        SourcePlace place = e.place();
        place.file = request.file.string();
        throw Error(e.kind(), e.reason(), place, e.hint());
    }
}

}  // namespace schuler::app
