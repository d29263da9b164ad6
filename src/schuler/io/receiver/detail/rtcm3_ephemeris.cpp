#include "schuler/io/detail/broadcast_scales.h"
#include "schuler/io/detail/ephemeris_checks.h"
#include "schuler/io/receiver/detail/rtcm3_messages.h"

#include <algorithm>
#include <array>

namespace schuler::io::detail {
namespace {

using gnss::KeplerEphemeris;
using gnss::System;

/// The orbit with the reference time between its halves, s.
double orbit(Bits& b, KeplerEphemeris& k, std::size_t toe_bits, double toe_unit) {
    orbit_in_plane(b, k);
    const double toe = toe_unit * static_cast<double>(b.take(toe_bits));
    orbit_plane(b, k);
    return toe;
}

/// If week, toc and toe are all known.
void date(KeplerEphemeris& k, int week, int wrap, Time now, double toc, double toe) {
    k.toc = from_week_count(k.satellite.system, week, wrap, toc, now);
    set_times(k, toe, toe);
}

KeplerEphemeris gps(Bits& b, Time now) {
    KeplerEphemeris k;
    k.satellite = {System::Gps, static_cast<std::uint8_t>(b.take(6))};
    const int week = b.integer(10);
    k.accuracy = gps_accuracy(b.integer(4));
    b.skip(2);
    k.idot = angle(b, 14, -43), k.iode = b.integer(8);
    const double toc = scaled_unsigned(b, 16, 4);
    clock_of_gps(b, k);
    k.iodc = b.integer(10);
    const double toe = orbit(b, k, 16, 16.0);
    k.group_delay[0] = scaled(b, 8, -31);
    k.health = b.integer(6);
    b.skip(1);
    k.fit_interval = b.take(1) != 0 ? 6.0 * 3600.0 : 4.0 * 3600.0;
    date(k, week, 1024, now, toc, toe);
    return k;
}

KeplerEphemeris qzss(Bits& b, Time now) {
    KeplerEphemeris k;
    k.satellite = {System::Qzss, static_cast<std::uint8_t>(b.take(4))};
    const double toc = scaled_unsigned(b, 16, 4);
    clock_of_gps(b, k);
    k.iode = b.integer(8);
    const double toe = orbit(b, k, 16, 16.0);
    k.idot = angle(b, 14, -43);
    b.skip(2);
    const int week = b.integer(10);
    k.accuracy = gps_accuracy(b.integer(4));
    k.health = b.integer(6);
    k.group_delay[0] = scaled(b, 8, -31);
    k.iodc = b.integer(10);
    date(k, week, 1024, now, toc, toe);
    return k;
}

KeplerEphemeris galileo(Bits& b, Time now, bool inav) {
    KeplerEphemeris k;
    k.satellite = {System::Galileo, static_cast<std::uint8_t>(b.take(6))};
    k.message = inav ? gnss::NavMessage::Inav : gnss::NavMessage::Fnav;
    const int week = b.integer(12);
    k.iode = b.integer(10);
    k.accuracy = galileo_accuracy(b.integer(8));
    k.idot = angle(b, 14, -43);
    const double toc = 60.0 * static_cast<double>(b.take(14));
    k.af2 = scaled(b, 6, -59), k.af1 = scaled(b, 21, -46), k.af0 = scaled(b, 31, -34);
    const double toe = orbit(b, k, 14, 60.0);
    k.group_delay[0] = scaled(b, 10, -32);
    if (inav) {
        k.group_delay[1] = scaled(b, 10, -32);
        const int health_e5b = b.integer(2), valid_e5b = b.integer(1), health_e1 = b.integer(2), valid_e1 = b.integer(1);
        k.health = galileo_health(valid_e1, health_e1, valid_e5b, health_e5b);
    } else {
        const int health = b.integer(2), valid = b.integer(1);
        k.health = valid << 3 | health << 4;
    }
    date(k, week, 4096, now, toc, toe);
    return k;
}

KeplerEphemeris beidou(Bits& b, Time now) {
    KeplerEphemeris k;
    k.satellite = {System::BeiDou, static_cast<std::uint8_t>(b.take(6))};
    k.message = gnss::is_geostationary_beidou(k.satellite) ? gnss::NavMessage::D2 : gnss::NavMessage::D1;
    const int week = b.integer(13);
    k.accuracy = gps_accuracy(b.integer(4));
    k.idot = angle(b, 14, -43), k.iode = b.integer(5);
    const double toc = 8.0 * static_cast<double>(b.take(17));
    k.af2 = scaled(b, 11, -66), k.af1 = scaled(b, 22, -50), k.af0 = scaled(b, 24, -33);
    k.iodc = b.integer(5);
    k.crs = scaled(b, 18, -6), k.delta_n = angle(b, 16, -43), k.m0 = angle(b, 32, -31);
    k.cuc = scaled(b, 18, -31), k.e = scaled_unsigned(b, 32, -33), k.cus = scaled(b, 18, -31),
    k.sqrt_a = scaled_unsigned(b, 32, -19);
    const double toe = 8.0 * static_cast<double>(b.take(17));
    k.cic = scaled(b, 18, -31), k.omega0 = angle(b, 32, -31), k.cis = scaled(b, 18, -31), k.i0 = angle(b, 32, -31);
    k.crc = scaled(b, 18, -6), k.omega = angle(b, 32, -31), k.omega_dot = angle(b, 24, -43);
    k.group_delay = {1e-10 * static_cast<double>(b.take_signed(10)), 1e-10 * static_cast<double>(b.take_signed(10))};
    k.health = b.integer(1);
    date(k, week, 8192, now, toc, toe);
    return k;
}

gnss::GlonassEphemeris glonass(Bits& b, Time now) {
    gnss::GlonassEphemeris g;
    g.satellite = {System::Glonass, static_cast<std::uint8_t>(b.take(6))};
    g.channel = b.integer(5) - 7;
    b.skip(4 + 12);
    g.health = b.integer(1);
    b.skip(1);
    const std::int64_t tb = static_cast<std::int64_t>(b.take(7)) * 900'000'000'000;
    constexpr double km = 1000.0;
    for (Eigen::Index i = 0; i < 3; ++i) {
        g.velocity[i] = km * std::ldexp(static_cast<double>(b.take_sign_magnitude(24)), -20);
        g.position[i] = km * std::ldexp(static_cast<double>(b.take_sign_magnitude(27)), -11);
        g.acceleration[i] = km * std::ldexp(static_cast<double>(b.take_sign_magnitude(5)), -30);
    }
    b.skip(1);
    g.clock_rate = std::ldexp(static_cast<double>(b.take_sign_magnitude(11)), -40);
    b.skip(3);
    g.clock = -std::ldexp(static_cast<double>(b.take_sign_magnitude(22)), -30);
    g.l2_delay = std::ldexp(static_cast<double>(b.take_sign_magnitude(5)), -30);
    g.age_days = b.integer(5);
    g.toe = g.transmission = nearest_in_moscow_day(tb, now);
    return g;
}

/// Bit positions of the week count and the clock reference time in a message.
struct DateFields {
    int number;
    System system;
    std::size_t week_at, week_bits, toc_at, toc_bits;
    double toc_unit;
};
constexpr std::array<DateFields, 4> date_fields = {{{1019, System::Gps, 18, 10, 56, 16, 16.0},
                                                    {1042, System::BeiDou, 18, 13, 54, 17, 8.0},
                                                    {1045, System::Galileo, 18, 12, 62, 14, 60.0},
                                                    {1046, System::Galileo, 18, 12, 62, 14, 60.0}}};

template <class Ephemeris>
Decoded add(const Bits& bits, std::vector<Ephemeris>& to, const Ephemeris& e) {
    if (!bits.ok() || e.satellite.number == 0 || !is_sound(e)) return Decoded::Damaged;
    add_new(to, e);
    return Decoded::Used;
}

}  // namespace

std::optional<MessageDate> rtcm3_date(std::string_view payload, int number, Time latest) {
    const auto* f = std::ranges::find(date_fields, number, &DateFields::number);
    if (f == date_fields.end() || 8 * payload.size() < f->toc_at + f->toc_bits) return std::nullopt;
    const Bits bits(payload);
    const int count = static_cast<int>(bits.at(f->week_at, f->week_bits)), wrap = 1 << f->week_bits;
    const double toc = f->toc_unit * static_cast<double>(bits.at(f->toc_at, f->toc_bits));
    Time t = from_week_count(f->system, count, wrap, toc, latest);
    if (t > latest) t.ns -= wrap * gnss::week_ns;
    return MessageDate{t, wrap};
}

Decoded rtcm3_ephemeris(std::string_view payload, int number, Time now, gnss::Navigation& n) {
    Bits bits(payload);
    bits.skip(12);
    switch (number) {
        case 1019: {
            const KeplerEphemeris k = gps(bits, now);
            return add(bits, n.kepler, k);
        }
        case 1020: {
            const gnss::GlonassEphemeris g = glonass(bits, now);
            return add(bits, n.glonass, g);
        }
        case 1042: {
            const KeplerEphemeris k = beidou(bits, now);
            return add(bits, n.kepler, k);
        }
        case 1044: {
            const KeplerEphemeris k = qzss(bits, now);
            return add(bits, n.kepler, k);
        }
        case 1045:
        case 1046: {
            const KeplerEphemeris k = galileo(bits, now, number == 1046);
            return add(bits, n.kepler, k);
        }
        default: return Decoded::Foreign;
    }
}

}  // namespace schuler::io::detail
