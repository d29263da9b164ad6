// Codes of fix quality as receivers and programs write them.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/io/text/columns.h"

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace schuler::io {

/// The numbers that a fix column holds, with how many rows have each: what decides where the column's name does not.
using CodeCounts = std::map<int, std::size_t>;

/// Counts them, and whether the file has a column of the carrier solution beside it (u-blox).
[[nodiscard]] CodeCounts count_fix_codes(const TextInput& input, const TableLayout& layout, const ColumnPlan& plan);

/// Meaning of the values of a fix column.
class FixCodes {
public:
    /// The table of the column's source: codes in its name (`fix_rtk1fix_2float_5single`, `fix_3is3d`), RTKLIB's for `Q`, VectorNav's
    /// for `fix_vn`, MAVLink's and PX4's for `fix_type`, u-blox's for `fix_type` beside a carrier solution, ArduPilot's or that of ROS
    /// for `status` by the codes that occur, gpsd's for `mode`, else NMEA's quality; a column under another name that holds 3 counts
    /// dimensions, for NMEA's 3 does not occur. `user` (code or word = fix name) comes first.
    /// Throws Error(Input) where a user's value is no fix name, or two sources fit that contradict each other.
    [[nodiscard]] static FixCodes for_column(std::string_view column_name, const std::map<std::string, std::string>& user,
                                             const std::string& file = {}, const CodeCounts& counts = {}, bool carrier = false);

    /// Unknown where the table has no such code or word.
    [[nodiscard]] FixType of(std::string_view field) const;
    /// Which table, for reports: "codes in the column's name", "RTKLIB Q", "NMEA quality", ...
    [[nodiscard]] const std::string& table() const { return table_; }
    /// Decided by the codes that occur, not by the name alone.
    [[nodiscard]] bool by_evidence() const { return by_evidence_; }

private:
    std::map<std::string, FixType, std::less<>> user_;
    std::map<int, FixType> codes_;
    std::string table_;
    bool by_evidence_ = false;
};

/// none, autonomous, differential, rtk_fixed, rtk_float; also fixed, float, single, 3d, dgps, sbas, ppp, ...; nullopt otherwise.
[[nodiscard]] std::optional<FixType> fix_from_word(std::string_view word);
[[nodiscard]] std::string_view name_of(FixType fix);
/// RTKLIB's Q: 1 fix, 2 float, 3 sbas, 4 dgps, 5 single, 6 ppp.
[[nodiscard]] FixType fix_from_rtklib(int q);
/// NMEA 0183 quality of GGA: 0 none, 1 autonomous, 2 differential, 3 PPS, 4 RTK fixed, 5 RTK float, 6 dead reckoning, 7, 8 none.
[[nodiscard]] FixType fix_from_nmea(int quality);

}  // namespace schuler::io
