#pragma once

#include <utility>
#include <vector>

#include "knee_robot/identification/equations.h"
#include "knee_robot/tracing/hypothesis.h"

namespace knee_robot::tracing {

/// Baseline and effects fitted together.
struct JointFit {
  Eigen::VectorXd base, base_std;             ///< base coordinates; std by leaving blocks out in turn
  std::vector<Eigen::VectorXd> coefficients;  ///< per effect
  /// Of those, by leaving blocks out in turn (jackknife); nan of an effect that acts in fewer than three blocks, as a
  /// short push does.
  std::vector<Eigen::VectorXd> std;
  std::vector<char> stable;    ///< per effect: no left-out block changes the sign of its leading coefficient
  Eigen::VectorXd residual_N;  ///< rows
  Eigen::VectorXd held_back;   ///< per block: sum of weighted squares when it was left out
};

/// Weight of the pull to zero of an effect's coefficients, relative to their columns' norms (Candidate::isPulled).
inline constexpr double kPull = 0.02;

/// The same of the pull to one of the share of a forward model that says how large it is (Candidate::ofSize): it is one,
/// or the shape is another one.
inline constexpr double kPullToWhole = 1.0;

enum class LeftOut { EveryBlock, None };

/// A bounded least-squares problem, block by block in few rows.
struct BlockProblem {
  std::vector<Eigen::MatrixXd> blocks;  ///< compressed [columns force]
  int bounded = 0;                      ///< first columns, whose coefficients are not negative
  std::vector<int> pulled;              ///< columns of effects with several coefficients: slightly pulled to zero
  std::vector<int> whole_effects;       ///< columns whose coefficient is pulled to one
  Eigen::VectorXd whole;                ///< norms with all blocks of the columns of maps, else 0
  Eigen::VectorXd prior;                ///< per column, root of the weight of a pull to zero
  Eigen::VectorXd own;                  ///< norms with all blocks of the columns of effects that are no maps, else 0
  std::vector<char> once;               ///< per column: of an effect that happens once (Candidate::local)
};

/// Base and effects along the recordings. Compressed once: what a model without one of the effects predicts costs no
/// further pass over the samples.
class JointProblem {
 public:
  /// `effect_rows[k]` belongs to `effects[k]` and is in N: of all its coefficients, or of the first of them only. `data`
  /// outlives the problem.
  JointProblem(const TraceData& data, const BaseFit& base, const Eigen::VectorXd& noise_N,
               const std::vector<Hypothesis>& effects, std::vector<Eigen::MatrixXd> effect_rows);

  /// Bounded weighted least squares of the force; with every block left out in turn, or without that: held_back is
  /// empty then, and what is told by it nan.
  JointFit fit(LeftOut left_out = LeftOut::EveryBlock) const;

  /// JointFit::held_back of base and effects, and without effect `k`.
  Eigen::VectorXd heldBack() const;
  Eigen::VectorXd heldBackWithout(std::size_t k) const;

 private:
  const TraceData& data_;
  Eigen::VectorXd noise_N_;
  std::vector<Eigen::MatrixXd> effect_rows_;
  BlockProblem problem_;
  std::vector<std::pair<int, int>> source_;  ///< per column of the problem: effect (-1: base), column in it
  identification::Equations equations_;
};

}  // namespace knee_robot::tracing
