#include "schuler/fusion/detail/loose_run_impl.h"

namespace schuler::fusion {

template Result run_pass_in<GeographicFrame>(const RunData&, const Settings&, const Layout&, const Start&, const PassOptions&);
template StartEstimate smooth_start_in<GeographicFrame>(const RunData&, const Settings&, const Layout&, const Start&, std::size_t);

}  // namespace schuler::fusion
