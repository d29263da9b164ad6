// Position and velocity columns shared by GNSS and reference tables. Private to the readers.
#pragma once

#include "schuler/core/position.h"
#include "schuler/io/text/detail/sample_rows.h"

#include <Eigen/Core>

#include <cmath>

namespace schuler::io::detail {

/// Latitude, longitude and height or Earth-fixed coordinates, and velocity, of one row.
class PositionColumns {
public:
    /// Requests the available columns. Throws if `required` and there is neither a geodetic nor an Earth-fixed position.
    PositionColumns(SampleColumns& columns, bool required);

    [[nodiscard]] bool has_position() const { return geodetic_ || ecef_; }
    /// The position; NaN members if the row has none. Throws Error on absurd values.
    [[nodiscard]] Geodetic position(const TableReader& row) const;
    [[nodiscard]] Eigen::Vector3d velocity_n(const TableReader& row) const;
    [[nodiscard]] std::size_t height_field() const { return height_; }
    /// The first field without a number, of a position in degrees that lacks one.
    [[nodiscard]] std::size_t missing_field(const Geodetic& p) const {
        return std::isnan(p.lat) ? lat_ : std::isnan(p.lon) ? lon_ : height_;
    }

private:
    bool geodetic_ = false, ecef_ = false;
    std::string section_;
    std::size_t lat_, lon_, height_;
    std::size_t x_, y_, z_;
    std::size_t vn_, ve_, vd_;
};

/// The number of an optional field; NaN if the column is absent.
[[nodiscard]] inline double optional_number(const TableReader& row, std::size_t field) {
    return field == SampleColumns::absent ? std::numeric_limits<double>::quiet_NaN() : row.number(field);
}

}  // namespace schuler::io::detail
