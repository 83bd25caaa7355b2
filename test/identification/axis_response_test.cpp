// Inertia, friction and delay of simulated axes whose truth is known, from recordings of quick moves in closed loop.
#include "knee_robot/identification/axis_response.h"

#include <gtest/gtest.h>

#include "knee_robot/base/errors.h"
#include "test/control/simulated_axis.h"

namespace knee_robot::identification {
namespace {

constexpr double kMillisecond = 0.001;

mechanism::Robot bench(int axes, double count_m) {
  mechanism::Robot robot;
  robot.path = "bench.yaml";
  robot.kind = mechanism::MechanismKind::Axes;
  robot.actuators.resize(static_cast<std::size_t>(axes));
  for (mechanism::Actuator& a : robot.actuators) {
    a.screw_lead_m = 0.01;
    a.counts_per_revolution = 0.01 / count_m;
  }
  return robot;
}

/// Minimum jerk to and fro with rests; `quick_s` a move.
double reference(double time, double quick_s, double amplitude) {
  const double turn = quick_s + 0.15;
  const int move = static_cast<int>(time / turn);
  const double x = std::min(1.0, (time - move * turn) / quick_s);
  const double s = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
  const double from = move == 0 ? 0.0 : (move % 2 == 1 ? amplitude : -amplitude);
  return from + ((move % 2 == 0 ? amplitude : -amplitude) - from) * s;
}

struct Recorded {
  std::vector<fake::SimulatedAxis> axes;
  double count_m = 5e-6, quick_s = 0.07, amplitude = 0.0015, time_s = 4.0, rows_per_s = 1000.0;
  bool together = false;  // all axes move at once, else one after the other

  recording::Recording play() {
    const int cycles = static_cast<int>((together ? 1.0 : static_cast<double>(axes.size())) * time_s / kMillisecond);
    const int every = static_cast<int>(std::lround(1000.0 / rows_per_s));
    const auto count = static_cast<Eigen::Index>(axes.size());
    recording::Recording r;
    r.path = "quick.csv";
    r.axes = static_cast<int>(count);
    r.position_m.resize(cycles / every, count);
    r.force_N.resize(cycles / every, count);
    std::vector<control::Pid> pids(axes.size());
    for (control::Pid& pid : pids)
      pid.setGains({40000.0, 100000.0, 800.0, 100.0});
    for (int k = 0; k < cycles; ++k) {
      for (std::size_t i = 0; i < axes.size(); ++i) {
        const double begin = together ? 0.0 : static_cast<double>(i) * time_s, now = k * kMillisecond - begin;
        control::PidInput input;
        input.reference = now >= 0.0 ? reference(std::min(now, time_s), quick_s, amplitude) : 0.0;
        input.measured = std::round(axes[i].position / count_m) * count_m;
        input.dt = kMillisecond;
        const double force = pids[i].update(input, 1000.0);
        if (k % every == 0 && k / every < r.position_m.rows()) {
          r.position_m(k / every, static_cast<Eigen::Index>(i)) = input.measured;
          r.force_N(k / every, static_cast<Eigen::Index>(i)) = force;
          if (i == 0) r.time_s.push_back(k * kMillisecond);
        }
        axes[i].advance(force, kMillisecond);
      }
    }
    return r;
  }
};

fake::SimulatedAxis axis(double mass, double viscous, double coulomb, double delay) {
  fake::SimulatedAxis one;
  one.mass_kg = mass;
  one.viscous = viscous;
  one.coulomb_N = coulomb;
  one.delay_s = delay;
  return one;
}

TEST(AxisResponse, FindsInertiaFrictionAndDelayWithinTwoOfItsStandardErrorsOrAFewPercent) {
  for (const double count : {2.5e-6, 20e-6}) {
    Recorded recorded;
    recorded.count_m = count;
    recorded.axes = {axis(8.0, 150.0, 10.0, 0.0), axis(14.0, 60.0, 20.0, 0.0013), axis(25.0, 300.0, 5.0, 0.003)};
    const AxisResponses found = axisResponses(bench(3, count), recorded.play());
    for (std::size_t i = 0; i < 3; ++i) {
      const fake::SimulatedAxis& truth = recorded.axes[i];
      const AxisResponse& x = found.axes[i];
      EXPECT_EQ(found.reasons[i], "") << count;
      EXPECT_NEAR(x.mass_kg, truth.mass_kg, std::max(0.05 * truth.mass_kg, 2.0 * x.mass_std)) << i << " at " << count;
      // Friction that turns just before and after a move looks like some delay where the encoder is coarse: the safe
      // side.
      EXPECT_GT(1e3 * x.delay_s, 1e3 * truth.delay_s - std::max(0.25, 2e3 * x.delay_std)) << i << " at " << count;
      EXPECT_LT(1e3 * x.delay_s, 1e3 * truth.delay_s + std::max(count > 1e-5 ? 1.0 : 0.25, 2e3 * x.delay_std))
          << i << " at " << count;
      EXPECT_NEAR(x.coulomb_N, truth.coulomb_N, std::max(2.5, 2.0 * x.coulomb_std)) << i << " at " << count;
      EXPECT_LT(x.mass_std, 0.1 * truth.mass_kg);
    }
  }
}

TEST(AxisResponse, RefusesWhatShowsNoQuickMoves) {
  Recorded slow;
  slow.axes = {axis(10.0, 100.0, 15.0, 0.001)};
  slow.quick_s = 1.5;
  const AxisResponses found = axisResponses(bench(1, slow.count_m), slow.play());
  EXPECT_NE(found.reasons[0], "");
}

TEST(AxisResponse, SaysWhichAxisDidNotMove) {
  Recorded recorded;
  recorded.axes = {axis(10.0, 100.0, 15.0, 0.001), axis(10.0, 100.0, 15.0, 0.001)};
  recording::Recording r = recorded.play();
  r.position_m.col(1).setConstant(0.1);
  const AxisResponses found = axisResponses(bench(2, recorded.count_m), r);
  EXPECT_EQ(found.reasons[0], "");
  EXPECT_NE(found.reasons[1].find("hardly moves"), std::string::npos) << found.reasons[1];
}

TEST(AxisResponse, RefusesAxesThatOnlyEverMoveTogether) {
  Recorded recorded;
  recorded.together = true;
  recorded.axes = {axis(10.0, 100.0, 15.0, 0.001), axis(10.0, 100.0, 15.0, 0.001)};
  const AxisResponses found = axisResponses(bench(2, recorded.count_m), recorded.play());
  EXPECT_NE(found.reasons[0].find("together"), std::string::npos) << found.reasons[0];
}

TEST(AxisResponse, RefusesAForceThatSomethingElseMakes) {
  Recorded recorded;
  recorded.axes = {axis(10.0, 100.0, 5.0, 0.001)};
  recording::Recording r = recorded.play();
  for (Eigen::Index k = 0; k < r.force_N.rows(); ++k)
    r.force_N(k, 0) += 150.0 * std::sin(0.05 * static_cast<double>(k));
  const AxisResponses found = axisResponses(bench(1, recorded.count_m), r);
  EXPECT_NE(found.reasons[0].find("explain"), std::string::npos) << found.reasons[0];
}

TEST(AxisResponse, RefusesWholeRecordingsInOneSentence) {
  Recorded recorded;
  recorded.axes = {axis(10.0, 100.0, 15.0, 0.001)};
  recording::Recording r = recorded.play();
  const auto refused = [&](const recording::Recording& one, const std::string& words) {
    try {
      axisResponses(bench(1, recorded.count_m), one);
      ADD_FAILURE() << "not refused: " << words;
    } catch (const Refusal& refusal) {
      EXPECT_NE(std::string(refusal.what()).find(words), std::string::npos) << refusal.what();
      EXPECT_EQ(std::string(refusal.what()).find('\n'), std::string::npos);
    }
  };
  recording::Recording without = r;
  without.force_N.resize(0, 0);
  refused(without, "no commanded force");
  Recorded thin = recorded;
  thin.axes = {axis(10.0, 100.0, 15.0, 0.001)};
  thin.rows_per_s = 100.0;
  refused(thin.play(), "rows a second");
  Recorded brief;
  brief.axes = {axis(10.0, 100.0, 15.0, 0.001)};
  brief.time_s = 1.0;
  refused(brief.play(), "too short");
}

}  // namespace
}  // namespace knee_robot::identification
