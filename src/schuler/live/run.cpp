#include "schuler/live/run.h"

#include "schuler/core/error.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/container/mcap_write.h"
#include "schuler/io/solution/solution_csv.h"
#include "schuler/live/detail/descriptor.h"
#include "schuler/live/detail/output_files.h"
#include "schuler/live/detail/run_log.h"
#include "schuler/live/detail/service_manager.h"
#include "schuler/live/message.h"
#include "schuler/live/station.h"

#include <fmt/format.h>

#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

namespace schuler::live {
namespace {

double monotonic() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// GPS time by this computer's clock.
Time clock_time() {
    const std::int64_t unix_ns =
        std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
    const std::int64_t utc_ns = unix_ns - unix_time_of_gps_epoch * 1'000'000'000;
    return {utc_ns + gps_minus_utc(utc_ns / 1'000'000'000) * std::int64_t{1'000'000'000}};
}

/// SIGINT and SIGTERM as a descriptor, during its lifetime; a closed pipe is a write error, not a signal.
class Signals {
public:
    Signals() {
        sigset_t set;
        sigemptyset(&set);
        for (const int s : {SIGINT, SIGTERM, SIGPIPE}) sigaddset(&set, s);
        pthread_sigmask(SIG_BLOCK, &set, &before_);
        sigdelset(&set, SIGPIPE);
        fd_.reset(signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC));
    }
    ~Signals() {
        // a pending signal has been handled: it must not end the program afterwards
        timespec now{};
        sigset_t set;
        sigemptyset(&set);
        for (const int s : {SIGINT, SIGTERM, SIGPIPE}) sigaddset(&set, s);
        while (sigtimedwait(&set, nullptr, &now) > 0) {}
        pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    }
    Signals(const Signals&) = delete;
    Signals& operator=(const Signals&) = delete;
    [[nodiscard]] int fd() const { return fd_.get(); }
    [[nodiscard]] bool came() const {
        signalfd_siginfo info{};
        return ::read(fd_.get(), &info, sizeof info) == sizeof info;
    }

private:
    detail::Descriptor fd_;
    sigset_t before_{};
};

/// Latencies in steps of 10 us, in memory of fixed size.
class Latencies {
public:
    void add(double s) {
        ++counts_[std::min(counts_.size() - 1, static_cast<std::size_t>(std::max(s, 0.0) / step))];
        ++all_;
        largest_ = std::max(largest_, s);
    }
    [[nodiscard]] double quantile(double p) const {
        std::size_t below = 0;
        for (std::size_t k = 0; k < counts_.size(); ++k) {
            below += counts_[k];
            if (all_ > 0 && static_cast<double>(below) >= p * static_cast<double>(all_))
                return (static_cast<double>(k) + 1.0) * step;
        }
        return not_given;
    }
    [[nodiscard]] double largest() const { return all_ > 0 ? largest_ : not_given; }

private:
    static constexpr double step = 1e-5;  // s
    std::array<std::size_t, 5000> counts_{};
    std::size_t all_ = 0;
    double largest_ = 0.0;
};

class Run {
public:
    Run(const LiveSettings& settings, filter::Navigator navigator)
        : settings_(settings),
          navigator_(std::move(navigator)),
          prepare_(settings),
          begin_(monotonic()),
          log_(settings.log, settings.file, begin_) {
        const auto tell = [this](const std::string& text) { this->tell(text); };
        for (const std::string& warning : settings.ignored) tell("warning: " + warning);
        stations_ = stations_of(settings, tell);
        for (const OutputSettings& o : settings.outputs) {
            sinks_.push_back({Output(o.to, o.limits, tell), o, {}});
            if (o.format == MessageFormat::Csv) sinks_.back().output.greet(std::string(io::solution_csv_header()) + "\n");
            if (o.format == MessageFormat::Mcap) {
                sinks_.back().output.greet(io::mcap_begin() + io::mcap_json_channels());
                sinks_.back().output.end_files_with(io::mcap_end());
            }
        }
        next_save_ = begin_ + settings.save_every;
        next_health_ = begin_ + settings.health_every;
        next_satellites_ = begin_ + 1.0;
        for (Station& s : stations_) s.last_bytes = begin_;
    }

    LiveReport go(const std::function<bool()>& stop) {
        restore();
        for (bool on = true; on;) {
            const double now = monotonic();
            for (Station& s : stations_) s.input.tend(now);
            for (Sink& s : sinks_) s.output.tend(now);
            wait(signals_);
            on = !signals_.came() && !(stop && stop()) &&
                 std::ranges::any_of(stations_, [](const Station& s) { return !s.input.finished(); }) &&
                 std::ranges::any_of(sinks_, [](const Sink& s) { return !s.output.broken(); });
            regular(monotonic());
            if (std::ranges::all_of(stations_, [](const Station& s) { return s.input.stands(); })) manager_.ready();
            if (manager_.present()) manager_.turned(monotonic(), status());
        }
        manager_.stopping();
        for (Station& s : stations_) settle(s);
        satellites();
        health(monotonic());
        for (Sink& s : sinks_) s.output.close(monotonic());
        report_.saved = save();
        report_.seconds = monotonic() - begin_;
        report_.phase = navigator_.phase();
        report_.imu = navigator_.counters().of(filter::Source::Imu, filter::FeedStatus::Taken);
        report_.fixes = navigator_.counters().of(filter::Source::Gnss, filter::FeedStatus::Taken);
        for (const Station& s : stations_) {
            report_.garbage += s.decoder->counters().garbage;
            report_.reconnections += s.input.reconnections();
        }
        for (const Sink& s : sinks_) report_.dropped += s.output.dropped();
        report_.latency_median = latencies_.quantile(0.5);
        report_.latency_999 = latencies_.quantile(0.999);
        tell(fmt::format("stopped after {:.1f} s: {} IMU samples, {} fixes, {} unparseable records, {} messages dropped",
                         report_.seconds, report_.imu, report_.fixes, report_.garbage, report_.dropped));
        return report_;
    }

private:
    struct Sink {
        Output output;
        OutputSettings settings;
        std::optional<std::int64_t> last;  ///< period index of the last message
        std::uint32_t messages = 0;        ///< of Mcap
    };

    void tell(const std::string& text) { log_.tell(text, monotonic()); }

    /// For the service manager.
    [[nodiscard]] std::string status() const {
        return fmt::format("{}, {:.0f} samples of the IMU a second", name_of(navigator_.phase()), imu_rate_);
    }

    void wait(const Signals& signals) {
        std::vector<Interest> all;
        std::vector<pollfd> polled;
        all.push_back({signals.fd(), true, false});
        for (const Station& s : stations_) all.push_back(s.input.interest());
        const std::size_t first_sink = all.size();
        for (const Sink& s : sinks_) s.output.interests(all);
        for (const Interest& i : all)
            polled.push_back({i.fd, static_cast<short>((i.read ? POLLIN : 0) | (i.write ? POLLOUT : 0)), 0});
        const bool waiting = std::ranges::any_of(stations_, [](const Station& s) { return s.decoder->waiting(); });
        if (poll(polled.data(), polled.size(), waiting ? 5 : 100) < 0) return;
        for (std::size_t k = 0; k < stations_.size(); ++k)
            if (polled[k + 1].revents != 0) read(stations_[k]);
        for (std::size_t k = first_sink; k < polled.size(); ++k) {
            if (polled[k].revents == 0) continue;
            for (Sink& s : sinks_) s.output.ready(polled[k].fd, monotonic());
        }
        const double now = monotonic();
        for (Station& s : stations_)
            if (s.decoder->waiting() && now - s.last_bytes > Decoder::quiet_time) settle(s);
    }

    void read(Station& s) {
        bytes_.clear();
        const double now = monotonic();
        const std::size_t got = s.input.read(bytes_, now);
        if (s.input.reconnections() != s.connections) {
            s.connections = s.input.reconnections();
            s.decoder->reset();
        }
        if (got == 0) return;
        s.last_bytes = now;
        samples_.clear();
        s.decoder->take(bytes_, samples_);
        use(s, now);
        tell_of(s);
    }

    void tell_of(Station& s) {
        const DecoderCounters& c = s.decoder->counters();
        if (c.garbage > 0 && s.garbage_told == 0) {
            tell(fmt::format("{}: unparseable record: {}", s.input.endpoint().text, c.example));
            s.garbage_told = c.garbage;
        }
        for (; s.warnings_told < c.warnings.size(); ++s.warnings_told)
            tell(fmt::format("{}: {}", s.input.endpoint().text, c.warnings[s.warnings_told]));
    }

    void settle(Station& s) {
        samples_.clear();
        s.decoder->quiet(samples_);
        use(s, monotonic());
        tell_of(s);
    }

    void use(Station& s, double arrived) {
        const Time arrival = clock_time();
        for (Sample& sample : samples_) {
            prepare_(sample, s, arrival);
            const bool imu = sample.index() == static_cast<std::size_t>(Instrument::Imu);
            const filter::FeedStatus status = std::visit([this](const auto& x) { return navigator_.feed(x); }, sample);
            if (imu && status == filter::FeedStatus::Taken) {
                ++imu_since_;
                newest_ = std::get<ImuSample>(sample).time;
                publish();
                latencies_.add(monotonic() - arrived);
            }
            events();
        }
    }

    [[nodiscard]] static std::optional<std::int64_t> period_of(const Sink& s, Time time) {
        if (s.settings.rate <= 0.0) return std::nullopt;
        constexpr double rounding = 1e-6;  // of a period
        return static_cast<std::int64_t>(std::floor(time.seconds() * s.settings.rate + rounding));
    }
    [[nodiscard]] static bool is_due(const Sink& s, Time time) {
        const auto period = period_of(s, time);
        return !period || s.last != period;
    }

    void send(Sink& s, const SolutionRow& row) {
        s.last = period_of(s, row.time);
        const double now = monotonic();
        switch (s.settings.format) {
            case MessageFormat::Json: return s.output.send(state_json(row, s.settings.lagged), now);
            case MessageFormat::Csv: return s.output.send(io::solution_csv_row(row) + "\n", now);
            case MessageFormat::Nmea: return s.output.send(state_nmea(row), now);
            case MessageFormat::Mcap: return record(s, [&](std::string& out) { return io::append_mcap(out, row, s.messages); });
            case MessageFormat::Shared: return s.output.store(row);
        }
    }

    /// `append(text)` is false if the time cannot be represented.
    template <class Append>
    void record(Sink& s, Append append) {
        record_.clear();
        if (append(record_)) {
            ++s.messages;
            s.output.send(record_, monotonic());
        } else if (!undated_told_) {
            undated_told_ = true;
            tell("times before zero cannot be written to MCAP: those messages are left out");
        }
    }

    void publish() {
        while (const auto row = navigator_.poll_row())
            for (Sink& s : sinks_)
                if (s.settings.lagged && is_due(s, row->time)) send(s, *row);
        std::optional<SolutionRow> row;
        for (Sink& s : sinks_) {
            if (s.settings.lagged || !is_due(s, *newest_)) continue;
            if (!row) {
                const auto state = navigator_.state();
                if (!state) return;  // the period remains due
                row = row_of(*state);
            }
            send(s, *row);
        }
    }

    void events() {
        while (const auto event = navigator_.poll()) {
            // repeated rejections are reported once per second
            const bool often =
                event->kind == filter::NavigatorEvent::Kind::Refused || event->kind == filter::NavigatorEvent::Kind::Measurement;
            if (!often || monotonic() > next_told_) tell(event_text(*event));
            if (often && monotonic() > next_told_) next_told_ = monotonic() + 1.0;
            broadcast(io::McapTopic::Event, event_json(*event));
        }
    }

    /// `line`: of JSON. Times of Mcap are those of the newest sample: before the first one there is none.
    void broadcast(io::McapTopic topic, const std::string& line) {
        for (Sink& s : sinks_) {
            if (!s.settings.events) continue;
            if (s.settings.format == MessageFormat::Json) s.output.send(line, monotonic());
            if (s.settings.format == MessageFormat::Mcap && newest_)
                record(s, [&](std::string& out) {
                    return io::append_mcap(out, topic, *newest_,
                                           std::string_view(line).substr(0, line.find_last_not_of("\r\n") + 1), s.messages);
                });
        }
    }

    void health(double now) {
        Health h;
        h.time = newest_ ? newest_->seconds() : not_given;
        h.phase = navigator_.phase();
        h.imu_rate = imu_rate_ = static_cast<double>(imu_since_) / std::max(now - last_health_, 1e-3);
        h.fed = &navigator_.counters();
        for (Station& s : stations_) {
            const DecoderCounters& c = s.decoder->counters();
            h.garbage += c.garbage;
            h.foreign += c.foreign;
            h.reconnections += s.input.reconnections();
        }
        for (const Sink& s : sinks_) {
            h.dropped += s.output.dropped();
            h.readers += s.output.readers();
        }
        h.latency_median = latencies_.quantile(0.5);
        h.latency_largest = latencies_.largest();
        broadcast(io::McapTopic::Health, health_json(h));
        imu_since_ = 0;
        last_health_ = now;
    }

    void satellites() {
        for (Station& s : stations_)
            if (const auto all = s.decoder->satellites().renewed())
                broadcast(io::McapTopic::Satellites, satellites_json(newest_ ? newest_->seconds() : not_given, *all));
    }

    void regular(double now) {
        log_.tend(now);
        if (now >= next_health_) {
            health(now);
            next_health_ = now + settings_.health_every;
        }
        if (now >= next_satellites_) {
            satellites();
            next_satellites_ = now + 1.0;
        }
        if (now >= next_save_) {
            (void)save();
            next_save_ = now + settings_.save_every;
        }
    }

    bool save() {
        if (settings_.state.empty()) return false;
        const std::vector<std::byte> bytes = navigator_.save();
        try {
            io::write_file(settings_.state, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
        } catch (const Error& e) {
            tell(fmt::format("the state could not be saved: {}", e.what()));
            return false;
        }
        return true;
    }

    void restore() {
        if (settings_.state.empty()) return;
        std::ifstream file(settings_.state, std::ios::binary);
        if (!file) return;
        const std::string text{std::istreambuf_iterator<char>(file), {}};
        const filter::RestoreStatus status = navigator_.restore(std::as_bytes(std::span(text)));
        report_.restored = status == filter::RestoreStatus::Restored;
        constexpr std::array<const char*, 6> names{"restored",           "too short", "not a state",
                                                   "of another version", "damaged",   "of other settings"};
        tell(fmt::format("{}: {}", settings_.state, names[static_cast<std::size_t>(status)]));
    }

    const LiveSettings& settings_;
    const Signals signals_;  // first: a log that is a closed pipe must not end the program
    filter::Navigator navigator_;
    Preparation prepare_;
    std::vector<Station> stations_;
    std::vector<Sink> sinks_;
    std::string bytes_, record_;
    bool undated_told_ = false;
    std::vector<Sample> samples_;
    Latencies latencies_;
    LiveReport report_;
    std::optional<Time> newest_;
    std::size_t imu_since_ = 0;
    double begin_, imu_rate_ = 0.0, next_save_ = 0.0, next_health_ = 0.0, next_satellites_ = 0.0, last_health_ = begin_,
                   next_told_ = 0.0;
    detail::RunLog log_;
    detail::ServiceManager manager_ = detail::ServiceManager::of_environment();
};

}  // namespace

LiveReport run_live(const LiveSettings& settings, const std::function<bool()>& stop) {
    filter::NavigatorMade made = filter::Navigator::make(navigator_settings(settings));
    if (!made) throw input_error(made.reason, {settings.file, 0, 0, made.key}, "a live run needs a value that is given");
    detail::check_output_files(settings);
    return Run(settings, std::move(*made.navigator)).go(stop);
}

}  // namespace schuler::live
