#pragma once

#include <array>

#include "residual_estimator.h"

namespace knee_robot::control {

/// Tells apart what makes a residual: a load that stays, a push, friction that is not what it was, a model that does
/// not hold any more.
///
/// - load: mean of the wrench over kMean_s of motion (rest counts little: friction hides a part of it). Its mass is -Fz
///   / g, its place My / Fz.
/// - push: what is certain beside that load is more than its limit for kPush_s. One that stays becomes a load.
/// - friction of a leg: residual forwards less residual backwards, over the same of the model's friction, each the mean
///   of kFriction_s of motion; what a load or an offset does is in both.
/// - model: a leg's running rms beyond its band, none of the above being the reason.
/// Limits, both from the model file: what the legs' bands (three times the residual that it promises) can look like at
/// the platform, or kReversal of what its friction can (of a load kLoad), whichever is more: that much of friction
/// nobody knows while directions change.
/// One a robot; real-time safe.
class DisturbanceClassifier {
 public:
  static constexpr double kMean_s = 3.0;
  static constexpr double kPush_s = 0.3;
  static constexpr double kFriction_s = 10.0;  // of motion in one direction
  static constexpr double kFrictionLeast_s = 4.0;
  static constexpr double kFrictionChange = 0.2;
  static constexpr double kRestWeight = 0.05;
  static constexpr double kReversal = 0.35, kLoad = 0.45;
  static constexpr double kHolds_s = 20.0;  // beyond the band for so long

  /// What acts on the robot, in the words that the operator gets.
  struct Verdict {
    bool carries = false;  ///< a load that nobody declared
    double load_kg = 0.0;  ///< negative: something that the model knows of is gone
    double load_m = 0.0;   ///< from the platform's origin, towards +X
    bool pushed = false;
    mechanism::Vector4 push = mechanism::Vector4::Zero();  ///< wrench beside the load
    std::array<bool, 4> friction_changed{};
    mechanism::Vector4 friction_growth = mechanism::Vector4::Zero();  ///< 0.2: 20 % more
    /// The same, 0 or less, with what was taken for a push: friction that is half of the model's looks like one.
    mechanism::Vector4 friction_least = mechanism::Vector4::Zero();
    bool holds = true;
  };

  /// The Drivers do not carry. What is known of friction stays.
  void reset() noexcept;
  /// `guided`: a hand moves the platform. Along the motion it looks like friction that has become less, and what the
  /// model does not explain is the hand.
  const Verdict& step(const ForceKnowledge& knowledge, const ResidualEstimator::Estimate& estimate, double dt,
                      bool guided = false) noexcept;
  const Verdict& verdict() const noexcept { return out_; }

 private:
  struct Direction {
    double time_s = 0.0, residual_N = 0.0, friction_N = 0.0;
    void take(double residual, double friction, double dt) noexcept;
  };
  /// Residual forwards less backwards, and the same of the model's friction, which is 0 as long as neither is known.
  struct Difference {
    double found_N = 0.0, expected_N = 0.0;
    double growth() const noexcept { return expected_N > 0.0 ? found_N / expected_N : 0.0; }
  };
  static Difference differenceOf(const std::array<Direction, 2>& directions) noexcept;
  void estimateLoad(const ForceKnowledge& knowledge, const ResidualEstimator::Estimate& now, double dt) noexcept;
  void estimateFriction(const ForceKnowledge& knowledge, const ResidualEstimator::Estimate& now, double dt) noexcept;

  mechanism::Vector4 mean_ = mechanism::Vector4::Zero();
  double weight_s_ = 0.0;  // behind the mean
  double away_s_ = 0.0;    // from the mean
  double beyond_s_ = 0.0;  // the band
  std::array<std::array<Direction, 2>, 4> directions_{}, pushed_or_not_{};
  Verdict out_;
};

}  // namespace knee_robot::control
