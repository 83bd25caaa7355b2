#include "driven_load.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/recording/filter.h"

namespace knee_robot::tracing {
namespace {

constexpr double kPartBeyond = 0.6, kLeastBeyond = 0.0, kDrivenShareBeside = 0.2;
constexpr double kJointBeside = 1.4;  ///< factor between neighbours

}  // namespace

ShapeParameter frictionBeyondParameter() {
  return {"friction_beyond", kLeastBeyond, 1.0, false, 1.0};
}

std::vector<std::vector<double>> withFrictionBeyond(const std::vector<std::vector<double>>& grid) {
  return withLast(grid, {1.0, kPartBeyond});
}

std::vector<std::vector<double>> besideJoint(const std::vector<double>& shape, double step,
                                             const std::vector<ShapeParameter>& limits) {
  std::vector<std::vector<double>> out;
  for (const double sign : {-1.0, 1.0}) {
    out.push_back(shape);
    out.back()[0] = std::clamp(shape[0] * std::pow(kJointBeside, sign * step), limits[0].low, limits[0].high);
    out.push_back(shape);
    out.back()[1] = std::clamp(shape[1] + sign * step * kDrivenShareBeside, limits[1].low, limits[1].high);
  }
  return out;
}

Eigen::VectorXd changeByJoint(const EffectInput& in, int i, const DriveJoint& joint) {
  const auto motor = in.friction_position_m.col(i);
  const auto rate = in.signals().velocity_m_per_s.col(i);
  const auto acceleration = in.signals().acceleration_m_per_s2.col(i);
  const double period = in.signals().period_s;
  const double dry = joint.friction_beyond * in.coulomb_N[i], viscous = joint.friction_beyond * in.viscous[i];
  ScrewBehindJoint screw(joint, in.laws[static_cast<std::size_t>(i)], dry, viscous);
  screw.start(motor[0], joint.windingAt(in.load_N(0, i)), in.share(0, i));
  Eigen::VectorXd wound(in.samples()), friction(in.samples());
  for (int n = 0; n < in.samples(); ++n) {
    const double load = in.load_N(n, i) - in.rotor_kg[i] * acceleration[n];
    wound[n] = screw.follow(motor[n], {load, 0.0}, period);
    friction[n] = joint.force_N(wound[n]) - load;  // as the joint shows it
  }
  recording::ZeroPhaseLowPass(in.signals().motion_cutoff_hz, 1.0 / period).apply(wound);
  const Eigen::VectorXd missing = in.moved_kg[i] * recording::secondDerivative(wound, period);
  const Eigen::VectorXd model = dry * in.share.col(i) + viscous * rate;
  return friction - missing - model;
}

}  // namespace knee_robot::tracing
