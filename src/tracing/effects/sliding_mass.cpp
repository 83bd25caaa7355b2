#include <algorithm>
#include <cmath>

#include "common/on_platform.h"

namespace knee_robot::tracing {
namespace {

constexpr double kHeaviestSliding_kg = 40.0;
constexpr double kShortestTravel_m = 0.005, kLongestTravel_m = 0.25;
constexpr double kLeastRubs = 0.02, kMostRubs = 6.0;  ///< m/s^2
constexpr double kLeastDrag = 0.05, kMostDrag = 20.0, kDrag = 1.0;
constexpr double kDirectionBeside_rad = 0.4, kTravelBeside = 1.4, kRubsBeside = 1.6, kDragBeside = 2.0,
                 kStartBeside = 0.7;
constexpr std::size_t kFirstStart = 4, kSlidesFrom = 3;  ///< in a shape; training recordings whose start is known

/// A mass on a rail between two stops. Stepped half-implicitly; a stop takes its velocity within a sample.
class Slider {
 public:
  Slider(double half_travel_m, double friction, double drag, double period_s)
      : half_m_(half_travel_m), friction_(friction), drag_(drag), period_s_(period_s) {}

  void start(double at_m) { at_m_ = at_m; }
  void step(double drive) {
    const double before = rate_;
    const double free = before + drive * period_s_, holds = friction_ * period_s_;
    rate_ = std::abs(free) <= holds ? 0.0 : (free - std::copysign(holds, free)) / (1.0 + drag_ * period_s_);
    at_m_ += rate_ * period_s_;
    if (std::abs(at_m_) > half_m_) {
      at_m_ = std::copysign(half_m_, at_m_);
      rate_ = 0.0;
    }
    acceleration_ = (rate_ - before) / period_s_;
  }
  double at_m() const { return at_m_; }
  double acceleration() const { return acceleration_; }

 private:
  const double half_m_, friction_, drag_, period_s_;
  double at_m_ = 0.0, rate_ = 0.0, acceleration_ = 0.0;
};

/// A mass that slides along a straight line of the platform between two stops, held by dry friction: a weight on a rail,
/// a shoe in its strap. Only what it does beyond the same mass held in the middle, which the platform's inertia
/// contains. Where it lay when each training recording began is searched for, too (kSlidesFrom of them at most); of any other
/// nobody knows, and the middle is taken until it slides. Its line goes through the platform's origin: elsewhere its
/// weight turns the platform alike.
class SlidingMass : public OnPlatform {
 public:
  std::string name() const override { return "sliding_mass"; }
  std::string sentence() const override {
    return "A mass slides on the platform from stop to stop once the tilt overcomes its friction: a weight on a rail, "
           "a "
           "limb that is strapped on loosely.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    std::vector<ShapeParameter> parameters = {{"direction_rad", -M_PI, M_PI},
                                              {"half_travel_m", kShortestTravel_m, kLongestTravel_m},
                                              {"friction_m_per_s2", kLeastRubs, kMostRubs},
                                              {"drag_per_s", kLeastDrag, kMostDrag, true}};
    for (std::size_t r = 1; r <= kSlidesFrom; ++r)
      parameters.push_back({"start_of_recording_" + std::to_string(r), -1.0, 1.0, true});
    return parameters;
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    std::vector<std::vector<double>> out;
    for (const double direction : {0.0, 0.25 * M_PI, 0.5 * M_PI, 0.75 * M_PI}) {
      for (const double half_m : {0.015, 0.04, 0.1}) {
        for (const double friction : {0.15, 0.4, 0.8, 1.4}) {
          out.push_back({direction, half_m, friction, kDrag});
          out.back().resize(kFirstStart + kSlidesFrom, 0.0);
        }
      }
    }
    return out;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override {
    return besideEach(shape, step, shapeParameters(), [](std::size_t k, double value, double side) {
      if (k == 0) return value + side * kDirectionBeside_rad;
      if (k >= kFirstStart) return value + side * kStartBeside;
      return value * std::pow(k == 1 ? kTravelBeside : k == 2 ? kRubsBeside : kDragBeside, side);
    });
  }
  bool knownElsewhere() const override { return false; }
  double leastFloors() const override { return 1.0; }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"mass_kg", true}}; }
  bool believable(const Eigen::VectorXd& coefficients) const override { return coefficients[0] <= kHeaviestSliding_kg; }

 protected:
  Eigen::Matrix4Xd onPose(const EffectInput& input, const std::vector<double>& shape) const override {
    Slider mass(shape[1], shape[2], shape[3], input.signals().period_s);
    const auto recording = static_cast<std::size_t>(std::max(0, input.recording));
    if (input.recording >= 0 && recording < kSlidesFrom) mass.start(shape[kFirstStart + recording] * shape[1]);
    const mechanism::Vector3 line(std::cos(shape[0]), std::sin(shape[0]), 0.0);
    Eigen::Matrix4Xd out(4, input.samples());
    for (int n = 0; n < input.samples(); ++n) {
      const std::size_t sample = static_cast<std::size_t>(n);
      const mechanism::Matrix3& rotation = input.rotation[sample];
      const mechanism::Vector4& moves = input.observation->motion.motion[sample].pose_acceleration;
      const mechanism::Vector3 along = rotation * line;
      const Eigen::Matrix<double, 3, 4> middle = velocityByPose(rotation, mechanism::Vector3::Zero());
      // What holds a kilogram in its place.
      const auto weight = [&](const Eigen::Matrix<double, 3, 4>& by_pose) -> mechanism::Vector3 {
        return by_pose * moves - input.robot->gravity;
      };
      const double drive = -along.dot(weight(velocityByPose(rotation, along * mass.at_m())));
      if (n > 0) mass.step(drive);
      const Eigen::Matrix<double, 3, 4> there = velocityByPose(rotation, along * mass.at_m());
      out.col(n) =
          there.transpose() * (weight(there) + along * mass.acceleration()) - middle.transpose() * weight(middle);
    }
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeSlidingMass() {
  return std::make_unique<SlidingMass>();
}

}  // namespace knee_robot::tracing
