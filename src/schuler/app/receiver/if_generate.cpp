#include "schuler/app/receiver/if_recording.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/text/number.h"
#include "schuler/io/text/split.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outcome.h"
#include "schuler/report/result_table.h"
#include "schuler/study/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::app {
namespace {

constexpr double transit = 67.0;  // code periods of the shortest signal path
const std::vector<std::string> six_satellites{"G03:47:-2210:118.25",    "G07:45:1200:300.5", "G11:43:-640.5:871.75",
                                              "G18:40:3105.25:512.125", "G22:48:310:42",     "G30:38:-4020:990.5"};

struct Wanted {
    int prn = 0;
    double cn0_db = 45.0, doppler = 0.0, code_delay = 0.0;  ///< dB-Hz, Hz, chips
};

Wanted wanted_from(const std::string& text) {
    const auto refuse = [&](const std::string& why, const std::string& hint) {
        throw input_error(fmt::format("\"{}\": {}", text, why), {.key = "--satellites"}, hint);
    };
    const std::vector<std::string> parts = io::split(text, ':');
    if (parts.size() > 4) refuse("more than four numbers", "give G07:C/N0:DOPPLER:DELAY");
    Wanted w{gps_number(parts[0])};
    const auto number_in = [&](std::size_t i, double& value, const char* what, double low, double high) {
        if (i >= parts.size() || parts[i].empty()) return;
        value = io::number_from(parts[i]);
        if (!(value >= low && value <= high))
            refuse(fmt::format("\"{}\" is not a {}", parts[i], what), fmt::format("give {:g} to {:g}", low, high));
    };
    number_in(1, w.cn0_db, "C/N0 in dB-Hz", 10.0, 60.0);
    number_in(2, w.doppler, "Doppler in Hz", -50e3, 50e3);
    number_in(3, w.code_delay, "code delay in chips", 0.0, 1023.0);
    return w;
}

std::vector<Wanted> all_wanted(const std::vector<std::string>& texts) {
    std::vector<Wanted> out;
    for (const std::string& text : texts.empty() ? six_satellites : texts) {
        out.push_back(wanted_from(text));
        for (std::size_t i = 0; i + 1 < out.size(); ++i)
            if (out[i].prn == out.back().prn)
                throw input_error(fmt::format("G{:02} is given twice", out.back().prn), {.key = "--satellites"}, "give it once");
    }
    return out;
}

/// Symbols of different satellites start in different milliseconds.
receiver::IfSatellite made_of(const Wanted& w, std::uint64_t seed) {
    const receiver::SignalStructure signal = receiver::gps_l1_ca();
    const double periods = transit + static_cast<double>(7 * w.prn % 20);
    return {w.prn,
            {(periods * signal.code_length + w.code_delay) * signal.chip_length(), -w.doppler * signal.wavelength(), 0.0, 0.0},
            receiver::cn0_from_db(w.cn0_db),
            seed + static_cast<std::uint64_t>(w.prn)};
}

report::Outcome generated(const GenerateRequest& request) {
    const std::vector<Wanted> wanted = all_wanted(request.satellites);
    const receiver::IfFormat format{request.sample_rate, request.intermediate_frequency};
    std::vector<receiver::IfSatellite> satellites;
    for (const Wanted& w : wanted) {
        receiver::IfFormat{request.sample_rate, request.intermediate_frequency + w.doppler}.check();
        satellites.push_back(made_of(w, 1000 * request.seed));
    }
    receiver::IfGenerator generator(format, satellites, request.seed);
    std::vector<receiver::IfSample> samples(format.samples_per_period());
    const auto periods = static_cast<long>(std::lround(request.seconds * 1e3));
    io::AtomicFile file(request.file);
    for (long i = 0; i < periods; ++i) {
        generator.generate(samples);
        file.write({reinterpret_cast<const char*>(samples.data()), samples.size() * sizeof(receiver::IfSample)});
        if (request.progress) request.progress(static_cast<double>(i + 1) / static_cast<double>(periods));
    }
    file.commit();

    const double seconds = static_cast<double>(periods) * 1e-3;
    report::Json json{{"command", "receiver generate"},
                      {"file", request.file.string()},
                      {"format", "ibyte"},
                      {"sample_rate_hz", format.sample_rate},
                      {"intermediate_frequency_hz", format.intermediate_frequency},
                      {"duration_s", seconds},
                      {"seed", request.seed}};
    report::Outcome out;
    report::ResultTable table{
        fmt::format("{:g} s at {:g} samples/s, intermediate frequency {:g} Hz, signed bytes I and Q (ibyte)", seconds,
                    format.sample_rate, format.intermediate_frequency),
        {{"satellite", "satellite"},
         {"cn0_db_hz", "C/N0", "dB-Hz", "g"},
         {"doppler_hz", "Doppler", "Hz", "g"},
         {"code_delay_chips", "code delay", "chips", "g"}}};
    for (const Wanted& w : wanted) table.rows.push_back({fmt::format("G{:02}", w.prn), w.cn0_db, w.doppler, w.code_delay});
    out.tables = report::table_text(table);
    json["satellites"] = report::table_json(table);
    out.json = report::text_of(json);
    out.files.push_back(request.file);
    return out;
}

}  // namespace

int gps_number(std::string_view name) {
    std::string_view digits = name;
    if (!digits.empty() && (digits.front() == 'G' || digits.front() == 'g')) digits.remove_prefix(1);
    int prn = 0;
    for (const char c : digits) prn = c >= '0' && c <= '9' && digits.size() <= 2 ? 10 * prn + (c - '0') : 99;
    if (prn < 1 || prn > 32)
        throw input_error(fmt::format("unknown satellite \"{}\"", name), {.key = "--satellites"}, "give G01 to G32");
    return prn;
}

report::Outcome generate_recording(const GenerateRequest& request) {
    return study::with_option_names([&] { return generated(request); });
}

}  // namespace schuler::app
