#pragma once

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {

/// Two points that something is tied to.
struct Anchors {
  mechanism::Vector3 base_m = mechanism::Vector3::Zero();      ///< base frame
  mechanism::Vector3 platform_m = mechanism::Vector3::Zero();  ///< platform frame
};

/// The straight line between them along a recording, one entry a sample.
struct Line {
  Eigen::MatrixXd lever;  ///< samples x actuators: force of each per newton of force that lengthens the line
  Eigen::VectorXd length_m, rate_m_per_s;
  double period_s = 0.0;  ///< of the samples
  Eigen::VectorXd way_m;  ///< by which it became longer since the sample before, by its rates
};
Line lineBetween(const EffectInput& input, const Anchors& anchors);
/// Of a shape that begins with X and Y of the base point and of the platform point; both are at height 0.
Anchors anchorsOf(const std::vector<double>& shape);

/// Pairs of points to begin a search from: the middle of base and platform and four points about each, at height 0.
std::vector<Anchors> crossOfAnchors(const mechanism::Robot& robot);

/// What acts along the straight line between a point of the base and a point of the platform: a spring, a cable, a
/// damper. Where it is anchored is searched: the first four shape parameters. Heights are left at 0: to first order
/// they are a change of the length.
class LineEffect : public Candidate {
 public:
  bool restsOnModel() const override { return false; }
  bool shared() const override { return true; }
  std::vector<ShapeParameter> shapeParameters() const override;
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override;
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override;
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override;
  std::vector<Eigen::MatrixXd> columnsOfAll(const EffectInput& input, const std::vector<double>& shape) const override;

 protected:
  virtual Anchors anchors(const std::vector<double>& shape) const { return anchorsOf(shape); }
  /// Force (N) with which it resists being longer, per unit of each coefficient: samples x coefficients.
  virtual Eigen::MatrixXd resistance(const Line& line, const std::vector<double>& shape) const = 0;
};

/// One that may be tied at any height of the base, the fifth shape parameter: where it acts only beyond a length, the
/// height is more than a change of that.
class RaisedLineEffect : public LineEffect {
 public:
  std::vector<ShapeParameter> shapeParameters() const override;

 protected:
  static constexpr std::size_t kBaseZ = 4;  ///< in the shape
  Anchors anchors(const std::vector<double>& shape) const override;
  /// Beginnings of shapes to search from: at the height of the base, or as far above the platform.
  static std::vector<std::vector<double>> anchorsToTry(const EffectInput& input);
};

/// A damper: what it resists with follows a power of the rate, the fifth shape parameter.
class LineDamper : public LineEffect {
 public:
  std::vector<ShapeParameter> shapeParameters() const override;
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override;
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override;

 protected:
  /// sign(v) |v|^exponent for the rate v; proportional to it below 1 mm/s.
  static Eigen::ArrayXd powerOfRate(const Line& line, const std::vector<double>& shape);
};

}  // namespace knee_robot::tracing
