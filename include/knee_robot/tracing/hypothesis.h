#pragma once

#include <vector>

#include "knee_robot/tracing/base_fit.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {

/// Recordings with what hypotheses look at, and the baseline's rows. Of the training recordings, or of a surrogate of
/// them.
struct TraceData {
  std::vector<identification::Observation> recordings;
  std::vector<EffectInput> inputs;  ///< point into `recordings`: fill after those are complete
  Stack stack;
  Eigen::VectorXd scale;           ///< of the rows, by attention
  Eigen::MatrixXd all_base_rows;   ///< in N, base coordinates, before scaling
  Eigen::VectorXd all_force_rows;  ///< in N, before scaling
  Eigen::MatrixXd base_rows;       ///< in N, base coordinates, scaled
  Eigen::VectorXd force_rows;      ///< in N, scaled
};

/// Scales the rows; all_base_rows and all_force_rows must be there.
void setAttention(TraceData& data, Attention attention);

/// A candidate at one place.
struct Place {
  const Candidate* candidate = nullptr;
  int actuator = -1;  ///< -1: shared
  int order = 0;      ///< of several by the same name on one actuator: ripples of different periods

  /// Whether it has columns on every actuator; otherwise on its own only.
  bool actsOnAll() const { return actuator < 0 || candidate->reachesOthers(); }
  bool operator==(const Place& other) const {
    return candidate == other.candidate && actuator == other.actuator && order == other.order;
  }
};

/// A candidate at one place with its shape.
struct Hypothesis {
  Place place;
  std::vector<double> shape;
};

/// Whether its one coefficient is the share of a forward model that says how large it is (Candidate::ofSize).
bool isWhole(const Hypothesis& hypothesis);

/// All places and shapes to try.
std::vector<Hypothesis> listHypotheses(const CandidateList& candidates, const std::vector<EffectInput>& inputs);

/// All but the k-th.
std::vector<Hypothesis> without(std::vector<Hypothesis> all, std::size_t k);

/// Columns of a hypothesis for all actuators (rows: actuator after actuator), low-passed, in N.
Eigen::MatrixXd effectRows(const TraceData& data, const Hypothesis& hypothesis);
/// The same of several.
std::vector<Eigen::MatrixXd> effectRows(const TraceData& data, const std::vector<Hypothesis>& effects);

/// Columns of a hypothesis along one recording, on the grid, of the actuators on which it acts: its own, or all
/// (Place::actsOnAll).
std::vector<Eigen::MatrixXd> actingColumns(const EffectInput& input, const Hypothesis& hypothesis);
/// Columns of a hypothesis along one recording, for one actuator, on the grid; zero where it does not act.
Eigen::MatrixXd effectColumns(const EffectInput& input, const Hypothesis& hypothesis, int actuator);

/// Rows divided by each actuator's noise.
Eigen::MatrixXd weighted(const Stack& stack, Eigen::MatrixXd rows, const Eigen::VectorXd& noise_N);

/// Weighted least squares onto the columns that are in the model already.
struct Projection {
  Eigen::MatrixXd
      q;  ///< orthonormal basis of those columns; with a pull, its rows of data: what it takes is q q^T of what it is given
  Eigen::VectorXd residual;  ///< of the force
};
/// `pull`: roots of the weights with which the first coefficients are pulled to zero (the prior's); may be empty.
Projection project(const Eigen::MatrixXd& columns, const Eigen::VectorXd& force, const Eigen::VectorXd& pull = {});

/// Its residual alone, for which no basis is formed.
Eigen::VectorXd leftBy(const Eigen::MatrixXd& columns, const Eigen::VectorXd& force, const Eigen::VectorXd& pull = {});

/// Projections onto all columns but some: what was factored for all of them is used again.
class Projector {
 public:
  Projector(const Eigen::MatrixXd& columns, const Eigen::VectorXd& force, const Eigen::VectorXd& pull);
  /// Onto all but `count` columns, `from` being the first of them.
  Projection without(Eigen::Index from, Eigen::Index count) const;

 private:
  Eigen::VectorXd force_;
  Eigen::MatrixXd basis_;        ///< orthonormal; rows of the pull below those of the data
  Eigen::MatrixXd coordinates_;  ///< of the columns, in that basis
};

/// How the shapes of one place can be scored against any residual of the same data: what their columns add to the
/// model's.
struct Probes {
  Eigen::MatrixXd columns;  ///< weighted, shape after shape; only the rows of the actuators on which it acts
  std::vector<Eigen::MatrixXd>
      inverse;  ///< per shape, of the Gram matrix made orthogonal to the model's; empty: absorbed
  std::vector<double>
      survives;  ///< per shape: largest share of a column's square that the model's columns do not explain
  Eigen::Index first_row = 0;
  bool one_sign = false;
};
/// All shapes of one place with their columns: low-passed, at the picks, in N, neither weighted nor scaled.
struct PlaceColumns {
  std::vector<Hypothesis> tried;
  Eigen::MatrixXd rows;         ///< shape after shape; of the actuators on which it acts
  Eigen::Index first_row = 0;   ///< of the stack's rows
  bool rests_on_model = false;  ///< looks at loads or forces, which every fit changes

  const Place& place() const { return tried.front().place; }
};

/// Columns of hypotheses of one and the same place, shape after shape, low-passed, at the picks, in N, neither weighted
/// nor scaled.
/// Rows of the actuators on which it acts, which begin at `first_row` of the stack's.
Eigen::MatrixXd placeRows(const TraceData& data, const std::vector<Hypothesis>& tried, Eigen::Index& first_row);
/// `rows`: of placeRows.
Probes makeProbes(const TraceData& data, const std::vector<Hypothesis>& tried, const Eigen::MatrixXd& rows,
                  Eigen::Index first_row, const Projection& projection, const Eigen::VectorXd& noise_N);
/// `tried`: hypotheses of one and the same place.
Probes makeProbes(const TraceData& data, const std::vector<Hypothesis>& tried, const Projection& projection,
                  const Eigen::VectorXd& noise_N);

/// Sum of squares (weighted) that each shape (rows) explains of each of the residuals (columns), which are orthogonal
/// to the model's columns.
Eigen::MatrixXd explained(const Probes& probes, const Eigen::MatrixXd& residuals);

/// The same for a single hypothesis and a single residual.
double explained(const TraceData& data, const Hypothesis& hypothesis, const Projection& projection,
                 const Eigen::VectorXd& noise_N);

/// Hypotheses place by place, in order.
std::vector<std::vector<Hypothesis>> byPlace(const std::vector<Hypothesis>& tried);

}  // namespace knee_robot::tracing
