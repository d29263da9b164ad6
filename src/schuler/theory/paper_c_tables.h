// Numbers printed in section 5 of paper C (roots, periods, tables 1 to 3), compared with the results of its own equations.
#pragma once

#include "schuler/theory/equator.h"

#include <string>
#include <vector>

namespace schuler::theory {

/// A vehicle of the paper's section 5.
struct PaperVehicle {
    std::string name;
    double speed, height;  ///< m/s, m
};
[[nodiscard]] std::vector<PaperVehicle> paper_vehicles();

/// The three sets of initial errors of table 1: 1 m of height, 1.57e-7 rad of latitude, 1.57e-7 rad of longitude.
[[nodiscard]] Vector6 paper_initial_errors(int set);
inline constexpr double paper_time = 3600.0;  ///< s, of tables 2 and 3

/// One printed number.
struct PaperEntry {
    std::string vehicle;
    int set;               ///< I = 1, ...; 0: not part of a set (roots, periods, speeds)
    std::string quantity;  ///< "dvN(3600)", "amplitude of dlambda", ...
    std::string unit;
    std::string printed;  ///< as in the paper, with a decimal point instead of a comma
    double right;         ///< from the corrected equations
    bool agrees;          ///< to the printed digits
    std::string remark;   ///< the discrepancy, or its explanation
};

/// Table 1, the roots and periods, and tables 2 and 3 except their zeros and dashes (zero by structure). The computed amplitudes
/// are positive; the paper's negative ones with a phase shifted by pi are the same oscillation and agree.
[[nodiscard]] std::vector<PaperEntry> paper_tables();

/// Half a unit of the last printed digit of a number such as "-1.2e-3", and its value.
/// @throws Error(Input) if it is not a number.
struct PrintedNumber {
    double value, half_unit;
};
[[nodiscard]] PrintedNumber printed_number(const std::string& text);

}  // namespace schuler::theory
