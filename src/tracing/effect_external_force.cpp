#include <algorithm>
#include <cmath>

#include "effects.h"

namespace knee_robot::tracing {
namespace {

/// Until then friction still has what nobody recorded in its memory: a short push that begins there is none.
constexpr double kSettled_s = 0.5, kLong_s = 2.0;

bool isTold(double from_s, double duration_s) {
  return from_s >= kSettled_s || duration_s >= kLong_s;
}

/// A push on the platform: constant force and moments (it need not go through the origin) during part of one training recording.
class ExternalForce : public Candidate {
 public:
  std::string name() const override { return "external_force"; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "Something pushed the platform during part of one recording; this cannot happen again in another one.";
  }
  bool shared() const override { return true; }
  bool transfers() const override { return false; }
  bool local() const override { return true; }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"recording", 1.0, 1e3, true}, {"from_s", 0.0, 1e6, true}, {"duration_s", 0.5, 1e3, true}};
  }
  /// `input` is one recording; the windows of the others are added when they are asked for themselves.
  std::vector<std::vector<double>> shapes(const EffectInput& input, int) const override {
    std::vector<std::vector<double>> grid;
    const double end = input.time(input.samples() - 1);
    for (const double duration : {1.0, 2.0, 4.0, 8.0}) {
      if (duration > 0.5 * end) continue;
      for (double from = 0.0; from + duration <= end; from += std::max(0.5 * duration, end / 60.0)) {
        if (isTold(from, duration)) grid.push_back({input.recording + 1.0, from, duration});
      }
    }
    return grid;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    const double aside = 0.25 * step * s[2], longer = std::pow(1.4, step);
    std::vector<std::vector<double>> all{{s[0], s[1] - aside, s[2]},
                                         {s[0], s[1] + aside, s[2]},
                                         {s[0], s[1], s[2] * longer},
                                         {s[0], s[1], s[2] / longer}};
    all.erase(std::remove_if(all.begin(), all.end(), [](const auto& one) { return !isTold(one[1], one[2]); }),
              all.end());
    return all;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"force_x_N", false}, {"force_z_N", false}, {"moment_theta_N_m", false}, {"moment_psi_N_m", false}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(input.samples(), 4);
    if (input.recording + 1 != static_cast<int>(shape[0])) return out;
    for (int n = 0; n < input.samples(); ++n) {
      const double since = input.time(n) - shape[1];
      if (since < 0.0 || since > shape[2]) continue;
      out.row(n) = -input.force_per_pose_force[static_cast<std::size_t>(n)].row(actuator);
    }
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeExternalForce() {
  return std::make_unique<ExternalForce>();
}

}  // namespace knee_robot::tracing
