// Bytes as they arrive to samples: messages are framed here and read by the readers of files.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/core/time.h"
#include "schuler/io/text/csv_recording.h"

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace schuler::live {

enum class Instrument { Imu, Gnss, Baro, Mag, Odometer, Heading };
inline constexpr std::size_t instrument_count = 6;
[[nodiscard]] std::string_view name_of(Instrument instrument);  ///< "imu", ...

using Sample =
    std::variant<ImuSample, GnssFix, BaroSample, MagSample, OdometerSample, HeadingSample>;  // in the order of Instrument

/// Ubx: NAV-PVT. Novatel: what files of that name hold. Csv: a header line first. Json: a line each, of any instrument. Gpsd: TPV reports.
enum class StreamFormat { Nmea, Ubx, Novatel, Csv, Json, Gpsd };

struct DecoderCounters {
    std::size_t messages = 0;             ///< understood
    std::size_t foreign = 0;              ///< well-formed, of no use here
    std::size_t garbage = 0;              ///< runs of bytes, lines or frames that are none, or damaged
    std::string example{};                ///< why the last of them is none
    std::vector<std::string> warnings{};  ///< what the reader of such files warns of: once each
};

class Decoder {
public:
    virtual ~Decoder() = default;
    /// Appends what is complete. Never throws on content.
    virtual void take(std::string_view bytes, std::vector<Sample>& out) = 0;
    /// Nothing has come for `quiet_time`: what is waiting is complete.
    virtual void quiet(std::vector<Sample>& out) { (void)out; }
    [[nodiscard]] virtual bool waiting() const { return false; }
    /// A connection restarts: what is half read is of the old one.
    virtual void reset() = 0;
    [[nodiscard]] const DecoderCounters& counters() const { return counters_; }

    static constexpr double quiet_time = 0.02;  ///< s

protected:
    void bad(std::string why) {
        ++counters_.garbage;
        counters_.example = std::move(why);
    }
    DecoderCounters counters_;
};

/// `options`: columns of Csv. `instrument`: what its rows are.
[[nodiscard]] std::unique_ptr<Decoder> make_decoder(StreamFormat format, Instrument instrument, const io::CsvOptions& options);

}  // namespace schuler::live
