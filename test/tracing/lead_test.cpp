// Commands that run ahead of what the motion needs: a dead time, or a drive that follows as a first-order lag.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "src/tracing/refit.h"
#include "src/tracing/settle_lead.h"
#include "test/tracing/searched_machine.h"
#include "test/tracing/traced_bench.h"

namespace knee_robot::tracing {
namespace {

constexpr double kStep_s = 1e-3;

struct Lead {
  double dead_time_s = 0.0, lag_s = 0.0;
  double reading_s = 0.0;  ///< time constant of a filter through which forces are read
};

/// Two bench axes of 60 kg that reverse often; both drives are late. `jitter_m`: rms of what encoders add.
recording::Recording recorded(const Lead& lead, int variant, double jitter_m = 0.0) {
  std::mt19937 random(static_cast<unsigned>(variant) + 1u);
  std::normal_distribution<double> noise(0.0, 0.3);
  recording::Recording r;
  r.name = r.path = "late.csv";
  r.fingerprint = "late" + std::to_string(variant);
  r.axes = 2;
  const int rows = 5000;
  r.position_m.resize(rows, 2);
  r.force_N.resize(rows, 2);
  for (int i = 0; i < 2; ++i) {
    const double hz[] = {0.13, 0.31, 0.83, 1.7}, speed[] = {0.04, 0.04, 0.03, 0.02};
    const auto motion = [&](double t) {
      Eigen::Vector3d x(0.3, 0.0, 0.0);
      for (int h = 0; h < 4; ++h) {
        const double w = 2.0 * M_PI * (1.0 + 0.17 * i) * hz[h], phase = w * t + h + 2.0 * i + variant;
        x += speed[h] * Eigen::Vector3d(std::sin(phase) / w, std::cos(phase), -w * std::sin(phase));
      }
      return x;
    };
    const auto needed = [&](double t) {
      const Eigen::Vector3d at = motion(t);
      return 60.0 * at[2] + 300.0 * at[1] + 20.0 * std::tanh(at[1] / 2e-3);
    };
    double read = 0.0;
    for (int k = 0; k < rows; ++k) {
      const double t = 0.01 * k;
      if (i == 0) r.time_s.push_back(t);
      r.position_m(k, i) = 1e-6 * std::round((motion(t)[0] + jitter_m / 0.3 * noise(random)) / 1e-6);
      const double at = t + 0.005 + lead.dead_time_s;  // a row's force holds for the 10 ms after it
      const double rate = (needed(at + kStep_s) - needed(at - kStep_s)) / (2.0 * kStep_s);
      double late = 0.0;
      if (lead.reading_s > 0.0) {
        // Through steps of a millisecond: the mean over the row's interval of what is read.
        double mean = 0.0;
        if (k == 0) read = needed(0.0);
        for (int step = 1; step <= 10; ++step) {
          read += (needed(t + step * kStep_s - 0.5 * kStep_s) - read) * (1.0 - std::exp(-kStep_s / lead.reading_s));
          mean += 0.1 * read;
        }
        late = mean - needed(at);
      }
      r.force_N(k, i) = needed(at) + lead.lag_s * rate + late + noise(random);
    }
  }
  r.reference_m = r.position_m;
  return r;
}

TEST(Lead, ADeadTimeIsOneAndIsMeasuredToATenth) {
  const TracedBench traced = tracedBench(recorded({0.025, 0.0, 0.0}, 0), nullptr);
  ASSERT_EQ(traced.result.effects.size(), 2u);
  for (const FoundEffect& e : traced.result.effects) {
    EXPECT_EQ(e.hypothesis.place.candidate->name(), "delay");
    EXPECT_TRUE(e.indistinguishable_from.empty());
    EXPECT_GT(e.probability, 0.8);
    EXPECT_NEAR(e.coefficients[0], 0.025, 0.0025);
  }
}

TEST(Lead, ADriveThatLagsIsOneAndIsMeasuredToATenth) {
  const TracedBench traced = tracedBench(recorded({0.0, 0.025, 0.0}, 0), nullptr);
  ASSERT_EQ(traced.result.effects.size(), 2u);
  for (const FoundEffect& e : traced.result.effects) {
    EXPECT_EQ(e.hypothesis.place.candidate->name(), "drive_lag");
    EXPECT_TRUE(e.indistinguishable_from.empty());
    EXPECT_NEAR(e.coefficients[0], 0.025, 0.0025);
  }
}

TEST(Lead, ADriveThatLagsIsOneBehindEncodersThatJitter) {
  const TracedBench traced = tracedBench(recorded({0.0, 0.025, 0.0}, 0, 15e-6), nullptr);
  ASSERT_EQ(traced.result.effects.size(), 2u);
  for (const FoundEffect& e : traced.result.effects)
    EXPECT_EQ(e.hypothesis.place.candidate->name(), "drive_lag");
}

TEST(Lead, ForcesThatAreReadThroughAFilterAreBehindAndNoDriveIsSaidToBeLate) {
  const TracedBench traced = tracedBench(recorded({0.0, 0.0, 0.05}, 0), nullptr);
  ASSERT_FALSE(traced.result.effects.empty());
  const FoundEffect& lag = traced.result.effects[0];
  EXPECT_EQ(lag.hypothesis.place.candidate->name(), "sensor_lag");
  EXPECT_GT(lag.probability, 0.8);
  EXPECT_NEAR(lag.coefficients[0], 0.05, 0.005);
  EXPECT_NEAR(lag.hypothesis.shape[0], 0.05, 0.01);
  for (std::size_t k = 1; k < traced.result.effects.size(); ++k)
    EXPECT_EQ(traced.result.effects[k].hypothesis.place.candidate->name(), "unnamed") << "what reversals leave";
}

TEST(Lead, IsPredictedInAnotherRecordingToTheNoise) {
  for (const Lead& lead : {Lead{0.025, 0.0, 0.0}, Lead{0.0, 0.025, 0.0}, Lead{0.0, 0.0, 0.05}}) {
    const TracedBench traced = tracedBench(recorded(lead, 0), nullptr);
    identification::ObservationOptions options;
    options.setCutoff(traced.model.cutoff_hz);
    identification::Observation other =
        identification::observe(bench(), identification::columnsOf(bench()), recorded(lead, 1), options);
    const auto left = [&](const Eigen::MatrixXd& predicted) {
      const auto p = identification::makePrediction(other, predicted, traced.model.cutoff_hz);
      return identification::accuracyOf({other}, {p}).rms_N[0];
    };
    dynamics::Model without = traced.model;
    without.effects.clear();
    without.elsewhere.reset();
    const double with_N = left(predictModel(bench(), traced.model, "model.yaml", other));
    const double without_N = left(predictModel(bench(), without, "model.yaml", other));
    std::printf("rms %.2f N without what leads, %.2f N with it\n", without_N, with_N);
    EXPECT_LT(with_N, 0.25 * without_N);
  }
}

class LeadOfRest : public SearchedMachine {
 protected:
  /// A delay that is in the model: forces as one would add them, times `factor` of every row.
  void found(const Eigen::VectorXd& factor) {
    FoundEffect e;
    e.hypothesis = named("delay", {});
    data_.all_force_rows += factor.cwiseProduct(0.03 * effectRows(data_, e.hypothesis).col(0));
    setAttention(data_, Attention::All);
    search_.effects.push_back(e);
    refit(search_);
    ASSERT_GT(search_.effects[0].coefficients[0], 0.003);
  }
};

TEST_F(LeadOfRest, ThatLeadsInMotionTooStays) {
  found(Eigen::VectorXd::Ones(data_.all_force_rows.size()));
  dropLeadsOfRest(search_);
  EXPECT_EQ(search_.effects.size(), 1u);
  EXPECT_TRUE(search_.taken_out.empty());
}

TEST_F(LeadOfRest, ThatHelpsWhereAnAxisSticksAloneIsTakenOutAndSaid) {
  const Eigen::ArrayXd weight = rowScale(data_.stack, data_.recordings, Attention::Moving).array();
  found((weight < 0.5 * weight.maxCoeff()).cast<double>());
  dropLeadsOfRest(search_);
  EXPECT_TRUE(search_.effects.empty());
  ASSERT_EQ(search_.taken_out.size(), 1u);
  EXPECT_NE(search_.taken_out[0].find("helps near rest only"), std::string::npos) << search_.taken_out[0];
}

}  // namespace
}  // namespace knee_robot::tracing
