#include "knee_robot/tracing/model_prediction.h"

#include <gtest/gtest.h>

#include <random>

#include "knee_robot/base/errors.h"
#include "knee_robot/identification/prediction.h"
#include "test/identification/synthetic.h"

namespace knee_robot::tracing {
namespace {

constexpr double kPredictedSeconds = 12.0;

/// Two training recordings and one other, with a baseline fitted to the first two.
struct Fitted {
  mechanism::Robot robot;
  TraceOptions options;
  std::vector<identification::Observation> training;
  identification::Observation other;
  TraceResult result;
};

Fitted fitted(const mechanism::Robot& robot) {
  Fitted f;
  f.robot = robot;
  std::vector<identification::Observation> all;
  for (int variant = 0; variant < 3; ++variant) {
    recording::Recording r =
        identification::syntheticRecording(robot, identification::syntheticModel(robot), variant, kPredictedSeconds);
    r.fingerprint = "fingerprint" + std::to_string(variant);
    all.push_back(identification::observe(robot, identification::columnsOf(robot), r, f.options.observation));
  }
  f.other = all[2];
  all.pop_back();
  f.training = all;
  BaseOptions how;
  how.rank = robot.mechanism ? 30 : 0;
  f.result.base =
      fitBase(robot, f.training, makeStack(f.training, f.options.observation), identification::columnsOf(robot), how);
  f.result.base.friction_laws[0] = dynamics::smoothLaw(1e-3);
  f.result.parameters = f.result.base.parameters;
  f.result.seen_parameters = 0.97 * f.result.base.parameters;
  f.result.after_rms_N = f.result.base.noise_N;
  return f;
}

const Fitted& fittedRobot() {
  static const Fitted f = fitted(identification::syntheticRobot());
  return f;
}

/// The effect at one place with a shape from the middle of its grid and random coefficients.
FoundEffect someEffect(const Fitted& f, const Candidate& candidate, int actuator) {
  std::vector<identification::Observation> recordings = f.training;
  EffectInput input = effectInput(f.robot, recordings[1], f.result.base.friction_laws, 1, 2);
  setModel(input, f.result.base.columns, f.result.seen_parameters);
  FoundEffect e;
  const std::vector<std::vector<double>> shapes = candidate.shapes(input, actuator);
  e.hypothesis = {{&candidate, candidate.shared() ? -1 : actuator}, shapes[shapes.size() / 2]};
  const Eigen::Index count = static_cast<Eigen::Index>(candidate.coefficients(input).size());
  std::mt19937 random(7);
  std::uniform_real_distribution<double> near_one(0.9, 1.1);
  e.coefficients.resize(count);
  for (double& c : e.coefficients)
    c = near_one(random) * (candidate.name() == "delay" || candidate.name() == "drive_lag" ? 0.01 : 1.0);
  e.std = 0.1 * e.coefficients;
  return e;
}

/// The file's predictions of both kinds of recordings are those of the result, to rounding.
void expectSame(const Fitted& f, const TraceResult& result) {
  const dynamics::Model written = tracedModel(f.robot, result, f.training, f.options);
  const dynamics::Model read = dynamics::parseModel(dynamics::modelToYaml(written), "model.yaml");
  EXPECT_EQ(dynamics::modelToYaml(read), dynamics::modelToYaml(written));
  std::vector<identification::Observation> recordings = f.training;
  recordings.push_back(f.other);
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    const int index = k < 2 ? static_cast<int>(k) : -1;
    const Eigen::MatrixXd expected = predictTraced(f.robot, result, recordings[k], index, 2);
    identification::Observation again = recordings[k];
    const Eigen::MatrixXd predicted = predictModel(f.robot, read, "model.yaml", again);
    EXPECT_TRUE(predicted.allFinite());
    EXPECT_LT((predicted - expected).cwiseAbs().maxCoeff(), 1e-9 * expected.cwiseAbs().maxCoeff()) << "recording " << k;
  }
}

void expectEveryEffectSame(const Fitted& f) {
  TraceResult everything = f.result;
  auto list = std::make_shared<CandidateList>(namedCandidates(f.robot));
  std::vector<EffectInput> inputs;
  for (int k = 0; k < 2; ++k) {
    inputs.push_back(effectInput(f.robot, f.training[static_cast<std::size_t>(k)], f.result.base.friction_laws, k, 2));
    setModel(inputs.back(), f.result.base.columns, f.result.seen_parameters);
  }
  for (auto& map : mapCandidates(inputs))
    list->push_back(std::move(map));
  ASSERT_GT(list->size(), 12u);
  for (const auto& candidate : *list) {
    SCOPED_TRACE(candidate->name() + " " + candidate->dependsOn(1));
    TraceResult result = f.result;
    result.candidates = list;
    result.effects = {someEffect(f, *candidate, 1)};
    expectSame(f, result);
    std::vector<identification::Observation> recordings = f.training;
    EXPECT_GT(
        (predictTraced(f.robot, result, recordings[1], 1, 2) - predictTraced(f.robot, f.result, recordings[1], 1, 2))
            .cwiseAbs()
            .maxCoeff(),
        1e-6)
        << "the effect does nothing, so that nothing was tested";
    everything.effects.push_back(result.effects.front());
  }
  everything.candidates = list;
  expectSame(f, everything);
}

TEST(ModelPrediction, OfEveryEffectEqualsTheTracesOwnOnAParallelRobot) {
  expectEveryEffectSame(fittedRobot());
}

TEST(ModelPrediction, OfEveryEffectEqualsTheTracesOwnOnBenchAxes) {
  expectEveryEffectSame(fitted(identification::syntheticBench(2)));
}

TEST(ModelPrediction, OfAWrongForceConstantIsTheWholeOfWhatTheCommandContainsOfItself) {
  Fitted f = fitted(identification::syntheticBench(2));
  f.result.seen_parameters = f.result.parameters;
  f.result.candidates = std::make_shared<CandidateList>(namedCandidates(f.robot));
  const Eigen::MatrixXd without = predictTraced(f.robot, f.result, f.other, -1, 2);
  for (const auto& candidate : *f.result.candidates) {
    if (candidate->name() == "force_gain") f.result.effects = {someEffect(f, *candidate, 0)};
  }
  ASSERT_EQ(f.result.effects.size(), 1u);
  for (const double given : {0.4, 0.7, 1.3, 3.0}) {  // of the force that is commanded
    f.result.effects[0].coefficients << 1.0 - given;
    const Eigen::MatrixXd with = predictTraced(f.robot, f.result, f.other, -1, 2);
    EXPECT_LT((given * with.col(0) - without.col(0)).cwiseAbs().maxCoeff(), 1e-6) << given;
    EXPECT_EQ(with.col(1), without.col(1));
  }
}

TEST(ModelPrediction, OfARippleCarriesItsPhaseOverWithinOneHomingOnly) {
  Fitted f = fitted(identification::syntheticBench(2));
  f.result.candidates = std::make_shared<CandidateList>(namedCandidates(f.robot));
  for (const auto& candidate : *f.result.candidates) {
    if (candidate->name() == "screw_ripple") f.result.effects = {someEffect(f, *candidate, 0)};
  }
  ASSERT_EQ(f.result.effects.size(), 1u);
  f.result.effects[0].coefficients << 3.0, 0.0, 0.0, 4.0;  // homed anew between the two: another phase
  f.result.home_ids = {11, 12};
  f.training[0].home_id = 11;
  f.training[1].home_id = 12;
  const auto ripple = [&](std::int64_t home_id) -> Eigen::VectorXd {
    identification::Observation o = f.other;
    o.home_id = home_id;
    TraceResult without = f.result;
    without.effects.clear();
    return (predictTraced(f.robot, f.result, o, -1, 2) - predictTraced(f.robot, without, o, -1, 2)).col(0);
  };
  EXPECT_EQ(ripple(0).norm(), 0.0) << "nothing is known of the phase";
  EXPECT_EQ(ripple(13).norm(), 0.0);
  const double turn = 2.0 * M_PI / f.result.effects[0].hypothesis.shape[0];
  const Eigen::ArrayXd phase = turn * f.other.signals.position_m.col(0).array();
  const bool of_friction = f.result.effects[0].hypothesis.shape[1] > 0.5;
  if (!of_friction) {
    EXPECT_LT((ripple(11).array() - 3.0 * phase.sin()).abs().maxCoeff(), 1e-6);
    EXPECT_LT((ripple(12).array() - 4.0 * phase.cos()).abs().maxCoeff(), 1e-6);
  }
  EXPECT_GT(ripple(11).norm(), 1.0);
  f.other.home_id = 12;
  expectSame(f, f.result);
}

TEST(ModelPrediction, UsesTheNumbersForOtherRecordingsThere) {
  const Fitted& f = fittedRobot();
  TraceResult result = f.result;
  result.candidates = std::make_shared<CandidateList>(namedCandidates(f.robot));
  for (const auto& candidate : *result.candidates) {
    if (candidate->name() == "stribeck" || candidate->name() == "position_dependent_friction")
      result.effects.push_back(someEffect(f, *candidate, 2));
  }
  ASSERT_EQ(result.effects.size(), 2u);
  TraceResult other = result;
  other.effects.pop_back();
  other.effects[0].coefficients[0] = 5.0;
  other.parameters *= 1.1;
  result.effects[1].transfers = false;
  result.elsewhere = std::make_shared<const TraceResult>(other);
  expectSame(f, result);
}

TEST(ModelPrediction, OfTheBaselineKnowsNothingOfWhatWasFoundOrOfAController) {
  const Fitted& f = fittedRobot();
  TraceResult result = f.result;
  result.candidates = std::make_shared<CandidateList>(namedCandidates(f.robot));
  result.baseline = result.base;
  result.baseline.parameters = result.parameters;
  const std::string plain = dynamics::modelToYaml(baselineModel(f.robot, result, f.training, f.options));
  for (const auto& candidate : *result.candidates) {
    if (candidate->name() == "stribeck") result.effects.push_back(someEffect(f, *candidate, 2));
  }
  TraceResult other = result;
  other.parameters *= 1.1;
  result.elsewhere = result.feedforward = std::make_shared<const TraceResult>(other);
  ASSERT_TRUE(tracedModel(f.robot, result, f.training, f.options).feedforward);
  EXPECT_EQ(dynamics::modelToYaml(baselineModel(f.robot, result, f.training, f.options)), plain);
}

TEST(ModelPrediction, OfIdentifysModelIsTheInstantByInstantOne) {
  const Fitted& f = fittedRobot();
  const dynamics::Model m = identification::syntheticModel(f.robot);
  identification::Observation o = f.other;
  EXPECT_EQ(predictModel(f.robot, m, "m.yaml", o), identification::predictForce(m, f.robot, o.signals, o.motion));
}

TEST(ModelPrediction, RefusesAnEffectThatIsUnknownOrHasOthersNumbers) {
  const Fitted& f = fittedRobot();
  TraceResult result = f.result;
  result.candidates = std::make_shared<CandidateList>(namedCandidates(f.robot));
  for (const auto& candidate : *result.candidates) {
    if (candidate->name() == "stribeck") result.effects.push_back(someEffect(f, *candidate, 2));
  }
  const std::string good = dynamics::modelToYaml(tracedModel(f.robot, result, f.training, f.options));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    identification::Observation o = f.other;
    predictModel(f.robot, dynamics::parseModel(text, "m.yaml"), "m.yaml", o);
  };
  EXPECT_NO_THROW(with("stribeck", "stribeck"));
  EXPECT_THROW(with("\"stribeck\"", "\"stick\""), InputError);
  EXPECT_THROW(with("velocity_m_per_s\", value", "velocity\", value"), InputError);
  EXPECT_THROW(with("velocity_m_per_s\", value: ", "velocity_m_per_s\", value: -"), InputError);
  EXPECT_THROW(with("excess_N", "excess"), InputError);
  EXPECT_THROW(with("[{actuator: 3}]", "[{actuator: 3}, {actuator: 4}]"), InputError);
  EXPECT_THROW(with("effects_see", "# effects_see"), InputError);
}

TEST(ModelPrediction, RefusesADriftWhoseHeatNothingStandsForOrWhoseWindingsHaveNoUsualForce) {
  const Fitted& f = fittedRobot();
  TraceResult result = f.result;
  result.candidates = std::make_shared<CandidateList>(namedCandidates(f.robot));
  for (const auto& candidate : *result.candidates) {
    if (candidate->name() == "gain_drift") result.effects.push_back(someEffect(f, *candidate, 2));
  }
  const auto with = [&](double heated_by, double usual_N) {
    result.effects[0].hypothesis.shape = {40.0, heated_by, 0.0, usual_N};
    identification::Observation o = f.other;
    const std::string text = dynamics::modelToYaml(tracedModel(f.robot, result, f.training, f.options));
    predictModel(f.robot, dynamics::parseModel(text, "m.yaml"), "m.yaml", o);
  };
  EXPECT_NO_THROW(with(0.0, 0.0));
  EXPECT_NO_THROW(with(4.0, 100.0));
  EXPECT_THROW(with(4.0, 0.0), InputError);
  EXPECT_THROW(with(4.0, -100.0), InputError);
  EXPECT_THROW(with(0.5, 100.0), InputError);
  EXPECT_THROW(with(5.0, 100.0), InputError);
}

TEST(Baseline, OfTraceIsTheModelOfIdentify) {
  const mechanism::Robot robot = identification::syntheticRobot();
  const identification::ObservationOptions options;
  const std::vector<identification::Column> columns = identification::columnsOf(robot);
  std::vector<identification::Observation> training;
  for (int variant = 0; variant < 2; ++variant) {
    training.push_back(identification::observe(
        robot, columns, identification::syntheticRecording(robot, identification::syntheticModel(robot), variant, 12.0),
        options));
  }
  std::vector<identification::Observation> same = training;
  const identification::Identification id = identification::identify(robot, same, {});
  TraceResult result;
  result.baseline = fitBase(robot, training, makeStack(training, options), columns);
  for (std::size_t k = 0; k < training.size(); ++k) {
    const Eigen::MatrixXd before = predictBaseline(result, training[k]);
    const Eigen::MatrixXd after =
        identification::predictForces(id.model, robot, same[k].signals, same[k].motion).mean_N;
    EXPECT_LT((before - after).cwiseAbs().maxCoeff(), 1e-6) << "recording " << k;
  }
}

TEST(PredictModel, LooksAtPositionsThroughTheLowPassThatTheModelWasFittedWith) {
  dynamics::Model model;
  model.cutoff_hz = 4.0;
  EXPECT_FALSE(observationOptions(model).motion_cutoff_given) << "as the encoders allow";
  model.fit_motion_cutoff_hz = 60.0;
  EXPECT_TRUE(observationOptions(model).motion_cutoff_given);
  EXPECT_EQ(observationOptions(model).signals.motion_cutoff_hz, 60.0);
}

}  // namespace
}  // namespace knee_robot::tracing
