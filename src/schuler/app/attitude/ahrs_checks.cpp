#include "schuler/analysis/turn_agreement.h"
#include "schuler/app/attitude/ahrs.h"
#include "schuler/core/units.h"
#include "schuler/math/quantile.h"

#include <algorithm>
#include <cmath>

namespace schuler::app {
namespace {

constexpr double enough_turned = 0.5;  // rad, below which units and axes are not judged

void check_times(const AhrsInput& input) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < input.imu.size(); ++i) steps.push_back((input.imu[i].time - input.imu[i - 1].time).seconds());
    const double step = math::median(std::move(steps));
    if (step > input.settings.mekf.guard.longest_step) {
        throw input_error(fmt::format("IMU samples are {:.3g} s apart: too far for an attitude", step), {{}, 0, 0, "imu.time_s"},
                          "if the times are milliseconds name their column time_ms");
    }
}

/// Rates in deg/s under a name with rad/s make every rotation 57 times too small.
bool rates_in_degrees(const analysis::TurnAgreement& a) {
    constexpr double least_agreement = 0.3;
    return a.turned > enough_turned && a.correlation > least_agreement && a.factor > 0.3 * units::deg &&
           a.factor < 3.0 * units::deg;
}

void check_gyro(const AhrsInput& input, const analysis::TurnAgreement& field, WarningLog& warnings) {
    const auto& imu = input.imu;
    const auto force = analysis::turn_agreement(
        imu, imu.size(), [&](std::size_t k) { return imu[k].time; }, [&](std::size_t k) { return imu[k].accel; });
    if (!rates_in_degrees(field) && !rates_in_degrees(force)) return;
    warnings.add("ahrs.gyro.unit",
                 "the gyro's rates are some 57 times those that accelerometer and magnetometer show: deg/s? "
                 "write it into the columns' names, as in gyro_x_deg_s");
}

void check_magnetometer(const AhrsInput& input, const analysis::TurnAgreement& field, WarningLog& warnings) {
    const auto& mag = input.mag;
    std::vector<double> norms;
    for (const MagSample& s : mag) {
        if (s.field_b.allFinite()) norms.push_back(s.field_b.norm() / units::microtesla);
    }
    const double size = math::median(std::move(norms));
    constexpr double least = 10.0, most = 200.0;
    if (size < least || size > most) {
        warnings.add("ahrs.mag.size", fmt::format("the magnetometer's median is {:.3g} uT where the Earth's field is 20 to 70: "
                                                  "wrong unit? write it into the column's name, as in mag_x_gauss",
                                                  size));
    }
    constexpr double least_agreement = 0.6;
    if (field.turned > enough_turned && !rates_in_degrees(field) && field.correlation < least_agreement) {
        warnings.add("ahrs.mag.axes",
                     fmt::format("the magnetometer does not turn with the gyro (correlation {:.2f}, 1 expected): are its axes "
                                 "those of the IMU? heading cannot be trusted; --six-axis leaves it out",
                                 field.correlation));
    }
    constexpr double longest_without = 10.0;
    const double without =
        std::max((mag.front().time - input.imu.front().time).seconds(), (input.imu.back().time - mag.back().time).seconds());
    if (without > longest_without) {
        warnings.add("ahrs.mag.span",
                     fmt::format("no magnetometer for {:.0f} s at one end of the IMU log: heading drifts there", without));
    }
}

}  // namespace

void check_ahrs_input(const AhrsInput& input, WarningLog& warnings) {
    check_times(input);
    const auto& mag = input.mag;
    const auto field = analysis::turn_agreement(
        input.imu, mag.size(), [&](std::size_t k) { return mag[k].time; }, [&](std::size_t k) { return mag[k].field_b; });
    check_gyro(input, field, warnings);
    if (!mag.empty() && !input.settings.mekf.six_axis) check_magnetometer(input, field, warnings);
}

}  // namespace schuler::app
