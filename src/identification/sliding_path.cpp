#include "knee_robot/identification/sliding_path.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "element_along.h"
#include "knee_robot/mechanism/leg_motion.h"

namespace knee_robot::identification {
namespace {

constexpr double kNarrow_rad = 1e-9;

/// The samples with a cubic between them.
Eigen::VectorXd refined(const Eigen::VectorXd& position, const Eigen::VectorXd& velocity, double period_s) {
  const Eigen::Index n = position.size();
  Eigen::VectorXd fine((n - 1) * SlidingPath::kSubsteps + 1);
  for (Eigen::Index k = 0; k + 1 < n; ++k) {
    for (int i = 0; i < SlidingPath::kSubsteps; ++i) {
      const double s = static_cast<double>(i) / SlidingPath::kSubsteps, r = 1.0 - s;
      fine[k * SlidingPath::kSubsteps + i] = r * r * (1.0 + 2.0 * s) * position[k] +
                                             s * s * (3.0 - 2.0 * s) * position[k + 1] +
                                             s * r * period_s * (r * velocity[k] - s * velocity[k + 1]);
    }
  }
  fine[fine.size() - 1] = position[n - 1];
  return fine;
}

/// Places of the extremes from which the path goes back by more than `resolution`, and the direction before the first
/// of them.
std::vector<Eigen::Index> turningPoints(const Eigen::VectorXd& x, double resolution, int& first_direction) {
  std::vector<Eigen::Index> turns;
  Eigen::Index highest = 0, lowest = 0;
  int direction = 0;
  for (Eigen::Index k = 1; k < x.size(); ++k) {
    if (x[k] > x[highest]) highest = k;
    if (x[k] < x[lowest]) lowest = k;
    if (direction >= 0 && x[k] < x[highest] - resolution) {
      if (direction > 0) turns.push_back(highest);
      direction = -1;
      lowest = k;
    } else if (direction <= 0 && x[k] > x[lowest] + resolution) {
      if (direction < 0) turns.push_back(lowest);
      direction = 1;
      highest = k;
    } else {
      continue;
    }
    if (first_direction == 0) first_direction = direction;
  }
  return turns;
}

double furthest(double here, double neighbour, int direction) {
  return direction > 0 ? std::max(here, neighbour) : direction < 0 ? std::min(here, neighbour) : neighbour;
}

}  // namespace

SlidingPath slidingPath(const Eigen::VectorXd& position, const Eigen::VectorXd& velocity, double period_s,
                        double resolution) {
  SlidingPath path;
  path.resolution = resolution;
  path.position = path.measured = refined(position, velocity, period_s);
  path.period_s = period_s;
  const auto strays = [&](double within_s, double by) {
    const Eigen::Index soon = std::min<Eigen::Index>(
        path.position.size(), 1 + static_cast<Eigen::Index>(within_s / period_s * SlidingPath::kSubsteps));
    return ((path.position.head(soon).array() - path.position[0]).abs() > by).any();
  };
  path.moves_at_start = strays(SlidingPath::kAtOnce_s, resolution);
  path.stands_at_start = !strays(SlidingPath::kStands_s, std::max(SlidingPath::kStill, resolution));
  std::vector<Eigen::Index> turns = turningPoints(path.position, resolution, path.first_direction);
  turns.push_back(path.position.size() - 1);
  int direction = path.first_direction;
  // The first stretch starts at its own lowest (highest) point: what a filter dips before a movement is none.
  for (Eigen::Index k = turns.front() - 1; k >= 0; --k)
    path.position[k] = furthest(path.position[k], path.position[k + 1], -direction);
  for (std::size_t turn = 1; turn < turns.size(); ++turn) {
    direction = -direction;
    for (Eigen::Index k = turns[turn - 1] + 1; k <= turns[turn]; ++k)
      path.position[k] = furthest(path.position[k], path.position[k - 1], direction);
  }
  return path;
}

namespace {

/// One element along a path, substep by substep.
class Follower {
 public:
  Follower(const SlidingPath& path, const dynamics::FrictionElement& element, double at_start)
      : path_(path),
        position_(element.kind == dynamics::FrictionKind::Stop ? path.position : path.measured),
        step_s_(path.period_s / SlidingPath::kSubsteps) {
    law_.elements[0] = element;
    law_.elements[0].share = 1.0;
    state_.start(at_start);
  }
  /// Share at substep k, asked for one after the other from 1 on.
  double to(Eigen::Index k) {
    return state_.step(law_, position_[k] - position_[k - 1], step_s_,
                       path_.tremble.size() > 0 ? path_.tremble[k / SlidingPath::kSubsteps] : 0.0);
  }

 private:
  const SlidingPath& path_;
  const Eigen::VectorXd& position_;
  const double step_s_;
  dynamics::FrictionLaw law_;
  dynamics::FrictionState state_;
};

/// What is added to each substep when the element begins with another share, up to the one after which it has forgotten
/// that.
Eigen::VectorXd fineChange(const SlidingPath& path, const dynamics::FrictionElement& element, double from, double to) {
  constexpr double kForgotten = 1e-12;
  constexpr int kInARow = 2 * SlidingPath::kSubsteps;
  Eigen::VectorXd change = Eigen::VectorXd::Zero(path.position.size());
  change[0] = to - from;
  Follower one(path, element, from), other(path, element, to);
  Eigen::Index k = 1;
  const bool tells = element.gap_m == 0.0;  // within a clearance nothing presses, wherever in it the stop is
  for (int forgotten = 0; k < change.size() && forgotten < kInARow; ++k) {
    change[k] = other.to(k) - one.to(k);
    forgotten = tells && std::abs(change[k]) < kForgotten ? forgotten + 1 : 0;
  }
  return change.head(std::min(change.size(), k + SlidingPath::kSubsteps));
}

Eigen::VectorXd fineShare(const SlidingPath& path, const dynamics::FrictionLaw& law) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(path.position.size());
  for (int k = 0; k < law.count; ++k) {
    const dynamics::FrictionElement& e = law.elements[static_cast<std::size_t>(k)];
    sum += e.share * elementAlong(path, e, path.shareAtStart(e.width_m, law.at_start));
  }
  return sum;
}

Eigen::VectorXd meanOverSamples(const Eigen::VectorXd& fine) {
  constexpr int kHalf = SlidingPath::kSubsteps / 2;
  const Eigen::Index size = fine.size();
  Eigen::VectorXd integral(size);  // in substeps
  integral[0] = 0.0;
  for (Eigen::Index k = 1; k < size; ++k)
    integral[k] = integral[k - 1] + 0.5 * (fine[k - 1] + fine[k]);
  Eigen::VectorXd mean((size - 1) / SlidingPath::kSubsteps + 1);
  for (Eigen::Index n = 0; n < mean.size(); ++n) {
    const Eigen::Index from = std::max<Eigen::Index>(0, n * SlidingPath::kSubsteps - kHalf);
    const Eigen::Index to = std::min(size - 1, n * SlidingPath::kSubsteps + kHalf);
    mean[n] = (integral[to] - integral[from]) / static_cast<double>(to - from);
  }
  return mean;
}

}  // namespace

Eigen::VectorXd frictionShare(const SlidingPath& path, const dynamics::FrictionLaw& law) {
  return meanOverSamples(fineShare(path, law));
}

Eigen::VectorXd elementShare(const SlidingPath& path, const dynamics::FrictionElement& element) {
  const double usual = path.usualShareAtStart(element.width_m);
  Eigen::VectorXd share = path.known->of(element, [&] { return meanOverSamples(elementAlong(path, element, usual)); });
  if (!path.loaded_at_start || element.kind == dynamics::FrictionKind::Smooth) return share;
  const Eigen::VectorXd change = meanOverSamples(fineChange(path, element, usual, *path.loaded_at_start));
  share.head(change.size()) += change;
  return share;
}

Eigen::VectorXd shareAtSamples(const SlidingPath& path, const dynamics::FrictionLaw& law) {
  const Eigen::VectorXd fine = fineShare(path, law);
  Eigen::VectorXd share((fine.size() - 1) / SlidingPath::kSubsteps + 1);
  for (Eigen::Index n = 0; n < share.size(); ++n)
    share[n] = fine[n * SlidingPath::kSubsteps];
  return share;
}

Eigen::VectorXd frictionShare(const SlidingPath& path, double width) {
  return frictionShare(path, dynamics::stopLaw(width));
}

std::vector<SlidingPath> actuatorPaths(const mechanism::Robot& robot, const recording::Signals& s) {
  const bool own = s.path_m.cols() > 0;
  const Eigen::MatrixXd &position_m = own ? s.path_m : s.position_m,
                        &velocity_m_per_s = own ? s.path_velocity_m_per_s : s.velocity_m_per_s;
  std::vector<SlidingPath> paths;
  for (int i = 0; i < robot.axes(); ++i) {
    paths.push_back(slidingPath(position_m.col(i), velocity_m_per_s.col(i), s.period_s,
                                s.rounding_left * robot.actuators[static_cast<std::size_t>(i)].metresPerCount()));
    if (s.taut_m.cols() > i) paths.back().taut = refined(s.taut_m.col(i), s.taut_velocity_m_per_s.col(i), s.period_s);
    if (s.tremble_m_per_s.cols() > i) paths.back().tremble = s.tremble_m_per_s.col(i);
  }
  return paths;
}

PassiveCoulomb::PassiveCoulomb(const mechanism::Robot& robot, const recording::Signals& s, const MotionPath& path)
    : levers_(kJoints, Eigen::Matrix4Xd::Zero(mechanism::kLegs, s.samples())), share_(s.samples(), kJoints) {
  Eigen::MatrixXd angle(s.samples(), kJoints), rate(s.samples(), kJoints);
  mechanism::RobotMotion motion;
  for (int n = 0; n < s.samples(); ++n) {
    const mechanism::Motion& here = path.motion[static_cast<std::size_t>(n)];
    const auto joints = mechanism::urdfJointPositions(*robot.mechanism, here.pose);
    mechanism::robotMotion(*robot.mechanism, here, motion);
    const mechanism::Matrix4 pose_per_length = motion.jacobian.inverse();
    int column = 0;
    for (std::size_t leg = 0; leg < mechanism::kLegs; ++leg) {
      for (int joint = 1; joint >= (leg == 3 ? 1 : 0); --joint, ++column) {
        angle(n, column) = joints[leg == 3 ? 9 : 3 * leg + static_cast<std::size_t>(joint)];
        rate(n, column) = motion.legs[leg].rate[joint];
        const mechanism::Vector4 lever = (motion.legs[leg].joints_per_pose.row(joint) * pose_per_length).transpose();
        const std::size_t at = static_cast<std::size_t>(column);
        levers_[at].col(n) = lever.allFinite() ? lever
                             : n > 0           ? levers_[at].col(n - 1).eval()
                                               : mechanism::Vector4::Zero().eval();
      }
    }
  }
  mechanism::Vector4 count;
  for (int i = 0; i < mechanism::kLegs; ++i)
    count[i] = s.rounding_left * robot.actuators[static_cast<std::size_t>(i)].metresPerCount();
  for (int joint = 0; joint < kJoints; ++joint) {
    const Eigen::Matrix4Xd& levers = levers_[static_cast<std::size_t>(joint)];
    const double resolution = (count.asDiagonal() * levers).norm() / std::sqrt(s.samples());
    share_.col(joint) =
        frictionShare(slidingPath(angle.col(joint), rate.col(joint), s.period_s, resolution), kNarrow_rad);
  }
}

}  // namespace knee_robot::identification
