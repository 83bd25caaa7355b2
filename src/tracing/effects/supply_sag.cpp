#include <algorithm>
#include <cmath>

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr double kLeast_N2 = 1e3, kMost_N2 = 1e6;
constexpr double kMostLost = 50.0;                       ///< where a small part of half_at_N2 is taken
constexpr double kShortest_s = 0.003, kLongest_s = 1.0;  ///< the shortest: at once
constexpr double kSagBeside = 2.0;                       ///< factor between neighbours
constexpr double kMostWork_N2_per_W = 1e4, kWork_N2_per_W = 1000.0;
constexpr double kLeastTaken = 0.05;  ///< of the squares, where work is fed back: no negative or boundless shares

/// All drives hang on one supply, whose voltage sags with what they take together, up to an end and with a lag: each then
/// needs a larger command for the same force. What a drive takes goes with the square of its force, each by its own
/// motor; of a switching amplifier the work that it does as well, in units of those squares (N^2 a watt; 0: an
/// amplifier that only passes its current on).
class SupplySag : public Candidate {
 public:
  std::string name() const override { return "supply_sag"; }
  bool shared() const override { return true; }
  bool ofDrive() const override { return true; }
  std::string sentence() const override {
    return "All drives give less force per volt the more they give together: they hang on a supply that sags.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"half_at_N2", kLeast_N2, kMost_N2},
            {"lag_s", kShortest_s, kLongest_s},
            {"work_N2_per_W", 0.0, kMostWork_N2_per_W, false, 0.0}};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    std::vector<std::vector<double>> grid;
    for (const std::vector<double>& half : geometricGrid(kLeast_N2, kMost_N2, 5)) {
      for (const double lag_s : {kShortest_s, 0.05, 0.3}) {
        for (const double work : {0.0, kWork_N2_per_W})
          grid.push_back({half[0], lag_s, work});
      }
    }
    return grid;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    std::vector<std::vector<double>> out;
    for (const double factor : {std::pow(kSagBeside, -step), std::pow(kSagBeside, step)}) {
      out.push_back({std::clamp(s[0] * factor, kLeast_N2, kMost_N2), s[1], s[2]});
      out.push_back({s[0], std::clamp(s[1] * factor, kShortest_s, kLongest_s), s[2]});
      if (s[2] > 0.0) out.push_back({s[0], s[1], std::min(s[2] * factor, kMostWork_N2_per_W)});
    }
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    std::vector<Coefficient> out;
    for (int i = 0; i < mechanism::kLegs; ++i)
      out.push_back({"most_lost_share_by_actuator_" + std::to_string(i + 1), true});
    return out;
  }
  bool isPulled(Eigen::Index) const override { return false; }  // none of them can be negative
  bool plausible(const Eigen::VectorXd& coefficients) const override { return coefficients.maxCoeff() < kMostLost; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    const double keeps = std::exp(-input.signals().period_s / shape[1]);
    Eigen::MatrixXd out(input.samples(), input.axes());
    Eigen::RowVectorXd sag = Eigen::RowVectorXd::Zero(input.axes());
    for (int n = 0; n < input.samples(); ++n) {
      const Eigen::RowVectorXd taken_N2 = takenBy(input, n, shape[2]);
      const double gains = n == 0 ? 1.0 : 1.0 - keeps;  // it had settled before it was recorded
      sag += gains * (taken_N2 / (taken_N2.sum() + shape[0]) - sag);
      out.row(n) = input.needed_N(n, actuator) * sag;
    }
    return out;
  }

 private:
  /// What every drive takes at a sample. Drives that feed work back spare the others theirs, but raise no voltage.
  static Eigen::RowVectorXd takenBy(const EffectInput& input, int n, double work_N2_per_W) {
    const Eigen::RowVectorXd force_N = input.needed_N.row(n), velocity = input.signals().velocity_m_per_s.row(n);
    const Eigen::RowVectorXd squares = force_N.cwiseAbs2();
    const Eigen::RowVectorXd all = squares + work_N2_per_W * force_N.cwiseProduct(velocity);
    if (all.sum() > kLeastTaken * squares.sum()) return all;
    return kLeastTaken * squares;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeSupplySag() {
  return std::make_unique<SupplySag>();
}

}  // namespace knee_robot::tracing
