// RINEX files, versions 2, 3 and 4: observations and broadcast navigation [RINEX304], [RINEX400], [RINEX211].
#pragma once

#include "schuler/core/log.h"
#include "schuler/gnss/ephemeris.h"
#include "schuler/gnss/observation.h"
#include "schuler/io/text/text_input.h"

#include <cstddef>

namespace schuler::io {

/// Number of records of a file by result.
struct RecordCounts {
    std::size_t read = 0;      ///< used
    std::size_t bad = 0;       ///< damaged, truncated or absurd: skipped
    std::size_t repeated = 0;  ///< epochs not later than the previous one, ephemerides already present: skipped
    std::size_t foreign = 0;   ///< of an unused kind: skipped
    long first_bad_line = 0;   ///< line (text) or byte (binary) of the first bad one

    void count_bad(long place) {
        if (bad++ == 0) first_bad_line = place;
    }
};

enum class RinexKind { None, Observation, Navigation, CompactObservation };

/// By the header's first lines. Never throws on content.
[[nodiscard]] RinexKind rinex_kind(const TextInput& input);

struct RinexObservations {
    gnss::ObservationLog log;
    RecordCounts records;       ///< epochs
    std::size_t bad_lines = 0;  ///< satellite lines skipped inside good epochs
};

/// Reads observations in one pass; also gz-compressed files, and Hatanaka-compressed ones if the program crx2rnx is installed.
/// Times are converted to GPS time. A damaged epoch or satellite line is skipped, counted and reported with its line in the log.
/// @throws Error(Input): no RINEX observation file, no usable epoch, crx2rnx missing or failing.
[[nodiscard]] RinexObservations read_rinex_observations(const TextInput& input, WarningLog& log);

struct RinexNavigation {
    gnss::Navigation navigation;
    RecordCounts records;
};

/// Reads ephemerides (LNAV, I/NAV, F/NAV, D1, D2, GLONASS FDMA, SBAS) and ionosphere coefficients; CNAV families are counted as
/// foreign. Damaged records are skipped, counted and reported in the log.
/// @throws Error(Input): no RINEX navigation file, no usable ephemeris.
[[nodiscard]] RinexNavigation read_rinex_navigation(const TextInput& input, WarningLog& log);

}  // namespace schuler::io
