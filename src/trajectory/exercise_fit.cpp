#include "exercise_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace knee_robot {
namespace {

constexpr double kFineTranslation = 0.002;  ///< m between poses that are looked at
constexpr double kFineRotation = 0.00873;   ///< rad
constexpr double kCoarse = 10.0;            ///< times as far while a start is searched
constexpr double kTiltCost = 0.5;           ///< share of a limit that a rad of tilt at the start must win

Margin nearestOnWay(const Exercise& exercise, const Robot& robot, const Pose& start, double amplitude, double spacing) {
  const double condition_max = planningCondition(robot);
  Pose pose = start;
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

}  // namespace

Margin nearestOnWay(const Exercise& exercise, const Robot& robot, const Pose& start, double amplitude) {
  return nearestOnWay(exercise, robot, start, amplitude, 1.0);
}

Pose bestStart(const Exercise& exercise, const Robot& robot, double amplitude) {
  const auto turns = [&](int axis) {
    return std::any_of(exercise.strokes.begin(), exercise.strokes.end(), [&](const auto& s) { return s.axis == axis; });
  };
  const std::vector<double> tilts = {0.0, 0.1, -0.1, 0.2, -0.2, 0.3, -0.3};
  const std::vector<double> level = {0.0};
  const double z_low = 0.5 * robot.actuators[3].position_min_m, z_high = robot.actuators[3].position_max_m;
  Pose best(exercise.start_x.value_or(0.0), 0.5 * (z_low + z_high), 0.0, 0.0);
  double best_score = -std::numeric_limits<double>::infinity();
  for (const double theta : turns(2) ? level : tilts) {
    for (const double psi : turns(3) ? level : tilts) {
      for (double x = -0.3; x < 0.301; x += exercise.start_x ? 1.0 : 0.05) {
        for (double z = z_low; z < z_high; z += 0.025) {
          const Pose start(exercise.start_x.value_or(x), z, theta, psi);
          const double cost = kTiltCost * (std::abs(theta) + std::abs(psi));
          // The start alone bounds what the way can reach: most of the grid is done with here.
          const double at_start = nearestLimit(robot, start, planningCondition(robot)).left;
          if (at_start - cost <= best_score) continue;
          const double left = nearestOnWay(exercise, robot, start, amplitude, kCoarse).left;
          const double score = left - cost;
          if (score <= best_score) continue;
          best_score = score;
          best = start;
        }
      }
    }
  }
  return best;
}

double largestAmplitude(const Exercise& exercise, const Robot& robot, const Pose& start, double asked) {
  double fits = 0.0, beyond = asked;
  while (beyond - fits > 0.0005 * asked) {
    const double middle = 0.5 * (fits + beyond);
    (nearestOnWay(exercise, robot, start, middle).left >= 0.0 ? fits : beyond) = middle;
  }
  // What is told to the user in three digits (of degrees for a rotation) must fit too.
  const double unit = exercise.rotation ? 3.14159265358979323846 / 180.0 : 1.0;
  if (fits <= 0.0) return 0.0;
  const double scale = std::pow(10.0, 2.0 - std::floor(std::log10(fits / unit)));
  return std::floor(fits / unit * scale) / scale * unit;
}

}  // namespace knee_robot
