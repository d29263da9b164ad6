#include "navigator.h"

#include "values.h"

#include "schuler/io/text/fix_codes.h"
#include "schuler/settings/config/config.h"

#include <algorithm>
#include <array>

namespace schuler::python {
namespace {

using filter::FeedStatus;

/// Settings of a stream: functions of a batch run that require the whole log are off unless requested, and then rejected.
settings::Config config_of_stream(const py::dict& given) {
    const auto usual = [](const char* key, settings::Value value) {
        return settings::Setting{key, std::move(value), {"settings", 0, 0, key}};
    };
    settings::SettingList list{usual("imu.estimate_noise", {false}), usual("gnss.estimate_std", {false}),
                               usual("gnss.latency_s", {0.0})};
    for (settings::Setting& s : settings_from(given)) list.push_back(std::move(s));
    return settings::config_from(list);
}

void set_rates(filter::FeedRates& rates, const py::dict& given) {
    // clang-format off
    const std::array<std::pair<const char*, double filter::FeedRates::*>, 8> known{{
        {"gnss", &filter::FeedRates::gnss}, {"baro", &filter::FeedRates::baro}, {"mag", &filter::FeedRates::mag},
        {"odometer", &filter::FeedRates::odometer}, {"heading", &filter::FeedRates::heading}, {"gauges", &filter::FeedRates::gauges},
        {"body_velocity", &filter::FeedRates::log}, {"ranges", &filter::FeedRates::ranges}}};
    // clang-format on
    std::vector<std::string> names{"gauge_count", "range_sources"};
    for (const auto& k : known) names.emplace_back(k.first);
    for (const auto& [name, value] : given) {
        const std::string key = py::str(name).cast<std::string>();
        const settings::Value v = value_from(value, "rates." + key);
        if (!v.is_number()) throw input_error("is not a number", {{}, 0, 0, "rates." + key}, "give samples a second");
        const auto it = std::ranges::find_if(known, [&](const auto& k) { return key == k.first; });
        if (it != known.end()) {
            rates.*(it->second) = v.number();
        } else if (key == "gauge_count") {
            rates.gauge_count = static_cast<int>(std::clamp(v.number(), -1.0, 100.0));
        } else if (key == "range_sources") {
            rates.range_sources = static_cast<std::size_t>(std::clamp(v.number(), 0.0, 1e6));
        } else {
            const std::string near = settings::nearest_key(key, names);
            throw input_error(
                "is not an instrument", {{}, 0, 0, "rates." + key},
                near.empty() ? fmt::format("known are {}", fmt::join(names, ", ")) : fmt::format("did you mean {}?", near));
        }
    }
}

filter::Navigator made(const py::dict& settings, double imu_interval, const py::dict& rates, double lag, double still_delay,
                       double longest_hole) {
    filter::NavigatorSettings n;
    n.filter = config_of_stream(settings).filter;
    n.imu_interval = imu_interval;
    set_rates(n.rates, rates);
    n.lag = lag;
    n.still_delay = still_delay;
    n.longest_hole = longest_hole;
    filter::NavigatorMade result = filter::Navigator::make(n);
    if (!result) throw input_error(result.reason, {{}, 0, 0, result.key});
    return std::move(*result.navigator);
}

}  // namespace

StreamNavigator::StreamNavigator(const py::dict& settings, double imu_interval, const py::dict& rates, double lag,
                                 double still_delay, double longest_hole)
    : navigator_(made(settings, imu_interval, rates, lag, still_delay, longest_hole)) {}

py::object statuses(std::vector<std::uint8_t> list, bool one) {
    if (one) return py::cast(static_cast<FeedStatus>(list.front()));
    return array_of(std::move(list));
}

void StreamNavigator::collect() {
    while (const auto row = navigator_.poll_row()) rows_.push_back(*row);
    while (const auto event = navigator_.poll()) events_.push_back(*event);
}

template <class Make>
py::object StreamNavigator::feed_all(py::ssize_t n, bool one, Make make) {
    if (one) {
        const FeedStatus status = navigator_.feed(make(0));
        collect();
        return py::cast(status);
    }
    std::vector<std::uint8_t> out(static_cast<std::size_t>(n));
    {
        const py::gil_scoped_release release;
        for (py::ssize_t i = 0; i < n; ++i) {
            out[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(navigator_.feed(make(i)));
            collect();
        }
    }
    return statuses(std::move(out), false);
}

py::object StreamNavigator::feed_imu(const py::object& time, const py::object& gyro, const py::object& accel) {
    const Times t("time", time);
    Input w("gyro", gyro, 3), f("accel", accel, 3);
    for (Input* in : {&w, &f}) in->expect_rows(t.rows());
    return feed_all(t.rows(), t.one(), [&](py::ssize_t i) { return ImuSample{t.at(i), w.vector(i), f.vector(i)}; });
}

py::object StreamNavigator::feed_gnss(const py::object& time, const py::object& position, const py::object& velocity,
                                      const py::object& std_position, const py::object& std_velocity, const std::string& fix,
                                      int satellites) {
    const Times t("time", time);
    Input p("position", position, 3), v("velocity", velocity, 3), sp("std_position", std_position, 3),
        sv("std_velocity", std_velocity, 3);
    for (Input* in : {&p, &v}) in->expect_rows(t.rows());
    for (Input* in : {&sp, &sv}) in->expect_rows(t.rows(), true);
    const std::optional<FixType> type = fix == "unknown" ? FixType::Unknown : io::fix_from_word(fix);
    if (!type)
        throw input_error(fmt::format("\"{}\" is not a known kind of fix", fix), {{}, 0, 0, "fix"},
                          "none, autonomous, differential, rtk_fixed, rtk_float or unknown");
    return feed_all(t.rows(), t.one(), [&](py::ssize_t i) {
        GnssFix f;
        f.time = t.at(i);
        f.position = {p.at(i, 0), p.at(i, 1), p.at(i, 2)};
        f.velocity_n = v.vector(i);
        f.std_position = sp.vector(i);
        f.std_velocity = sv.vector(i);
        f.fix = *type;
        f.satellites = satellites;
        return f;
    });
}

py::object StreamNavigator::feed_baro(const py::object& time, const py::object& height, const py::object& pressure) {
    const Times t("time", time);
    Input h("height", height, 1), p("pressure", pressure, 1);
    for (Input* in : {&h, &p}) in->expect_rows(t.rows());
    return feed_all(t.rows(), t.one(), [&](py::ssize_t i) { return BaroSample{t.at(i), h.at(i), p.at(i)}; });
}

py::object StreamNavigator::feed_mag(const py::object& time, const py::object& field) {
    const Times t("time", time);
    Input b("field", field, 3);
    b.expect_rows(t.rows());
    return feed_all(t.rows(), t.one(), [&](py::ssize_t i) { return MagSample{t.at(i), b.vector(i)}; });
}

py::object StreamNavigator::feed_odometer(const py::object& time, const py::object& speed, const py::object& std) {
    const Times t("time", time);
    Input v("speed", speed, 1), s("std", std, 1);
    v.expect_rows(t.rows());
    s.expect_rows(t.rows(), true);
    return feed_all(t.rows(), t.one(), [&](py::ssize_t i) { return OdometerSample{t.at(i), v.at(i), s.at(i)}; });
}

py::object StreamNavigator::feed_heading(const py::object& time, const py::object& heading, const py::object& std) {
    const Times t("time", time);
    Input v("heading", heading, 1), s("std", std, 1);
    v.expect_rows(t.rows());
    s.expect_rows(t.rows(), true);
    return feed_all(t.rows(), t.one(), [&](py::ssize_t i) { return HeadingSample{t.at(i), v.at(i), s.at(i)}; });
}

py::object StreamNavigator::feed_gauges(const py::object& time, const py::object& height) {
    const Times t("time", time);
    Input h("height", height, 3);
    h.expect_rows(t.rows());
    return feed_all(t.rows(), t.one(), [&](py::ssize_t i) { return GaugeSample{t.at(i), h.vector(i)}; });
}

py::object StreamNavigator::feed_body_velocity(const py::object& time, const py::object& velocity) {
    const Times t("time", time);
    Input v("velocity", velocity, 3);
    v.expect_rows(t.rows());
    return feed_all(t.rows(), t.one(), [&](py::ssize_t i) { return BodyVelocitySample{t.at(i), v.vector(i)}; });
}

py::object StreamNavigator::feed_ranges(const py::object& time, const std::vector<std::string>& names,
                                        const std::vector<bool>& station, const py::dict& columns) {
    const Times t("time", time);
    if (!t.one()) throw input_error("is an array", {{}, 0, 0, "time"}, "give one epoch of ranges at a time");
    const auto n = static_cast<py::ssize_t>(names.size());
    if (station.size() != names.size()) throw input_error("has another length than the names", {{}, 0, 0, "station"});
    const auto column = [&](const char* name, py::ssize_t width) {
        Input in(name, columns.contains(name) ? py::object(columns[name]) : py::object(py::none()), width);
        in.expect_rows(n, true);
        return in;
    };
    const Input pseudorange = column("pseudorange", 1), rate = column("range_rate", 1), std = column("std", 1),
                std_rate = column("std_rate", 1), cn0 = column("cn0", 1), tx = column("tx", 3),
                tx_velocity = column("tx_velocity", 3), tx_clock = column("tx_clock", 1),
                tx_clock_rate = column("tx_clock_rate", 1), frequency = column("frequency", 1), variance = column("variance", 1);
    const auto or_zero = [](const Input& in, py::ssize_t i) { return in.given() ? in.at(i) : 0.0; };
    std::vector<RangeSample> samples;
    for (py::ssize_t i = 0; i < n; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const std::optional<std::uint16_t> source = navigator_.range_source(names[k], station[k]);
        if (!source)
            throw input_error(fmt::format("{} is one more than the stated number of sources", names[k]),
                              {{}, 0, 0, "rates.range_sources"});
        RangeSample& s = samples.emplace_back();
        s.source = *source;
        s.pseudorange = pseudorange.at(i);
        s.range_rate = rate.at(i);
        s.std = std.at(i);
        s.std_rate = std_rate.at(i);
        s.cn0 = cn0.at(i);
        s.tx.r = tx.vector(i);
        s.tx_velocity = tx_velocity.vector(i);
        s.tx_clock = or_zero(tx_clock, i);
        s.tx_clock_rate = or_zero(tx_clock_rate, i);
        s.frequency = or_zero(frequency, i);
        s.variance = or_zero(variance, i);
    }
    const FeedStatus status = navigator_.feed(t.at(0), samples);
    collect();
    return py::cast(status);
}

py::dict StreamNavigator::feed(const SharedRecording& shared) {
    const Recording& r = *shared.recording;
    std::array<std::size_t, 9> next{};
    std::vector<std::uint16_t> source;  // index in the navigator, by index in the log
    for (const RangeSource& s : r.ranges.sources) source.push_back(navigator_.range_source(s.name, s.station).value_or(0xffff));
    const filter::FeedCounters before = navigator_.counters();
    {
        const py::gil_scoped_release release;
        const auto until = [&](std::size_t channel, const auto& rows, Time time) {
            for (std::size_t& k = next[channel]; k < rows.size() && rows[k].time <= time; ++k) (void)navigator_.feed(rows[k]);
        };
        std::vector<RangeSample> samples;
        for (const ImuSample& imu : r.imu) {
            until(0, r.gnss, imu.time);
            until(1, r.baro, imu.time);
            until(2, r.mag, imu.time);
            until(3, r.odometer, imu.time);
            until(4, r.heading, imu.time);
            until(5, r.gauges, imu.time);
            until(6, r.body_velocity, imu.time);
            for (std::size_t& k = next[7]; k < r.ranges.epochs.size() && r.ranges.epochs[k].time <= imu.time; ++k) {
                const auto of = r.ranges.of(r.ranges.epochs[k]);
                samples.assign(of.begin(), of.end());
                std::erase_if(samples, [&](const RangeSample& s) { return source[s.source] == 0xffff; });
                for (RangeSample& s : samples) s.source = source[s.source];
                (void)navigator_.feed(r.ranges.epochs[k].time, samples);
            }
            (void)navigator_.feed(imu);
            collect();
        }
    }
    py::dict taken;
    const filter::FeedCounters after = navigator_.counters();
    for (std::size_t s = 0; s < filter::source_count; ++s) {
        const auto of = [&](const filter::FeedCounters& c) { return c.of(static_cast<filter::Source>(s), FeedStatus::Taken); };
        taken[py::cast(static_cast<filter::Source>(s))] = of(after) - of(before);
    }
    return taken;
}

std::vector<SolutionRow> StreamNavigator::take_rows() { return std::exchange(rows_, {}); }
std::vector<filter::NavigatorEvent> StreamNavigator::take_events() { return std::exchange(events_, {}); }

py::dict StreamNavigator::counters() const {
    const filter::FeedCounters& c = navigator_.counters();
    py::dict out;
    for (std::size_t s = 0; s < filter::source_count; ++s) {
        py::dict of_source;
        for (std::size_t k = 0; k < filter::feed_status_count; ++k)
            of_source[py::cast(static_cast<FeedStatus>(k)).attr("name").attr("lower")()] = c.by_status[s][k];
        of_source["reordered"] = c.reordered[s];
        out[py::cast(static_cast<filter::Source>(s)).attr("name").attr("lower")()] = of_source;
    }
    out["holes"] = c.holes;
    out["restarts"] = c.restarts;
    return out;
}

void StreamNavigator::forget() {
    rows_.clear();
    events_.clear();
}

}  // namespace schuler::python
