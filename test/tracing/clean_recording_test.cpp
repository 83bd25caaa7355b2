#include "test/tracing/simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

TEST(Trace, LeavesACleanRecordingAlone) {
  const TracedCase c = traceSimulated("");
  EXPECT_TRUE(c.result.effects.empty());
  for (int i = 0; i < 4; ++i)
    EXPECT_LT(c.result.before_rms_N[i], 1.3 * c.result.floor_N[i]) << "actuator " << i + 1;
}

}  // namespace
}  // namespace knee_robot::tracing
