#include <algorithm>
#include <cmath>

#include "common/yielding.h"
#include "knee_robot/mechanism/leg_distance.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr std::size_t kFirst = 0, kSecond = 1, kBetween = 2, kFrom = 3, kSideOfPull = 4,
                      kRubsOver = 5;  ///< in the shape
constexpr double kLongestLink_m = 3.0, kFromStep_m = 0.03;
constexpr double kLeastWay_m = 2e-4, kUsualWay_m = 3e-3, kMostWay_m = 0.05, kWayFactor = 1.6;
constexpr double kSlackShares[] = {0.25, 0.5, 0.75};  ///< of the samples, in which it hangs: beginnings of the search

/// Along a recording, one entry a sample.
struct Link {
  Eigen::MatrixXd lever;  ///< samples x actuators: force of each per newton of force that lengthens it
  Eigen::VectorXd length_m, rate_m_per_s, way_m;
};

mechanism::LegPair pairOf(const std::vector<double>& shape) {
  const auto whole = [&](std::size_t k) { return static_cast<int>(std::lround(shape[k])); };
  // Where along the legs it is tied is not searched: to first order another place is another stiffness.
  return {whole(kFirst) - 1, whole(kSecond) - 1, static_cast<mechanism::BetweenLegs>(whole(kBetween))};
}

Link linkAlong(const EffectInput& input, const std::vector<double>& shape) {
  const mechanism::LegPair pair = pairOf(shape);
  Link out;
  out.lever.resize(input.samples(), input.axes());
  out.length_m.resize(input.samples());
  out.rate_m_per_s.resize(input.samples());
  out.way_m.setZero(input.samples());
  for (int n = 0; n < input.samples(); ++n) {
    const auto sample = static_cast<std::size_t>(n);
    const mechanism::Motion& motion = input.observation->motion.motion[sample];
    const mechanism::LegDistance now = mechanism::legDistance(*input.robot->mechanism, motion.pose, pair);
    out.lever.row(n) = (input.force_per_pose_force[sample] * now.by_pose).transpose();
    out.length_m[n] = now.length_m;
    out.rate_m_per_s[n] = now.by_pose.dot(motion.pose_velocity);
    if (n > 0)
      out.way_m[n] = 0.5 * (out.rate_m_per_s[n] + out.rate_m_per_s[n - 1]) * (input.time(n) - input.time(n - 1));
  }
  return out;
}

/// A hose, a cable bundle or a strap from one leg to another: pulls beyond a length (side 1) or pushes below it (side
/// -1), damps as long as it does, and rubs.
class LinkBetweenLegs : public Candidate {
 public:
  std::string name() const override { return "link_between_legs"; }
  std::string sentence() const override {
    return "Something ties two legs together: a hose, a cable bundle or a strap that goes taut, damps and rubs.";
  }
  bool shared() const override { return true; }
  bool restsOnModel() const override { return false; }
  bool needsTwoRecordings() const override { return true; }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"first_leg", 1.0, 4.0, true}, {"second_leg", 1.0, 4.0, true},
            {"between", 0.0, 2.0, true},   {"acts_from_m", -kLongestLink_m, kLongestLink_m},
            {"side", -1.0, 1.0, true},     {"rubs_over_m", kLeastWay_m, kMostWay_m}};
  }
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override;
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override {
    std::vector<std::vector<double>> out;
    for (const double sign : {-step, step}) {
      out.push_back(shape);
      out.back()[kFrom] += sign * kFromStep_m;
      out.push_back(shape);
      out.back()[kRubsOver] = std::clamp(shape[kRubsOver] * std::pow(kWayFactor, sign), kLeastWay_m, kMostWay_m);
    }
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {
        {"stiffness_N_per_m", true}, {"stiffening_N_per_m2", true}, {"damping_N_s_per_m", true}, {"friction_N", true}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    return columnsOfAll(input, shape)[static_cast<std::size_t>(actuator)];
  }
  std::vector<Eigen::MatrixXd> columnsOfAll(const EffectInput& input, const std::vector<double>& shape) const override {
    const Link link = linkAlong(input, shape);
    const double side = shape[kSideOfPull];
    const Eigen::ArrayXd taut_m = (side * (link.length_m.array() - shape[kFrom])).max(0.0);
    Eigen::MatrixXd per_coefficient_N(input.samples(), 4);
    per_coefficient_N << side * taut_m, side * taut_m.square(), (taut_m > 0.0).select(link.rate_m_per_s.array(), 0.0),
        yieldedShare(link.way_m, shape[kRubsOver]);
    std::vector<Eigen::MatrixXd> out;
    for (int i = 0; i < input.axes(); ++i)
      out.push_back(link.lever.col(i).asDiagonal() * per_coefficient_N);
    return out;
  }
};

std::vector<std::vector<double>> LinkBetweenLegs::shapes(const EffectInput& input, int) const {
  std::vector<std::vector<double>> grid;
  for (int first = 1; first <= mechanism::kLegs; ++first) {
    for (int second = first + 1; second <= mechanism::kLegs; ++second) {
      for (const double between : {0.0, 1.0, 2.0}) {
        std::vector<double> shape = {
            static_cast<double>(first), static_cast<double>(second), between, 0.0, 1.0, kUsualWay_m};
        const Link link = linkAlong(input, shape);
        std::vector<double> lengths_m(link.length_m.data(), link.length_m.data() + link.length_m.size());
        std::sort(lengths_m.begin(), lengths_m.end());
        for (const double share : kSlackShares) {
          shape[kFrom] = lengths_m[static_cast<std::size_t>(share * static_cast<double>(lengths_m.size() - 1))];
          for (const double side : {1.0, -1.0}) {
            shape[kSideOfPull] = side;
            grid.push_back(shape);
          }
        }
      }
    }
  }
  return grid;
}

}  // namespace

std::unique_ptr<Candidate> makeLinkBetweenLegs() {
  return std::make_unique<LinkBetweenLegs>();
}

}  // namespace knee_robot::tracing
