#include "wrong_units.h"

#include <cmath>

#include "knee_robot/base/numbers.h"
#include "knee_robot/base/words.h"
#include "knee_robot/identification/prior.h"
#include "other_forces.h"

namespace knee_robot::identification {
namespace {

constexpr double kFollows = 0.5;      ///< correlation of a force with the links' own
constexpr double kOtherUnit = 8.0;    ///< of what a URDF says: no link is so far off
constexpr double kOtherOrder = 30.0;  ///< of usual bodies, of which only the order of magnitude is claimed

/// A recorded force against that of the links along the same motion.
struct Against {
  double slope = 1.0, correlation = 0.0;
};

Against compared(const std::vector<Observation>& training, const Eigen::VectorXd& links, int actuator) {
  double measured = 0.0, both = 0.0, own = 0.0;
  for (const Observation& o : training) {
    const Eigen::VectorXd expected_N = o.regressor[static_cast<std::size_t>(actuator)] * links;
    for (int n = 0; n < o.samples(); ++n) {
      if (!o.usable[static_cast<std::size_t>(n)]) continue;
      const double force_N = o.force_filtered_N(n, actuator);
      measured += force_N * force_N;
      both += force_N * expected_N[n];
      own += expected_N[n] * expected_N[n];
    }
  }
  if (measured <= 0.0 || own <= 0.0) return {};
  return {both / own, both / std::sqrt(measured * own)};
}

std::string timesText(double slope) {
  const double times = slope < 1.0 ? 1.0 / slope : slope, step = std::pow(10.0, std::floor(std::log10(times)) - 1.0);
  return shortNumber(std::round(times / step) * step, 9) + (slope < 1.0 ? " times smaller" : " times larger");
}

}  // namespace

std::string doubtAboutUnits(const mechanism::Robot& robot, const std::vector<Column>& columns,
                            const std::vector<Observation>& training) {
  const Prior prior = priorOf(robot, columns, Eigen::VectorXd::Ones(robot.axes()));
  const double most = robot.urdf.empty() ? kOtherOrder : kOtherUnit;
  std::vector<int> who;
  std::vector<double> slopes;
  for (int i = 0; i < robot.axes(); ++i) {
    if (training.front().force_unit[static_cast<std::size_t>(i)] == "A") continue;  // the drive's gain may not be known
    const Against a = compared(training, prior.mean, i);
    if (a.correlation < kFollows || (a.slope < most && a.slope > 1.0 / most)) continue;
    who.push_back(i);
    slopes.push_back(a.slope);
  }
  if (who.empty()) return "";
  std::size_t k = 0;
  return "The recorded force is " +
         joined(who, [&](int i) { return timesText(slopes[k++]) + " at " + whoIs(robot, i); }) +
         " than the weight and inertia of the links " + (robot.urdf.empty() ? "of usual bodies" : "by the URDF") +
         ", which it follows: is it in another unit than its column says (kN, V, A), or " +
         (robot.urdf.empty() ? "is the geometry in another one (mm)?" : "is the URDF in another one (g, mm)?");
}

}  // namespace knee_robot::identification
