#pragma once

#include <Eigen/Core>

#include "knee_robot/mechanism/geometry.h"
#include "knee_robot/trajectory/reference_file.h"

namespace knee_robot::excitation {

/// Shape of a finite Fourier series with smooth ends: the series is multiplied by a window that rises from 0 to 1
/// within `ramp_s`, stays at 1 for one or more periods, and falls back, both by the quintic 10 s^3 - 15 s^4 + 6 s^5. So
/// the motion is periodic in between and starts and ends at rest in the series' centre.
struct SeriesShape {
  int harmonics = 7;
  double period_s = 16.0;    ///< of the first harmonic
  double ramp_s = 2.0;       ///< of each ramp
  double duration_s = 20.0;  ///< ramps included
};

/// The shape in whole points of the stream, the period being what its ramps leave, so that the last point is exactly
/// the centre. InputError where harmonics, ramps or duration are out of range.
SeriesShape completedShape(SeriesShape shape);

/// A sine and a cosine a harmonic.
inline Eigen::Index coefficientColumns(const SeriesShape& shape) {
  return 2 * static_cast<Eigen::Index>(shape.harmonics);
}

/// What the coefficients are multiplied with at one instant: window times sin(j w t) and cos(j w t), j = 1..harmonics,
/// in this order of columns (sin_1, cos_1, sin_2, ...), with first and second time derivative.
struct SeriesBasis {
  Eigen::RowVectorXd value, rate, acceleration;
};
SeriesBasis seriesBasis(const SeriesShape& shape, double time);

/// Series of four coordinates: actuator lengths (m), or platform coordinates.
struct FourierSeries {
  SeriesShape shape;
  trajectory::Space space = trajectory::Space::Actuator;
  mechanism::Vector4 centre = mechanism::Vector4::Zero();
  Eigen::Matrix<double, 4, Eigen::Dynamic> coefficients;  ///< 4 x 2 harmonics, columns as in SeriesBasis
};

/// The four coordinates with their derivatives at one instant.
struct SeriesPoint {
  mechanism::Vector4 value, rate, acceleration;
};
SeriesPoint pointAt(const FourierSeries& series, const SeriesBasis& basis);

/// The series sampled every kStreamPeriod, first and last point at rest in the centre.
trajectory::Reference sampledReference(const FourierSeries& series);

}  // namespace knee_robot::excitation
