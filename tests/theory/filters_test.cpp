// Every filter's error dynamics before its three judges (tests/support/error_models.h).
#include "schuler/core/units.h"
#include "schuler/filter/states/frame.h"
#include "support/error_models.h"

namespace schuler {
namespace {

SCHULER_ERROR_MODEL(Geographic, "filter.GeographicFrame.error_n", filter::GeographicFrame)
SCHULER_ERROR_MODEL(EarthFixed, "filter.EarthFixedFrame.error_e", filter::EarthFixedFrame)

}  // namespace
}  // namespace schuler
