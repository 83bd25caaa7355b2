#pragma once

#include <Eigen/Core>
#include <vector>

#include "knee_robot/dynamics/robot_inertia.h"
#include "knee_robot/identification/columns.h"

namespace knee_robot::identification {

/// Coordinates in which a robot's inertias are fitted: each link's pseudo-inertia as L E L^T, where L L^T is the
/// prior's. E = 1 is the prior, and a change of E of size 1 is as large as the prior itself (the natural metric of Lee,
/// Wensing and Park 2020, at the prior). Ten coordinates a link: the diagonal of E, then sqrt(2) times its upper
/// triangle, row by row.
struct PhysicalCoordinates {
  Eigen::VectorXd prior;      ///< inertial parameters of the robot's URDF, ten a link
  Eigen::MatrixXd transform;  ///< square, block diagonal: inertial parameters = transform * coordinates

  static constexpr int kPerLink = 10;
};

/// InputError-free: every LinkInertia that loadRobotInertia returns is possible. A body on the boundary of what is
/// possible (a point mass, a thin disc) is moved inside by 1e-6 of its size.
PhysicalCoordinates physicalCoordinates(const dynamics::RobotInertia& prior);
/// The same of any links' parameters, ten each.
PhysicalCoordinates physicalCoordinates(const Eigen::VectorXd& prior);

/// A weighted linear least-squares problem over physically possible inertias, without a word about the prior:
/// |data * [coordinates; free] - target|^2, `free` being all columns that are not Rigid.
struct PhysicalProblem {
  Eigen::MatrixXd data;
  Eigen::VectorXd target;
  std::vector<int> free;          ///< columns of the linear model, in order
  Eigen::VectorXd free_size;      ///< one per free column: what the prior (zero) takes for large; 0: no prior at all
  std::vector<char> nonnegative;  ///< one per free column
};

/// Brings compressed equations (compress(), weighted) to these coordinates.
PhysicalProblem physicalProblem(const Eigen::MatrixXd& triangle, const std::vector<Column>& columns,
                                const PhysicalCoordinates& coordinates, const Eigen::VectorXd& offset_size_N);

/// Prior residuals root * ([coordinates; free] - mean). Each singular direction of the data (friction and rotor
/// projected out) enters with weight strength * (strength / (strength + information))^2: fully where the data are
/// silent, not at all where their information (sum of squares of what a change of the prior's own size does to the
/// residuals) is much larger.
struct PriorPull {
  Eigen::MatrixXd root;
  Eigen::VectorXd mean;
  double silent =
      0.0;  ///< directions that the prior decides: sum of the shares strength w / (information + strength w)
};
PriorPull priorPull(const PhysicalProblem& problem, double strength);

/// A solution of data and prior together.
struct PhysicalSolution {
  Eigen::VectorXd inertial;  ///< coordinates, ten a link
  Eigen::VectorXd free;
  double cost = 0.0;  ///< sum of squares, data and prior
  int iterations = 0;
  int pushes = 0;  ///< how often bodies were pushed off the boundary and the solver started again
  bool optimal =
      false;  ///< no change of a body gains more than a millionth of the cost: the problem is convex, so this is its optimum
};

/// Solves with Ceres: every E is U U^T with U upper triangular, positive on the diagonal (log-Cholesky, Rucker and
/// Wensing 2022), so that each iterate is physically possible; friction and rotor inertia stay non-negative by bounds.
/// Exact derivatives. The roots of E stay above exp(-8): an optimum on the boundary is met to that accuracy. Roots can
/// come to rest on the boundary above the optimum: there each body's slope tells, the body is pushed off along it and
/// the solver goes on. Throws std::runtime_error when Ceres fails.
PhysicalSolution solvePhysical(const PhysicalProblem& problem, const PriorPull& pull);

/// Parameters of all columns.
Eigen::VectorXd physicalParameters(const PhysicalSolution& solution, const PhysicalProblem& problem,
                                   const PhysicalCoordinates& coordinates, const std::vector<Column>& columns);

}  // namespace knee_robot::identification
