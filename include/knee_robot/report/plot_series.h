#pragma once

#include <Eigen/Core>
#include <vector>

#include "knee_robot/report/json_parts.h"

namespace knee_robot::report {

/// Numbers for a plot, rounded to what a plot shows: a thousandth of their span. null where there is none.
Json plotNumbers(const std::vector<double>& values);
/// The same for a logarithmic axis: four digits of each.
Json logNumbers(const std::vector<double>& values);

/// The lines of a plot over one x (time), thinned to what a page shows: of more than 1500 points, the smallest and
/// largest value of every stretch in the order in which they come, null for a stretch without any. All lines share x().
class PlotSeries {
 public:
  explicit PlotSeries(const std::vector<double>& x);

  Json x() const { return x_; }
  /// One line, as long as the constructor's x.
  Json line(const Eigen::VectorXd& values) const;
  /// Every column of a matrix, as a list of lines.
  Json lines(const Eigen::MatrixXd& columns) const;

 private:
  std::size_t points_, stretch_;
  Json x_;
};

}  // namespace knee_robot::report
