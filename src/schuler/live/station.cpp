#include "schuler/live/station.h"

#include "schuler/core/error.h"
#include "schuler/dataset/read_files.h"
#include "schuler/settings/magnetometer_axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace schuler::live {
namespace {

StreamFormat format_of(const SourceSettings& s, const Endpoint& endpoint) {
    if (endpoint.medium == Medium::Gpsd) return StreamFormat::Gpsd;
    return s.format == "json"        ? StreamFormat::Json
           : s.format == "nmea"      ? StreamFormat::Nmea
           : s.format == "ubx"       ? StreamFormat::Ubx
           : s.format == "novatel"   ? StreamFormat::Novatel
           : s.format == "vectornav" ? StreamFormat::Vectornav
                                     : StreamFormat::Csv;
}

const dataset::FileSource& file_of(const settings::Config& c, Instrument i) {
    static const dataset::FileSource none;
    switch (i) {
        case Instrument::Imu: return c.imu;
        case Instrument::Gnss: return c.gnss;
        case Instrument::Baro: return c.baro;
        case Instrument::Mag: return c.mag;
        case Instrument::Odometer: return c.odometer;
        case Instrument::Heading: return c.heading;
        default: return none;  // with the only names of columns that there are
    }
}

}  // namespace

std::vector<Station> stations_of(const LiveSettings& l, const std::function<void(const std::string&)>& tell) {
    std::vector<Station> out;
    for (std::size_t i = 0; i < instrument_count; ++i) {
        const SourceSettings& s = l.sources[i];
        if (s.from.empty()) continue;
        const auto instrument = static_cast<Instrument>(i);
        const std::string key = std::string(name_of(instrument)) + ".source";
        const Endpoint endpoint = endpoint_from(s.from, Direction::In, key);
        const StreamFormat format = format_of(s, endpoint);
        auto it = std::ranges::find_if(out, [&](const Station& o) { return o.input.endpoint().text == s.from; });
        if (it != out.end()) {
            if (format == StreamFormat::Csv)
                throw input_error("is the source of another instrument too, and rows of a table are of one", {l.file, 0, 0, key},
                                  "use format = \"json\", which names the instrument in each line");
        } else {
            const dataset::FileSource& file = file_of(l.config, instrument);
            io::CsvOptions options;
            options.columns = file.columns;
            options.scale = file.scale;
            options.fix_codes = l.config.fix_codes;
            out.push_back({Input(endpoint, tell), make_decoder(format, instrument, options)});
            it = out.end() - 1;
        }
        it->of[i] = true;
        it->arrival[i] = s.arrival;
    }
    return out;
}

Preparation::Preparation(const LiveSettings& l) {
    const settings::Config& c = l.config;
    for (std::size_t i = 0; i < instrument_count; ++i)
        offset_[i] = Duration::from_seconds(file_of(c, static_cast<Instrument>(i)).time_offset);
    C_imu_mag_ = settings::C_imu_mag(c).value_or(Eigen::Matrix3d::Identity());
    sea_level_pressure_ = c.sea_level_pressure;
    undulation_ = c.filter.gnss.height == filter::HeightKind::Msl && c.undulation ? *c.undulation : 0.0;
}

void Preparation::operator()(Sample& sample, const Station& station, Time arrival) const {
    const std::size_t i = sample.index();
    std::visit([&](auto& s) { s.time = (station.arrival[i] ? arrival : s.time) + offset_[i]; }, sample);
    if (auto* fix = std::get_if<GnssFix>(&sample)) {
        fix->position.h += undulation_;
    } else if (auto* mag = std::get_if<MagSample>(&sample)) {
        mag->field_b = C_imu_mag_ * mag->field_b;
    } else if (auto* baro = std::get_if<BaroSample>(&sample)) {
        std::vector<BaroSample> one{*baro};
        dataset::settle_pressures(one, sea_level_pressure_);
        *baro = one.front();
    }
}

}  // namespace schuler::live
