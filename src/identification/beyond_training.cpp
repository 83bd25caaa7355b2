#include "knee_robot/identification/beyond_training.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/numbers.h"
#include "other_forces.h"

namespace knee_robot::identification {
namespace {

constexpr double kBeside = 0.1;        ///< of the range in training: so far is not beyond it
constexpr double kLeastShare = 0.005;  ///< of the samples

/// A coordinate of the place, and how a user reads it.
struct Coordinate {
  std::string name, unit;
  double in_unit = 1.0;
};

std::vector<Coordinate> coordinatesOf(const mechanism::Robot& robot) {
  constexpr double kDegree = 360.0 / kTwoPi;
  if (robot.mechanism) return {{"X", "m", 1.0}, {"Z", "m", 1.0}, {"theta", "deg", kDegree}, {"psi", "deg", kDegree}};
  std::vector<Coordinate> out;
  for (int i = 0; i < robot.axes(); ++i) {
    const mechanism::Actuator& a = robot.actuators[static_cast<std::size_t>(i)];
    const std::string name = "the position of " + whoIs(robot, i);
    out.push_back(a.revolute ? Coordinate{name, "deg", kDegree / a.jointRadius()} : Coordinate{name, "m", 1.0});
  }
  return out;
}

bool isKnown(const Observation& o, int n) {
  const std::size_t at = static_cast<std::size_t>(n);
  const bool pose = o.motion.motion.empty() ||
                    (o.motion.pose_known[at] != 0 && (o.motion.uncertain.empty() || o.motion.uncertain[at] == 0));
  return pose && o.isJudged(n);
}

double placeOf(const Observation& o, int n, int coordinate) {
  return o.motion.motion.empty() ? o.signals.position_m(n, coordinate)
                                 : o.motion.motion[static_cast<std::size_t>(n)].pose[coordinate];
}

struct Range {
  double low = INFINITY, high = -INFINITY;
  void take(double place) {
    low = std::min(low, place);
    high = std::max(high, place);
  }
  /// How far beyond, with its sign; 0 within.
  double beyond(double place) const { return place > high ? place - high : place < low ? place - low : 0.0; }
};

/// Of the samples that leave training's ranges by more than a little: how many, and how far in each coordinate.
struct Outside {
  int samples = 0, known = 0;
  std::vector<double> farthest;
};

Outside outsideOf(const Observation& o, const std::vector<Range>& trained) {
  Outside outside;
  outside.farthest.assign(trained.size(), 0.0);
  for (int n = 0; n < o.samples(); ++n) {
    if (!isKnown(o, n)) continue;
    ++outside.known;
    bool out = false;
    for (std::size_t c = 0; c < trained.size(); ++c) {
      const double beyond = trained[c].beyond(placeOf(o, n, static_cast<int>(c)));
      if (std::abs(beyond) <= kBeside * (trained[c].high - trained[c].low)) continue;
      out = true;
      if (std::abs(beyond) > std::abs(outside.farthest[c])) outside.farthest[c] = beyond;
    }
    outside.samples += out ? 1 : 0;
  }
  return outside;
}

std::string sentenceOf(const Observation& o, const std::vector<Coordinate>& coordinates,
                       const std::vector<Range>& trained) {
  const Outside outside = outsideOf(o, trained);
  if (outside.known == 0 || outside.samples < kLeastShare * outside.known) return "";
  std::string where;
  for (std::size_t c = 0; c < coordinates.size(); ++c) {
    const double far = outside.farthest[c];
    if (far == 0.0) continue;
    const Coordinate& in = coordinates[c];
    const double edge = far > 0.0 ? trained[c].high : trained[c].low;
    where += (where.empty() ? "" : ", ") + in.name + " " + shortNumber((edge + far) * in.in_unit, 3) + " " + in.unit +
             " where training ends at " + shortNumber(edge * in.in_unit, 3);
  }
  return shortNumber(100.0 * outside.samples / outside.known, 2) +
         " % of the samples lie beyond the places of training (" + where +
         "): what the model says there is a guess; train on such places, too.";
}

}  // namespace

std::vector<std::string> beyondTraining(const mechanism::Robot& robot, const std::vector<Observation>& training,
                                        const std::vector<Observation>& validation) {
  const std::vector<Coordinate> coordinates = coordinatesOf(robot);
  std::vector<Range> trained(coordinates.size());
  for (const Observation& o : training) {
    for (int n = 0; n < o.samples(); ++n) {
      for (std::size_t c = 0; isKnown(o, n) && c < coordinates.size(); ++c)
        trained[c].take(placeOf(o, n, static_cast<int>(c)));
    }
  }
  std::vector<std::string> sentences;
  for (const Observation& o : validation)
    sentences.push_back(sentenceOf(o, coordinates, trained));
  return sentences;
}

}  // namespace knee_robot::identification
