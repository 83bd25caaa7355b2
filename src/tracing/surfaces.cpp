#include "surfaces.h"

#include <array>

namespace knee_robot::tracing {
namespace {

enum class Beside { Position, Load };
constexpr std::array<Beside, 2> kBesideSpeed = {Beside::Position, Beside::Load};
constexpr std::array<double, 6> kSharesOfFastest = {0.02, 0.1, 0.25, 0.45, 0.7, 1.0};
constexpr int kSpeedKnots = kSharesOfFastest.size(), kOtherKnots = 4;

class Surface : public Candidate {
 public:
  /// Knots of the speed, then those of the other signal; one entry an actuator.
  Surface(Beside beside, std::vector<std::vector<double>> knots) : beside_(beside), knots_(std::move(knots)) {}

  std::string name() const override { return "unnamed"; }
  bool isMap() const override { return true; }
  bool isFriction() const override { return true; }
  bool needsTwoRecordings() const override { return true; }
  bool worksOnBench() const override { return true; }
  bool restsOnModel() const override { return beside_ == Beside::Load; }
  double leastFloors() const override { return 2.0; }
  std::string sentence() const override {
    return std::string("No named effect fits; the dry friction depends smoothly on the speed and on the ") +
           (beside_ == Beside::Position ? "position" : "load") + " together.";
  }
  std::string dependsOn(int actuator) const override {
    const std::string own = std::to_string(actuator + 1);
    return "speed_" + own + "_m_per_s_and_" +
           (beside_ == Beside::Position ? "position_" + own + "_m" : "load_" + own + "_N") + "_times_direction";
  }
  std::vector<ShapeParameter> shapeParameters() const override { return knotParameters(kSpeedKnots + kOtherKnots); }
  std::vector<std::vector<double>> shapes(const EffectInput&, int actuator) const override {
    return {knots_[static_cast<std::size_t>(actuator)]};
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return knotCoefficients("force", "N", kSpeedKnots * kOtherKnots);
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& knots) const override {
    const auto middle = knots.begin() + kSpeedKnots;
    const Eigen::MatrixXd over_speed =
        hats(input.signals().velocity_m_per_s.col(actuator).cwiseAbs(), {knots.begin(), middle});
    const Eigen::MatrixXd over_other = hats(other(input, actuator), {middle, knots.end()});
    Eigen::MatrixXd out(input.samples(), kSpeedKnots * kOtherKnots);
    for (int k = 0; k < kSpeedKnots; ++k) {
      const Eigen::VectorXd at_speed = over_speed.col(k).cwiseProduct(input.share.col(actuator));
      out.middleCols(k * kOtherKnots, kOtherKnots) = at_speed.asDiagonal() * over_other;
    }
    return out;
  }
  Eigen::VectorXd other(const EffectInput& input, int actuator) const {
    return beside_ == Beside::Position ? input.signals().position_m.col(actuator) : input.load_N.col(actuator);
  }

 private:
  const Beside beside_;
  const std::vector<std::vector<double>> knots_;
};

/// Empty when one of the two hardly varies.
std::vector<double> surfaceKnots(const std::vector<EffectInput>& inputs, const Surface& surface, int actuator) {
  std::vector<double> speeds, others;
  for (const EffectInput& input : inputs) {
    const Eigen::VectorXd speed = input.signals().velocity_m_per_s.col(actuator).cwiseAbs();
    const Eigen::VectorXd other = surface.other(input, actuator);
    speeds.insert(speeds.end(), speed.data(), speed.data() + speed.size());
    others.insert(others.end(), other.data(), other.data() + other.size());
  }
  const Range of_speed = rangeOf(speeds), of_other = rangeOf(others);
  if (!of_speed.varies() || !of_other.varies()) return {};
  std::vector<double> knots;
  for (const double share : kSharesOfFastest)
    knots.push_back(share * of_speed.high);
  for (const double knot : evenKnots(others, of_other, false, kOtherKnots))
    knots.push_back(knot);
  return knots;
}

}  // namespace

void addSurfaces(const std::vector<EffectInput>& inputs, CandidateList& surfaces) {
  for (const Beside beside : kBesideSpeed) {
    std::vector<std::vector<double>> knots;
    for (int i = 0; i < inputs.front().axes(); ++i) {
      knots.push_back(surfaceKnots(inputs, Surface(beside, {}), i));
      if (knots.back().empty()) break;
    }
    if (!knots.back().empty()) surfaces.push_back(std::make_unique<Surface>(beside, std::move(knots)));
  }
}

std::unique_ptr<Candidate> surface(const std::string& depends_on, int actuator, const std::vector<double>& knots) {
  if (knots.size() != static_cast<std::size_t>(kSpeedKnots + kOtherKnots)) return nullptr;
  for (const Beside beside : kBesideSpeed) {
    auto found = std::make_unique<Surface>(
        beside, std::vector<std::vector<double>>(static_cast<std::size_t>(actuator) + 1, knots));
    if (found->dependsOn(actuator) == depends_on) return found;
  }
  return nullptr;
}

}  // namespace knee_robot::tracing
