#include "schuler/ahrs/constant_magnet.h"

#include "schuler/ahrs/field_turns.h"

#include <algorithm>

namespace schuler::ahrs {
namespace {

constexpr double noticeable = 10e-6;     // T
constexpr double place_to_place = 4e-6;  // T, changes of the Earth's field in a building
constexpr double gains = 0.05;           // of the magnetometer, which change a strong field's apparent size with the attitude
constexpr std::size_t sections = 6, enough_sections = 4, fewest_pairs = 20;

}  // namespace

std::optional<ConstantMagnet> find_constant_magnet(std::span<const ImuSample> imu, std::span<const MagSample> mag) {
    const Turning turning(imu);
    const FieldTurns whole(turning, reading_pairs(mag));
    if (!whole.enough()) return std::nullopt;
    const Eigen::Matrix3d as_given = Eigen::Matrix3d::Identity();
    const FieldTurns::Unexplained all = whole.unexplained(as_given);
    const double size = all.hard_iron_b.norm(), tolerance = place_to_place + gains * size;
    if (all.left > unconvincing * whole.changes() || size < noticeable || all.std > tolerance) return std::nullopt;
    std::size_t judged = 0;
    double spread = 0.0;
    for (std::size_t i = 0; i < sections; ++i) {
        const std::size_t from = mag.size() * i / sections, to = mag.size() * (i + 1) / sections;
        const FieldTurns turns(turning, reading_pairs(mag.subspan(from, to - from)));
        if (turns.size() < fewest_pairs) continue;
        const FieldTurns::Unexplained section = turns.unexplained(as_given);
        if (section.std > tolerance) continue;
        const double apart = (section.hard_iron_b - all.hard_iron_b).norm();
        if (apart > tolerance + 3.0 * section.std) return std::nullopt;
        spread = std::max(spread, apart);
        ++judged;
    }
    if (judged < enough_sections) return std::nullopt;
    return ConstantMagnet{all.hard_iron_b, std::max(all.std, spread)};
}

}  // namespace schuler::ahrs
