// The states of a filter: named blocks selected for a run, one meaning per index.
#pragma once

#include "schuler/estim/state.h"

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

namespace schuler::filter {

/// A contiguous group of states with one name. Errors of the first three blocks are in the axes of the mechanization's frame.
struct LayoutBlock {
    std::string_view name;  ///< static text
    std::string_view unit;
    int offset = 0, size = 0;
};

/// Offsets of the error-state blocks. The first five are always present; an absent optional block has offset -1.
class Layout {
public:
    static constexpr int position = 0;            ///< 3, m
    static constexpr int velocity = 3;            ///< 3, m/s
    static constexpr int attitude = 6;            ///< 3, rad
    static constexpr int navigation = 9;          ///< number of states above; the rows of ParameterRow begin with the next one
    static constexpr int gyro_bias = navigation;  ///< 3, rad/s, body
    static constexpr int accel_bias = 12;         ///< 3, m/s^2, body

    int gyro_scale = -1;             ///< 3
    int accel_scale = -1;            ///< 3
    int gyro_misalignment = -1;      ///< 6, rad: sensitivity of x to y and z, y to x and z, z to x and y
    int accel_misalignment = -1;     ///< 6, rad, in the same order
    int gravity_constant = -1;       ///< 3, m/s^2, gravity disturbance in the axes of its model: systematic part
    int gravity_random = -1;         ///< 3, m/s^2, random part
    int gravity_slope = -1;          ///< 3, per metre (or second) along the track: of the random part, or of a polynomial
    int gravity_curvature = -1;      ///< 3, second derivative of the same
    int gravity_before = -1;         ///< 3, m/s^2, clone of the whole disturbance before its last step
    int lever_arm = -1;              ///< 3, m, body
    int mounting = -1;               ///< 2: pitch and yaw of the vehicle's forward axis in body axes, rad
    int axle = -1;                   ///< 1, m, distance of the IMU ahead of the unsteered axle
    int baro_bias = -1;              ///< 1, m
    int mag_bias = -1;               ///< 1, rad, heading offset of the magnetometer
    int hard_iron = -1;              ///< 3, body, Earth's horizontal field = 1: x and y are compass deviation B and C
    int mag_disturbance = -1;        ///< 1, rad, deviation of the magnetic heading that changes within seconds
    int gnss_position = -1;          ///< 3, m, correlated GNSS position error, north-east-down
    int gnss_velocity = -1;          ///< 3, m/s, correlated GNSS velocity error, north-east-down
    int gnss_latency = -1;           ///< 1, s, delay of the fixes' positions beyond the assumed latency
    int gnss_velocity_latency = -1;  ///< 1, s, the same for their velocities, if separate
    int odometer_scale = -1;         ///< 1, scale-factor error of the odometer
    int heading_offset = -1;         ///< 1, rad, offset of the heading sensor relative to the body's forward axis
    int gauge_level = -1;            ///< `gauges`, m, constant error of the height of each
    int gauges = 0;
    int log_scale = -1;         ///< 1, scale-factor error of the velocity log in body axes
    int log_misalignment = -1;  ///< 2, rad, misalignment of the velocity log about the right and down axes
    int clock = -1;             ///< 1, m, c times the receiver's clock error; every clock and offset column of a range is +1
    int drift = -1;             ///< 1, m/s, its rate, which drives the clock
    int rate_noise = -1;        ///< 1, m/s, white error of the clock's rate over an epoch's range rates; reset at each epoch
    int antenna = -1;           ///< 3, m, Earth-fixed: antenna position at the last epoch of carrier phases, a clone
    int phase = -1;             ///< two per tracked carrier, m: phase errors at the end and at the start of the last rate
    int phases = 0;             ///< number of carriers
    int carrier_clock = -1;     ///< 1, m, receiver clock of the carrier phases relative to that of the codes; reset at each epoch
    int ambiguity = -1;         ///< `ambiguities`, m, of the phases of satellites and carriers as they come
    int ambiguities = 0;
    int network = -1;      ///< 1, m, ground stations' common offset
    int intersystem = -1;  ///< 3, m, GLONASS, Galileo, BeiDou relative to the GPS clock
    int source_rate = -1;  ///< slots: slow error of a source's range rate, m/s; slot k belongs to the source of slot k below
    int source = -1;       ///< slots: slow error of a source of ranges, m; the last block
    int size = 0;          ///< total of all blocks

    static constexpr int slots = 30;  ///< of the source blocks
    static constexpr int most_ambiguities = 40;

    /// Position, velocity, attitude and the sensors' biases.
    Layout();

    /// Appends a block of states and returns its offset. Name and unit are static texts. If there is no room, `fits` is false
    /// from then on and the offset is invalid.
    int add(std::string_view name, std::string_view unit, int states);
    [[nodiscard]] bool fits() const { return fits_; }

    [[nodiscard]] std::span<const LayoutBlock> blocks() const { return {blocks_.data(), count_}; }
    /// Leading states that act on position, velocity and attitude during a step: these three, the inertial sensor errors, gravity;
    /// and the lever arm (InertialFilter::fill_transition).
    [[nodiscard]] int driven() const;
    /// Number of states in use without any slot of the source block.
    [[nodiscard]] int without_slots() const { return source < 0 ? size : source; }

private:
    std::array<LayoutBlock, 36> blocks_{};
    std::size_t count_ = 0;
    bool fits_ = true;
};

}  // namespace schuler::filter
