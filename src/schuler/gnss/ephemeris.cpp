#include "schuler/gnss/ephemeris.h"

namespace schuler::gnss {

void Navigation::add(const Navigation& other) {
    kepler.insert(kepler.end(), other.kepler.begin(), other.kepler.end());
    glonass.insert(glonass.end(), other.glonass.begin(), other.glonass.end());
    sbas.insert(sbas.end(), other.sbas.begin(), other.sbas.end());
    for (std::size_t i = 0; i < klobuchar.size(); ++i) {
        if (!klobuchar[i]) klobuchar[i] = other.klobuchar[i];
    }
    if (!galileo_ionosphere) galileo_ionosphere = other.galileo_ionosphere;
    if (!leap_seconds) leap_seconds = other.leap_seconds;
}

}  // namespace schuler::gnss
