// The gravity disturbance from spherical harmonics.
#pragma once

#include "schuler/core/position.h"

#include <Eigen/Core>

#include <memory>
#include <string>

namespace schuler::earth {

/// A gravity model in GeographicLib's format (egm96, egm2008, ...), not supplied with the program.
class GravityField {
public:
    /// Reads FOLDER/NAME.egm and NAME.egm.cof; if the folder is empty, from the default folder of GeographicLib's tools.
    /// @throws Error(Input) if they are missing or damaged.
    GravityField(const std::string& name, const std::string& folder);
    ~GravityField();
    GravityField(GravityField&&) noexcept;
    GravityField& operator=(GravityField&&) noexcept;

    /// Gravity minus the normal gravity of the model's own ellipsoid, north, east, down, m/s^2.
    [[nodiscard]] Eigen::Vector3d disturbance_n(const Geodetic& position) const;

private:
    struct Model;
    std::unique_ptr<Model> model_;
};

}  // namespace schuler::earth
