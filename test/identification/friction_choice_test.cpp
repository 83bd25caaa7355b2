// The law of friction near rest, chosen from recordings that each law made by itself: its own integration, at 0.1 ms,
// without the candidates' code.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <random>

#include "knee_robot/identification/evaluation.h"
#include "test/identification/synthetic.h"

namespace knee_robot::identification {
namespace {

constexpr double kStep_s = 1e-4;
constexpr double kCoulomb_N = 30.0, kNoise_N = 0.3;

/// A law by its own words: the share of Coulomb friction after moving at velocity v for kStep_s, with some numbers of
/// memory.
struct OwnLaw {
  std::string name;
  std::function<double(double v, double* memory)> share;
};

constexpr int kMemory = 6;

double plasticSpring(double v, double width, double& bent) {
  bent += v * kStep_s;
  if (bent > width) bent = width;
  if (bent < -width) bent = -width;
  return bent / width;
}

std::vector<OwnLaw> ownLaws() {
  return {
      {"one stop of 30 um", [](double v, double* m) { return plasticSpring(v, 30e-6, m[0]); }},
      {"stops of 20 um and 400 um",
       [](double v, double* m) { return 0.6 * plasticSpring(v, 20e-6, m[0]) + 0.4 * plasticSpring(v, 400e-6, m[1]); }},
      {"Maxwell slip: six stops of 8 um to 0.7 mm",
       [](double v, double* m) {
         const double widths_m[kMemory] = {8e-6, 2e-5, 5e-5, 1.2e-4, 3e-4, 7e-4};
         const double shares[kMemory] = {0.25, 0.2, 0.2, 0.15, 0.12, 0.08};
         double sum = 0.0;
         for (int k = 0; k < kMemory; ++k)
           sum += shares[k] * plasticSpring(v, widths_m[k], m[k]);
         return sum;
       }},
      {"tanh of 1 mm/s", [](double v, double*) { return std::tanh(v / 1e-3); }},
      {"arc tangent of 0.7 mm/s", [](double v, double*) { return 2.0 / M_PI * std::atan(v / 7e-4); }},
      {"v / sqrt(v^2 + (2 mm/s)^2)", [](double v, double*) { return v / std::sqrt(v * v + 4e-6); }},
      {"asinh(v / 0.3 mm/s), full at 20 mm/s",
       [](double v, double*) { return std::asinh(v / 3e-4) / std::asinh(20e-3 / 3e-4); }},
      {"Dahl's of 100 um",
       [](double v, double* m) {
         m[0] += (v - std::abs(v) * m[0]) * kStep_s / 100e-6;
         return m[0];
       }},
      {"Dahl's of 250 um with exponent 1.7",
       [](double v, double* m) {
         const double sign = v < 0.0 ? -1.0 : 1.0;
         m[0] += std::pow(std::max(0.0, 1.0 - sign * m[0]), 1.7) * v * kStep_s / 250e-6;
         return m[0];
       }},
      {"a clearance of 50 um, then elastic over 60 um",
       [](double v, double* m) {
         const double bent = 85e-6 * plasticSpring(v, 85e-6, m[0]);
         return std::copysign(std::max(0.0, std::abs(bent) - 25e-6) / 60e-6, bent);
       }},
      {"elastic over 90 um, relaxing in 3 s",
       [](double v, double* m) {
         m[0] -= m[0] * kStep_s / 3.0;
         return plasticSpring(v, 90e-6, m[0]);
       }},
      {"tanh of 1.5 mm/s, 30 ms late",
       [](double v, double* m) {
         m[0] += (v - m[0]) * kStep_s / 0.03;
         return std::tanh(m[0] / 1.5e-3);
       }},
      {"Dahl's of 80 um, 30 % more below 1 mm/s",
       [](double v, double* m) {
         m[0] += (v - std::abs(v) * m[0]) * kStep_s / 80e-6;
         return m[0] * (1.0 + 0.3 * std::exp(-v * v / 1e-6));
       }},
      {"a hump of 30 % over half a millimetre after a reversal",
       [](double v, double* m) {
         m[0] += (v - std::abs(v) * m[0]) * kStep_s / 60e-6;
         m[1] += (v - std::abs(v) * m[1]) * kStep_s / 600e-6;
         return 1.3 * m[0] - 0.3 * m[1];
       }},
      {"none below 0.5 mm/s, full from 1.5 mm/s on",
       [](double v, double*) { return std::copysign(std::clamp((std::abs(v) - 5e-4) / 1e-3, 0.0, 1.0), v); }},
      {"LuGre of 150 um with damping of 2 ms, creeping at 0.1 mm/s",
       [](double v, double* m) {
         const double rate = (v - std::sqrt(v * v + 1e-8) * m[0]) / 150e-6;
         m[0] += rate * kStep_s;
         return m[0] + 2e-3 * rate;
       }},
      {"v / (|v| + 0.8 mm/s)", [](double v, double*) { return v / (std::abs(v) + 8e-4); }},
      {"a ramp up to 2.4 mm/s", [](double v, double*) { return std::clamp(v / 2.4e-3, -1.0, 1.0); }},
  };
}

/// One axis, slow enough to spend time near rest, whose forces follow from `law`; before it moves it rests for
/// `rest_s`, its friction loaded as `memory` says.
recording::Recording ownRecording(const mechanism::Robot& robot, const OwnLaw& law, int variant, double seconds,
                                  double rest_s = 0.0, std::array<double, kMemory> memory = {}) {
  std::vector<Sines> sines = syntheticMotion(true, variant);
  for (double& hz : sines[0].hz)
    hz *= 0.4;
  std::mt19937 random(static_cast<unsigned>(variant) + 11u);
  std::normal_distribution<double> noise(0.0, kNoise_N);
  recording::Recording r;
  r.name = "own_" + std::to_string(variant);
  r.path = r.name + ".csv";
  r.axes = 1;
  const int rows = static_cast<int>((rest_s + seconds) * 100.0);
  r.position_m.resize(rows, 1);
  r.force_N.resize(rows, 1);
  const double count = robot.actuators[0].metresPerCount();
  for (int k = 0; k < rows; ++k) {
    const double t = 0.01 * k - rest_s;
    r.time_s.push_back(0.01 * k);
    r.position_m(k, 0) = count * std::round(syntheticState(robot, sines, std::max(0.0, t), seconds).q[0] / count);
    double sum = 0.0;  // mean over the 10 ms for which the row's force is held
    for (int i = 0; i < 100; ++i) {
      const SyntheticState now = syntheticState(robot, sines, std::max(0.0, t + (i + 0.5) * kStep_s), seconds);
      const bool moves = t + i * kStep_s > 0.0;
      const double v = moves ? now.v[0] : 0.0, a = moves ? now.a[0] : 0.0;
      sum += 200.0 * v + 80.0 * a + 10.0 + kCoulomb_N * law.share(v, memory.data());
    }
    r.force_N(k, 0) = sum / 100.0 + noise(random);
  }
  return r;
}

TEST(MassBesideFriction, IsRightToAThousandthWhateverTheLaw) {
  const mechanism::Robot robot = syntheticBench(1);
  const IdentifyOptions options;
  constexpr int kMotions = 16;
  for (const std::size_t which : {std::size_t{3}, ownLaws().size() - 2}) {
    const OwnLaw law = ownLaws()[which];
    double sum = 0.0, squares = 0.0, std = 0.0;
    int held = 0;
    for (int motion = 0; motion < kMotions; ++motion) {
      std::vector<Observation> train = {
          observe(robot, columnsOf(robot), ownRecording(robot, law, motion, 40.0), options.observation)};
      const Identification id = identify(robot, train, options);
      const auto mass = std::find_if(id.model.parameters.begin(), id.model.parameters.end(),
                                     [](const auto& parameter) { return parameter.name == "rotor_1"; });
      ASSERT_NE(mass, id.model.parameters.end());
      sum += (mass->value - 80.0) / kMotions;
      squares += (mass->value - 80.0) * (mass->value - 80.0) / kMotions;
      std += mass->std / kMotions;
      held += std::abs(mass->value - 80.0) < 2.0 * mass->std;
    }
    std::cout << law.name << ": mass of 80 kg, mean deviation " << sum << " kg, rms " << std::sqrt(squares)
              << " kg, standard error " << std << " kg, two of them hold it " << held << " times of " << kMotions
              << '\n';
    EXPECT_LT(std::sqrt(squares), 0.08) << law.name << ": friction half a substep late makes 0.12 and 0.18 kg";
  }
}

class LawNearRest : public testing::TestWithParam<std::size_t> {};

TEST_P(LawNearRest, IsPredictedOnAnotherMotionWhateverLawMadeIt) {
  const OwnLaw law = ownLaws()[GetParam()];
  const mechanism::Robot robot = syntheticBench(1);
  IdentifyOptions options;
  options.uncertainty = false;
  std::vector<Observation> train, other;
  train.push_back(observe(robot, columnsOf(robot), ownRecording(robot, law, 0, 60.0), options.observation));
  other.push_back(observe(robot, columnsOf(robot), ownRecording(robot, law, 1, 30.0), options.observation));
  const Identification id = identify(robot, train, options);
  const double error = applyModel(id.model, robot, other, options.observation.cutoff_hz).accuracy.rms_N[0];
  std::cout << law.name << ": chosen " << dynamics::describe(id.model.friction[0]) << ", Fc "
            << parameterValue(id.model, "Fc_1") << " N, error on the other motion " << error << " N\n";
  EXPECT_LT(error, 0.02 * kCoulomb_N) << law.name;
  EXPECT_NEAR(parameterValue(id.model, "Fc_1"), kCoulomb_N, 0.1 * kCoulomb_N) << law.name;
}

INSTANTIATE_TEST_SUITE_P(EveryLaw, LawNearRest, testing::Range<std::size_t>(0, ownLaws().size()));

TEST(LawNearRestOfARecordingThatBeganLoaded, IsPredictedOnAnotherMotion) {
  const OwnLaw law = ownLaws()[1];
  const mechanism::Robot robot = syntheticBench(1);
  IdentifyOptions options;
  options.uncertainty = false;
  std::vector<Observation> train, other;
  for (const int variant : {0, 2}) {
    const double load = variant == 0 ? -1.0 : 0.5;
    train.push_back(observe(robot, columnsOf(robot),
                            ownRecording(robot, law, variant, 20.0, 2.0, {load * 20e-6, load * 400e-6}),
                            options.observation));
  }
  other.push_back(observe(robot, columnsOf(robot), ownRecording(robot, law, 1, 30.0), options.observation));
  const Identification id = identify(robot, train, options);
  const double error = applyModel(id.model, robot, other, options.observation.cutoff_hz).accuracy.rms_N[0];
  EXPECT_LT(error, 0.02 * kCoulomb_N) << dynamics::describe(id.model.friction[0]);
  EXPECT_EQ(id.model.friction[0].at_start, 0.0) << "training does not agree";
}

TEST(LawNearRestOfARecordingThatBeginsAsThoseOfTraining, IsPredictedFromItsFirstSample) {
  const OwnLaw law = ownLaws()[1];
  const mechanism::Robot robot = syntheticBench(1);
  IdentifyOptions options;
  options.uncertainty = false;
  const auto begunWith = [&](int variant, double load) {
    return observe(robot, columnsOf(robot), ownRecording(robot, law, variant, 20.0, 2.0, {load * 20e-6, load * 400e-6}),
                   options.observation);
  };
  std::vector<Observation> train = {begunWith(0, -0.7), begunWith(2, -0.5)}, other = {begunWith(1, -0.6)};
  const Identification id = identify(robot, train, options);
  EXPECT_NEAR(id.model.friction[0].at_start, 2.0 / 3.0 * -0.6, 0.05) << "of two that agree";
  const auto error = [&](const dynamics::Model& model) {
    return applyModel(model, robot, other, options.observation.cutoff_hz).accuracy.rms_N[0];
  };
  dynamics::Model without = id.model;
  without.friction[0].at_start = 0.0;
  EXPECT_GT(error(without), 0.1 * kCoulomb_N);
  EXPECT_LT(error(id.model), 0.5 * error(without)) << dynamics::describe(id.model.friction[0]);
}

TEST(ViscousFriction, ThatGrowsAsTheRootOfTheSpeedIsPredictedOnAnotherMotion) {
  const OwnLaw law = {"tanh of 1 mm/s beside v / sqrt(|v| + 2 mm/s)",
                      [](double v, double*) { return std::tanh(v / 1e-3) + 4.0 * v / std::sqrt(std::abs(v) + 2e-3); }};
  const mechanism::Robot robot = syntheticBench(1);
  IdentifyOptions options;
  options.uncertainty = false;
  std::vector<Observation> train = {
      observe(robot, columnsOf(robot), ownRecording(robot, law, 0, 60.0), options.observation)};
  std::vector<Observation> other = {
      observe(robot, columnsOf(robot), ownRecording(robot, law, 1, 30.0), options.observation)};
  const Identification id = identify(robot, train, options);
  EXPECT_LT(applyModel(id.model, robot, other, options.observation.cutoff_hz).accuracy.rms_N[0], 0.02 * kCoulomb_N)
      << dynamics::describe(id.model.friction[0]);
}

TEST(LawOfOneElement, ThatIsARampIsPredictedBestByARamp) {
  const OwnLaw law = ownLaws().back();
  const mechanism::Robot robot = syntheticBench(1);
  IdentifyOptions options;
  options.uncertainty = false;
  std::vector<Observation> train = {
      observe(robot, columnsOf(robot), ownRecording(robot, law, 0, 60.0), options.observation)};
  const std::vector<TriedLaw> tried = identify(robot, train, options).friction.at(0).tried;
  const auto ramp = std::find_if(tried.begin(), tried.end(), [](const TriedLaw& t) {
    return t.law.elements[0].smooth == dynamics::SmoothShape::Ramp;
  });
  ASSERT_NE(ramp, tried.end());
  EXPECT_NEAR(ramp->law.elements[0].speed_m_per_s, 2.4e-3, 0.2e-3);
  for (const TriedLaw& other : tried)
    EXPECT_LE(ramp->held_back, other.held_back) << dynamics::describe(other.law);
}

TEST(LawOfOneElement, ThatIsARationalLawOrAnArctangentIsFoundForThat) {
  const std::vector<OwnLaw> laws = ownLaws();
  const mechanism::Robot robot = syntheticBench(1);
  IdentifyOptions options;
  options.uncertainty = false;
  const auto expect = [&](const OwnLaw& law, dynamics::SmoothShape shape, double speed_m_per_s) {
    std::vector<Observation> train = {
        observe(robot, columnsOf(robot), ownRecording(robot, law, 0, 60.0), options.observation)};
    const dynamics::FrictionLaw found = identify(robot, train, options).model.friction[0];
    EXPECT_EQ(found.count, 1) << law.name << ": " << dynamics::describe(found);
    EXPECT_EQ(found.elements[0].smooth, shape) << law.name << ": " << dynamics::describe(found);
    EXPECT_NEAR(found.elements[0].speed_m_per_s, speed_m_per_s, 0.1 * speed_m_per_s) << law.name;
  };
  expect(laws[4], dynamics::SmoothShape::Arctangent, 7e-4);
  expect(laws[laws.size() - 2], dynamics::SmoothShape::Rational, 8e-4);
}

TEST(LawOfOneElement, IsFoundForWhatItIs) {
  const mechanism::Robot robot = syntheticBench(1);
  IdentifyOptions options;
  options.uncertainty = false;
  const auto chosen = [&](std::size_t k) {
    std::vector<Observation> train = {
        observe(robot, columnsOf(robot), ownRecording(robot, ownLaws()[k], 0, 60.0), options.observation)};
    const dynamics::FrictionLaw law = identify(robot, train, options).model.friction[0];
    return *std::max_element(law.elements.begin(), law.elements.begin() + law.count,
                             [](const auto& a, const auto& b) { return a.share < b.share; });
  };
  const dynamics::FrictionElement stop = chosen(0), smooth = chosen(3), bristles = chosen(7);
  EXPECT_EQ(stop.kind, dynamics::FrictionKind::Stop);
  EXPECT_NEAR(stop.width_m, 30e-6, 10e-6);
  EXPECT_EQ(smooth.kind, dynamics::FrictionKind::Smooth);
  EXPECT_NEAR(smooth.speed_m_per_s, 1e-3, 2e-4);
  EXPECT_EQ(bristles.kind, dynamics::FrictionKind::Bristles);
  EXPECT_NEAR(bristles.width_m, 100e-6, 25e-6);
}

}  // namespace
}  // namespace knee_robot::identification
