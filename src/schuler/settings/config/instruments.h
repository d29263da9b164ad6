// Survey instruments other than IMU and receiver: their files, and their errors as assumed by the filter.
#pragma once

#include "schuler/core/samples.h"

#include <string>
#include <vector>

namespace schuler::settings {

/// Sections [gauges], [log] and [compass] of dataset.toml; an empty file: no such instrument. One sigma; white errors at every
/// sample, the others constant.
struct InstrumentsConfig {
    struct {
        std::string file;                                                    ///< time_s, height_1_m [, height_2_m, height_3_m]
        double white = 0.05, bias = 10.0;                                    ///< m
        std::vector<Eigen::Vector3d> lever_arms_b{Eigen::Vector3d::Zero()};  ///< IMU to gauge, m
    } gauges;
    struct {
        std::string file;                                       ///< time_s, vel_x_m_s, vel_y_m_s, vel_z_m_s
        double white = 0.02;                                    ///< m/s
        double scale = 0.005, misalignment = 0.005;             ///< misalignment in rad
        Eigen::Vector3d lever_arm_b = Eigen::Vector3d::Zero();  ///< IMU to log, m
    } log;
    struct {
        std::string file;                  ///< time_s, heading_deg
        double white = 0.01, bias = 0.02;  ///< rad
    } compass;
};

}  // namespace schuler::settings
