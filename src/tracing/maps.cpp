#include <algorithm>
#include <cmath>
#include <functional>

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr int kKnots = 8;

using SignalOf = std::function<Eigen::VectorXd(const EffectInput&, int actuator)>;

/// Piecewise linear function of one signal: hat functions on knots at equal shares of the training samples. Optionally times the
/// direction of travel, for friction that depends on the signal.
class Map : public Candidate {
 public:
  Map(std::string signal, SignalOf of, bool friction, std::vector<std::vector<double>> knots)
      : signal_(std::move(signal)), of_(std::move(of)), friction_(friction), knots_(std::move(knots)) {}

  std::string name() const override { return "unnamed"; }
  std::string sentence() const override {
    return std::string("No named effect fits; the ") + (friction_ ? "friction" : "force") + " depends smoothly on " +
           signal_ + ".";
  }
  bool worksOnBench() const override { return true; }
  bool isFriction() const override { return friction_; }
  std::vector<ShapeParameter> shapeParameters() const override {
    std::vector<ShapeParameter> out;
    for (int k = 1; k <= kKnots; ++k)
      out.push_back({"knot_" + std::to_string(k), -1e9, 1e9});
    return out;
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int actuator) const override {
    return {knots_[static_cast<std::size_t>(actuator)]};
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    std::vector<Coefficient> out;
    for (int k = 1; k <= kKnots; ++k)
      out.push_back({"force_at_knot_" + std::to_string(k) + "_N", false});
    return out;
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& knots) const override {
    const Eigen::VectorXd x = of_(input, actuator);
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(x.size(), kKnots);
    for (Eigen::Index n = 0; n < x.size(); ++n) {
      const double sign = friction_ ? input.share(n, actuator) : 1.0;
      const double at = std::clamp(x[n], knots.front(), knots.back());  // constant beyond what training has seen
      std::size_t k = 0;
      while (k + 2 < knots.size() && at > knots[k + 1])
        ++k;
      const double part = (at - knots[k]) / (knots[k + 1] - knots[k]);
      out(n, static_cast<Eigen::Index>(k)) = sign * (1.0 - part);
      out(n, static_cast<Eigen::Index>(k) + 1) = sign * part;
    }
    return out;
  }
  int positionOf(int actuator) const override {
    if (signal_.rfind("position_", 0) != 0) return -1;
    return signal_[9] == '#' ? actuator : signal_[9] - '1';
  }
  std::string dependsOn(int actuator) const override {
    const std::string own = std::to_string(actuator + 1);
    std::string text = signal_;
    const std::size_t at = text.find('#');
    if (at != std::string::npos) text.replace(at, 1, own);
    return text + (friction_ ? "_times_direction" : "");
  }

 private:
  std::string signal_;
  SignalOf of_;
  bool friction_;
  std::vector<std::vector<double>> knots_;  ///< per actuator
};

/// Knots at equal shares of the samples; apart even where the signal rests. Empty when the signal hardly varies.
std::vector<double> knotsOf(const std::vector<EffectInput>& inputs, const SignalOf& of, int actuator) {
  std::vector<double> values;
  for (const EffectInput& input : inputs) {
    const Eigen::VectorXd x = of(input, actuator);
    values.insert(values.end(), x.data(), x.data() + x.size());
  }
  std::sort(values.begin(), values.end());
  const double low = values[values.size() / 200], high = values[values.size() - 1 - values.size() / 200];
  if (!(high - low > 1e-9)) return {};
  std::vector<double> knots;
  for (int k = 0; k < kKnots; ++k) {
    const double share = static_cast<double>(k) / (kKnots - 1);
    const double quantile = values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
    knots.push_back(0.5 * std::clamp(quantile, low, high) + 0.5 * (low + share * (high - low)));
  }
  return knots;
}

/// A signal that maps are made of.
struct MapSignal {
  std::string name;  ///< "#": number of the actuator itself
  SignalOf of;
  bool friction = false;
};

std::vector<MapSignal> mapSignals(bool bench, int axes) {
  std::vector<MapSignal> all;
  const auto add = [&](const std::string& name, const SignalOf& of, bool friction) {
    all.push_back({name, of, friction});
  };
  const auto own_velocity = [](const EffectInput& in, int i) -> Eigen::VectorXd {
    return in.signals().velocity_m_per_s.col(i);
  };
  const auto own_load = [](const EffectInput& in, int i) -> Eigen::VectorXd { return in.load_N.col(i); };
  const auto since = [](const EffectInput& in, int i) -> Eigen::VectorXd { return in.since_reversal_m.col(i); };
  const auto time = [](const EffectInput& in, int) -> Eigen::VectorXd {
    return Eigen::VectorXd::LinSpaced(in.samples(), 0.0, in.time(in.samples() - 1));
  };
  add("velocity_#_m_per_s", own_velocity, false);
  add("load_#_N", own_load, false);
  add("load_#_N", own_load, true);
  add("distance_since_reversal_#_m", since, true);
  add("time_s", time, false);
  add("time_s", time, true);
  if (bench) {  // independent axes: another one's motion cannot matter
    const auto own = [](const EffectInput& in, int i) -> Eigen::VectorXd { return in.signals().position_m.col(i); };
    add("position_#_m", own, false);
    add("position_#_m", own, true);
    return all;
  }
  for (int k = 0; k < axes; ++k) {
    const auto position = [k](const EffectInput& in, int) -> Eigen::VectorXd { return in.signals().position_m.col(k); };
    const auto velocity = [k](const EffectInput& in, int) -> Eigen::VectorXd {
      return in.signals().velocity_m_per_s.col(k);
    };
    add("position_" + std::to_string(k + 1) + "_m", position, false);
    add("position_" + std::to_string(k + 1) + "_m", position, true);
    add("velocity_" + std::to_string(k + 1) + "_m_per_s", velocity, false);
  }
  const char* const pose[] = {"pose_x_m", "pose_z_m", "pose_theta_rad", "pose_psi_rad"};
  for (int k = 0; k < 4; ++k) {
    const auto coordinate = [k](const EffectInput& in, int) {
      Eigen::VectorXd out(in.samples());
      for (int n = 0; n < in.samples(); ++n)
        out[n] = in.observation->motion.motion[static_cast<std::size_t>(n)].pose[k];
      return out;
    };
    add(pose[k], coordinate, false);
    add(pose[k], coordinate, true);
  }
  return all;
}

}  // namespace

CandidateList mapCandidates(const std::vector<EffectInput>& inputs) {
  CandidateList maps;
  for (const MapSignal& signal : mapSignals(inputs.front().force_per_pose_force.empty(), inputs.front().axes())) {
    std::vector<std::vector<double>> knots;
    for (int i = 0; i < inputs.front().axes(); ++i) {
      knots.push_back(knotsOf(inputs, signal.of, i));
      if (knots.back().empty()) break;
    }
    if (!knots.back().empty())
      maps.push_back(std::make_unique<Map>(signal.name, signal.of, signal.friction, std::move(knots)));
  }
  return maps;
}

std::unique_ptr<Candidate> mapCandidate(const mechanism::Robot& robot, const std::string& depends_on, int actuator,
                                        const std::vector<double>& knots) {
  if (knots.size() != static_cast<std::size_t>(kKnots)) return nullptr;
  for (const MapSignal& signal : mapSignals(!robot.mechanism, robot.axes())) {
    std::vector<std::vector<double>> all(static_cast<std::size_t>(robot.axes()), knots);
    auto map = std::make_unique<Map>(signal.name, signal.of, signal.friction, std::move(all));
    if (map->dependsOn(actuator) == depends_on) return map;
  }
  return nullptr;
}

}  // namespace knee_robot::tracing
