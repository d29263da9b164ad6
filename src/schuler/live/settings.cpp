#include "schuler/live/settings.h"

#include "schuler/settings/config/applicability.h"
#include "schuler/settings/config/sections.h"
#include "schuler/settings/option_builders.h"
#include "schuler/settings/toml_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

namespace schuler::live {
namespace {

using settings::Option;
using settings::OptionTable;
using settings::Value;

constexpr std::array source_formats{"csv", "json", "nmea", "ubx", "novatel", "vectornav"};

constexpr std::array<std::string_view, 4> message_formats{"json", "csv", "nmea", "mcap"};  // in the order of MessageFormat

double number_between(const settings::NamedValue& v, double low, double high) {
    if (!v.second.is_number() || !(v.second.number() >= low && v.second.number() <= high))
        throw input_error("is not a number in its range", {{}, v.second.line, 0, "output." + v.first},
                          fmt::format("give a number from {} to {}", low, high));
    return v.second.number();
}

std::string text_of(const settings::NamedValue& v) {
    if (v.second.text() == nullptr)
        throw input_error("is not a text", {{}, v.second.line, 0, "output." + v.first}, "write it in quotes");
    return *v.second.text();
}

bool flag_of(const settings::NamedValue& v) {
    if (v.second.flag() == nullptr)
        throw input_error("is neither true nor false", {{}, v.second.line, 0, "output." + v.first}, "write true or false");
    return *v.second.flag();
}

OutputSettings output_of(const settings::ValueTable& table) {
    OutputSettings out;
    bool any = false, has_rate = false;
    std::optional<SourcePlace> format_place;
    for (const settings::NamedValue& v : table) {
        const SourcePlace place{{}, v.second.line, 0, "output." + v.first};
        if (v.first == "to") {
            out.to = endpoint_from(text_of(v), Direction::Out, "output.to");
            any = true;
        } else if (v.first == "format") {
            const std::string format = text_of(v);
            const auto it = std::ranges::find(message_formats, format);
            if (it == message_formats.end()) throw input_error("is not a known format", place, "write json, csv, nmea or mcap");
            out.format = static_cast<MessageFormat>(it - message_formats.begin());
            format_place = place;
        } else if (v.first == "rate_hz") {
            out.rate = number_between(v, 0.0, 1e4);
            has_rate = true;
        } else if (v.first == "at") {
            const std::string at = text_of(v);
            if (at != "now" && at != "lag")
                throw input_error("is neither \"now\" nor \"lag\"", place,
                                  "now: the newest sample; lag: the filter, the lag ago");
            out.lagged = at == "lag";
        } else if (v.first == "events") {
            out.events = flag_of(v);
        } else if (v.first == "queue_kb") {
            out.limits.queue = static_cast<std::size_t>(number_between(v, 1.0, 1e6) * 1024.0);
        } else if (v.first == "rotate_mb") {
            out.limits.rotate = static_cast<std::size_t>(number_between(v, 0.0, 1e6) * 1e6);
        } else if (v.first == "keep") {
            out.limits.keep = static_cast<int>(number_between(v, 0.0, 1000.0));
        } else {
            throw input_error("unknown key", place,
                              "an output has to, format, rate_hz, at, events, queue_kb, rotate_mb and keep");
        }
    }
    if (!any)
        throw input_error("an output has no place", {{}, table.empty() ? 0 : table.front().second.line, 0, "output.to"},
                          "write to = \"stdout\"");
    if (out.format == MessageFormat::Mcap && (out.to.medium == Medium::Udp || out.to.medium == Medium::Serial))
        throw input_error("an MCAP file has a beginning, which is lost here", *format_place,
                          "send it to a file, tcp or stdout, or choose json");
    if (out.to.medium == Medium::Shared) {
        if (format_place)
            throw input_error("shared memory has its own layout", *format_place, "leave the format out (docs/live.md)");
        out.format = MessageFormat::Shared;
        if (!has_rate) out.rate = 0.0;
    }
    return out;
}

OptionTable<LiveSettings> make_table() {
    using L = LiveSettings;
    OptionTable<L> t;
    for (std::size_t i = 0; i < instrument_count; ++i) {
        const std::string section(name_of(static_cast<Instrument>(i)));
        t.add(settings::text<L>(section + ".source",
                                "source of the samples: tcp://HOST:PORT, tcp-listen://:PORT, udp://:PORT, "
                                "serial:/dev/NAME?baud=115200, file:PATH, gpsd://HOST or stdin; instruments may share one",
                                [i](auto& l) -> auto& { return l.sources[i].from; }));
        Option<L> format = settings::text<L>(section + ".format", "format of the samples",
                                             [i](auto& l) -> auto& { return l.sources[i].format; });
        format.spec.choices.assign(source_formats.begin(), source_formats.end());
        t.add(std::move(format));
        t.add(settings::flag<L>(section + ".arrival_time", "use the time of arrival as the time of a sample",
                                [i](auto& l) -> auto& { return l.sources[i].arrival; }));
        if (i > 0)
            t.add(settings::number<L>(section + ".rate_hz", 1.0, 0, 1e4, "largest sample rate",
                                      [i](auto& l) -> auto& { return l.sources[i].rate; }));
    }
    t.add(settings::number<L>("imu.rate_hz", 1.0, 5, 1e4, "nominal sample rate", [](auto& l) -> auto& { return l.imu_rate; }))
        .add(settings::integer<L>("gauges.count", 1, 3, "number of heights in a sample of the gauges",
                                  [](auto& l) -> auto& { return l.gauges; }))
        .add(settings::number<L>("live.lag_s", 1.0, 0, 10, "largest delay of a sample after the IMU",
                                 [](auto& l) -> auto& { return l.lag; }))
        .add(settings::number<L>("live.still_delay_s", 1.0, 0, 5, "additional delay for the detection of standstill",
                                 [](auto& l) -> auto& { return l.still_delay; }))
        .add(settings::number<L>("live.longest_hole_s", 1.0, 0, 60, "longest gap of the IMU that is bridged",
                                 [](auto& l) -> auto& { return l.longest_hole; }))
        .add(settings::text<L>("live.state", "file that keeps the state of the filter between runs",
                               [](auto& l) -> auto& { return l.state; }))
        .add(settings::number<L>("live.save_every_s", 1.0, 1, 1e6, "interval at which the state is saved, besides at the end",
                                 [](auto& l) -> auto& { return l.save_every; }))
        .add(settings::text<L>("live.log", "log of connections, events and problems: stderr, none or a file",
                               [](auto& l) -> auto& { return l.log; }))
        .add(settings::number<L>("live.health_every_s", 1.0, 0.1, 1e6, "interval of health messages",
                                 [](auto& l) -> auto& { return l.health_every; }));
    Option<L> outputs{settings::detail::spec("output", settings::Shape::Tables,
                                             "[[output]] with to, format, rate_hz, at, events, queue_kb, rotate_mb, keep"),
                      [](L& l, const Value& v) {
                          l.outputs.clear();
                          for (const Value& one : *v.list()) l.outputs.push_back(output_of(*one.table()));
                      },
                      [](const L&) { return std::optional<Value>(); }};
    t.add(std::move(outputs));
    return t;
}

/// Sections of dataset.toml for an instrument, and the sections not used by a live run.
std::vector<std::string> without_effect(const LiveSettings& l, const settings::SettingList& given) {
    const auto sent = [&l](Instrument i) { return !l.sources[static_cast<std::size_t>(i)].from.empty(); };
    const struct {
        std::string_view prefix;
        bool effect;
        std::string_view reason;
    } rules[] = {{"gnss.", sent(Instrument::Gnss), "there is no source of fixes"},
                 {"baro.", sent(Instrument::Baro), "there is no source of the barometer"},
                 {"mag.", sent(Instrument::Mag), "there is no source of the magnetometer"},
                 {"odometer.", sent(Instrument::Odometer), "there is no source of the odometer"},
                 {"heading.", sent(Instrument::Heading), "there is no source of a heading"},
                 {"compass.", sent(Instrument::Heading), "there is no source of a heading"},
                 {"gauges.", sent(Instrument::Gauges), "there is no source of gauges"},
                 {"log.", sent(Instrument::Log), "there is no source of a velocity log"},
                 {"ranges.", false, "a live run takes no ranges"},
                 {"stations.", false, "a live run takes no ranges"},
                 {"base.", false, "a live run takes no ranges"},
                 {"filter.protection.", false, "a live run takes no ranges"},
                 {"filter.self_check", false, "it belongs to `schuler process`"},
                 {"reference.", false, "a live run is compared with nothing"},
                 {"gravity.", false, "it belongs to `schuler gravity`"}};
    std::vector<std::string> out;
    for (const settings::Setting& s : given) {
        const auto* rule = std::ranges::find_if(rules, [&](const auto& r) { return s.key.starts_with(r.prefix); });
        const std::string_view reason =
            rule != std::end(rules) ? (rule->effect ? std::string_view() : rule->reason) : settings::idle_reason(s.key, l.config);
        if (!reason.empty()) out.push_back(fmt::format("{} is given and has no effect: {}", s.key, reason));
    }
    return out;
}

}  // namespace

const settings::OptionTable<LiveSettings>& live_table() {
    static const OptionTable<LiveSettings> table = make_table();
    return table;
}

LiveSettings read_live(const std::filesystem::path& file, const settings::SettingList& above) {
    std::vector<settings::OptionSpec> known = live_table().specs();
    const std::vector<settings::OptionSpec>& of_filter = settings::config_table().specs();
    known.insert(known.end(), of_filter.begin(), of_filter.end());
    settings::SettingList own, others;
    for (settings::Setting& s : settings::flatten(settings::read_toml(file), file.string(), known))
        (live_table().find(s.key) != nullptr ? own : others).push_back(std::move(s));
    LiveSettings out;
    out.file = file.string();
    live_table().apply(own, out);
    const settings::SettingList all = settings::overlaid(std::move(others), above);
    out.config = settings::config_from(all);
    // a batch fits the noise if only a grade is given; here only the grade is available
    const bool asked = std::ranges::any_of(all, [](const settings::Setting& s) { return s.key == "imu.estimate_noise"; });
    if (!asked) out.config.filter.imu.estimate_noise = false;
    for (std::size_t i = 0; i < instrument_count; ++i) {
        const std::string section(name_of(static_cast<Instrument>(i)));
        if (out.sources[i].from.empty()) continue;
        settings::with_places(own, [&] { (void)endpoint_from(out.sources[i].from, Direction::In, section + ".source"); });
    }
    if (out.sources[0].from.empty())
        throw input_error("there is no source of the IMU", {file.string(), 0, 0, "imu.source"},
                          "write [imu] source = \"tcp://HOST:PORT\"");
    if (out.config.scheme == settings::Scheme::Gnss)
        throw input_error("the receiver alone needs no filter", {file.string(), 0, 0, "filter.scheme"},
                          "choose loose or separate");
    out.ignored = without_effect(out, all);
    if (out.outputs.empty())
        throw input_error("there is no output", {file.string(), 0, 0, "output"}, "write [[output]] with to = \"stdout\"");
    return out;
}

filter::NavigatorSettings navigator_settings(const LiveSettings& l) {
    filter::NavigatorSettings n;
    n.filter = l.config.filter;
    n.filter.outages.clear();
    n.filter.gnss.estimate_std = false;  // estimated from whole logs
    double lagged = 0.0;
    bool all = false;
    for (const OutputSettings& o : l.outputs) {
        if (!o.lagged) continue;
        lagged = std::max(lagged, o.rate);
        all = all || o.rate == 0.0;
    }
    n.filter.output_rate = all ? 0.0 : lagged > 0.0 ? lagged : 1.0;
    n.imu_interval = 1.0 / l.imu_rate;
    n.lag = l.lag;
    n.still_delay = l.still_delay;
    n.longest_hole = l.longest_hole;
    const auto rate = [&l](Instrument i, double usual) {
        const SourceSettings& s = l.sources[static_cast<std::size_t>(i)];
        return s.from.empty() ? 0.0 : s.rate > 0.0 ? s.rate : usual;
    };
    n.rates.gnss = rate(Instrument::Gnss, 20.0);
    n.rates.baro = rate(Instrument::Baro, 100.0);
    n.rates.mag = rate(Instrument::Mag, 200.0);
    n.rates.odometer = rate(Instrument::Odometer, 200.0);
    n.rates.heading = rate(Instrument::Heading, 20.0);
    n.rates.gauges = rate(Instrument::Gauges, 20.0);
    n.rates.gauge_count = n.rates.gauges > 0.0 ? l.gauges : 0;
    n.rates.log = rate(Instrument::Log, 20.0);
    return n;
}

}  // namespace schuler::live
