#include "knee_robot/trajectory/exercise_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "knee_robot/base/constants.h"

namespace knee_robot::trajectory {
namespace {

constexpr double kFineTranslation = 0.002;  ///< m between poses that are looked at
constexpr double kFineRotation = 0.00873;   ///< rad
constexpr double kCoarse = 10.0;            ///< times as far while a start is searched
constexpr int kAmplitudeRounds = 7;         ///< of bisection while the start is searched with the amplitude
constexpr double kTiltCost = 0.5;           ///< share of a limit that a rad of tilt at the start must win

Margin searchWay(const Exercise& exercise, const mechanism::Robot& robot, const mechanism::Pose& start,
                 double amplitude, double spacing) {
  const double condition_max = planningCondition(robot);
  mechanism::Pose pose = start;
  Margin nearest = nearestLimit(robot, pose, condition_max);
  for (const ExerciseStroke& stroke : exercise.strokes) {
    const double distance = stroke.share * amplitude;
    const double step = spacing * (stroke.axis < 2 ? kFineTranslation : kFineRotation);
    const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(distance) / step)));
    const double from = pose[stroke.axis];
    for (int k = 1; k <= steps; ++k) {
      pose[stroke.axis] = from + distance * k / steps;
      const Margin here = nearestLimit(robot, pose, condition_max);
      if (here.left < nearest.left) nearest = here;
    }
  }
  return nearest;
}

/// A start pose and how good it is: the share of a limit that is left on the whole way, less a price for tilt.
struct Start {
  mechanism::Pose pose = mechanism::Pose::Zero();
  double score = -std::numeric_limits<double>::infinity();
};

/// Looks for the best start of one exercise at one amplitude.
class StartSearch {
 public:
  StartSearch(const Exercise& exercise, const mechanism::Robot& robot, double amplitude)
      : exercise_(exercise), robot_(robot), amplitude_(amplitude) {}

  Start search() {
    const double z_low = 0.5 * robot_.actuators[3].position_min_m, z_high = robot_.actuators[3].position_max_m;
    const std::vector<double> tilts = {0.0, 0.1, -0.1, 0.2, -0.2, 0.3, -0.3}, level = {0.0};
    for (const double theta : turns(2) ? level : tilts) {
      for (const double psi : turns(3) ? level : tilts) {
        for (double x = -0.3; x < 0.301; x += exercise_.start_x ? 1.0 : 0.05) {
          for (double z = z_low; z < z_high; z += 0.025)
            tryStart({exercise_.start_x.value_or(x), z, theta, psi});
        }
      }
    }
    refine();
    return best_;
  }

 private:
  bool turns(int axis) const {
    return std::any_of(exercise_.strokes.begin(), exercise_.strokes.end(),
                       [&](const auto& s) { return s.axis == axis; });
  }

  void tryStart(const mechanism::Pose& pose) {
    const double cost = kTiltCost * (std::abs(pose[2]) + std::abs(pose[3]));
    // The start alone bounds what the way can reach: most of the grid is done with here.
    if (nearestLimit(robot_, pose, planningCondition(robot_)).left - cost <= best_.score) return;
    const double score = searchWay(exercise_, robot_, pose, amplitude_, kCoarse).left - cost;
    if (score > best_.score) best_ = {pose, score};
  }

  /// Steps along Xm and Zm, halved when they no longer help.
  void refine() {
    for (double step = 0.0125; step > 0.0003;) {
      const double before = best_.score;
      const mechanism::Pose from = best_.pose;
      for (const double sign : {-1.0, 1.0}) {
        if (!exercise_.start_x) tryStart(from + mechanism::Pose(sign * step, 0.0, 0.0, 0.0));
        tryStart(from + mechanism::Pose(0.0, sign * step, 0.0, 0.0));
      }
      if (best_.score <= before) step *= 0.5;
    }
  }

  const Exercise& exercise_;
  const mechanism::Robot& robot_;
  double amplitude_;
  Start best_;
};

}  // namespace

Margin nearestOnWay(const Exercise& exercise, const mechanism::Robot& robot, const mechanism::Pose& start,
                    double amplitude) {
  return searchWay(exercise, robot, start, amplitude, 1.0);
}

mechanism::Pose startThatFitsMost(const Exercise& exercise, const mechanism::Robot& robot, double amplitude) {
  mechanism::Pose start = StartSearch(exercise, robot, amplitude).search().pose;
  if (nearestOnWay(exercise, robot, start, amplitude).left >= 0.0) return start;
  mechanism::Pose fitting = start;
  double fits = 0.0, beyond = amplitude;
  for (int round = 0; round < kAmplitudeRounds; ++round) {
    const double middle = 0.5 * (fits + beyond);
    const mechanism::Pose found = StartSearch(exercise, robot, middle).search().pose;
    if (nearestOnWay(exercise, robot, found, middle).left >= 0.0) {
      fits = middle;
      fitting = found;
    } else {
      beyond = middle;
    }
  }
  return fitting;
}

double largestAmplitude(const Exercise& exercise, const mechanism::Robot& robot, const mechanism::Pose& start,
                        double asked) {
  double fits = 0.0, beyond = asked;
  while (beyond - fits > 0.0005 * asked) {
    const double middle = 0.5 * (fits + beyond);
    (nearestOnWay(exercise, robot, start, middle).left >= 0.0 ? fits : beyond) = middle;
  }
  // What is told to the user in three digits (of degrees for a rotation) must fit too.
  const double unit = exercise.rotation ? kDegree : 1.0;
  if (fits <= 0.0) return 0.0;
  const double scale = std::pow(10.0, 2.0 - std::floor(std::log10(fits / unit)));
  return std::floor(fits / unit * scale) / scale * unit;
}

}  // namespace knee_robot::trajectory
