#include "schuler/io/receiver/novatel_raw.h"

#include "schuler/core/error.h"
#include "schuler/io/bytes.h"
#include "schuler/io/detail/broadcast_scales.h"
#include "schuler/io/detail/ephemeris_checks.h"
#include "schuler/io/receiver/detail/navigation_frames.h"
#include "schuler/io/receiver/detail/novatel_frames.h"
#include "schuler/io/receiver/detail/novatel_ranges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace schuler::io {
namespace {

using detail::NovatelFields;
using detail::NovatelMessage;
using detail::NovatelRange;
using detail::satellite_of;
using gnss::SatelliteId;
using gnss::Signal;
using gnss::System;

enum Log : int {
    gps_ephemeris = 7,
    ionosphere_utc = 8,
    raw_ephemeris = 41,
    range = 43,
    compressed_range = 140,
    glonass_ephemeris = 723,
    galileo_ephemeris = 1122,
    beidou_ephemeris = 1696
};

bool is_raw(int id) {
    return id == gps_ephemeris || id == raw_ephemeris || id == range || id == compressed_range || id == glonass_ephemeris ||
           id == galileo_ephemeris || id == beidou_ephemeris;
}

class RawReader {
public:
    RawReader() : frames_(result.navigation) {}

    NovatelRaw result;
    std::size_t unknown_signals = 0, repeated = 0, compressed = 0;

    void take(const NovatelMessage& m) {
        if (m.secondary || m.ns == 0) return;
        const Time now{m.ns};
        if (detail::is_compressed(m)) ++compressed;
        switch (m.id) {
            case range:
            case compressed_range: ranges(m, now); break;
            case gps_ephemeris: gps(m, now); break;
            case raw_ephemeris: subframes(m, now); break;
            case glonass_ephemeris: glonass(m); break;
            case galileo_ephemeris: galileo(m, now); break;
            case beidou_ephemeris: beidou(m, now); break;
            case ionosphere_utc: ionosphere(m); break;
            default: break;
        }
    }

    /// To be called after the last log.
    void finish() {
        name_lowest_channels();
        omit_epochs_in_full();
        order_epochs();
        find_losses();
    }

private:
    struct Lock {
        float seconds = 0.0F;
        bool half_added = false, parity_known = false, behind_a_gap = false;
    };
    struct Measured {
        gnss::SignalObservation of;
        Lock lock;
    };

    void ranges(const NovatelMessage& m, Time now) {
        NovatelFields f(m);
        const bool is_compressed = m.id == compressed_range;
        const auto count = f.next<std::uint32_t>();
        constexpr std::uint32_t most = 1000;
        if (count == 0 || count > most) return;
        gnss::ObservationLog& log = result.observations;
        gnss::ObservationEpoch epoch;
        epoch.time = now;
        epoch.first = log.observations.size();
        for (std::uint32_t i = 0; i < count && !f.is_short(); ++i) {
            const NovatelRange r = is_compressed ? detail::compressed_range_of(f) : detail::range_of(f);
            if (!f.is_short()) measurement(r, is_compressed);
        }
        std::ranges::stable_sort(measured_, {}, [](const Measured& x) { return x.of.satellite; });
        for (const Measured& x : measured_) {
            log.observations.push_back(x.of);
            locks_.push_back(x.lock);
        }
        measured_.clear();
        epoch.count = log.observations.size() - epoch.first;
        if (epoch.count == 0) return;
        log.epochs.push_back(epoch);
        if (is_compressed) compressed_epochs_.insert(log.epochs.size() - 1);
        else in_full_.insert(now);
    }

    /// Epochs of RANGECMP that RANGE gives at full resolution.
    void omit_epochs_in_full() {
        if (compressed_epochs_.empty() || in_full_.empty()) return;
        std::vector<bool> kept(result.observations.epochs.size(), true);
        for (const std::size_t i : compressed_epochs_) kept[i] = !in_full_.contains(result.observations.epochs[i].time);
        keep(kept);
    }

    /// Old firmware leaves the frequency number of RANGECMP zero: that is channel -7 only if others are given.
    void name_lowest_channels() {
        if (!channels_given_) return;
        for (const std::uint8_t slot : zero_channels_)
            if (std::int8_t& channel = result.observations.channels.of_slot[slot]; channel == gnss::unknown_channel) channel = -7;
    }

    /// Omits the smallest number of epochs that makes the times increase: a single late stamp, not all epochs after it.
    void order_epochs() {
        gnss::ObservationLog& log = result.observations;
        constexpr std::size_t none = SIZE_MAX;
        std::vector<std::size_t> ends,
            before(log.epochs.size(), none);  // ends[k]: the earliest-ending increasing sequence of k + 1 epochs
        for (std::size_t i = 0; i < log.epochs.size(); ++i) {
            const auto at =
                std::ranges::lower_bound(ends, log.epochs[i].time, {}, [&](std::size_t e) { return log.epochs[e].time; });
            if (at != ends.begin()) before[i] = *(at - 1);
            if (at == ends.end()) ends.push_back(i);
            else if (log.epochs[i].time < log.epochs[*at].time) *at = i;
        }
        if (ends.size() == log.epochs.size()) return;
        repeated = log.epochs.size() - ends.size();
        std::vector<bool> kept(log.epochs.size(), false);
        for (std::size_t i = ends.back(); i != none; i = before[i]) kept[i] = true;
        keep(kept);
    }

    void keep(const std::vector<bool>& kept) {
        gnss::ObservationLog& log = result.observations;
        std::size_t n = 0, to = 0;
        for (std::size_t i = 0; i < log.epochs.size(); ++i) {
            if (!kept[i]) continue;
            gnss::ObservationEpoch e = log.epochs[i];
            for (std::size_t k = 0; k < e.count; ++k) {
                log.observations[to + k] = log.observations[e.first + k];
                locks_[to + k] = locks_[e.first + k];
            }
            e.first = to;
            to += e.count;
            log.epochs[n++] = e;
        }
        log.epochs.resize(n);
        log.observations.resize(to);
        locks_.resize(to);
    }

    /// Epochs where the lock time did not increase with time.
    void find_losses() {
        struct Held {
            Time time;
            Lock lock;
        };
        std::map<std::pair<SatelliteId, Signal>, Held> held;
        for (const gnss::ObservationEpoch& e : result.observations.epochs) {
            for (std::size_t i = e.first; i < e.first + e.count; ++i) {
                gnss::SignalObservation& o = result.observations.observations[i];
                if (!std::isfinite(o.phase)) continue;
                Held& before = held[{o.satellite, o.signal}];
                const Lock& lock = locks_[i];
                const double since = std::min((e.time - before.time).seconds(), 1e6);
                const double expected = static_cast<double>(before.lock.seconds) + since;
                // stored in single precision: resolution of a sixteenth of a second after six days
                const double rounding = static_cast<double>(std::numeric_limits<float>::epsilon()) * std::abs(expected);
                const bool lost = before.time.ns == 0 || lock.behind_a_gap ||
                                  static_cast<double>(lock.seconds) + 0.05 + rounding < expected ||
                                  lock.half_added != before.lock.half_added;
                o.loss_of_lock = static_cast<std::uint8_t>((lost ? 1 : 0) | (lock.parity_known ? 0 : 2));
                before = {e.time, lock};
            }
        }
    }

    void measurement(const NovatelRange& r, bool is_compressed) {
        if (!r.signal) {
            ++unknown_signals;
            return;
        }
        const bool phase_locked = (r.status & 1U << 10) != 0, parity_known = (r.status & 1U << 11) != 0,
                   code_locked = (r.status & 1U << 12) != 0, half_added = (r.status & 1U << 28) != 0;
        gnss::SignalObservation o;
        o.satellite = r.satellite;
        o.signal = *r.signal;
        if (code_locked && r.psr > 1e6 && r.psr < 1e9) o.pseudorange = r.psr;
        if (phase_locked && std::isfinite(r.adr) && std::abs(r.adr) < 1e10 && r.adr != 0.0)
            o.phase = -r.adr;  // the phase in the log decreases as the range increases
        if (std::isfinite(r.doppler) && std::abs(r.doppler) < 1e6) o.doppler = r.doppler;
        if (r.cn0 > 0.0 && r.cn0 < 100.0) o.cn0 = r.cn0;
        if (r.satellite.system == System::Glonass && r.channel) {
            channels_given_ = channels_given_ || is_compressed;
            std::int8_t& channel = result.observations.channels.of_slot[r.satellite.number];
            if (channel == gnss::unknown_channel) channel = static_cast<std::int8_t>(*r.channel);
        } else if (r.satellite.system == System::Glonass && is_compressed) {
            zero_channels_.insert(r.satellite.number);
        }
        auto& unlocked = unlocked_[is_compressed ? 1 : 0];
        const bool has_phase = std::isfinite(o.phase);
        const bool behind_a_gap = has_phase && unlocked.erase({o.satellite, o.signal}) > 0;
        if (!has_phase) unlocked.insert({o.satellite, o.signal});
        if (std::isfinite(o.pseudorange) || has_phase)
            measured_.push_back({o, {r.locked, half_added, parity_known, behind_a_gap}});
    }

    void add(const gnss::KeplerEphemeris& k) {
        if (detail::is_sound(k)) detail::add_new(result.navigation.kepler, k);
    }

    void gps(const NovatelMessage& m, Time now) {
        NovatelFields f(m);
        const auto d = [&] { return f.next<double>(); };
        const auto u = [&] { return f.next<std::uint32_t>(); };
        gnss::KeplerEphemeris k;
        const auto satellite = satellite_of(0, static_cast<int>(std::min<std::uint32_t>(u(), 1000)));
        if (!satellite) return;
        k.satellite = *satellite;
        const double sent = d();
        k.health = static_cast<int>(u() & 0x3FU);
        k.iode = static_cast<int>(u() & 0xFFU);
        const auto other_issue = static_cast<int>(u() & 0xFFU);
        (void)u();  // the week, and the week of the reference: both follow from the header's time
        (void)u();
        const double toe = d();
        k.sqrt_a = std::sqrt(d());
        k.delta_n = d(), k.m0 = d(), k.e = d(), k.omega = d();
        k.cuc = d(), k.cus = d(), k.crc = d(), k.crs = d(), k.cic = d(), k.cis = d();
        k.i0 = d(), k.idot = d(), k.omega0 = d(), k.omega_dot = d();
        k.iodc = static_cast<int>(u() & 0x3FFU);
        const double toc = d();
        k.group_delay[0] = d();
        k.af0 = d(), k.af1 = d(), k.af2 = d();
        f.skip(4, 1);  // whether the code is encrypted
        (void)d();     // the corrected mean motion
        k.accuracy = std::sqrt(d());
        if (f.is_short() || other_issue != k.iode || !(std::abs(toc) <= 604'800.0)) return;
        k.toc = detail::nearest_in_week(toc, now);
        detail::set_times(k, toe, sent);
        add(k);
    }

    /// The three subframes of an ephemeris as transmitted, parity removed.
    void subframes(const NovatelMessage& m, Time now) {
        NovatelFields f(m);
        const auto satellite = satellite_of(0, static_cast<int>(std::min<std::uint32_t>(f.next<std::uint32_t>(), 1000)));
        constexpr std::size_t size = 30;
        f.skip(8, 2);  // reference week and seconds
        for (std::size_t s = 0; s < 3; ++s) {
            const std::string bytes = f.bytes(size);
            if (!satellite || bytes.empty()) return;
            std::array<std::uint32_t, 10> words{};
            for (std::size_t i = 0; i < size; ++i) words[i / 3] = words[i / 3] << 8 | static_cast<unsigned char>(bytes[i]);
            (void)frames_.gps_subframe(*satellite, words, now);
        }
    }

    void glonass(const NovatelMessage& m) {
        NovatelFields f(m);
        const auto vector = [&](Eigen::Vector3d& v) {
            for (double& x : v) x = f.next<double>();
        };
        gnss::GlonassEphemeris g;
        const auto satellite = satellite_of(1, f.next<std::uint16_t>());
        if (!satellite) return;
        g.satellite = *satellite;
        g.channel = f.next<std::uint16_t>() - 7;
        f.skip(2, 2);  // satellite type
        const double week = f.next<std::uint16_t>();
        const double toe = std::round(1e-3 * f.next<std::uint32_t>());
        f.skip(4 + 2 + 1 + 1 + 4, 5);  // offset to GLONASS time, day, two reserved, issue
        g.health = f.next<std::uint32_t>() < 4 ? 0 : 1;
        vector(g.position), vector(g.velocity), vector(g.acceleration);
        g.clock = -f.next<double>();
        g.l2_delay = f.next<double>();
        g.clock_rate = f.next<double>();
        f.skip(4 + 4 + 4, 3);  // transmission time, technology, accuracy
        g.age_days = static_cast<int>(std::min<std::uint32_t>(f.next<std::uint32_t>(), 1000));
        g.toe = g.transmission = Time{detail::novatel_time(week, toe)};
        if (f.is_short() || g.toe.ns == 0 || g.channel < -7 || g.channel > 13 || !detail::is_sound(g)) return;
        result.observations.channels.of_slot[g.satellite.number] = static_cast<std::int8_t>(g.channel);
        detail::add_new(result.navigation.glonass, g);
    }

    void galileo(const NovatelMessage& m, Time now) {
        NovatelFields f(m);
        const auto d = [&] { return f.next<double>(); };
        gnss::KeplerEphemeris k;
        const auto satellite = satellite_of(3, static_cast<int>(std::min<std::uint32_t>(f.next<std::uint32_t>(), 1000)));
        if (!satellite) return;
        k.satellite = *satellite;
        const bool fnav = f.flag(), inav = f.flag();
        const auto two_bits = [&] { return f.next<std::uint8_t>() & 3; };
        const int health_e1 = two_bits(), health_e5a = two_bits(), health_e5b = two_bits();
        const auto one_bit = [&] { return f.next<std::uint8_t>() & 1; };
        const int invalid_e1 = one_bit(), invalid_e5a = one_bit(), invalid_e5b = one_bit();
        k.health = invalid_e1 | health_e1 << 1 | invalid_e5a << 3 | health_e5a << 4 | invalid_e5b << 6 | health_e5b << 7;
        k.accuracy = detail::galileo_accuracy(f.next<std::uint8_t>());
        f.skip(1, 1);
        k.iode = k.iodc = static_cast<int>(f.next<std::uint32_t>() & 0x3FFU);
        const double toe = f.next<std::uint32_t>();
        k.sqrt_a = d();
        k.delta_n = d(), k.m0 = d(), k.e = d(), k.omega = d();
        k.cuc = d(), k.cus = d(), k.crc = d(), k.crs = d(), k.cic = d(), k.cis = d();
        k.i0 = d(), k.idot = d(), k.omega0 = d(), k.omega_dot = d();
        struct Clock {
            double toc, af0, af1, af2;
        };
        std::array<Clock, 2> clocks{};
        for (Clock& c : clocks) c = {static_cast<double>(f.next<std::uint32_t>()), d(), d(), d()};
        k.group_delay = {d(), d()};
        if (f.is_short()) return;
        for (const bool is_inav : {true, false}) {
            if (is_inav ? !inav : !fnav) continue;
            const Clock& c = clocks[is_inav ? 1 : 0];
            if (!(c.toc <= 604'800.0)) continue;
            gnss::KeplerEphemeris one = k;
            one.message = is_inav ? gnss::NavMessage::Inav : gnss::NavMessage::Fnav;
            one.af0 = c.af0, one.af1 = c.af1, one.af2 = c.af2;
            one.toc = detail::nearest_in_week(c.toc, now);
            detail::set_times(one, toe, not_given);
            add(one);
        }
    }

    void beidou(const NovatelMessage& m, Time now) {
        NovatelFields f(m);
        const auto d = [&] { return f.next<double>(); };
        const auto u = [&] { return f.next<std::uint32_t>(); };
        gnss::KeplerEphemeris k;
        const auto satellite = satellite_of(4, static_cast<int>(std::min<std::uint32_t>(u(), 1000)));
        if (!satellite) return;
        k.satellite = *satellite;
        k.message = gnss::is_geostationary_beidou(*satellite) ? gnss::NavMessage::D2 : gnss::NavMessage::D1;
        (void)u();  // week
        k.accuracy = d();
        k.health = static_cast<int>(u() & 1U);
        k.group_delay = {d(), d()};
        k.iodc = static_cast<int>(u() & 0xFFU);
        const double toc = u();
        k.af0 = d(), k.af1 = d(), k.af2 = d();
        k.iode = static_cast<int>(u() & 0xFFU);
        const double toe = u();
        k.sqrt_a = d(), k.e = d(), k.omega = d(), k.delta_n = d(), k.m0 = d();
        k.omega0 = d(), k.omega_dot = d(), k.i0 = d(), k.idot = d();
        k.cuc = d(), k.cus = d(), k.crc = d(), k.crs = d(), k.cic = d(), k.cis = d();
        if (f.is_short() || !(toc <= 604'800.0)) return;
        k.toc = detail::nearest_in_week(toc, now, System::BeiDou);
        detail::set_times(k, toe, not_given);
        add(k);
    }

    void ionosphere(const NovatelMessage& m) {
        NovatelFields f(m);
        gnss::KlobucharCoefficients c;
        for (double& a : c.alpha) a = f.next<double>();
        for (double& b : c.beta) b = f.next<double>();
        f.skip(4 + 4 + 8 + 8 + 4 + 4, 6);
        const auto leap = f.next<std::int32_t>();
        const auto sane = [](double x, double most) { return std::isfinite(x) && std::abs(x) < most; };
        if (f.is_short() || !std::ranges::all_of(c.alpha, [&](double a) { return sane(a, 1e-3); }) ||
            !std::ranges::all_of(c.beta, [&](double b) { return sane(b, 1e8); }))
            return;
        result.navigation.klobuchar[static_cast<std::size_t>(System::Gps)] = c;
        if (leap >= 0 && leap < 100) result.navigation.leap_seconds = leap;
    }

    std::vector<Measured> measured_;                                    ///< of the current epoch
    std::vector<Lock> locks_;                                           ///< of each observation
    std::array<std::set<std::pair<SatelliteId, Signal>>, 2> unlocked_;  ///< whose last measurement had no phase: RANGE, RANGECMP
    std::set<std::size_t> compressed_epochs_;
    std::set<Time> in_full_;                ///< epochs of RANGE
    std::set<std::uint8_t> zero_channels_;  ///< GLONASS slots whose frequency number is zero in RANGECMP
    bool channels_given_ = false;           ///< others have one
    detail::FrameCollector frames_;
};

}  // namespace

NovatelRaw read_novatel_raw(const TextInput& input, WarningLog& log) {
    const std::string bytes = read_bytes(input);
    RawReader reader;
    const detail::NovatelScan scan = detail::scan_novatel(bytes, [&](const NovatelMessage& m) {
        reader.take(m);
        return true;
    });
    reader.finish();
    if (scan.damaged > 0)
        log.add(input.name() + " novatel.damaged",
                fmt::format("{}: damaged logs, the first at byte {}: skipped", input.name(), scan.first_damaged), scan.damaged);
    if (reader.unknown_signals > 0)
        log.add(input.name() + " novatel.signals", fmt::format("{}: measurements of unknown signals: skipped", input.name()),
                reader.unknown_signals);
    if (reader.repeated > 0)
        log.add(input.name() + " novatel.repeated",
                fmt::format("{}: epochs not later than the one before, or stamped later than those behind them: skipped",
                            input.name()),
                reader.repeated);
    if (reader.compressed > 0 && reader.result.observations.epochs.empty())
        detail::tell_compressed(input.name(), reader.compressed, log);
    return std::move(reader.result);
}

bool is_novatel_raw(const TextInput& input) {
    try {
        constexpr std::size_t enough = 300'000;
        const std::string bytes = read_head(input, enough);
        bool found = false;
        (void)detail::scan_novatel(bytes, [&](const NovatelMessage& m) {
            found = is_raw(m.id);
            return !found;
        });
        return found;
    } catch (const Error&) {
        return false;
    }
}

}  // namespace schuler::io
