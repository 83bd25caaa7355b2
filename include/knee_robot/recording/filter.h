#pragma once

#include <Eigen/Core>

namespace knee_robot::recording {

/// How a low-pass continues a signal beyond its ends; see ZeroPhaseLowPass.
enum class Continuation {
  Line,     ///< of any signal
  Parabola  ///< of a position, which may be recorded while it accelerates
};

/// Zero-phase low-pass: a Butterworth filter of 4th order run forward and backward over each column (the amplitude at
/// the cut-off is 1/2). The signal is continued at both ends by its reflection at the point where a straight line
/// through its outermost quarter period of the cut-off ends, and the filter starts in the steady state of the first
/// value: constants and straight lines pass unchanged up to the ends, and no single sample is the end. Such a
/// reflection has no acceleration at its centre; a position's is about the parabola through its outermost half period,
/// where that is surely curved.
class ZeroPhaseLowPass {
 public:
  /// Share of the sampling rate at and above which a cut-off does nothing.
  static constexpr double kMostOfRate = 0.45;

  /// `cutoff_hz` must be positive; see kMostOfRate.
  ZeroPhaseLowPass(double cutoff_hz, double rate_hz, Continuation continuation = Continuation::Line);

  void apply(Eigen::Ref<Eigen::VectorXd> signal) const;
  /// Every column by itself.
  void applyToColumns(Eigen::MatrixXd& signals) const;
  /// Samples at either end that the continuation may influence visibly (about one period of the cut-off).
  int edgeSamples() const { return edge_; }

 private:
  struct Section {
    double b0, b1, b2, a1, a2;
  };
  using Four = Eigen::Array<double, 4, Eigen::Dynamic>;
  void run(Four& signals) const;
  void continueBeyondEnds(Four& signals, Eigen::Index pad) const;

  Continuation continuation_;
  bool active_ = false;
  int padding_ = 0;
  int edge_ = 0;
  Section sections_[2]{};
};

/// First derivative of uniformly sampled columns by the central five-point formula (fourth order; three-point formulas
/// next to the ends and at them, of two rows their difference). At least two rows.
Eigen::MatrixXd firstDerivative(const Eigen::MatrixXd& signals, double period_s);
/// Second derivative in the same way; the two outermost rows repeat their neighbours. At least three rows.
Eigen::MatrixXd secondDerivative(const Eigen::MatrixXd& signals, double period_s);

}  // namespace knee_robot::recording
