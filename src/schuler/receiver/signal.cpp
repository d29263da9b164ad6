#include "schuler/receiver/signal.h"

#include "schuler/core/error.h"

#include <fmt/format.h>

#include <cmath>

namespace schuler::receiver {

SignalStructure gps_l1_ca() { return {gnss::frequency_of(gnss::System::Gps, '1'), 1.023e6, 1023, 0.020}; }

SignalStructure glonass_l1_of(int channel) {
    if (channel < -7 || channel > 6)
        throw input_error(fmt::format("GLONASS frequency number {} does not exist", channel), {}, "give -7 to 6");
    return {gnss::frequency_of(gnss::System::Glonass, '1', channel), 0.511e6, 511, 0.010};
}

double cn0_from_db(double db_hz) { return std::pow(10.0, db_hz / 10.0); }
double db_from_cn0(double cn0) { return 10.0 * std::log10(cn0); }

LineOfSight LineOfSight::after(double dt) const {
    return {range + dt * (rate + dt * (acceleration / 2.0 + dt * jerk / 6.0)), rate + dt * (acceleration + dt * jerk / 2.0),
            acceleration + dt * jerk, jerk};
}

}  // namespace schuler::receiver
