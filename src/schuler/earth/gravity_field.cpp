#include "schuler/earth/gravity_field.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"

#include <GeographicLib/GravityModel.hpp>

#include <exception>

namespace schuler::earth {

struct GravityField::Model {
    Model(const std::string& name, const std::string& folder) : harmonics(name, folder) {}
    GeographicLib::GravityModel harmonics;
};

GravityField::GravityField(const std::string& name, const std::string& folder) {
    try {
        model_ = std::make_unique<Model>(name, folder);
    } catch (const std::exception& e) {
        const std::string where = folder.empty() ? GeographicLib::GravityModel::DefaultGravityPath() : folder;
        throw input_error(e.what(), {where + "/" + name + ".egm", 0, 0, {}},
                          "install the model with geographiclib-get-gravity, or name its folder");
    }
}

GravityField::~GravityField() = default;
GravityField::GravityField(GravityField&&) noexcept = default;
GravityField& GravityField::operator=(GravityField&&) noexcept = default;

Eigen::Vector3d GravityField::disturbance_n(const Geodetic& p) const {
    double east, north, up;
    model_->harmonics.Disturbance(p.lat / units::deg, p.lon / units::deg, p.h, east, north, up);
    return {north, east, -up};
}

}  // namespace schuler::earth
