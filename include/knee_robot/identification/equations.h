#pragma once

#include <Eigen/Core>
#include <vector>

#include "knee_robot/identification/observation.h"

namespace knee_robot::identification {

/// The equations that are fitted: a * parameters = b, both sides low-passed, all usable samples, thinned to what the
/// cut-off leaves. Rows carry their actuator, and the block of training data that cross-validation leaves out together.
struct Equations {
  Eigen::MatrixXd a;              ///< rows x columns
  Eigen::VectorXd b;              ///< N
  std::vector<int> actuator;      ///< per row
  std::vector<int> block;         ///< per row, 0 .. blocks - 1
  std::vector<std::size_t> file;  ///< per row: training file, and its sample
  std::vector<int> sample;
  std::vector<char> rest;      ///< per row: its actuator rests or reverses, or did within the low-pass's reach
  std::vector<double> time_s;  ///< per row: time of its sample; files follow each other far apart
  std::vector<double>
      elapsed_s;  ///< per row: usable motion before its sample, without what is masked between; each file starts anew
  double step_s = 0.0;  ///< between neighbouring samples
  int blocks = 0;
  int axes = 0;
  double duration_s = 0.0;  ///< of the samples at which every axis moves (bench: some axis)

  int rows() const { return static_cast<int>(b.size()); }
};

/// Number of blocks that cross-validation aims at.
inline constexpr int kBlocks = 10;

/// Stacks the training observations. Blocks are contiguous runs of motion, split at stops and at the ends of files
/// (inside a run only when it is longer than a tenth of the data). Where the robot comes again to a place where it was
/// before, with the same velocity, that visit belongs to the first one's block: of a repeated motion a block is a
/// stretch of it with all its repeats. Bench axes are independent: there an axis' row needs only its own motion.
Equations stackEquations(const std::vector<Observation>& training, const ObservationOptions& options);

/// Takes some columns of (unweighted) equations of the same observations anew, after the observations' regressors
/// changed there.
void refillColumns(const std::vector<Observation>& training, const ObservationOptions& options,
                   const std::vector<int>& columns, Equations& equations);

/// a and b with every row divided by its actuator's noise: one number per actuator, or two, those of rows near rest
/// second.
void weightRows(Equations& equations, const Eigen::VectorXd& noise_N);

/// The two noises of every actuator for weightRows; near rest at least as much as in motion: what law friction follows
/// there is a guess.
Eigen::VectorXd noiseInMotionAndNearRest(const Equations& equations, const Eigen::VectorXd& residual);

/// Signals of every training file (samples x signals), low-passed, at the rows of `actuator`.
Eigen::MatrixXd atRows(const std::vector<Observation>& training, const ObservationOptions& options,
                       const Equations& equations, int actuator, std::vector<Eigen::MatrixXd> signals);

/// Root mean square of `residual` (one entry a row) for each actuator; 0 where an actuator has no rows.
Eigen::VectorXd rmsPerActuator(const Equations& equations, const Eigen::VectorXd& residual);

}  // namespace knee_robot::identification
