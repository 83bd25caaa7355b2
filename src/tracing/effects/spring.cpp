#include "common/line_effect.h"

namespace knee_robot::tracing {
namespace {

/// A straight spring between a point of the base and a point of the platform: force k (d - d0) along their distance d.
/// Stiffness and k d0 are linear.
class Spring : public LineEffect {
 public:
  std::string name() const override { return "spring"; }
  std::string sentence() const override {
    return "A spring acts between a point of the base and a point of the platform: its force grows with their "
           "distance.";
  }
  bool isForceField() const override { return true; }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"stiffness_N_per_m", true}, {"stiffness_times_free_length_N", false}};
  }

 protected:
  Eigen::MatrixXd resistance(const Line& line, const std::vector<double>&) const override {
    Eigen::MatrixXd out(line.length_m.size(), 2);
    out << line.length_m, -Eigen::VectorXd::Ones(line.length_m.size());
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeSpring() {
  return std::make_unique<Spring>();
}

}  // namespace knee_robot::tracing
