// Every effect of the catalogue, instant by instant as the controller takes it, is the one that was traced.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/acting_effects.h"
#include "knee_robot/dynamics/effect_law.h"
#include "knee_robot/dynamics/warming.h"
#include "knee_robot/recording/filter.h"
#include "knee_robot/tracing/model_prediction.h"
#include "test/identification/synthetic.h"

namespace knee_robot::tracing {
namespace {

constexpr double kMotionSeconds = 12.0;
constexpr int kActing = 1;
constexpr double kActingSize_N = 5.0;  ///< rms of an effect
constexpr double kRounding = 1e-12;    ///< of the columns of a leg that something else does not touch
const std::set<std::string> kLeftOut = {"external_force",    "backlash",
                                        "flexible_coupling", "gain_drift",
                                        "drive_dead_zone",   "hanging_mass",
                                        "sliding_mass",      "nonlinear_spring",
                                        "passive_joint",     "payload_change",
                                        "sensor_lag",        "stretch_reflex",
                                        "supply_sag",        "joint_stretch_reflex",
                                        "wobbling_mass",     "idle_current_reduction",
                                        "motor_saturation"};

/// Two recordings of training and another one of a machine that has the baseline alone; and everything that may be
/// added to it.
struct Machine {
  mechanism::Robot robot;
  std::vector<identification::Observation> recordings;
  TraceResult result;
  CandidateList maps;

  const identification::Observation& other() const { return recordings[2]; }
  EffectInput input(int recording) const {
    EffectInput in = effectInput(robot, recordings[static_cast<std::size_t>(recording)], result.base.friction_laws,
                                 recording < 2 ? recording : -1, 2);
    setModel(in, result.base.columns, result.seen_parameters);
    return in;
  }
};

Machine machineOf(const mechanism::Robot& robot) {
  Machine m;
  m.robot = robot;
  const TraceOptions options;
  for (int variant = 0; variant < 3; ++variant) {
    recording::Recording r =
        identification::syntheticRecording(robot, identification::syntheticModel(robot), variant, kMotionSeconds);
    r.fingerprint = "fingerprint" + std::to_string(variant);
    m.recordings.push_back(identification::observe(robot, identification::columnsOf(robot), r, options.observation));
  }
  const std::vector<identification::Observation> training(m.recordings.begin(), m.recordings.begin() + 2);
  m.result.base.columns = identification::columnsOf(robot);
  m.result.base.friction_laws.assign(static_cast<std::size_t>(robot.axes()), dynamics::bristleLaw(2e-4));
  const dynamics::Model truth = identification::syntheticModel(robot);
  m.result.parameters.resize(static_cast<Eigen::Index>(m.result.base.columns.size()));
  for (std::size_t c = 0; c < m.result.base.columns.size(); ++c)
    m.result.parameters[static_cast<Eigen::Index>(c)] =
        identification::parameterValue(truth, m.result.base.columns[c].name);
  m.result.seen_parameters = 0.97 * m.result.parameters;
  m.result.after_rms_N = Eigen::VectorXd::Ones(robot.axes());
  m.result.candidates = std::make_shared<CandidateList>(namedCandidates(robot));
  m.maps = mapCandidates({m.input(0), m.input(1)});
  return m;
}

const Machine& robotMachine() {
  static const Machine m = machineOf(identification::syntheticRobot());
  return m;
}
const Machine& benchMachine() {
  static const Machine m = machineOf(identification::syntheticBench(2));
  return m;
}

std::vector<const Candidate*> catalogue(const Machine& m) {
  std::vector<const Candidate*> all;
  for (const auto& candidate : *m.result.candidates)
    all.push_back(candidate.get());
  for (const auto& map : m.maps)
    all.push_back(map.get());
  return all;
}

std::string describe(const Candidate& c) {
  return c.name() + " " + c.dependsOn(kActing);
}

/// From the middle of its grid.
std::vector<double> shapeOf(const Machine& m, const Candidate& candidate) {
  const std::vector<std::vector<double>> shapes = candidate.shapes(m.input(0), candidate.shared() ? -1 : kActing);
  return shapes[shapes.size() / 2];
}

bool isLeftOut(const Candidate& c) {
  const std::string signal = c.dependsOn(kActing) + "_";
  return kLeftOut.count(c.name()) > 0 || signal.rfind("time_s_", 0) == 0 || signal.rfind("age_of_place_", 0) == 0 ||
         signal.rfind("needed_force_", 0) == 0;
}

/// Columns of the law along a recording, sample by sample.
Eigen::MatrixXd alongRecording(const Machine& m, const dynamics::EffectLaw& law, const EffectInput& in, int actuator) {
  const Eigen::MatrixXd rate = recording::firstDerivative(in.force_N.col(actuator), in.signals().period_s);
  Eigen::MatrixXd out(in.samples(), law.coefficients());
  dynamics::EffectInstant at;
  dynamics::EffectState state;
  at.mechanism = m.robot.mechanism ? &*m.robot.mechanism : nullptr;
  at.actuator = actuator;
  for (int n = 0; n < in.samples(); ++n) {
    at.period_s = n > 0 ? in.signals().period_s : 0.0;
    at.position_m = identification::actuatorRow(in.signals().position_m, n);
    at.velocity_m_per_s = identification::actuatorRow(in.signals().velocity_m_per_s, n);
    at.displacement_m = n > 0 ? in.friction_position_m(n, actuator) - in.friction_position_m(n - 1, actuator) : 0.0;
    at.motion = m.robot.mechanism ? &in.observation->motion.motion[static_cast<std::size_t>(n)] : nullptr;
    at.share = in.share(n, actuator);
    at.since_reversal = {in.since_reversal_m(n, actuator), in.since_reversal_s(n, actuator),
                         in.since_last_reversal_m(n, actuator), n >= in.first_turn[actuator]};
    at.load_N = in.load_N(n, actuator);
    at.force_N = in.force_N(n, actuator);
    at.force_rate_N_per_s = rate(n, 0);
    if (law.shared()) {
      dynamics::PoseColumns columns;
      law.poseColumns(at, state, columns);
      const auto row = in.force_per_pose_force[static_cast<std::size_t>(n)].row(actuator);
      out.row(n) = row * columns.leftCols(law.coefficients());
    } else {
      dynamics::EffectColumns columns;
      law.columns(at, state, columns);
      for (int c = 0; c < law.coefficients(); ++c)
        out(n, c) = columns[static_cast<std::size_t>(c)];
    }
  }
  return out;
}

void expectLawToBeTheColumns(const Machine& m, const Candidate& candidate, const std::vector<double>& shape) {
  const auto law = dynamics::effectLaw(candidate.name(), candidate.dependsOn(kActing), shape);
  EXPECT_EQ(law == nullptr, isLeftOut(candidate));
  if (!law) {
    EXPECT_FALSE(dynamics::whyNotInstantly(candidate.name()).empty());
    return;
  }
  EXPECT_EQ(law->shared(), candidate.shared());
  EffectInput input = m.input(2);
  input.recordings = 1;  // one phase of a ripple
  for (int i = 0; i < m.robot.axes(); ++i) {
    if (!candidate.shared() && i != kActing) continue;
    const Eigen::MatrixXd expected = candidate.columns(input, i, shape);
    const Eigen::MatrixXd found = alongRecording(m, *law, input, i);
    ASSERT_EQ(found.cols(), expected.cols());
    EXPECT_GT(expected.norm(), 0.0);
    const double near = candidate.shared() ? 1e-5 : 1e-9;  // tracing turns the platform by a small angle
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), near * expected.cwiseAbs().maxCoeff() + kRounding);
  }
}

void expectLawsToBeTheColumns(const Machine& m) {
  for (const Candidate* candidate : catalogue(m)) {
    SCOPED_TRACE(describe(*candidate));
    expectLawToBeTheColumns(m, *candidate, shapeOf(m, *candidate));
  }
}

TEST(InstantByInstant, ADriveWarmsUpAsItWasTracedWhateverHeatsIt) {
  const Machine& m = robotMachine();
  for (const Candidate* candidate : catalogue(m)) {
    if (candidate->name() != "thermal_drift") continue;
    for (const dynamics::Heat by : {dynamics::Heat::Motion, dynamics::Heat::Work, dynamics::Heat::Worked}) {
      for (const double viscous_s_per_m : {0.0, 15.0}) {
        for (const double levels_off : {0.0, 0.7})
          expectLawToBeTheColumns(m, *candidate, {30.0, dynamics::numberOf(by), viscous_s_per_m, levels_off, 0.001});
      }
    }
  }
}

/// settleRestLaw sets that parameter to 0, by its name: the actuator's law then.
TEST(InstantByInstant, EveryEffectWithALawNearRestOfItsOwnMayFollowTheActuators) {
  const Machine& m = robotMachine();
  const EffectInput input = m.input(2);
  int with_own_law = 0;
  for (const Candidate* candidate : catalogue(m)) {
    std::vector<double> shape = shapeOf(m, *candidate);
    if (shape.empty() || candidate->shapeParameters().back().name != "smooth_below_m_per_s") continue;
    ++with_own_law;
    shape.back() = 0.0;
    const Eigen::MatrixXd follows = candidate->columns(input, kActing, shape);
    EXPECT_TRUE(follows.allFinite()) << candidate->name();
    EXPECT_FALSE(candidate->shared()) << candidate->name() << " follows no actuator's law";
  }
  EXPECT_GE(with_own_law, 5);
}

TEST(InstantByInstant, EveryLawIsTheColumnsThatItWasTracedWithOnAParallelRobot) {
  expectLawsToBeTheColumns(robotMachine());
}

TEST(InstantByInstant, EveryLawIsTheColumnsThatItWasTracedWithOnBenchAxes) {
  expectLawsToBeTheColumns(benchMachine());
}

/// The effect with coefficients that give it a size, and the same phase in both training recordings.
FoundEffect foundEffect(const Machine& m, const Candidate& candidate) {
  FoundEffect e;
  e.hypothesis = {{&candidate, candidate.shared() ? -1 : kActing}, shapeOf(m, candidate)};
  const EffectInput input = m.input(1);
  const Eigen::MatrixXd columns = effectColumns(input, e.hypothesis, kActing);
  const double size = columns.rowwise().sum().norm() / std::sqrt(static_cast<double>(columns.rows()));
  const bool timing = candidate.name() == "delay" || candidate.name() == "drive_lag";
  e.coefficients.setConstant(columns.cols(), timing ? 0.006 : kActingSize_N / size);
  for (Eigen::Index k = 0; k < columns.cols() && candidate.name() == "unnamed"; ++k)
    e.coefficients[k] *= k % 3 - 0.7;
  e.std = 0.1 * e.coefficients;
  return e;
}

dynamics::Model modelWith(const Machine& m, const std::vector<FoundEffect>& effects) {
  TraceResult result = m.result;
  result.effects = effects;
  return tracedModel(m.robot, result, {m.recordings[0], m.recordings[1]}, {});
}

/// What the controller sees at the samples of the other recording: its reference, 1 ms apart, without encoders and
/// filters.
Eigen::MatrixXd asTheControllerSeesIt(const Machine& m, const dynamics::Model& model) {
  const std::vector<identification::Sines> sines = identification::syntheticMotion(!m.robot.mechanism, 2);
  const dynamics::ForceModel force_model(model, m.robot);
  dynamics::ForceModelData data;
  Eigen::MatrixXd out(m.other().samples(), m.robot.axes());
  for (int k = 0; k <= 10 * (m.other().samples() - 1); ++k) {
    const identification::SyntheticState s = identification::syntheticState(m.robot, sines, 0.001 * k, kMotionSeconds);
    mechanism::Vector4 force;
    EXPECT_TRUE(dynamics::forceFromModel(force_model, s.q, s.v, s.a, s.motion, data, force, 0.001));
    if (k % 10 == 0) out.row(k / 10) = force.head(m.robot.axes()).transpose();
  }
  return out;
}

Eigen::MatrixXd asPredicted(const Machine& m, const dynamics::Model& model) {
  identification::Observation o = m.other();
  return predictModel(m.robot, model, "model.yaml", o);
}

/// rms without the ends, where a recording's filters have only one side.
double rms(const Eigen::MatrixXd& values) {
  const auto inner = values.middleRows(100, values.rows() - 200);
  return inner.norm() / std::sqrt(static_cast<double>(inner.rows()));
}

/// As errors are judged: a delay's column is a derivative, which smears the steps of friction over several samples
/// where the controller asks for the step so much sooner.
double lowPassedRms(Eigen::MatrixXd values) {
  recording::ZeroPhaseLowPass(3.0, 100.0).applyToColumns(values);
  return rms(values);
}

/// Its force steps where a reversal is noticed: at a row of the recording, at a cycle of the controller.
bool stepsAtReversals(const Candidate& c) {
  return c.name() == "reversal_friction" || c.dependsOn(kActing).rfind("time_since_reversal", 0) == 0;
}

void expectForcesAsPredicted(const Machine& m) {
  ASSERT_NEAR(m.other().signals.time_s.front(), 0.0, 1e-9);
  const dynamics::Model plain = modelWith(m, {});
  const Eigen::MatrixXd plain_predicted = asPredicted(m, plain), plain_seen = asTheControllerSeesIt(m, plain);
  std::vector<FoundEffect> all;
  for (const Candidate* candidate : catalogue(m)) {
    SCOPED_TRACE(describe(*candidate));
    const FoundEffect effect = foundEffect(m, *candidate);
    const dynamics::Model model = modelWith(m, {effect});
    const Eigen::MatrixXd seen = asTheControllerSeesIt(m, model) - plain_seen;
    if (isLeftOut(*candidate)) {
      EXPECT_EQ(rms(seen), 0.0);
      continue;
    }
    const Eigen::MatrixXd predicted = asPredicted(m, model) - plain_predicted;
    EXPECT_GT(rms(predicted), 0.2 * kActingSize_N) << "the effect does nothing, so that nothing was tested";
    const bool timing =
        candidate->name() == "delay" || candidate->name() == "drive_lag" || stepsAtReversals(*candidate);
    EXPECT_LT(lowPassedRms(seen - predicted), (timing ? 0.1 : 0.02) * lowPassedRms(predicted));
    if (!timing) {
      EXPECT_LT(rms(seen - predicted), 0.05 * rms(predicted));
    }
    all.push_back(effect);
  }
  for (std::size_t from = 0; from < all.size(); from += dynamics::kMostActingEffects) {
    const std::size_t to = std::min(all.size(), from + dynamics::kMostActingEffects);
    const dynamics::Model model =
        modelWith(m, {all.begin() + static_cast<std::ptrdiff_t>(from), all.begin() + static_cast<std::ptrdiff_t>(to)});
    const Eigen::MatrixXd predicted = asPredicted(m, model);
    const Eigen::MatrixXd seen = asTheControllerSeesIt(m, model);
    EXPECT_LT(lowPassedRms(seen - predicted), 0.01 * lowPassedRms(predicted)) << "as many together as there may be";
  }
}

TEST(InstantByInstant, ASpringThatDoesNotRelaxIsNoLaw) {
  EXPECT_NE(dynamics::effectLaw("viscoelastic_element", "", {2.0, 1.0}), nullptr);
  for (const double never : {0.0, -2.0}) {
    EXPECT_EQ(dynamics::effectLaw("viscoelastic_element", "", {never, 1.0}), nullptr) << never;
    EXPECT_EQ(dynamics::effectLaw("viscoelastic_element", "", {1.0, never}), nullptr) << never;
    EXPECT_EQ(dynamics::effectLaw("viscoelastic_link", "", {0.0, 0.0, 0.0, 0.0, never}), nullptr) << never;
    EXPECT_EQ(dynamics::effectLaw("unnamed", "platform_way_of_late", {never}), nullptr) << never;
  }
}

TEST(InstantByInstant, ACableThatYieldsOverNoWayIsNoLaw) {
  EXPECT_NE(dynamics::effectLaw("elastoplastic_link", "", {0.0, 0.0, 0.0, 0.0, 0.0, 0.004}), nullptr);
  for (const double none : {0.0, -0.004})
    EXPECT_EQ(dynamics::effectLaw("elastoplastic_link", "", {0.0, 0.0, 0.0, 0.0, 0.0, none}), nullptr) << none;
}

TEST(InstantByInstant, FrictionThatFallsOffOverNoWayIsNoLaw) {
  EXPECT_NE(dynamics::effectLaw("reversal_friction", "", {0.01, 0.0, 0.0, 0.0}), nullptr);
  for (const double none : {0.0, -0.01})
    EXPECT_EQ(dynamics::effectLaw("reversal_friction", "", {none, 0.0, 0.0, 0.0}), nullptr) << none;
  EXPECT_EQ(dynamics::effectLaw("reversal_friction", "", {0.01, -0.001, 0.0, 0.0}), nullptr);
}

TEST(InstantByInstant, TwoRipplesOfOneActuatorAreBothInTheForce) {
  const Machine& m = benchMachine();
  const std::vector<const Candidate*> all = catalogue(m);
  const auto ripple = std::find_if(all.begin(), all.end(), [](auto* c) { return c->name() == "screw_ripple"; });
  ASSERT_NE(ripple, all.end());
  const FoundEffect first = foundEffect(m, **ripple);
  FoundEffect second = first;
  second.hypothesis.place.order = 1;
  second.hypothesis.shape[0] *= 0.6;
  const dynamics::Model both = modelWith(m, {first, second});
  ASSERT_EQ(both.effects.size(), 2u);
  const Eigen::MatrixXd predicted = asPredicted(m, both), alone = asPredicted(m, modelWith(m, {first}));
  EXPECT_GT(rms(predicted - alone), 0.2 * kActingSize_N) << "the second does nothing, so that nothing was tested";
  EXPECT_LT(lowPassedRms(asTheControllerSeesIt(m, both) - predicted), 0.01 * lowPassedRms(predicted));
}

TEST(InstantByInstant, EveryEffectAlongAMotionIsWhatPredictSaysOfItsRecordingOnAParallelRobot) {
  expectForcesAsPredicted(robotMachine());
}

TEST(InstantByInstant, EveryEffectAlongAMotionIsWhatPredictSaysOfItsRecordingOnBenchAxes) {
  expectForcesAsPredicted(benchMachine());
}

}  // namespace
}  // namespace knee_robot::tracing
