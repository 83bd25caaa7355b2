#include "plan_rest_excitation.h"

#include <cstdio>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::nodes {

int planRestExcitation(const mechanism::Robot& robot, const excitation::RestExcitationOptions& options,
                       const std::string& output) {
  const excitation::RestExcitation rest = excitation::planRestExcitation(robot, options);
  trajectory::writeReference(output, rest.reference,
                             {"movement near rest for " + robot.path + ", seed " + std::to_string(options.seed)});
  const double seconds = rest.reference.period_s * static_cast<double>(rest.reference.points.rows() - 1);
  std::printf("%d strokes at %d places in %.1f s; an actuator stands still for %.0f %% of them\n", rest.strokes,
              static_cast<int>(rest.places.rows()), seconds, 100.0 * rest.resting_share);
  for (const trajectory::Margin& m : rest.check.margins)
    std::printf("  %-20s %10.5g of %-10.5g %s, %.0f %% left\n", trajectory::nameOf(m.quantity), m.value, m.limit,
                trajectory::unitOf(m.quantity), 100.0 * m.left);
  std::printf("written to %s\n", output.c_str());
  return kExitDone;
}

}  // namespace knee_robot::nodes
