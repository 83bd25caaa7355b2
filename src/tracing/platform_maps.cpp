#include "platform_maps.h"

#include <algorithm>
#include <array>

namespace knee_robot::tracing {
namespace {

enum class Over { Coordinate, Rate, CoordinateTimesRate };

struct Coordinate {
  const char *name, *unit, *what, *force_unit;
};
constexpr std::array<Coordinate, 4> kPose = {Coordinate{"x", "m", "force", "N"}, Coordinate{"z", "m", "force", "N"},
                                             Coordinate{"theta", "rad", "moment", "N_m"},
                                             Coordinate{"psi", "rad", "moment", "N_m"}};

/// platform_force_over_pose_x_m, platform_moment_over_rate_psi_rad_per_s, platform_force_over_pose_z_m_times_rate ...
std::string signalName(std::size_t coordinate, Over over) {
  const Coordinate& c = kPose[coordinate];
  const std::string of = std::string(c.name) + "_" + c.unit, begins = "platform_" + std::string(c.what) + "_over_";
  if (over == Over::Rate) return begins + "rate_" + of + "_per_s";
  return begins + "pose_" + of + (over == Over::CoordinateTimesRate ? "_times_rate" : "");
}

class PlatformMap : public Candidate {
 public:
  PlatformMap(std::size_t coordinate, Over over, std::vector<double> knots)
      : coordinate_(coordinate), over_(over), knots_(std::move(knots)) {}

  std::string name() const override { return "unnamed"; }
  bool isMap() const override { return true; }
  bool shared() const override { return true; }
  double leastFloors() const override { return 2.0; }
  bool isForceField() const override { return over_ == Over::Coordinate; }
  bool restsOnModel() const override { return false; }
  std::string dependsOn(int) const override { return signalName(coordinate_, over_); }
  std::string sentence() const override {
    const std::string along =
        std::string(kPose[coordinate_].what) + " on the platform along " + kPose[coordinate_].name;
    const std::string of[] = {"that coordinate", "that coordinate's rate",
                              "that coordinate, in proportion to its rate"};
    return "No named effect fits; a " + along + " depends smoothly on " + of[static_cast<int>(over_)] + " (" +
           dependsOn(0) + ").";
  }
  std::vector<ShapeParameter> shapeParameters() const override { return knotParameters(); }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override { return {knots_}; }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return knotCoefficients(kPose[coordinate_].what, kPose[coordinate_].force_unit);
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& knots) const override {
    const Eigen::Index c = static_cast<Eigen::Index>(coordinate_);
    Eigen::VectorXd lever(input.samples());
    for (int n = 0; n < input.samples(); ++n) {
      const std::size_t sample = static_cast<std::size_t>(n);
      lever[n] = input.force_per_pose_force[sample](actuator, c);
      if (over_ == Over::CoordinateTimesRate) lever[n] *= input.observation->motion.motion[sample].pose_velocity[c];
    }
    return lever.asDiagonal() * hats(signal(input), knots);
  }
  Eigen::VectorXd signal(const EffectInput& input) const {
    const Eigen::Index c = static_cast<Eigen::Index>(coordinate_);
    Eigen::VectorXd out(input.samples());
    for (int n = 0; n < input.samples(); ++n) {
      const mechanism::Motion& motion = input.observation->motion.motion[static_cast<std::size_t>(n)];
      out[n] = over_ == Over::Rate ? motion.pose_velocity[c] : motion.pose[c];
    }
    return out;
  }

 private:
  const std::size_t coordinate_;
  const Over over_;
  const std::vector<double> knots_;
};

/// Empty when the signal hardly varies.
std::vector<double> knotsOf(const std::vector<EffectInput>& inputs, const PlatformMap& map, Over over) {
  std::vector<double> values;
  for (const EffectInput& input : inputs) {
    const Eigen::VectorXd x = map.signal(input);
    values.insert(values.end(), x.data(), x.data() + x.size());
  }
  Range range = rangeOf(values);
  if (!range.varies()) return {};
  if (over != Over::Rate) return evenKnots(values, range, false);
  range.high = std::max(-range.low, range.high);
  range.low = -range.high;
  return knotsAtZero(range);
}

constexpr std::array<Over, 3> kOver = {Over::Coordinate, Over::Rate, Over::CoordinateTimesRate};

}  // namespace

void addPlatformMaps(const std::vector<EffectInput>& inputs, CandidateList& maps) {
  if (!inputs.front().robot->mechanism) return;
  for (std::size_t c = 0; c < kPose.size(); ++c) {
    for (const Over over : kOver) {
      std::vector<double> knots = knotsOf(inputs, PlatformMap(c, over, {}), over);
      if (!knots.empty()) maps.push_back(std::make_unique<PlatformMap>(c, over, std::move(knots)));
    }
  }
}

std::unique_ptr<Candidate> platformMap(const std::string& depends_on, const std::vector<double>& knots) {
  for (std::size_t c = 0; c < kPose.size(); ++c) {
    for (const Over over : kOver)
      if (depends_on == signalName(c, over)) return std::make_unique<PlatformMap>(c, over, knots);
  }
  return nullptr;
}

}  // namespace knee_robot::tracing
