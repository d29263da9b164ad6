#include "schuler/ppk/air_delay.h"

namespace schuler::ppk {

AirDelay air_delay(const AirModel& model, const TrackedSatellite& s, const Geodetic& receiver, gnss::Direction direction) {
    AirDelay out;
    if (model.troposphere)
        out.troposphere = gnss::troposphere_delay(gnss::saastamoinen_zenith(receiver, model.relative_humidity), model.mapping,
                                                  s.transmit, receiver, direction.elevation);
    if (model.ionosphere)
        out.ionosphere =
            gnss::ionospheric_delay(*model.ionosphere, s.id.system, gnss::l1_frequency, s.transmit, receiver, direction).delay;
    return out;
}

double ionosphere_factor(double wavelength) {
    const double ratio = wavelength * gnss::l1_frequency / gnss::speed_of_light;
    return ratio * ratio;
}

}  // namespace schuler::ppk
