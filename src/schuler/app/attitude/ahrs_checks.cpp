#include "schuler/analysis/turn_agreement.h"
#include "schuler/app/attitude/ahrs.h"
#include "schuler/core/units.h"
#include "schuler/math/quantile.h"

#include <algorithm>
#include <cmath>
#include <optional>

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

/// By what the rates have to be multiplied, if degrees and radians were confused: every rotation is 57 times too small or too large.
std::optional<double> wrong_unit(const analysis::TurnAgreement& a, double least_agreement) {
    if (!(a.turned > enough_turned && a.correlation > least_agreement)) return std::nullopt;
    for (const double unit : {units::deg, 1.0 / units::deg})
        if (a.factor > 0.3 * unit && a.factor < 3.0 * unit) return unit;
    return std::nullopt;
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
    if (field.turned > enough_turned && field.correlation < least_agreement) {
        warnings.add(
            "ahrs.mag.axes",
            fmt::format("the magnetometer does not turn with the gyro (correlation {:.2f}, 1 expected): are its axes "
                        "those of the IMU, its times on the same clock, is a magnet near it at times? heading cannot be trusted; "
                        "--six-axis leaves it out",
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

void settle_gyro_unit(AhrsInput& input, WarningLog& warnings) {
    const auto& imu = input.imu;
    const auto& mag = input.mag;
    const auto field = analysis::turn_agreement(
        imu, mag.size(), [&](std::size_t k) { return mag[k].time; }, [&](std::size_t k) { return mag[k].field_b; });
    const auto force = analysis::turn_agreement(
        imu, imu.size(), [&](std::size_t k) { return imu[k].time; }, [&](std::size_t k) { return imu[k].accel; });
    constexpr double suspicious = 0.3, clear = 0.6;  // correlation
    std::optional<double> unit = wrong_unit(field, suspicious);
    if (!unit) unit = wrong_unit(force, suspicious);
    if (!unit) return;
    const bool settled = wrong_unit(field, clear) == unit || wrong_unit(force, clear) == unit;
    if (settled)
        for (ImuSample& s : input.imu) s.gyro *= *unit;
    const char* what =
        *unit < 1.0
            ? "the gyro's rates are about 57 times those implied by accelerometer and magnetometer: are they in deg/s?"
            : "the gyro's rates are a 57th of those implied by accelerometer and magnetometer: were they converted twice?";
    warnings.add("ahrs.gyro.unit",
                 settled ? fmt::format("{} they are multiplied by {:.7g}; give [imu] scale = {{ gyro_rad_s = {:.7g} }}", what,
                                       *unit, *unit)
                         : fmt::format("{} write the unit into the columns' names, as in gyro_x_deg_s", what));
}

void check_ahrs_input(const AhrsInput& input, WarningLog& warnings) {
    check_times(input);
    const auto& mag = input.mag;
    const auto field = analysis::turn_agreement(
        input.imu, mag.size(), [&](std::size_t k) { return mag[k].time; }, [&](std::size_t k) { return mag[k].field_b; });
    if (!mag.empty() && !input.settings.mekf.six_axis) check_magnetometer(input, field, warnings);
}

}  // namespace schuler::app
