// [receiver] of scenario files: a receiver at correlator level, signal strengths and jammers.
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/settings/list_options.h"
#include "schuler/settings/scenario/scenario.h"

namespace schuler::settings {
namespace {

using S = ScenarioConfig;
using units::deg;

/// Milliseconds per coherent sum, the code period being one.
template <class Access>
Option<S> integration(const char* key, std::string help, Access access) {
    Option<S> option = integer<S>(key, 1, 20, std::move(help), access);
    option.set = [set = option.set](S& s, const Value& v) {
        if (20 % *v.integer() != 0)
            throw input_error(fmt::format("{} ms do not divide a bit of 20 ms", *v.integer()), {}, "use 1, 2, 4, 5, 10 or 20");
        set(s, v);
    };
    return option;
}

}  // namespace

void add_receiver_scenario_options(OptionTable<S>& table) {
    const auto bank = [](auto field) { return [=](auto& s) -> auto& { return s.receiver_channels.bank.*field; }; };
    const auto alone = [](auto field) { return [=](auto& s) -> auto& { return s.receiver_channels.bank.alone.*field; }; };
    const auto aided = [](auto field) { return [=](auto& s) -> auto& { return s.receiver_channels.bank.aided.*field; }; };
    const auto deep = [](auto field) { return [=](auto& s) -> auto& { return s.receiver_channels.bank.deep.*field; }; };
    using T = receiver::TrackingSettings;
    using D = receiver::DeepSettings;
    table
        .add(number<S>("receiver.rate_hz", 1.0, 0, 50,
                       "a receiver at correlator level tracks the satellites of [ranges] and measures at this "
                       "rate; 0 = none",
                       [](auto& s) -> auto& { return s.receiver_channels.rate; }))
        .add(number<S>("receiver.cn0_db_hz", 1.0, 1, 70, "C/N0 of every signal without jamming",
                       [](auto& s) -> auto& { return s.receiver_channels.cn0; }))
        .add(list_of<S, sim::StrengthPoint>(
            "receiver.cn0_profile", "[ { time_s, cn0_db_hz }, ... ]", "C/N0 over time instead, linear between the points",
            [](S& s) -> auto& { return s.receiver_channels.profile; },
            [](sim::StrengthPoint& p) {
                return std::vector<Entry>{{.name = "time_s", .number = &p.time}, {.name = "cn0_db_hz", .number = &p.cn0}};
            },
            [](std::vector<sim::StrengthPoint>& profile, const sim::StrengthPoint& p) {
                if (!profile.empty() && !(p.time > profile.back().time))
                    throw input_error(fmt::format("{:g} s is not after the point before", p.time), {}, "sort it by time_s");
                profile.push_back(p);
            }))
        .add(list_of<S, sim::Jammer>(
            "receiver.jammer", "[ { lat_deg, lon_deg, height_m, power_w, spread, start_s, duration_s }, ... ]",
            "noise transmitters with free-space loss; spread: 1 = a tone, 2.22 = as wide as the code",
            [](S& s) -> auto& { return s.receiver_channels.jammers; },
            [](sim::Jammer& j) {
                return std::vector<Entry>{{.name = "lat_deg", .number = &j.position.lat, .factor = deg},
                                          {.name = "lon_deg", .number = &j.position.lon, .factor = deg},
                                          {.name = "height_m", .number = &j.position.h},
                                          {.name = "power_w", .number = &j.power},
                                          {.name = "spread", .number = &j.spread},
                                          {.name = "start_s", .number = &j.start},
                                          {.name = "duration_s", .number = &j.duration}};
            },
            [](std::vector<sim::Jammer>& jammers, const sim::Jammer& j) {
                if (!(j.power > 0.0 && j.spread > 0.0 && j.duration > 0.0))
                    throw input_error("a jammer without power, spread or duration", {}, "give positive numbers");
                jammers.push_back(j);
            }))
        .add(number<S>("receiver.pll_bandwidth_hz", 1.0, 0.5, 50, "bandwidth of the phase loop without inertial aiding",
                       alone(&T::pll_bandwidth)))
        .add(number<S>("receiver.dll_bandwidth_hz", 1.0, 0.01, 10, "bandwidth of the code loop without inertial aiding",
                       alone(&T::dll_bandwidth)))
        .add(integration("receiver.integration_ms", "coherent integration without inertial aiding; a divisor of 20",
                         alone(&T::integration)))
        .add(flag<S>(
            "receiver.aided",
            "tracking loops aided by the solution in tight coupling, and in loose coupling by a first run of it; those of "
            "intermediate coupling always are",
            [](auto& s) -> auto& { return s.receiver_channels.aided; }))
        .add(number<S>("receiver.aided_pll_bandwidth_hz", 1.0, 0.5, 50, "bandwidth of the phase loop with inertial aiding",
                       aided(&T::pll_bandwidth)))
        .add(number<S>("receiver.aided_dll_bandwidth_hz", 1.0, 0.01, 10, "bandwidth of the code loop with inertial aiding",
                       aided(&T::dll_bandwidth)))
        .add(integration("receiver.aided_integration_ms", "coherent integration with inertial aiding; a divisor of 20",
                         aided(&T::integration)))
        .add(choice<S, receiver::Prefilter>(
            "receiver.prefilter",
            {{"noncoherent", receiver::Prefilter::Noncoherent}, {"coherent", receiver::Prefilter::Coherent}},
            "discriminators of deep channels: noncoherent, or coherent while the phase is tracked", deep(&D::prefilter)))
        .add(number<S>("receiver.front_end_mhz", 1e6, 0.6, 100, "two-sided bandwidth of the front end; default: unlimited",
                       bank(&receiver::BankSettings::front_end)))
        .add(number<S>("receiver.clock_h_minus1", 1.0, 0, 1e-10,
                       "flicker frequency noise of the oscillator, in addition to ranges.clock",
                       [](auto& s) -> auto& { return s.receiver_channels.clock_flicker; }))
        .add(number<S>("receiver.clock_per_g", 1.0, 0, 1e-6,
                       "fractional frequency offset for one g of specific force on each axis",
                       [](auto& s) -> auto& { return s.receiver_channels.clock_per_g; }));
}

sim::SignalSettings signal_settings(const ScenarioConfig& s, const sim::RangingSettings& ranging) {
    return {ranging, s.receiver_channels.cn0, s.receiver_channels.profile, s.receiver_channels.jammers};
}

void check_receiver(const ScenarioConfig& s) {
    if (s.ranging.rate > 0.0)
        throw input_error("ranges are measured by the receiver", {.file = {}, .key = "ranges.rate_hz"},
                          "leave it out, or leave out receiver.rate_hz");
    sim::check(signal_settings(s, s.ranging.settings));
}

}  // namespace schuler::settings
