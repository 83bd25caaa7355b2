#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "knee_robot/dynamics/friction_law.h"
#include "knee_robot/dynamics/parameters.h"
#include "knee_robot/identification/known_shares.h"
#include "knee_robot/identification/motion_path.h"

namespace knee_robot::identification {

/// The path of a joint as friction sees it: several points a sample, and no way back shorter than what the encoders
/// tell apart. Friction that followed every wiggle of a rounded, low-passed position would reverse where the joint does
/// not; friction that waited until the way back is certain would reverse late. So the turning points are found with the
/// whole recording in view: each lies at the extreme itself, and counts when the path goes back from it by more than
/// `resolution`.
struct SlidingPath {
  Eigen::VectorXd position;  ///< kSubsteps per sample period, the samples too; rising or falling between turning points
  Eigen::VectorXd
      measured;          ///< the same without this: for laws that follow velocity, which small ways back do not harm
  Eigen::VectorXd taut;  ///< for smooth laws, where it was asked for (ObservationOptions::taut_steps); empty: measured
  Eigen::VectorXd tremble;      ///< per sample: way per time beyond it (Signals::tremble_m_per_s); empty: none
  double period_s = 0.01;       ///< of the samples
  bool moves_at_start = false;  ///< it has left where it was within kAtOnce_s
  static constexpr double kAtOnce_s = 0.1;
  /// It is within kStill of where it was for kStands_s, whatever it trembles.
  bool stands_at_start = false;
  static constexpr double kStands_s = 0.2, kStill = 1e-5;  ///< the latter in the position's unit, or `resolution`
  int first_direction = 0;  ///< of the first movement that the encoders tell; 0: there is none
  double resolution = 0.0;  ///< in the position's unit: shorter ways back are not told apart from rounding
  static constexpr int kSubsteps = 4;
  /// Of elementShare() without loaded_at_start; copies have it in common, since a path stays as it is once it is asked.
  std::shared_ptr<KnownShares> known = std::make_shared<KnownShares>();

  std::optional<double> loaded_at_start;  ///< share of full Coulomb friction then, where it is known

  /// Share of full Coulomb friction when the recording starts, if nobody knows it. Of a joint that moves already,
  /// friction that builds up over less than the encoders tell has done so; of other friction nothing is known, and it is
  /// zero.
  double usualShareAtStart(double width) const { return moves_at_start && width < resolution ? first_direction : 0.0; }
  /// The share that is known, or else that one, or what a law says of recordings that begin at rest.
  double shareAtStart(double width, double of_law = 0.0) const {
    if (loaded_at_start) return *loaded_at_start;
    return of_law != 0.0 && stands_at_start ? of_law : usualShareAtStart(width);
  }
};

/// From uniformly sampled positions and velocities (a cubic between neighbours), `period_s` apart. `resolution`: see
/// above, in the position's unit, not negative.
SlidingPath slidingPath(const Eigen::VectorXd& position, const Eigen::VectorXd& velocity, double period_s,
                        double resolution);

/// Share of full Coulomb friction at every sample, averaged over the sample's interval as the forces are. It starts
/// with shareAtStart and changes as soon as the path moves: the first stretch has no way back either.
Eigen::VectorXd frictionShare(const SlidingPath& path, const dynamics::FrictionLaw& law);
/// The same of one element, as if it carried all friction.
Eigen::VectorXd elementShare(const SlidingPath& path, const dynamics::FrictionElement& element);
/// Share at the samples themselves.
Eigen::VectorXd shareAtSamples(const SlidingPath& path, const dynamics::FrictionLaw& law);
/// One stop; `width` in the path's unit, positive.
Eigen::VectorXd frictionShare(const SlidingPath& path, double width);

/// One path per actuator; resolution: what rounding leaves of an encoder count (Signals::rounding_left).
std::vector<SlidingPath> actuatorPaths(const mechanism::Robot& robot, const recording::Signals& signals);

/// Coulomb columns of the legs' seven passive joints, in the order of the passive friction parameters: 12 11 22 21 32
/// 31 41. The sign of each is frictionShare of a narrow width along the joint's own path, whose resolution is what that
/// much of a count of every encoder (root of the sum of squares) moves the joint by.
class PassiveCoulomb {
 public:
  static constexpr int kJoints = dynamics::extended::kPassiveFrictionCount / 2;

  PassiveCoulomb(const mechanism::Robot& robot, const recording::Signals& signals, const MotionPath& motion);

  /// Actuator forces (N) that hold against friction of 1 N m in the joint at a sample.
  mechanism::Vector4 column(int sample, int joint) const {
    return share_(sample, joint) * levers_[static_cast<std::size_t>(joint)].col(sample);
  }

 private:
  std::vector<Eigen::Matrix4Xd> levers_;  ///< per joint: a column a sample
  Eigen::MatrixXd share_;
};

}  // namespace knee_robot::identification
