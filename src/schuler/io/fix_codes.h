// Codes of fix quality as receivers and programs write them.
#pragma once

#include "schuler/core/samples.h"

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace schuler::io {

/// Meaning of the values of a fix column.
class FixCodes {
public:
    /// The table that the column's name suggests: codes in the name (`fix_rtk1fix_2float_5single`, `fix_3is3d`), RTKLIB's for
    /// `Q`, VectorNav's for `fix_vn`, MAVLink's for `fix_type`, else NMEA's quality. `user` (code or word = fix name) comes first.
    /// Throws Error(Input) where a user's value is no fix name.
    [[nodiscard]] static FixCodes for_column(std::string_view column_name, const std::map<std::string, std::string>& user,
                                             const std::string& file = {});

    /// Unknown where the table has no such code or word.
    [[nodiscard]] FixType of(std::string_view field) const;
    /// Which table, for reports: "codes in the column's name", "RTKLIB Q", "NMEA quality", ...
    [[nodiscard]] const std::string& table() const { return table_; }

private:
    std::map<std::string, FixType, std::less<>> user_;
    std::map<int, FixType> codes_;
    std::string table_;
};

/// none, autonomous, differential, rtk_fixed, rtk_float; also fixed, float, single, 3d, dgps, sbas, ppp, ...; nullopt otherwise.
[[nodiscard]] std::optional<FixType> fix_from_word(std::string_view word);
[[nodiscard]] std::string_view name_of(FixType fix);
/// RTKLIB's Q: 1 fix, 2 float, 3 sbas, 4 dgps, 5 single, 6 ppp.
[[nodiscard]] FixType fix_from_rtklib(int q);
/// NMEA 0183 quality of GGA: 0 none, 1 autonomous, 2 differential, 3 PPS, 4 RTK fixed, 5 RTK float, 6 dead reckoning, 7, 8 none.
[[nodiscard]] FixType fix_from_nmea(int quality);

}  // namespace schuler::io
