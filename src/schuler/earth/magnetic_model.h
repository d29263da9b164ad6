// The Earth's magnetic field from spherical harmonics: declination and field as functions of position and date.
#pragma once

#include "schuler/core/position.h"

#include <Eigen/Core>

#include <memory>
#include <string>

namespace schuler::earth {

/// Field at a position, north-east-down, T.
struct MagneticField {
    Eigen::Vector3d field_n;

    [[nodiscard]] double horizontal() const;   ///< T
    [[nodiscard]] double declination() const;  ///< rad, positive east of true north
    [[nodiscard]] double inclination() const;  ///< rad, positive down
};

/// A model in GeographicLib's format [ChulliatWmm2025].
class MagneticModel {
public:
    /// Reads FOLDER/NAME.wmm and NAME.wmm.cof. @throws Error(Input) if they are missing or damaged.
    MagneticModel(const std::string& name, const std::string& folder);
    ~MagneticModel();
    MagneticModel(MagneticModel&&) noexcept;
    MagneticModel& operator=(MagneticModel&&) noexcept;

    /// Field at a decimal year. Outside first_year() to last_year() it is extrapolated linearly.
    [[nodiscard]] MagneticField at(double year, const Geodetic& position) const;
    [[nodiscard]] double first_year() const;
    [[nodiscard]] double last_year() const;

private:
    struct Model;
    std::unique_ptr<Model> model_;
};

}  // namespace schuler::earth
