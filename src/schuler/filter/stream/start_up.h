// Alignment of a stream: level from standstill, heading from the Earth rate, a sensor or the motion, without future data.
#pragma once

#include "schuler/filter/navigator_settings.h"
#include "schuler/filter/states/model.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <optional>

namespace schuler::filter {

/// Takes increments, standstill windows and measurements in time order, and reports the start once it is known.
///
/// At rest: roll and pitch from the mean specific force, the gyro biases from the mean rate if they exceed the Earth rate,
/// heading by gyrocompassing if they are small compared with it. In motion: the gyros maintain a level frame w of unknown azimuth
/// psi; velocity and position integrated in it are fitted to those of the receiver,
///     v_n(t) = R(psi) v_w(t) + b t + v0,   p_n(t) = R(psi) p_w(t) + b t^2/2 + v0 t + p0,
/// linear in (cos psi, sin psi, b, v0, p0), where b is the effect of a tilt on gravity; velocity matching [Groves2013:5.6], by
/// least squares. cos^2 + sin^2 close to one shows that the inertial unit and the receiver observe the same motion.
class StartUp {
public:
    /// Settings are held by reference.
    explicit StartUp(const NavigatorSettings& settings) : settings_(settings) {}

    void add(const ImuIncrement& increment, bool interpolated);
    void add_still(const StillWindow& window);
    /// A fix valid near the end of the last increment; `components` as in Event.
    void add_position(const GnssFix& fix, const FixNoise& noise, Time valid, std::uint8_t components);
    void add_velocity(const GnssFix& fix, const FixNoise& noise, std::uint8_t components);
    /// field_b: any unit, body axes.
    void add_mag(const Eigen::Vector3d& field_b, double declination);
    void add_heading(const HeadingSample& sample);

    [[nodiscard]] Phase phase() const;
    /// The start at the end of the last increment, once known.
    [[nodiscard]] std::optional<Start> ready() const;

    static constexpr int unknowns = 8;  ///< cos psi, sin psi, b (2), v0 (2), p0 (2)
    using Normal = Eigen::Matrix<double, unknowns, unknowns>;
    using Unknowns = Eigen::Matrix<double, unknowns, 1>;

    /// The fit of the motion since `since`.
    struct Fit {
        Time since{};
        Normal N = Normal::Zero();
        Unknowns y = Unknowns::Zero();
        double sum2 = 0.0;  ///< of the normalised measurements
        int rows = 0;
        Eigen::Vector3d v_w = Eigen::Vector3d::Zero(), p_w = Eigen::Vector3d::Zero();  ///< integrated
        bool has_origin = false;
        Geodetic origin{};
    };
    struct Memory {
        bool any_increment = false;
        Time now{}, first{};
        ImuIncrement last{{}, 0.0, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
        Eigen::Vector3d recent_dv = Eigen::Vector3d::Zero();  ///< over about the last second, m/s
        double recent_time = 0.0;
        // standing
        double still = 0.0;  ///< s
        Time still_end{};
        Eigen::Vector3d rate = Eigen::Vector3d::Zero(), force = Eigen::Vector3d::Zero();  ///< sums over it
        // level frame
        bool level = false, level_at_rest = false;
        Eigen::Quaterniond q_wb = Eigen::Quaterniond::Identity();
        double std_level = 0.0;  ///< rad
        Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();
        double std_gyro_bias = 0.0;
        bool at_rest_bias = false;
        Fit fit;
        // fixes
        bool has_position = false, has_velocity = false;
        Geodetic position{};
        Time position_time{};
        Eigen::Vector3d std_position = Eigen::Vector3d::Zero(), velocity = Eigen::Vector3d::Zero(),
                        std_velocity = Eigen::Vector3d::Zero();
        bool has_height = false;
        std::array<bool, 3> velocity_given{};
        Time velocity_time{};
        // heading
        bool has_heading = false;
        bool heading_of_mag = false, heading_of_sensor = false;
        double psi = 0.0, std_heading = 0.0;                                                 ///< rad, of the level frame
        Eigen::Vector2d tilt = Eigen::Vector2d::Zero(), std_tilt = Eigen::Vector2d::Zero();  ///< about north and east, rad
    };
    Memory memory;

private:
    void level_by(const Eigen::Vector3d& force_b, double std, bool at_rest);
    void begin_fit();
    void add_row(const Unknowns& row, double measured, double sigma);
    void solve();
    void course();
    void compass();
    void found(double heading, double std);
    [[nodiscard]] double yaw_in_level() const;
    [[nodiscard]] bool stands() const;
    /// One sigma of the error of levelling by the accelerometers, rad.
    [[nodiscard]] double least_tilt() const;
    [[nodiscard]] bool can_gyrocompass() const;
    [[nodiscard]] Geodetic start_place() const;
    [[nodiscard]] Eigen::Vector3d lever_w() const;
    [[nodiscard]] Start start_with(const Eigen::Quaterniond& q_nb, const Eigen::Vector3d& std_rpy) const;

    const NavigatorSettings& settings_;
};

}  // namespace schuler::filter
