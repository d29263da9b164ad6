// Every filter's error dynamics before its three judges (tests/support/error_models.h).
#include "schuler/core/units.h"
#include "schuler/fusion/frame.h"
#include "support/error_models.h"

namespace schuler {
namespace {

SCHULER_ERROR_MODEL(Geographic, "fusion.GeographicFrame.error_n", fusion::GeographicFrame)
SCHULER_ERROR_MODEL(EarthFixed, "fusion.EarthFixedFrame.error_e", fusion::EarthFixedFrame)

}  // namespace
}  // namespace schuler
