#include "knee_robot/excitation/fourier_series.h"

#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::excitation {
namespace {

constexpr int kMostHarmonics = 30;
constexpr double kShortestRamp_s = 0.2;
constexpr double kShortestPeriod_s = 1.0;
constexpr double kLongest_s = 600.0;

struct Window {
  double value = 1.0, rate = 0.0, acceleration = 0.0;
};

Window windowAt(const SeriesShape& shape, double time) {
  const bool rising = time < shape.ramp_s;
  const double rest = rising ? time : shape.duration_s - time;
  if (rest >= shape.ramp_s) return {};
  if (rest <= 0.0) return {0.0, 0.0, 0.0};
  const double s = rest / shape.ramp_s, direction = rising ? 1.0 : -1.0;
  return {s * s * s * (10.0 + s * (-15.0 + 6.0 * s)), direction * 30.0 * s * s * (1.0 - s) * (1.0 - s) / shape.ramp_s,
          60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (shape.ramp_s * shape.ramp_s)};
}

}  // namespace

SeriesShape completedShape(SeriesShape shape) {
  if (shape.harmonics < 1 || shape.harmonics > kMostHarmonics) {
    throw InputError("harmonics " + std::to_string(shape.harmonics) + " is not in 1 to " +
                     std::to_string(kMostHarmonics));
  }
  if (!(shape.ramp_s >= kShortestRamp_s)) {  // nan, too
    throw InputError("a ramp of " + shortNumber(shape.ramp_s) + " s is shorter than the " +
                     shortNumber(kShortestRamp_s) + " s that a motion needs at least to rise from rest");
  }
  if (!(shape.duration_s >= 2.0 * shape.ramp_s + kShortestPeriod_s && shape.duration_s <= kLongest_s)) {
    throw InputError("duration " + shortNumber(shape.duration_s) + " s is not between two ramps of " +
                     shortNumber(shape.ramp_s) + " s with " + shortNumber(kShortestPeriod_s) + " s between them and " +
                     shortNumber(kLongest_s) + " s");
  }
  shape.duration_s = std::round(shape.duration_s / trajectory::kStreamPeriod) * trajectory::kStreamPeriod;
  shape.period_s = shape.duration_s - 2.0 * shape.ramp_s;
  return shape;
}

SeriesBasis seriesBasis(const SeriesShape& shape, double time) {
  const Window w = windowAt(shape, time);
  const Eigen::Index columns = coefficientColumns(shape);
  SeriesBasis basis;
  basis.value.resize(columns);
  basis.rate.resize(columns);
  basis.acceleration.resize(columns);
  for (int j = 1; j <= shape.harmonics; ++j) {
    const double omega = kTwoPi * j / shape.period_s;
    const double sine = std::sin(omega * time), cosine = std::cos(omega * time);
    const int column = 2 * (j - 1);
    const auto set = [&](int c, double f, double df) {
      const double ddf = -omega * omega * f;
      basis.value[c] = w.value * f;
      basis.rate[c] = w.rate * f + w.value * df;
      basis.acceleration[c] = w.acceleration * f + 2.0 * w.rate * df + w.value * ddf;
    };
    set(column, sine, omega * cosine);
    set(column + 1, cosine, -omega * sine);
  }
  return basis;
}

SeriesPoint pointAt(const FourierSeries& series, const SeriesBasis& basis) {
  return {series.centre + series.coefficients * basis.value.transpose(), series.coefficients * basis.rate.transpose(),
          series.coefficients * basis.acceleration.transpose()};
}

trajectory::Reference sampledReference(const FourierSeries& series) {
  trajectory::Reference reference;
  reference.name = "planned excitation";
  reference.space = series.space;
  const Eigen::Index last = std::lround(series.shape.duration_s / trajectory::kStreamPeriod);
  reference.points.resize(last + 1, 4);
  for (Eigen::Index k = 0; k <= last; ++k) {
    const SeriesBasis basis = seriesBasis(series.shape, static_cast<double>(k) * trajectory::kStreamPeriod);
    reference.points.row(k) = pointAt(series, basis).value.transpose();
  }
  return reference;
}

}  // namespace knee_robot::excitation
