#pragma once

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "knee_robot/recording/filter.h"
#include "src/tracing/near_rest.h"
#include "src/tracing/refit.h"
#include "test/identification/synthetic.h"

namespace knee_robot::tracing {

/// A search in two recordings of a machine that has the baseline and nothing else.
class SearchedMachine : public testing::Test {
 protected:
  static constexpr int kActuator = 1;

  SearchedMachine() {
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0.0, 0.3);
    for (int variant = 0; variant < 2; ++variant)
      data_.recordings.push_back(
          identification::observe(robot_, identification::columnsOf(robot_),
                                  identification::syntheticRecording(robot_, identification::syntheticModel(robot_),
                                                                     variant, 24.0, [&] { return noise(random); }),
                                  {}));
    data_.stack = makeStack(data_.recordings, {});
    base_ = fitBase(robot_, data_.recordings, data_.stack, identification::columnsOf(robot_));
    BaseFit newtons = base_;
    newtons.noise_N.setOnes();
    data_.all_base_rows = baseRows(newtons, data_.recordings, data_.stack);
    data_.all_force_rows = forceRows(newtons, data_.recordings, data_.stack);
    setAttention(data_, Attention::All);
    for (std::size_t r = 0; r < data_.recordings.size(); ++r) {
      data_.inputs.push_back(effectInput(robot_, data_.recordings[r], base_.friction_laws, static_cast<int>(r), 2));
      setModel(data_.inputs.back(), base_.columns, base_.parameters);
    }
    search_.data = &data_;
    search_.base = &base_;
    search_.rms_N = base_.noise_N;
    updateNearRest(search_);
  }

  Hypothesis named(const std::string& name, const std::vector<double>& shape) const {
    for (const auto& candidate : candidates_) {
      if (candidate->name() == name) return {{candidate.get(), candidate->shared() ? -1 : kActuator}, shape};
    }
    return {};
  }
  /// The machine's rows have this besides.
  void add(const Eigen::VectorXd& force_N) { data_.force_rows += force_N; }

  /// The machine has this in both of its recordings.
  void has(const Hypothesis& hypothesis, const Eigen::VectorXd& coefficients) {
    for (std::size_t r = 0; r < data_.recordings.size(); ++r)
      hasIn(r, hypothesis, coefficients);
  }
  /// In one of them.
  void hasIn(std::size_t k, const Hypothesis& hypothesis, const Eigen::VectorXd& coefficients) {
    identification::Observation& o = data_.recordings[k];
    Eigen::MatrixXd force_N(o.samples(), o.axes());
    for (int i = 0; i < o.axes(); ++i)
      force_N.col(i) = effectColumns(data_.inputs[k], hypothesis, i) * coefficients;
    recording::ZeroPhaseLowPass(data_.stack.cutoff_hz, 1.0 / o.signals.period_s).applyToColumns(force_N);
    o.force_filtered_N += force_N;
    BaseFit newtons = base_;
    newtons.noise_N.setOnes();
    data_.all_force_rows = forceRows(newtons, data_.recordings, data_.stack);
    setAttention(data_, Attention::All);
  }

  /// The model takes the actuator to rub by this law.
  void rubBy(const dynamics::FrictionLaw& law) {
    BaseFit other = base_;
    other.friction_laws[kActuator] = law;
    adoptBase(search_, other);
  }

  const mechanism::Robot robot_ = identification::syntheticRobot();
  const CandidateList candidates_ = namedCandidates(robot_);
  TraceData data_;
  BaseFit base_;
  Search search_;
};

}  // namespace knee_robot::tracing
