// Codes of fix quality used by receivers and programs.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/io/text/columns.h"

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace schuler::io {

/// The numbers in a fix column, with the number of rows for each: decides if the column's name is ambiguous.
using CodeCounts = std::map<int, std::size_t>;

/// Counts them, and whether the file also has a column of the carrier solution (u-blox).
[[nodiscard]] CodeCounts count_fix_codes(const TextInput& input, const TableLayout& layout, const ColumnPlan& plan);

/// Meaning of the values of a fix column.
class FixCodes {
public:
    /// The code table of the column: codes in its name (`fix_rtk1fix_2float_5single`, `fix_3is3d`), RTKLIB's for `Q`, VectorNav's
    /// for `fix_vn`, MAVLink's and PX4's for `fix_type`, u-blox's for `fix_type` beside a carrier solution, ArduPilot's or that
    /// of ROS for `status` by the codes present, gpsd's for `mode`, else NMEA's quality; a column of another name that contains 3
    /// counts dimensions, because NMEA's 3 does not occur. `user` (code or word = fix name) takes precedence.
    /// Throws Error(Input) if a user's value is not a fix name, or two contradictory tables match.
    [[nodiscard]] static FixCodes for_column(std::string_view column_name, const std::map<std::string, std::string>& user,
                                             const std::string& file = {}, const CodeCounts& counts = {}, bool carrier = false);

    /// Unknown if the code or word is not in the table.
    [[nodiscard]] FixType of(std::string_view field) const;
    /// The table used, for reports: "codes in the column's name", "RTKLIB Q", "NMEA quality", ...
    [[nodiscard]] const std::string& table() const { return table_; }
    /// Decided by the codes present, not by the name alone.
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
