#include "knee_robot/dynamics/parameters.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr Eigen::Index kMass = 4;    ///< first moments and mass, the last four of a body's parameters
constexpr double kFarthest_m = 0.6;  ///< of what is carried, from the platform's middle
constexpr const char* kNames[kMass] = {"mX_kg_m", "mY_kg_m", "mZ_kg_m", "mass_kg"};

/// The platform carries another mass in one training recording than in another: another patient, a tool that was taken
/// off. The baseline has the mean; what a further recording carries is not known.
class PayloadChange : public Candidate {
 public:
  std::string name() const override { return "payload_change"; }
  std::string sentence() const override {
    return "The platform carries another mass in one recording than in another: another patient, a tool that was taken "
           "off.";
  }
  bool shared() const override { return true; }
  bool transfers() const override { return false; }
  bool restsOnModel() const override { return false; }
  bool needsTwoRecordings() const override { return true; }
  bool worksOn(const mechanism::Robot& robot) const override { return !robot.chain && Candidate::worksOn(robot); }
  double leastFloors() const override { return 1.0; }
  /// Against the first recording.
  std::vector<Coefficient> coefficients(const EffectInput& input) const override {
    std::vector<Coefficient> out;
    for (int r = 2; r <= input.recordings; ++r) {
      for (const char* name : kNames)
        out.push_back({std::string(name) + "_more_in_recording_" + std::to_string(r), false});
    }
    return out;
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>&) const override {
    const Eigen::MatrixXd& all = input.observation->regressor[static_cast<std::size_t>(actuator)];
    const auto carried = all.middleCols(dynamics::kInertialParameters - kMass, kMass);
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(input.samples(), kMass * (input.recordings - 1));
    if (input.recording < 0) return out;
    for (int r = 1; r < input.recordings; ++r)
      out.middleCols(kMass * (r - 1), kMass) = ((r == input.recording ? 1.0 : 0.0) - 1.0 / input.recordings) * carried;
    return out;
  }
  bool plausible(const Eigen::VectorXd& coefficients) const override {
    for (Eigen::Index r = 0; r + kMass <= coefficients.size(); r += kMass) {
      if (coefficients.segment<3>(r).norm() > kFarthest_m * std::abs(coefficients[r + 3])) return false;
    }
    return true;
  }
};

}  // namespace

std::unique_ptr<Candidate> makePayloadChange() {
  return std::make_unique<PayloadChange>();
}

}  // namespace knee_robot::tracing
