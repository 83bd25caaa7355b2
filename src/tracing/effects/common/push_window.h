#pragma once

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {

/// When somebody pushed: part of one training recording; shape = recording (from 1), from_s, duration_s. What every
/// push shares, whatever it acts on.
class PushWindow : public Candidate {
 public:
  std::string name() const override { return "external_force"; }
  bool restsOnModel() const override { return false; }
  bool shared() const override { return true; }
  bool transfers() const override { return false; }
  bool local() const override { return true; }
  std::vector<ShapeParameter> shapeParameters() const override;
  /// `input` is one recording; the windows of the others are added when they are asked for themselves.
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override;
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override;

 protected:
  /// Samples of `input` in the window, `end` not among them. Not those before the actuator has moved: at rest friction
  /// may be anything.
  struct Samples {
    int begin = 0, end = 0;
  };
  static Samples samplesOf(const EffectInput& input, int actuator, const std::vector<double>& shape);
};

}  // namespace knee_robot::tracing
