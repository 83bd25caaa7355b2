#include "knee_robot/excitation/rest_excitation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/trajectory/exercise_fit.h"
#include "knee_robot/trajectory/profiles.h"

namespace knee_robot::excitation {
namespace {

using mechanism::Lengths;
using trajectory::kStreamPeriod;

constexpr double kShortest_m = 3e-5, kLongest_m = 8e-3;
constexpr int kSizes = 8;  ///< between these, in equal ratios
constexpr double kSlowest_m_per_s = 3e-4;
constexpr double kWays = 2.0;  ///< times as fast as the fastest strokes
constexpr double kBriefest_s = 0.2, kLongestStop_s = 3.0;
constexpr double kAtEnds_s = 1.0;    ///< at rest, so that the recording shows with which load it begins
constexpr double kLimitShare = 0.9;  ///< of the robot file's velocity and acceleration
constexpr double kAcceleration_m_per_s2 = 0.1, kJerk_m_per_s3 = 1.0;
constexpr double kLeastAtAPlace_s = 5.0;
constexpr double kRoom = 0.1;  ///< share of every limit that a place keeps
constexpr int kPlaceCandidates = 400;
constexpr int kPlaceTries = 12;                              ///< each with places closer together
constexpr double kPlacesCloser = 0.8;                        ///< than those before, whose ways broke a limit
const mechanism::Vector4 kPlaceReach(0.08, 0.08, 0.2, 0.3);  ///< of poses about the centre, m and rad

void refuseOptions(const mechanism::Robot& robot, const RestExcitationOptions& options) {
  const auto demand = [](bool holds, const std::string& sentence) {
    if (!holds) throw InputError(sentence);
  };
  demand(!robot.chain, robot.path + " describes a chain; movements near rest are planned for actuators with lengths");
  demand(options.places >= 1 && options.places <= 20,
         "places " + std::to_string(options.places) + " is not in 1 to 20");
  demand(options.duration_s >= 10.0 && options.duration_s <= 3600.0,
         "duration " + shortNumber(options.duration_s) + " is not in 10 to 3600 s");
  demand(options.velocity_max > kSlowest_m_per_s && options.velocity_max <= 0.1,
         "velocity " + shortNumber(options.velocity_max) + " is not in (" + shortNumber(kSlowest_m_per_s) +
             ", 0.1] m/s: this is a movement near rest");
  demand(!options.condition_max || (*options.condition_max > 1.0 && *options.condition_max <= 1e6),
         "the singularity margin is not in (1, 1e6]");
}

/// One try: its dice, and how fast things may go.
class Planner {
 public:
  Planner(const mechanism::Robot& robot, const RestExcitationOptions& options)
      : robot_(robot), options_(options), random_(options.seed) {
    robot_.singularity_condition_max =
        std::min(robot.singularity_condition_max, options.condition_max.value_or(trajectory::planningCondition(robot)));
    velocity_ = options.velocity_max;
    way_velocity_ = kWays * velocity_;
    acceleration_ = kAcceleration_m_per_s2;
    for (const mechanism::Actuator& a : robot.actuators) {
      velocity_ = std::min(velocity_, kLimitShare * a.velocity_max_m_per_s);
      way_velocity_ = std::min(way_velocity_, kLimitShare * a.velocity_max_m_per_s);
      acceleration_ = std::min(acceleration_, kLimitShare * a.acceleration_max_m_per_s2);
    }
    if (!robot.mechanism) return;
    const trajectory::Exercise nothing{"movement near rest", "", false, 0.0, {}, std::nullopt};
    centre_ = trajectory::startThatFitsMost(nothing, robot_, 0.0);
  }

  const mechanism::Robot& robot() const { return robot_; }

  /// Lengths of places, the centre first, each as far as possible from those before; fewer where there is no room.
  std::vector<Lengths> places(double reach) {
    std::vector<Lengths> candidates = {atCentre()}, chosen;
    for (int k = 0; k < kPlaceCandidates; ++k) {
      Lengths q;
      if (somewhere(reach, q)) candidates.push_back(q);
    }
    if (!hasRoom(candidates.front())) return {};
    chosen.push_back(candidates.front());
    while (static_cast<int>(chosen.size()) < options_.places) {
      const auto apart = [&](const Lengths& q) {
        double least = std::numeric_limits<double>::infinity();
        for (const Lengths& other : chosen)
          least = std::min(least, (q - other).norm());
        return least;
      };
      const auto farthest = std::max_element(candidates.begin(), candidates.end(),
                                             [&](const Lengths& a, const Lengths& b) { return apart(a) < apart(b); });
      if (apart(*farthest) < kLongest_m) break;
      chosen.push_back(*farthest);
    }
    return chosen;
  }

  /// The whole movement over places; `rest.strokes` are counted. Empty when ways alone take too long.
  trajectory::Points movement(const std::vector<Lengths>& places, RestExcitation& rest) {
    std::vector<Lengths> rows;
    std::vector<std::vector<Lengths>> ways;
    std::size_t on_ways = 0;
    for (std::size_t k = 1; k < places.size(); ++k) {
      ways.push_back(way(places[k - 1], places[k]));
      on_ways += ways.back().size();
    }
    const double left_s = options_.duration_s - kStreamPeriod * static_cast<double>(on_ways);
    const double each_s = left_s / static_cast<double>(places.size());
    if (each_s < kLeastAtAPlace_s) return {};
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (k > 0) rows.insert(rows.end(), ways[k - 1].begin(), ways[k - 1].end());
      const std::size_t from = rows.size();
      rows.resize(from + static_cast<std::size_t>(std::lround(each_s / kStreamPeriod)), places[k]);
      for (int i = 0; i < robot_.axes(); ++i)
        rest.strokes += addStrokes(i, from, rows);
    }
    trajectory::Points points = trajectory::Points::Zero(static_cast<Eigen::Index>(rows.size()), 4);
    for (std::size_t n = 0; n < rows.size(); ++n)
      points.row(static_cast<Eigen::Index>(n)) = rows[n].transpose();
    return points;
  }

 private:
  double uniform(double least, double most) { return std::uniform_real_distribution<double>(least, most)(random_); }
  double logUniform(double least, double most) { return std::exp(uniform(std::log(least), std::log(most))); }

  Lengths atCentre() const {
    if (robot_.mechanism) return mechanism::legLengths(*robot_.mechanism, centre_);
    Lengths q = Lengths::Zero();
    for (int i = 0; i < robot_.axes(); ++i) {
      const mechanism::Actuator& a = robot_.actuators[static_cast<std::size_t>(i)];
      q[i] = 0.5 * (a.position_min_m + a.position_max_m);
    }
    return q;
  }

  /// A place within `reach` (1: the whole of kPlaceReach, or of an axis' range) with room around it; false: it has none.
  bool somewhere(double reach, Lengths& q) {
    q = atCentre();
    if (robot_.mechanism) {
      mechanism::Pose pose = centre_;
      for (int i = 0; i < 4; ++i)
        pose[i] += reach * kPlaceReach[i] * uniform(-1.0, 1.0);
      q = mechanism::legLengths(*robot_.mechanism, pose);
      return hasRoom(q) && trajectory::nearestLimit(robot_, pose, robot_.singularity_condition_max).left > kRoom;
    }
    for (int i = 0; i < robot_.axes(); ++i) {
      const mechanism::Actuator& a = robot_.actuators[static_cast<std::size_t>(i)];
      q[i] += 0.5 * reach * (a.position_max_m - a.position_min_m) * uniform(-1.0, 1.0);
    }
    return hasRoom(q);
  }

  /// For the longest stroke.
  bool hasRoom(const Lengths& q) const {
    for (int i = 0; i < robot_.axes(); ++i) {
      const mechanism::Actuator& a = robot_.actuators[static_cast<std::size_t>(i)];
      if (q[i] - kLongest_m < a.position_min_m || q[i] + kLongest_m > a.position_max_m) return false;
    }
    return true;
  }

  trajectory::PointToPoint profile(double distance, double velocity) const {
    return {distance, {velocity, acceleration_, kJerk_m_per_s3}};
  }

  /// Straight in actuator lengths; rows after `from` up to `to`.
  std::vector<Lengths> way(const Lengths& from, const Lengths& to) const {
    const double longest = (to - from).cwiseAbs().maxCoeff();
    const trajectory::PointToPoint along = profile(longest, way_velocity_);
    const long steps = static_cast<long>(std::ceil(along.duration() / kStreamPeriod));
    std::vector<Lengths> rows;
    for (long k = 1; k <= steps; ++k)
      rows.push_back(from + (to - from) * (along.at(static_cast<double>(k) * kStreamPeriod).position / longest));
    return rows;
  }

  /// Adds strokes of axis i to the rows from `from` on, which stand at its place; returns how many. It comes back to
  /// its place at the end.
  int addStrokes(int i, std::size_t from, std::vector<Lengths>& rows) {
    const double place = rows[from][i];
    double offset = 0.0;
    const auto rowsOf = [](double seconds) { return static_cast<std::size_t>(std::lround(seconds / kStreamPeriod)); };
    std::size_t now = from + rowsOf(kAtEnds_s + uniform(0.0, 0.5));
    const std::size_t end = rows.size() - rowsOf(kAtEnds_s);
    std::vector<int>& deck = decks_[static_cast<std::size_t>(i)];
    int strokes = 0;
    while (true) {
      const trajectory::PointToPoint back = profile(-offset, velocity_);
      const trajectory::PointToPoint next = profile(drawn(offset, deck), logUniform(kSlowest_m_per_s, velocity_));
      const double stop_s = logUniform(kBriefest_s, kLongestStop_s);
      const double reached = offset + next.at(next.duration()).position;
      const double after_s = next.duration() + stop_s + profile(-reached, velocity_).duration();
      const bool last = now + rowsOf(after_s) > end;
      const trajectory::PointToPoint& stroke = last ? back : next;
      const double start = offset;
      for (std::size_t n = now; n < rows.size(); ++n)
        rows[n][i] = place + start + stroke.at(kStreamPeriod * static_cast<double>(n - now)).position;
      ++strokes;
      if (last) return strokes;
      offset = reached;
      now += rowsOf(next.duration() + stop_s);
    }
  }

  /// A way that stays within kLongest_m of the place. Sizes come from a deck, so that each axis gets all of them.
  double drawn(double offset, std::vector<int>& deck) {
    if (deck.empty()) {
      deck.resize(kSizes);
      std::iota(deck.begin(), deck.end(), 0);
      std::shuffle(deck.begin(), deck.end(), random_);
    }
    const double finer = std::pow(kLongest_m / kShortest_m, 1.0 / kSizes);
    const double least_m = kShortest_m * std::pow(finer, deck.back());
    deck.pop_back();
    const double distance = logUniform(least_m, finer * least_m) * (uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0);
    return std::abs(offset + distance) <= kLongest_m ? distance : -distance;
  }

  mechanism::Robot robot_;
  RestExcitationOptions options_;
  std::mt19937_64 random_;
  std::array<std::vector<int>, 4> decks_;  ///< of each axis: sizes that are still to come
  double velocity_ = 0.0, way_velocity_ = 0.0, acceleration_ = 0.0;
  mechanism::Pose centre_ = mechanism::Pose::Zero();
};

double restingShare(const trajectory::Points& points, int axes) {
  const Eigen::Index steps = points.rows() - 1;
  const auto step = points.bottomRows(steps).leftCols(axes) - points.topRows(steps).leftCols(axes);
  return (step.array().abs() < 1e-12).cast<double>().mean();
}

}  // namespace

RestExcitation planRestExcitation(const mechanism::Robot& robot, const RestExcitationOptions& options) {
  refuseOptions(robot, options);
  Planner planner(robot, options);
  std::string why = "no place has room for strokes of " + shortNumber(1e3 * kLongest_m) + " mm within its limits";
  double reach = 1.0;
  for (int k = 0; k < kPlaceTries; ++k, reach *= kPlacesCloser) {
    RestExcitation rest;
    const std::vector<Lengths> places = planner.places(reach);
    if (places.empty()) break;
    rest.reference.name = "movement near rest";
    rest.reference.points = planner.movement(places, rest);
    if (rest.reference.points.size() == 0) {
      why = "the ways between " + std::to_string(options.places) + " places leave less than " +
            shortNumber(kLeastAtAPlace_s) + " s for each within " + shortNumber(options.duration_s) +
            " s; plan a longer movement, or fewer places";
      continue;
    }
    rest.check = trajectory::checkReference(rest.reference, planner.robot());
    if (!rest.check.ok()) {
      why = rest.check.violation->sentence;
      continue;
    }
    rest.places.resize(static_cast<Eigen::Index>(places.size()), 4);
    for (std::size_t p = 0; p < places.size(); ++p)
      rest.places.row(static_cast<Eigen::Index>(p)) = places[p].transpose();
    rest.resting_share = restingShare(rest.reference.points, robot.axes());
    return rest;
  }
  throw Refusal("no movement near rest fits " + robot.path + ": " + why);
}

}  // namespace knee_robot::excitation
