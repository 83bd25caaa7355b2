#include <cmath>

#include "knee_robot/tracing/candidate.h"

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

std::vector<Eigen::MatrixXd> Candidate::columnsOfAll(const EffectInput& input, const std::vector<double>& shape) const {
  std::vector<Eigen::MatrixXd> out;
  for (int i = 0; i < input.axes(); ++i)
    out.push_back(columns(input, i, shape));
  return out;
}

std::vector<Eigen::MatrixXd> Candidate::reach(const EffectInput& input, int actuator,
                                              const std::vector<double>& shape) const {
  const Eigen::MatrixXd own = columns(input, actuator, shape);
  std::vector<Eigen::MatrixXd> out(static_cast<std::size_t>(input.axes()),
                                   Eigen::MatrixXd::Zero(own.rows(), own.cols()));
  out[static_cast<std::size_t>(actuator)] = own;
  return out;
}

std::vector<std::vector<double>> Candidate::near(const std::vector<double>&, double) const {
  return {};
}

std::vector<double> Candidate::ofSize(const std::vector<double>&, double) const {
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

std::vector<std::vector<double>> withLast(const std::vector<std::vector<double>>& grid,
                                          const std::vector<double>& values) {
  std::vector<std::vector<double>> out;
  for (const double value : values) {
    for (const std::vector<double>& shape : grid) {
      out.push_back(shape);
      out.back().push_back(value);
    }
  }
  return out;
}

CandidateList namedCandidates(const mechanism::Robot& robot) {
  CandidateList fit;
  for (const CandidateMaker make : candidateMakers()) {
    std::unique_ptr<Candidate> candidate = make();
    if (candidate->worksOn(robot)) fit.push_back(std::move(candidate));
  }
  return fit;
}

}  // namespace knee_robot::tracing
