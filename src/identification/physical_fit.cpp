#include "knee_robot/identification/physical_fit.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "knee_robot/dynamics/chain_regressor.h"
#include "knee_robot/identification/physical_problem.h"
#include "knee_robot/identification/prior.h"

namespace knee_robot::identification {
namespace {

const double kBodyStrengths[] = {1e-2, 1e-1, 1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7};

/// Everything that stays the same while the strength changes.
struct PhysicalSetting {
  const Identification& base;
  PhysicalCoordinates coordinates;

  PhysicalProblem problem(int left_out) const {
    return physicalProblem(joinBlocks(base.compressed, left_out), base.columns, coordinates,
                           kOffsetShare * base.force_rms_N);
  }
};

/// Mean squares of every left-out block (rows) for every strength (columns).
Eigen::MatrixXd leaveOut(const PhysicalSetting& setting) {
  const Identification& base = setting.base;
  Eigen::MatrixXd error(static_cast<Eigen::Index>(base.compressed.size()), std::size(kBodyStrengths));
  for (int block = 0; block < static_cast<int>(base.compressed.size()); ++block) {
    const PhysicalProblem problem = setting.problem(block);
    const Eigen::MatrixXd& out = base.compressed[static_cast<std::size_t>(block)];
    const Eigen::Index p = out.cols() - 1;
    for (std::size_t k = 0; k < std::size(kBodyStrengths); ++k) {
      const PhysicalSolution s = solvePhysical(problem, priorPull(problem, kBodyStrengths[k]));
      const Eigen::VectorXd parameters = physicalParameters(s, problem, setting.coordinates, base.columns);
      error(block, static_cast<Eigen::Index>(k)) =
          (out.col(p) - out.leftCols(p) * parameters).squaredNorm() / base.block_rows[static_cast<std::size_t>(block)];
    }
  }
  return error;
}

void chooseByHeldBack(const PhysicalSetting& setting, PhysicalFit& fit) {
  const Identification& base = setting.base;
  const Eigen::MatrixXd error = leaveOut(setting);
  Eigen::VectorXd share(error.rows());
  for (Eigen::Index i = 0; i < share.size(); ++i)
    share[i] = static_cast<double>(base.block_rows[static_cast<std::size_t>(i)]) / base.equations;
  const Eigen::RowVectorXd mean = share.transpose() * error;
  Eigen::Index best = 0;
  mean.minCoeff(&best);
  const PhysicalProblem all = setting.problem(-1);
  const double directions = static_cast<double>(setting.coordinates.transform.cols()) + base.model.axes;
  for (Eigen::Index k = 0; k < error.cols(); ++k) {
    PhysicalPoint point;
    point.strength = kBodyStrengths[k];
    point.supported = directions - priorPull(all, point.strength).silent;
    point.held_back = mean[k];
    point.beyond_best = mean[k] - mean[best];
    const Eigen::VectorXd worse = error.col(k) - error.col(best);
    const double variance = (share.array() * (worse.array() - point.beyond_best).square()).sum();
    point.standard_error = std::sqrt(variance / std::max<Eigen::Index>(1, share.size() - 1));
    if (point.beyond_best <= point.standard_error) {
      fit.strength = point.strength;
      fit.supported = point.supported;
    }
    fit.curve.push_back(point);
  }
}

dynamics::LinkInertia bodyOf(const Eigen::VectorXd& parameters, Eigen::Index link) {
  return dynamics::fromParameters(
      dynamics::LinkParameters(parameters.segment<dynamics::kLinkParameters>(link * dynamics::kLinkParameters)));
}

/// Bodies with these names; the model has no base combinations.
PhysicalFit fitBodies(const Identification& base, PhysicalCoordinates coordinates,
                      const std::vector<std::string>& names) {
  const PhysicalSetting setting{base, std::move(coordinates)};
  PhysicalFit fit;
  chooseByHeldBack(setting, fit);
  const PhysicalProblem problem = setting.problem(-1);
  const PhysicalSolution s = solvePhysical(problem, priorPull(problem, fit.strength));
  const Eigen::VectorXd parameters = physicalParameters(s, problem, setting.coordinates, base.columns);

  fit.optimal = s.optimal;
  fit.model = base.model;
  fit.model.base.clear();
  for (std::size_t c = 0; c < base.columns.size(); ++c)
    fit.model.parameters[c].value = parameters[static_cast<Eigen::Index>(c)];
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Eigen::Index link = static_cast<Eigen::Index>(k);
    Eigen::VectorXd change = s.inertial.segment<PhysicalCoordinates::kPerLink>(link * PhysicalCoordinates::kPerLink);
    change.head(4).array() -= 1.0;
    fit.bodies.push_back({names[k], bodyOf(parameters, link), bodyOf(setting.coordinates.prior, link),
                          change.norm() / 2.0});  // the prior itself has the norm 2
  }
  return fit;
}

}  // namespace

PhysicalFit fitPhysical(const mechanism::Robot& robot, const Identification& base,
                        const dynamics::RobotInertia& prior) {
  if (!robot.mechanism) throw std::invalid_argument("bench axes have no link inertias");
  PhysicalFit fit =
      fitBodies(base, physicalCoordinates(prior), {dynamics::linkNames().begin(), dynamics::linkNames().end()});
  for (std::size_t k = 0; k < fit.bodies.size(); ++k)
    fit.inertia.links[k] = fit.bodies[k].fitted;
  for (std::size_t c = 0; c < base.columns.size(); ++c) {
    if (base.columns[c].role == ColumnRole::Rotor)
      fit.inertia.rotor_mass[base.columns[c].actuator] = fit.model.parameters[c].value;
  }
  return fit;
}

PhysicalFit fitPhysicalChain(const mechanism::Robot& robot, const Identification& base) {
  std::vector<std::string> names;
  for (const mechanism::ChainJoint& joint : robot.chain->joints)
    names.push_back("of " + joint.name);
  return fitBodies(base, physicalCoordinates(dynamics::chainInertia(robot)), names);
}

}  // namespace knee_robot::identification
