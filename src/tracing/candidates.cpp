#include <cmath>

#include "effects.h"

namespace knee_robot::tracing {

bool Candidate::worksOn(const mechanism::Robot& robot) const {
  return robot.mechanism.has_value() || worksOnBench();
}

std::vector<std::vector<double>> Candidate::shapes(const EffectInput&, int) const {
  return {{}};
}

Eigen::VectorXd Candidate::elsewhere(const Eigen::VectorXd& coefficients) const {
  return transfers() ? coefficients : Eigen::VectorXd();
}

Eigen::VectorXd Candidate::atHome(const Eigen::VectorXd& coefficients, const std::vector<int>&) const {
  return elsewhere(coefficients);
}

std::vector<std::vector<double>> Candidate::near(const std::vector<double>&, double) const {
  return {};
}

bool Candidate::plausible(const Eigen::VectorXd&) const {
  return true;
}

std::string Candidate::dependsOn(int) const {
  return {};
}

std::vector<std::vector<double>> geometricGrid(double low, double high, int count) {
  std::vector<std::vector<double>> grid;
  for (int k = 0; k < count; ++k)
    grid.push_back({low * std::pow(high / low, count > 1 ? static_cast<double>(k) / (count - 1) : 0.0)});
  return grid;
}

CandidateList namedCandidates(const mechanism::Robot& robot) {
  CandidateList all;
  all.push_back(makeAsymmetricCoulomb());
  all.push_back(makeAsymmetricViscous());
  all.push_back(makeStribeck());
  all.push_back(makePresliding());
  all.push_back(makeLoadDependentFriction());
  all.push_back(makeScrewRipple());
  all.push_back(makePositionDependentFriction());
  all.push_back(makeQuadraticDrag());
  all.push_back(makeThermalDrift());
  all.push_back(makeForceGain());
  all.push_back(makeForceOffset());
  all.push_back(makeDelay());
  all.push_back(makeDriveLag());
  all.push_back(makeBacklash());
  all.push_back(makeFlexibleCoupling());
  all.push_back(makeSpring());
  all.push_back(makeExternalForce());
  all.push_back(makePowerFlowFriction());
  all.push_back(makeLoadDependentViscous());
  all.push_back(makeDashpot());
  all.push_back(makeNonlinearSpring());
  all.push_back(makeAsymmetricDashpot());
  all.push_back(makeGainDrift());
  all.push_back(makeTorsionalHysteresis());
  all.push_back(makeGearRipple());
  all.push_back(makeTemperatureFriction());
  all.push_back(makeJointElasticity());
  all.push_back(makePushAtTip());
  CandidateList fit;
  for (auto& candidate : all) {
    if (candidate->worksOn(robot)) fit.push_back(std::move(candidate));
  }
  return fit;
}

}  // namespace knee_robot::tracing
