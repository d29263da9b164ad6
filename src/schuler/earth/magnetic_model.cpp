#include "schuler/earth/magnetic_model.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"

#include <GeographicLib/MagneticModel.hpp>

#include <cmath>
#include <exception>

namespace schuler::earth {

struct MagneticModel::Model {
    Model(const std::string& name, const std::string& folder) : harmonics(name, folder) {}
    GeographicLib::MagneticModel harmonics;
};

double MagneticField::horizontal() const { return field_n.head<2>().norm(); }
double MagneticField::declination() const { return std::atan2(field_n.y(), field_n.x()); }
double MagneticField::inclination() const { return std::atan2(field_n.z(), horizontal()); }

MagneticModel::MagneticModel(const std::string& name, const std::string& folder) {
    try {
        model_ = std::make_unique<Model>(name, folder);
    } catch (const std::exception& e) {
        throw input_error(e.what(), {folder + "/" + name + ".wmm", 0, 0, {}}, "install the program's data files again");
    }
}

MagneticModel::~MagneticModel() = default;
MagneticModel::MagneticModel(MagneticModel&&) noexcept = default;
MagneticModel& MagneticModel::operator=(MagneticModel&&) noexcept = default;

namespace {
constexpr double nanotesla = 1e-9;
}

MagneticField MagneticModel::at(double year, const Geodetic& position) const {
    double east, north, up;
    model_->harmonics(year, position.lat / units::deg, position.lon / units::deg, position.h, east, north, up);
    return {Eigen::Vector3d(north, east, -up) * nanotesla};
}

double MagneticModel::first_year() const { return model_->harmonics.MinTime(); }
double MagneticModel::last_year() const { return model_->harmonics.MaxTime(); }

}  // namespace schuler::earth
