#include "schuler/core/units.h"
#include "schuler/dataset/description.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/config/sections.h"
#include "schuler/settings/option_builders.h"

namespace schuler::settings {
namespace {

using gnss::IonosphereModel;
using gnss::Mapping;
using gnss::TroposphereModel;

Option<Config> systems() {
    return special<Config>(
        "gnss.systems", "letters of G R E C J S I", "satellite systems used: GPS, GLONASS, Galileo, BeiDou, QZSS, SBAS, NavIC",
        [](Config& c, const Value& v) {
            const std::string letters = v.text() != nullptr ? *v.text() : std::string();
            auto& use = c.raw.solver.ranges.systems;
            use.fill(false);
            for (const char letter : letters) {
                const auto system = gnss::system_from_letter(letter);
                if (!system) throw input_error(fmt::format("{} is not a satellite system", letter), {}, "use letters of GRECJSI");
                use[static_cast<std::size_t>(*system)] = true;
            }
            if (letters.empty())
                throw input_error(fmt::format("{} is not a satellite system", to_toml(v)), {}, "use letters of GRECJSI");
        },
        [](const Config& c) -> std::optional<Value> {
            std::string letters;
            for (std::size_t i = 0; i < gnss::system_count; ++i) {
                if (c.raw.solver.ranges.systems[i]) letters += gnss::letter_of(static_cast<gnss::System>(i));
            }
            return Value{letters};
        });
}

template <class T>
auto ranges(T gnss::RangeSettings::*field) {
    return [=](auto& c) -> auto& { return c.raw.solver.ranges.*field; };
}

}  // namespace

void add_raw_gnss_options(OptionTable<Config>& table) {
    table
        .add(file_list("gnss.observations", "raw measurements (RINEX, UBX or RTCM 3) instead of gnss.file",
                       [](auto& c) -> auto& { return c.raw.observations; }))
        .add(file_list("gnss.navigation", "broadcast ephemerides: RINEX navigation files",
                       [](auto& c) -> auto& { return c.raw.navigation; }))
        .add(text<Config>("gnss.precise", "precise orbits and clocks (SP3) instead of broadcast ones",
                          [](auto& c) -> auto& { return c.raw.precise; }))
        .add(text<Config>(
            "gnss.antennas",
            "antenna calibrations (ANTEX): with a base, positions are those of the reference points of the antennas; with "
            "gnss.precise, orbits are those of the satellites' phase centres",
            [](auto& c) -> auto& { return c.raw.antennas; }))
        .add(text<Config>("gnss.antenna_type", "type of the receiver's antenna, as in gnss.antennas; default: that of the header",
                          [](auto& c) -> auto& { return c.raw.antenna; }))
        .add(systems())
        .add(number<Config>("gnss.elevation_mask_deg", units::deg, -10, 80, "satellites below this elevation are not used",
                            ranges(&gnss::RangeSettings::elevation_mask)))
        .add(number<Config>("gnss.cn0_mask_db_hz", 1.0, 0, 60, "signals below this C/N0 are not used",
                            ranges(&gnss::RangeSettings::least_cn0)))
        .add(choice<Config, IonosphereModel>(
            "gnss.ionosphere",
            {{"broadcast", IonosphereModel::Broadcast}, {"dual", IonosphereModel::Dual}, {"none", IonosphereModel::None}},
            "Klobuchar's model, or the ionosphere-free combination of two frequencies", ranges(&gnss::RangeSettings::ionosphere)))
        .add(choice<Config, TroposphereModel>(
            "gnss.troposphere", {{"saastamoinen", TroposphereModel::Saastamoinen}, {"none", TroposphereModel::None}},
            "delay in the standard atmosphere", ranges(&gnss::RangeSettings::troposphere)))
        .add(choice<Config, Mapping>("gnss.troposphere_mapping", {{"niell", Mapping::Niell}, {"cosecant", Mapping::Cosecant}},
                                     "mapping function of the troposphere", ranges(&gnss::RangeSettings::mapping)))
        .add(number<Config>("gnss.code_std_m", 1.0, 1e-3, 100, "one sigma of a pseudorange at the zenith with a strong signal",
                            ranges(&gnss::RangeSettings::code_sigma)))
        .add(number<Config>("gnss.doppler_std_m_s", 1.0, 1e-4, 10, "one sigma of a Doppler at the zenith with a strong signal",
                            ranges(&gnss::RangeSettings::doppler_sigma)))
        .add(flag<Config>(
            "gnss.phase_velocity",
            "velocity (tight coupling: range rates) of raw measurements from the carrier phases of two epochs instead of the Doppler; "
            "default: on in tight coupling without a base",
            [](auto& c) -> auto& { return c.raw.phase_velocity; }))
        .add(flag<Config>("gnss.raim", "test the residuals of raw measurements and leave out faulty satellites",
                          [](auto& c) -> auto& { return c.raw.solver.raim; }))
        .add(number<Config>("gnss.raim_false_alarm", 1.0, 1e-12, 0.5, "probability of a false alarm in one epoch",
                            [](auto& c) -> auto& { return c.raw.solver.false_alarm; }));
}

}  // namespace schuler::settings
