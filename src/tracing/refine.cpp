#include <ceres/ceres.h>

#include <Eigen/QR>
#include <cmath>

#include "search.h"

namespace knee_robot::tracing {
namespace {

constexpr int kSteps = 6;
constexpr double kRelativeStep = 1e-3;
constexpr double kReach_m = 0.2;   ///< by which what may have either sign (an anchor) moves at least, past zero
constexpr double kFarthest = 1.5;  ///< factor by which a shape may move: further away it is another hypothesis

/// Where a refined parameter is: effect, entry of its shape.
struct Entry {
  std::size_t effect = 0, parameter = 0;
};

/// What base and effects leave, as a function of the shapes: coefficients are solved for (variable projection).
class LeftBeside {
 public:
  LeftBeside(const Search& s, std::vector<Entry> entries)
      : s_(s),
        entries_(std::move(entries)),
        base_(project(weighted(s.data->stack, s.data->base_rows, s.rms_N),
                      weighted(s.data->stack, s.data->force_rows, s.rms_N), s.base->pull)),
        shapes_(hypothesesOf(s.effects)),
        columns_(shapes_.size()) {
    for (std::size_t k = 0; k < shapes_.size(); ++k)
      columns_[k] = columnsOf(shapes_[k]);
  }
  bool operator()(double const* const* parameters, double* residuals) const {
    std::vector<Hypothesis> now = shapes_;
    std::vector<char> moved(now.size(), 0);
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      double& value = now[entries_[k].effect].shape[entries_[k].parameter];
      moved[entries_[k].effect] |= value != parameters[0][k];
      value = parameters[0][k];
    }
    Eigen::Index count = 0;
    for (const Eigen::MatrixXd& c : columns_)
      count += c.cols();
    Eigen::MatrixXd all(base_.residual.size(), count);
    Eigen::Index at = 0;
    for (std::size_t k = 0; k < now.size(); ++k) {
      all.middleCols(at, columns_[k].cols()) = moved[k] ? columnsOf(now[k]) : columns_[k];
      at += columns_[k].cols();
    }
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(all);
    Eigen::Map<Eigen::VectorXd>(residuals, base_.residual.size()) = base_.residual - all * qr.solve(base_.residual);
    return true;
  }

 private:
  Eigen::MatrixXd columnsOf(const Hypothesis& h) const {
    const Eigen::MatrixXd c = weighted(s_.data->stack, effectRows(*s_.data, h), s_.rms_N);
    return c - base_.q * (base_.q.transpose() * c);
  }

  const Search& s_;
  std::vector<Entry> entries_;
  Projection base_;
  std::vector<Hypothesis> shapes_;
  std::vector<Eigen::MatrixXd> columns_;
};

}  // namespace

void refineShapes(Search& s) {
  std::vector<Entry> entries;
  std::vector<double> values;
  for (std::size_t k = 0; k < s.effects.size(); ++k) {
    const Hypothesis& h = s.effects[k].hypothesis;
    const std::vector<ShapeParameter> shapes = h.place.candidate->shapeParameters();
    for (std::size_t p = 0; p < shapes.size(); ++p) {
      if (shapes[p].fixed || s.effects[k].band_hz > 0.0) continue;
      entries.push_back({k, p});
      values.push_back(h.shape[p]);
    }
  }
  if (entries.empty()) return;
  ceres::NumericDiffOptions step;
  step.relative_step_size = kRelativeStep;
  auto* cost = new ceres::DynamicNumericDiffCostFunction<LeftBeside, ceres::CENTRAL>(new LeftBeside(s, entries),
                                                                                     ceres::TAKE_OWNERSHIP, step);
  cost->AddParameterBlock(static_cast<int>(values.size()));
  cost->SetNumResiduals(static_cast<int>(s.data->force_rows.size()));
  ceres::Problem problem;
  problem.AddResidualBlock(cost, nullptr, values.data());
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const Hypothesis& h = s.effects[entries[k].effect].hypothesis;
    const ShapeParameter bounds = h.place.candidate->shapeParameters()[entries[k].parameter];
    const double reach = bounds.low < 0.0 ? kReach_m : 0.0;
    const double a = std::min(values[k] / kFarthest, values[k] - reach);
    const double b = std::max(values[k] * kFarthest, values[k] + reach);
    problem.SetParameterLowerBound(values.data(), static_cast<int>(k),
                                   std::min(values[k], std::max(bounds.low, std::min(a, b))));
    problem.SetParameterUpperBound(values.data(), static_cast<int>(k),
                                   std::max(values[k], std::min(bounds.high, std::max(a, b))));
  }
  ceres::Solver::Options options;
  options.max_num_iterations = kSteps;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable() || !(summary.final_cost < summary.initial_cost)) return;
  for (std::size_t k = 0; k < entries.size(); ++k)
    s.effects[entries[k].effect].hypothesis.shape[entries[k].parameter] = values[k];
  refit(s);
}

}  // namespace knee_robot::tracing
