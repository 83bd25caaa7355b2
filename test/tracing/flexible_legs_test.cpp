#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "knee_robot/dynamics/model.h"
#include "knee_robot/recording/filter.h"
#include "knee_robot/tracing/trace.h"
#include "test/identification/synthetic.h"

namespace knee_robot::tracing {
namespace {

/// The synthetic machine's rigid bodies, or its friction and rotors.
dynamics::Model part(const mechanism::Robot& robot, bool rigid_bodies) {
  dynamics::Model model = identification::syntheticModel(robot);
  for (std::size_t k = 0; k < model.parameters.size(); ++k) {
    if ((k < static_cast<std::size_t>(dynamics::kInertialParameters)) != rigid_bodies) model.parameters[k].value = 0.0;
  }
  return model;
}

/// A machine whose legs give by these (m/N) under the load of the rigid bodies. Friction and rotors are on the
/// encoders' side.
class SoftMachine {
 public:
  SoftMachine(const mechanism::Robot& robot, const mechanism::Vector4& compliance, int variant)
      : robot_(robot),
        compliance_(compliance),
        sines_(identification::syntheticMotion(false, variant)),
        bodies_(part(robot, true), robot),
        drives_(part(robot, false), robot) {}

  recording::Recording recorded(int variant) {
    std::mt19937 random(static_cast<unsigned>(variant) + 1u);
    std::normal_distribution<double> noise(0.0, 0.3);
    recording::Recording r = identification::syntheticRecording(robot_, part(robot_, true), variant, kLong_s);
    for (Eigen::Index k = 0; k < r.force_N.rows(); ++k) {
      const double t = 0.01 * static_cast<double>(k), middle = t + 0.005;
      r.position_m.row(k) = encoders(t).transpose();
      const mechanism::Vector4 before = encoders(middle - kStep_s), at = encoders(middle),
                               after = encoders(middle + kStep_s);
      const mechanism::Vector4 rate = (after - before) / (2.0 * kStep_s),
                               acceleration = (after - 2.0 * at + before) / (kStep_s * kStep_s);
      mechanism::Motion seen;  // where the encoders say that the platform is: the rotors' side
      mechanism::motionFromLengths(*robot_.mechanism, at, rate, acceleration,
                                   identification::syntheticState(robot_, sines_, middle, kLong_s).motion.pose, seen);
      mechanism::Vector4 force;
      dynamics::forceFromModel(drives_, at, rate, acceleration, seen, drives_data_, force);
      for (int i = 0; i < 4; ++i)
        r.force_N(k, i) += force[i] + noise(random);
    }
    return r;
  }

 private:
  static constexpr double kLong_s = 40.0, kStep_s = 2e-3;

  mechanism::Vector4 encoders(double t) {
    const identification::SyntheticState s = identification::syntheticState(robot_, sines_, t, kLong_s);
    mechanism::Vector4 load;
    dynamics::forceFromModel(bodies_, s.q, s.v, s.a, s.motion, bodies_data_, load);
    return s.q + compliance_.cwiseProduct(load);
  }

  const mechanism::Robot& robot_;
  const mechanism::Vector4 compliance_;
  const std::vector<identification::Sines> sines_;
  const dynamics::ForceModel bodies_, drives_;
  dynamics::ForceModelData bodies_data_, drives_data_;
};

TraceResult tracedSoft(const mechanism::Robot& robot, const mechanism::Vector4& compliance) {
  const std::vector<recording::Recording> recordings = {SoftMachine(robot, compliance, 0).recorded(0),
                                                        SoftMachine(robot, compliance, 1).recorded(1)};
  TraceOptions options;
  options.surrogates = 5;
  return trace(robot, recordings,
               identification::observeAll(robot, identification::columnsOf(robot), recordings, options.observation),
               options);
}

/// What the machine's forces lack along its encoders' path with its own parameters, and what the columns say; N, slow.
struct Lacking {
  Eigen::MatrixXd forces_N, said_N;
};

constexpr double kStiff_N_per_m = 1e6;  // does not swing

Lacking lackingOf(const mechanism::Robot& robot, const mechanism::Vector4& compliance) {
  const std::vector<identification::Column> columns = identification::columnsOf(robot);
  const dynamics::Model truth = identification::syntheticModel(robot);
  Eigen::VectorXd parameters(static_cast<Eigen::Index>(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c)
    parameters[static_cast<Eigen::Index>(c)] =
        identification::parameterValue(truth, columns[c].name) / columns[c].newtons;
  identification::Observation o =
      identification::observe(robot, columns, SoftMachine(robot, compliance, 0).recorded(0), {});
  const std::vector<dynamics::FrictionLaw> laws(4, dynamics::stopLaw(1e-5));
  identification::setFriction(o, columns, laws);
  EffectInput in = effectInput(robot, o, laws, 0, 1);
  setModel(in, columns, parameters);
  Lacking out{o.signals.force_N - in.force_N, Eigen::MatrixXd::Zero(in.samples(), 4)};
  for (const auto& candidate : namedCandidates(robot)) {
    if (candidate->name() != "flexible_coupling" || !candidate->shared()) continue;
    for (int i = 0; i < 4; ++i)
      out.said_N.col(i) =
          candidate->columns(in, i, {0.0, kStiff_N_per_m}) * Eigen::Vector2d(compliance[0], compliance[3]);
  }
  const recording::ZeroPhaseLowPass slow(2.0, 1.0 / o.signals.period_s);
  slow.applyToColumns(out.forces_N);
  slow.applyToColumns(out.said_N);
  return out;
}

TEST(FlexibleLegs, ChangeTheForcesByWhatTheColumnsSay) {
  const mechanism::Robot robot = identification::syntheticRobot();
  const Lacking soft = lackingOf(robot, {1e-5, 1e-5, 1e-5, 0.6e-5});
  // Friction's hysteresis between samples, which the stiff machine has as well.
  const Lacking stiff = lackingOf(robot, mechanism::Vector4::Zero());
  for (int i = 0; i < 4; ++i) {
    const auto rows = [&](const Eigen::MatrixXd& all) -> Eigen::VectorXd { return all.col(i).segment(300, 3400); };
    const Eigen::VectorXd given = rows(soft.forces_N) - rows(stiff.forces_N), said = rows(soft.said_N);
    EXPECT_LT((given - said).norm(), 0.3 * given.norm()) << "actuator " << i + 1;
    EXPECT_NEAR(given.dot(said) / said.squaredNorm(), 1.0, 0.15) << "actuator " << i + 1;
  }
}

// 50 kN/m under some 100 N: two millimetres, of which gravity's parameters take up most along these paths.
TEST(FlexibleLegs, AreNamedByTheLoadThatTheyBringToOneAnother) {
  const mechanism::Robot robot = identification::syntheticRobot();
  constexpr double kSoft = 2e-5, kLessSoft = 1.2e-5;  // m/N
  const TraceResult result = tracedSoft(robot, {kSoft, kSoft, kSoft, kLessSoft});
  std::cout << "before " << result.before_rms_N.transpose() << " after " << result.after_rms_N.transpose() << " N\n";
  for (const FoundEffect& found : result.effects)
    std::cout << found.hypothesis.place.candidate->name() << " on " << found.hypothesis.place.actuator << ": "
              << found.coefficients.transpose() << "\n";
  ASSERT_EQ(result.effects.size(), 1u);
  const FoundEffect& e = result.effects[0];
  EXPECT_EQ(e.hypothesis.place.candidate->name(), "flexible_coupling");
  EXPECT_EQ(e.hypothesis.place.actuator, -1);
  EXPECT_NEAR(e.coefficients[0], kSoft, 0.6 * kSoft);
  EXPECT_NEAR(e.coefficients[1], kLessSoft, 0.6 * kLessSoft);
}

TEST(FlexibleLegs, AreNotFoundWhereLegsAreStiff) {
  const TraceResult result = tracedSoft(identification::syntheticRobot(), mechanism::Vector4::Zero());
  EXPECT_TRUE(result.effects.empty());
}

}  // namespace
}  // namespace knee_robot::tracing
