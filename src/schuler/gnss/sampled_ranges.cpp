#include "schuler/gnss/sampled_ranges.h"

namespace schuler::gnss {

std::vector<Range> satellite_ranges(const RangingLog& log, const RangeEpoch& epoch) {
    std::vector<Range> ranges;
    for (const RangeSample& m : log.of(epoch)) {
        const auto id = satellite_from(log.sources[m.source].name);
        if (log.sources[m.source].station || !id) continue;
        Range r;
        r.satellite = *id;
        r.transmit = epoch.time - Duration::from_seconds(m.pseudorange / speed_of_light);
        r.pseudorange = m.pseudorange + speed_of_light * m.tx_clock;
        r.range_rate = m.range_rate + speed_of_light * m.tx_clock_rate;
        r.frequency = m.frequency;
        r.cn0 = m.cn0;
        r.position = m.tx;
        r.velocity = m.tx_velocity;
        r.variance = m.variance;
        r.noise = m.noise;
        r.sigma = m.std;
        r.sigma_rate = m.std_rate;
        ranges.push_back(r);
    }
    return ranges;
}

}  // namespace schuler::gnss
