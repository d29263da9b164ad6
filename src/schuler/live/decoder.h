// Conversion of incoming bytes to samples: messages are framed here and decoded by the file readers.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/core/time.h"
#include "schuler/io/text/csv/csv_recording.h"
#include "schuler/live/satellites.h"

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace schuler::live {

enum class Instrument { Imu, Gnss, Baro, Mag, Odometer, Heading, Gauges, Log };
inline constexpr std::size_t instrument_count = 8;
[[nodiscard]] std::string_view name_of(Instrument instrument);  ///< "imu", ...

using Sample = std::variant<ImuSample, GnssFix, BaroSample, MagSample, OdometerSample, HeadingSample, GaugeSample,
                            BodyVelocitySample>;  // in the order of Instrument

/// Ubx: NAV-PVT, NAV-SAT. Novatel: content of such files. Vectornav: binary messages. Csv: header line first. Json: one line per sample, any instrument. Gpsd: TPV, SKY.
enum class StreamFormat { Nmea, Ubx, Novatel, Vectornav, Csv, Json, Gpsd };

struct DecoderCounters {
    std::size_t messages = 0;             ///< decoded
    std::size_t foreign = 0;              ///< well-formed, but not used here
    std::size_t garbage = 0;              ///< runs of bytes, lines or frames that are invalid or damaged
    std::string example{};                ///< why the last of them is invalid
    std::vector<std::string> warnings{};  ///< warnings of the file reader, once each
};

class Decoder {
public:
    virtual ~Decoder() = default;
    /// Appends complete samples. Never throws because of the content.
    virtual void take(std::string_view bytes, std::vector<Sample>& out) = 0;
    /// No data have arrived for `quiet_time`: the pending data are complete.
    virtual void quiet(std::vector<Sample>& out) { (void)out; }
    [[nodiscard]] virtual bool waiting() const { return false; }
    /// A connection restarts: partially read data are discarded.
    virtual void reset() = 0;
    [[nodiscard]] const DecoderCounters& counters() const { return counters_; }
    /// Satellites of Nmea, Ubx and Gpsd.
    [[nodiscard]] SatelliteReport& satellites() { return satellites_; }

    static constexpr double quiet_time = 0.02;  ///< s

protected:
    void bad(std::string why) {
        ++counters_.garbage;
        counters_.example = std::move(why);
    }
    DecoderCounters counters_;
    SatelliteReport satellites_;
};

/// `options`: columns of Csv. `instrument`: the instrument of its rows.
[[nodiscard]] std::unique_ptr<Decoder> make_decoder(StreamFormat format, Instrument instrument, const io::CsvOptions& options);

}  // namespace schuler::live
