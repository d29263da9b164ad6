#include "schuler/fusion/detail/loose_run_impl.h"

namespace schuler::fusion {

template Result run_pass_in<EarthFixedFrame>(const RunData&, const Settings&, const Layout&, const Start&, const PassOptions&);

}  // namespace schuler::fusion
