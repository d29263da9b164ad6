// Broadcast ephemerides of the navigation messages, in SI units and GPS time.
#pragma once

#include "schuler/core/time.h"
#include "schuler/gnss/satellite.h"

#include <Eigen/Core>

#include <array>
#include <optional>
#include <vector>

namespace schuler::gnss {

/// Source message of an ephemeris. Galileo's I/NAV clock refers to E1 and E5b, the F/NAV clock to E1 and E5a.
enum class NavMessage : std::uint8_t { Lnav, Cnav, Inav, Fnav, D1, D2, Glonass, Sbas };

/// Keplerian elements with harmonic corrections: GPS and QZSS [ISGPS200:table 20-III], Galileo [GalileoICD:tables 65, 67],
/// BeiDou [BeiDouICD:table 5-10], NavIC. Angles rad, lengths m, times s.
struct KeplerEphemeris {
    SatelliteId satellite;
    NavMessage message = NavMessage::Lnav;
    Time toc, toe;                     ///< reference times of clock and orbit
    Time transmission;                 ///< time of transmission, toe if unknown
    double af0 = 0, af1 = 0, af2 = 0;  ///< clock: s, s/s, s/s^2
    double sqrt_a = 0, e = 0, i0 = 0, omega0 = 0, omega = 0, m0 = 0;
    double delta_n = 0, omega_dot = 0, idot = 0;
    double a_rate = 0, delta_n_rate = 0;  ///< m/s, rad/s^2: CNAV
    double cuc = 0, cus = 0, crc = 0, crs = 0, cic = 0, cis = 0;
    /// s. GPS, QZSS, NavIC: T_GD, 0; CNAV: T_GD less the inter-signal corrections of L1 C/A, L2C and L5. Galileo: BGD E1/E5a, E1/E5b. BeiDou: T_GD1 (B1), T_GD2 (B2).
    std::array<double, 3> group_delay{0, 0, 0};
    int iode = 0, iodc = 0;
    int health = 0;           ///< 0: healthy
    double accuracy = 0;      ///< m, one sigma as broadcast; 0 or less: unknown or not guaranteed
    double fit_interval = 0;  ///< s; 0: nominal
};

/// State vector at a reference time, in PZ-90 Earth-fixed axes [GLONASSICD:4.4].
struct GlonassEphemeris {
    SatelliteId satellite;
    Time toe;
    Time transmission;
    Eigen::Vector3d position{0, 0, 0}, velocity{0, 0, 0}, acceleration{0, 0, 0};  ///< m, m/s, m/s^2 (Sun and Moon)
    double clock = 0;                                                             ///< s, minus tau_n: satellite minus system time
    double clock_rate = 0;                                                        ///< s/s, gamma_n
    double l2_delay = 0;                                                          ///< s, delta tau_n: delay of L2 relative to L1
    int channel = 0;
    int health = 0;
    int age_days = 0;
};

/// State vector of a geostationary satellite [RTCA229:A.4.4.11].
struct SbasEphemeris {
    SatelliteId satellite;
    Time toe;
    Time transmission;
    Eigen::Vector3d position{0, 0, 0}, velocity{0, 0, 0}, acceleration{0, 0, 0};
    double clock = 0, clock_rate = 0;
    int health = 0;
    double accuracy = 0;
};

/// Coefficients of a broadcast ionosphere model. Klobuchar: SI of the message (s, s/semicircle, ...).
struct KlobucharCoefficients {
    std::array<double, 4> alpha{}, beta{};
};
struct GalileoIonosphere {
    std::array<double, 3> a{};  ///< effective ionisation level, solar flux units, per degree of modified dip latitude
};

/// The content of a navigation file or of the messages in a receiver's log.
struct Navigation {
    std::vector<KeplerEphemeris> kepler;
    std::vector<GlonassEphemeris> glonass;
    std::vector<SbasEphemeris> sbas;
    std::array<std::optional<KlobucharCoefficients>, system_count> klobuchar;  ///< by system
    std::optional<GalileoIonosphere> galileo_ionosphere;
    std::optional<int> leap_seconds;  ///< GPS minus UTC as broadcast

    /// Merges the content of another file; ionosphere coefficients already present are kept.
    void add(const Navigation& other);
    [[nodiscard]] std::size_t size() const { return kepler.size() + glonass.size() + sbas.size(); }
};

}  // namespace schuler::gnss
