// What paper C prints in its section 5 (roots, periods, tables 1 to 3), beside what its own equations give.
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

/// The three sets of initial errors of table 1: 1 m of height, 1.57e-7 rad of latitude, the same of longitude.
[[nodiscard]] Vector6 paper_initial_errors(int set);
inline constexpr double paper_time = 3600.0;  ///< s, of tables 2 and 3

/// One printed number.
struct PaperEntry {
    std::string vehicle;
    int set;               ///< I = 1, ...; 0: not of a set (roots, periods, speeds)
    std::string quantity;  ///< "dvN(3600)", "amplitude of dlambda", ...
    std::string unit;
    std::string printed;  ///< as in the paper, decimal point instead of comma
    double right;         ///< from the corrected equations
    bool agrees;          ///< to the digits printed
    std::string remark;   ///< what is off, or how to read it
};

/// Table 1, the roots and periods, and tables 2 and 3 except their zeros and dashes (zero by structure). Amplitudes are positive
/// on the right; the paper's negative ones with a phase shifted by pi are the same oscillation and agree.
[[nodiscard]] std::vector<PaperEntry> paper_tables();

/// Half a unit of the last printed digit of a number such as "-1.2e-3", and its value.
/// @throws Error(Input) where it is no number.
struct PrintedNumber {
    double value, half_unit;
};
[[nodiscard]] PrintedNumber printed_number(const std::string& text);

}  // namespace schuler::theory
