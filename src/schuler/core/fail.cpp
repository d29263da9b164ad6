#include "schuler/core/fail.h"

namespace schuler {

void fail(Error error) { throw error; }  // NOLINT(performance-unnecessary-value-param): thrown as it is

}  // namespace schuler
