// The header of a RINEX observation file, as required by its records. Private to the readers.
#pragma once

#include "schuler/gnss/observation.h"
#include "schuler/io/bytes.h"
#include "schuler/io/rinex/rinex.h"

#include <array>
#include <string>
#include <vector>

namespace schuler::io::detail {

/// Meaning of one field of a satellite line.
struct ObservationType {
    char kind = ' ';         ///< C, L, D, S; blank: not used
    std::size_t signal = 0;  ///< in SystemTypes::signals
    double scale = 1.0;      ///< divisor of the value
};
struct SystemTypes {
    std::vector<ObservationType> types;
    std::vector<gnss::Signal> signals;
};

struct ObservationHeader {
    double version = 0.0;
    char file_system = 'G';  ///< for satellites without a letter (RINEX 2)
    char time_system = 'G';  ///< G, R (UTC), C
    std::array<SystemTypes, gnss::system_count> systems;
};

/// Reads up to END OF HEADER. @throws Error(Input) if it is not that of an observation file of version 2 to 4.
[[nodiscard]] ObservationHeader read_observation_header(Lines& lines, const std::string& name, gnss::ObservationLog& log);

}  // namespace schuler::io::detail
