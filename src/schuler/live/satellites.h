// Satellites as a receiver reports them beside its fixes: where they are, how strong, which are used.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/gnss/satellite.h"

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::live {

/// One satellite; values that the receiver leaves out are not numbers.
struct SatelliteSeen {
    gnss::SatelliteId id;
    double elevation = not_given, azimuth = not_given;  ///< rad
    double cn0 = not_given;                             ///< dB-Hz, of the strongest signal
    bool used = false;                                  ///< in the receiver's solution
};

/// The satellites of the newest messages. Damaged messages and numbers of no satellite are passed over.
class SatelliteReport {
public:
    /// A GSV or GSA sentence without line end, its checksum verified. Signals of one satellite are merged.
    void nmea(std::string_view sentence);
    /// The sentences of an epoch are complete.
    void nmea_epoch();
    /// A whole NAV-SAT frame, its checksum verified. Afterwards sentences are ignored: the receiver repeats itself in them.
    void ubx(std::string_view frame);
    /// All satellites at once.
    void replace(std::vector<SatelliteSeen> all);

    /// All satellites in order if any were reported since the last call. Systems that are missing for five calls are gone.
    [[nodiscard]] std::optional<std::vector<SatelliteSeen>> renewed();

private:
    struct Group {
        std::vector<SatelliteSeen> seen{}, partial{};
        int next = 1;  ///< sentence of the sequence
        int age = 0;   ///< calls of renewed()
    };
    struct Used {
        std::set<gnss::SatelliteId> all{};
        int age = 0;
    };

    void gsv(const std::vector<std::string_view>& fields);
    void gsa(const std::vector<std::string_view>& fields);

    std::map<std::string, Group, std::less<>> groups_;  ///< by talker and signal
    std::array<std::optional<std::set<gnss::SatelliteId>>, gnss::system_count> naming_;
    std::array<Used, gnss::system_count> used_;
    std::vector<SatelliteSeen> whole_;
    bool binary_ = false, news_ = false;
};

}  // namespace schuler::live
