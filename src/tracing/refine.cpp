#include "refine.h"

#include <ceres/ceres.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "knee_robot/base/parallel.h"
#include "refit.h"
#include "ripple_periods.h"

namespace knee_robot::tracing {
namespace {

constexpr int kSteps = 6;
constexpr int kLineSteps = 4;  ///< at bounds none of them may do, and a shorter trust region follows
constexpr double kRelativeStep = 1e-3, kLeastStep = 1e-6;  ///< of shapes, for derivatives
constexpr double kReach_m = 0.2;  ///< by which what may have either sign (an anchor) moves at least, past zero
constexpr double kAtReach_m = 1e-3;
constexpr int kTimesRefined = 4;      ///< an anchor of a strap lies up to a metre from where the search begins
constexpr double kStillFalls = 0.98;  ///< of the squares
constexpr int kWholeSteps = 3;
constexpr double kNearlyWhole = 0.1, kHardlyMore = 1.02;  ///< of the size; of the squares
constexpr double kFarthest = 1.5;  ///< factor by which a shape may move: further away it is another hypothesis

/// Where a refined parameter is: effect, entry of its shape.
struct Entry {
  std::size_t effect = 0, parameter = 0;
};

/// What base and effects leave, as a function of the shapes: coefficients are solved for (variable projection). Of the
/// derivative, the part that changes the coefficients lies in the columns and is left out (Kaufman 1975): the gradient
/// is exact without it.
class LeftBeside : public ceres::CostFunction {
 public:
  LeftBeside(const Search& s, std::vector<Entry> entries)
      : s_(s),
        entries_(std::move(entries)),
        base_(project(weighted(s.data->stack, s.data->base_rows, s.rms_N),
                      weighted(s.data->stack, s.data->force_rows, s.rms_N), s.base->pull)),
        shapes_(hypothesesOf(s.effects)) {
    for (const Hypothesis& h : shapes_) {
      columns_.push_back(columnsOf(h));
      first_pull_.push_back(pulls_);
      pulls_ += columns_.back().rows() - base_.residual.size();
    }
    set_num_residuals(static_cast<int>(base_.residual.size() + pulls_));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(entries_.size()));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    moveTo(parameters[0]);
    const Eigen::Index n = base_.residual.size();
    const std::vector<Eigen::Index> first = firstColumns();
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n + pulls_, first.back());
    Eigen::VectorXd target = Eigen::VectorXd::Zero(n + pulls_);
    target.head(n) = base_.residual;
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      if (isWhole(shapes_[k])) target[n + first_pull_[k]] = columns_[k](n, 0);
    }
    for (std::size_t k = 0; k < columns_.size(); ++k)
      place(columns_[k], k, all.middleCols(first[k], columns_[k].cols()));
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(all);
    const Eigen::VectorXd coefficients = qr.solve(target);
    Eigen::Map<Eigen::VectorXd>(residuals, target.size()) = target - all * coefficients;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    const Eigen::MatrixXd slopes = slopesOf(coefficients, first);
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor>(jacobians[0], slopes.rows(), slopes.cols()) = all * qr.solve(slopes) - slopes;
    return true;
  }

 private:
  /// Without what the base explains; below it, where the joint fit pulls its coefficients to zero (as columns that the
  /// base nearly explains would run away without), that pull.
  Eigen::MatrixXd columnsOf(const Hypothesis& h) const {
    const Eigen::MatrixXd c = weighted(s_.data->stack, effectRows(*s_.data, h), s_.rms_N);
    const bool whole = isWhole(h);
    const Eigen::Index pulls = whole || h.place.candidate->isPulled(c.cols()) ? c.cols() : 0;
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(c.rows() + pulls, c.cols());
    out.topRows(c.rows()) = c - base_.q * (base_.q.transpose() * c);
    out.bottomRows(pulls).diagonal() = (whole ? kPullToWhole : kPull) * c.colwise().norm().head(pulls);
    return out;
  }
  /// Brings an effect's columns, or their combination, to the rows of the whole problem.
  void place(const Eigen::MatrixXd& columns, std::size_t effect, Eigen::Ref<Eigen::MatrixXd> to) const {
    const Eigen::Index n = base_.residual.size();
    to.topRows(n) = columns.topRows(n);
    to.middleRows(n + first_pull_[effect], columns.rows() - n) = columns.bottomRows(columns.rows() - n);
  }
  std::vector<Eigen::Index> firstColumns() const {
    std::vector<Eigen::Index> first(1, 0);
    for (const Eigen::MatrixXd& c : columns_)
      first.push_back(first.back() + c.cols());
    return first;
  }
  /// Columns are kept from one point to the next where their shape stays.
  void moveTo(const double* values) const {
    std::vector<char> moved(shapes_.size(), 0);
    for (std::size_t e = 0; e < entries_.size(); ++e) {
      double& value = shapes_[entries_[e].effect].shape[entries_[e].parameter];
      if (value != values[e]) moved[entries_[e].effect] = 1;
      value = values[e];
    }
    inParallel(shapes_.size(), [&](std::size_t k) {
      if (moved[k] != 0) columns_[k] = columnsOf(shapes_[k]);
    });
  }
  /// Derivative of the effects' sum by each entry, coefficients held.
  Eigen::MatrixXd slopesOf(const Eigen::VectorXd& coefficients, const std::vector<Eigen::Index>& first) const {
    Eigen::MatrixXd slopes =
        Eigen::MatrixXd::Zero(base_.residual.size() + pulls_, static_cast<Eigen::Index>(entries_.size()));
    inParallel(entries_.size(), [&](std::size_t e) {
      const std::size_t k = entries_[e].effect;
      Hypothesis low = shapes_[k], high = shapes_[k];
      const double value = low.shape[entries_[e].parameter];
      const double step = std::max(kRelativeStep * std::abs(value), kLeastStep);
      low.shape[entries_[e].parameter] = value - step;
      high.shape[entries_[e].parameter] = value + step;
      place((columnsOf(high) - columnsOf(low)) * coefficients.segment(first[k], columns_[k].cols()) / (2.0 * step), k,
            slopes.col(static_cast<Eigen::Index>(e)));
    });
    return slopes;
  }

  const Search& s_;
  const std::vector<Entry> entries_;
  const Projection base_;
  std::vector<Eigen::Index> first_pull_;  ///< of each effect, below the residuals
  Eigen::Index pulls_ = 0;
  mutable std::vector<Hypothesis> shapes_;        ///< of the last point
  mutable std::vector<Eigen::MatrixXd> columns_;  ///< weighted and without what the base explains, at that point
};

/// What may be refined, and how far.
struct Room {
  std::vector<Entry> entries;
  std::vector<double> values, low, high;
  std::vector<char> goes_on;  ///< one that may have either sign: nothing but the reach ends it

  void add(const Search& s, const Entry& entry) {
    const Hypothesis& h = s.effects[entry.effect].hypothesis;
    const ShapeParameter bounds = h.place.candidate->shapeParameters()[entry.parameter];
    const double value = h.shape[entry.parameter], reach = bounds.low < 0.0 ? kReach_m : 0.0;
    double a = std::min(value / kFarthest, value - reach), b = std::max(value * kFarthest, value + reach);
    if (entry.parameter == 0) {
      const auto [shortest, longest] = roomOfPeriod(s, entry.effect);
      a = std::max(a, shortest);
      b = std::min(b, longest);
    }
    a = std::min(value, std::max(bounds.low, std::min(a, b)));
    b = std::max(value, std::min(bounds.high, std::max(a, b)));
    if (a >= b) return;  // zero, at its bound: Ceres would refuse all others with it
    entries.push_back(entry);
    values.push_back(value);
    low.push_back(a);
    high.push_back(b);
    goes_on.push_back(bounds.low < 0.0 && low.back() > bounds.low && high.back() < bounds.high);
  }
  bool isAtItsReach(std::size_t k) const {
    return goes_on[k] != 0 && std::min(values[k] - low[k], high[k] - values[k]) < kAtReach_m;
  }
};

Room roomOf(const Search& s) {
  Room room;
  for (std::size_t k = 0; k < s.effects.size(); ++k) {
    const std::vector<ShapeParameter> shapes = s.effects[k].hypothesis.place.candidate->shapeParameters();
    for (std::size_t p = 0; p < shapes.size(); ++p) {
      if (!shapes[p].fixed && s.effects[k].band_hz == 0.0) room.add(s, {k, p});
    }
  }
  return room;
}

/// All of it, by the joint fit that follows: bounds of coefficients and forces that rest on the model are not seen by
/// refinement.
bool isWorse(const Search& s, const Eigen::VectorXd& rms_before_N) {
  return s.rms_N.cwiseQuotient(rms_before_N).squaredNorm() > static_cast<double>(s.rms_N.size());
}

/// Shapes of friction and of what comes late would go off step by step, to what laws near rest and rivals leave.
bool wanders(const Search& s, const Room& room) {
  return std::any_of(room.entries.begin(), room.entries.end(), [&](const Entry& e) {
    const Candidate& candidate = *s.effects[e.effect].hypothesis.place.candidate;
    return candidate.isFriction() || candidate.leads() || candidate.lags();
  });
}

/// Whether shapes came nearer to the data and may come nearer still: squares fall, or an anchor has moved only as far as
/// it may at once.
bool refineOnce(Search& s) {
  Room room = roomOf(s);
  if (room.entries.empty()) return false;
  ceres::Problem problem;
  problem.AddResidualBlock(new LeftBeside(s, room.entries), nullptr, room.values.data());
  for (std::size_t k = 0; k < room.entries.size(); ++k) {
    problem.SetParameterLowerBound(room.values.data(), static_cast<int>(k), room.low[k]);
    problem.SetParameterUpperBound(room.values.data(), static_cast<int>(k), room.high[k]);
  }
  ceres::Solver::Options options;
  options.max_num_iterations = kSteps;
  options.linear_solver_type = ceres::DENSE_QR;
  options.line_search_interpolation_type = ceres::QUADRATIC;  // the cubic one asks for derivatives at every trial
  options.max_num_line_search_step_size_iterations = kLineSteps;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable() || !(summary.final_cost < summary.initial_cost)) return false;
  bool goes_on = !wanders(s, room) && summary.final_cost < kStillFalls * summary.initial_cost;
  const std::vector<FoundEffect> before = s.effects;
  const Eigen::VectorXd rms_before_N = s.rms_N;
  for (std::size_t k = 0; k < room.entries.size(); ++k) {
    s.effects[room.entries[k].effect].hypothesis.shape[room.entries[k].parameter] = room.values[k];
    goes_on = goes_on || room.isAtItsReach(k);
  }
  refit(s);
  if (isWorse(s, rms_before_N)) {
    s.effects = before;
    refit(s);
    return false;
  }
  return goes_on;
}

/// Rows hardly tell a shape with its size from another with another: the one that is whole (Candidate::ofSize), where
/// it leaves hardly more.
void makeWhole(Search& s) {
  for (std::size_t k = 0; k < s.effects.size(); ++k) {
    for (int step = 0; step < kWholeSteps; ++step) {
      const FoundEffect& e = s.effects[k];
      if (e.coefficients.size() != 1 || !(e.coefficients[0] > 0.0) || e.band_hz != 0.0) break;
      const std::vector<double> shape = e.hypothesis.place.candidate->ofSize(e.hypothesis.shape, e.coefficients[0]);
      if (shape.empty() || std::abs(e.coefficients[0] - 1.0) < kNearlyWhole) break;
      const std::vector<FoundEffect> before = s.effects;
      const Eigen::VectorXd rms_before_N = s.rms_N;
      s.effects[k].hypothesis.shape = shape;
      refit(s);
      const double squares = s.rms_N.cwiseQuotient(rms_before_N).squaredNorm();
      if (squares <= kHardlyMore * static_cast<double>(s.rms_N.size())) continue;
      s.effects = before;
      refit(s);
      break;
    }
  }
}

}  // namespace

void refineShapes(Search& s) {
  for (int round = 0; round < kTimesRefined && refineOnce(s); ++round) {
  }
  makeWhole(s);
}

}  // namespace knee_robot::tracing
