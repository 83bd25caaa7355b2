#include "knee_robot/report/plot_series.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "knee_robot/base/constants.h"

namespace knee_robot::report {
namespace {

std::vector<double> times(std::size_t n) {
  std::vector<double> t;
  for (std::size_t k = 0; k < n; ++k)
    t.push_back(0.01 * static_cast<double>(k));
  return t;
}

Eigen::VectorXd wave(Eigen::Index n) {
  return Eigen::VectorXd::LinSpaced(n, 0.0, 0.01 * static_cast<double>(n)).array().sin();
}

TEST(PlotSeries, KeepsShortLinesAsTheyAre) {
  const PlotSeries series(times(1500));
  const Json line = series.line(wave(1500));
  ASSERT_EQ(line.size(), 1500u);
  EXPECT_EQ(series.x().size(), 1500u);
  for (std::size_t k = 0; k < 1500; ++k)
    ASSERT_NEAR(line[k].get<double>(), wave(1500)[static_cast<Eigen::Index>(k)], 1e-3);
}

TEST(PlotSeries, ThinsLongLinesButKeepsTheirPeaksWhereTheyAre) {
  const PlotSeries series(times(100000));
  Eigen::VectorXd values = wave(100000);
  values[54321] = 50.0;
  values[70000] = -7.0;
  const Json line = series.line(values), x = series.x();
  ASSERT_EQ(line.size(), x.size());
  EXPECT_LE(line.size(), 1502u);
  double highest = 0.0, lowest = 0.0;
  std::size_t top = 0, bottom = 0;
  for (std::size_t k = 0; k < line.size(); ++k) {
    if (line[k].get<double>() > highest) highest = line[top = k];
    if (line[k].get<double>() < lowest) lowest = line[bottom = k];
  }
  EXPECT_EQ(highest, 50.0);
  EXPECT_EQ(lowest, -7.0);
  EXPECT_NEAR(x[top].get<double>(), 543.21, 1.4) << "within its stretch of 134 samples";
  EXPECT_NEAR(x[bottom].get<double>(), 700.0, 1.4);
}

TEST(PlotSeries, InterruptsTheLineWhereThereIsNoValue) {
  Eigen::VectorXd few = wave(10);
  few[5] = kNan;
  const Json line = PlotSeries(times(10)).line(few);
  for (std::size_t k = 0; k < 10; ++k)
    EXPECT_EQ(line[k].is_null(), k == 5) << k;
  Eigen::VectorXd many = wave(100000);
  many.segment(20000, 30000).setConstant(kNan);
  many[60000] = std::numeric_limits<double>::infinity();
  const Json thinned = PlotSeries(times(100000)).line(many);
  std::size_t gaps = 0;
  for (const Json& value : thinned)
    gaps += value.is_null();
  EXPECT_NEAR(static_cast<double>(gaps), 0.3 * static_cast<double>(thinned.size()), 4.0);
}

TEST(PlotSeries, RoundsToWhatAPlotShows) {
  EXPECT_EQ(plotNumbers({0.7123456789, 0.7223456789}).dump(), "[0.71235,0.72235]");
  EXPECT_EQ(plotNumbers({-12345.678, 54321.012}).dump(), "[-12346.0,54321.0]");
  EXPECT_EQ(plotNumbers({kNan, -1e-9, 1.0}).dump(), "[null,0.0,1.0]") << "no -0";
  EXPECT_EQ(logNumbers({1.23456e-7, 98765.4, kNan}).dump(), "[1.235e-07,98770.0,null]");
}

TEST(PlotSeries, AValueThatDiffersByRoundingIsFlat) {
  const double one_up = std::nextafter(1.0, 2.0);  // a coherence without a reference
  EXPECT_EQ(plotNumbers({1.0, one_up, 1.0}).dump(), "[1.0,1.0,1.0]");
}

TEST(PlotSeries, SurvivesEmptyAndConstantData) {
  EXPECT_EQ(PlotSeries({}).line(Eigen::VectorXd()).dump(), "[]");
  EXPECT_EQ(plotNumbers({kNan, kNan}).dump(), "[null,null]");
  EXPECT_EQ(plotNumbers({0.0, 0.0}).dump(), "[0.0,0.0]");
  EXPECT_EQ(plotNumbers({3.0}).dump(), "[3.0]");
}

}  // namespace
}  // namespace knee_robot::report
