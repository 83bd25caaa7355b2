#pragma once

#include <random>
#include <vector>

#include "knee_robot/dynamics/model.h"
#include "knee_robot/tracing/trace.h"
#include "test/identification/synthetic.h"

namespace knee_robot::tracing {

/// The synthetic machine's rigid bodies, or its friction and rotors.
inline dynamics::Model partOfMachine(const mechanism::Robot& robot, bool rigid_bodies) {
  dynamics::Model model = identification::syntheticModel(robot);
  for (std::size_t k = 0; k < model.parameters.size(); ++k) {
    if ((k < static_cast<std::size_t>(dynamics::kInertialParameters)) != rigid_bodies) model.parameters[k].value = 0.0;
  }
  return model;
}

/// A machine whose legs give by these (m/N) under the load of the rigid bodies, exactly. Friction and rotors are on the
/// encoders' side.
class SoftMachine {
 public:
  SoftMachine(const mechanism::Robot& robot, const mechanism::Vector4& compliance, int variant)
      : robot_(robot),
        compliance_(compliance),
        sines_(identification::syntheticMotion(false, variant)),
        bodies_(partOfMachine(robot, true), robot),
        drives_(partOfMachine(robot, false), robot) {}

  recording::Recording recorded(int variant) {
    std::mt19937 random(static_cast<unsigned>(variant) + 1u);
    std::normal_distribution<double> noise(0.0, 0.3);
    recording::Recording r = identification::syntheticRecording(robot_, partOfMachine(robot_, true), variant, kLong_s);
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

/// Two recordings of such a machine along different paths, traced.
inline TraceResult tracedSoft(const mechanism::Robot& robot, const mechanism::Vector4& compliance) {
  const std::vector<recording::Recording> recordings = {SoftMachine(robot, compliance, 0).recorded(0),
                                                        SoftMachine(robot, compliance, 1).recorded(1)};
  TraceOptions options;
  options.surrogates = 5;
  return trace(robot, recordings,
               identification::observeAll(robot, identification::columnsOf(robot), recordings, options.observation),
               options);
}

/// The recording of such a machine with its own parameters: what its forces lack along the encoders' path, and what
/// somebody's candidate may look at.
class SoftRecording {
 public:
  SoftRecording(const mechanism::Robot& robot, const mechanism::Vector4& compliance)
      : columns_(identification::columnsOf(robot)),
        observation_(identification::observe(robot, columns_, SoftMachine(robot, compliance, 0).recorded(0), {})),
        laws_(4, dynamics::stopLaw(1e-5)) {
    identification::setFriction(observation_, columns_, laws_);
    input = effectInput(robot, observation_, laws_, 0, 1);
    const dynamics::Model truth = identification::syntheticModel(robot);
    Eigen::VectorXd parameters(static_cast<Eigen::Index>(columns_.size()));
    for (std::size_t c = 0; c < columns_.size(); ++c)
      parameters[static_cast<Eigen::Index>(c)] =
          identification::parameterValue(truth, columns_[c].name) / columns_[c].newtons;
    setModel(input, columns_, parameters);
  }
  SoftRecording(const SoftRecording&) = delete;  // its input points into it
  SoftRecording& operator=(const SoftRecording&) = delete;

  Eigen::MatrixXd lacking_N() const { return observation_.signals.force_N - input.force_N; }

  EffectInput input;

 private:
  const std::vector<identification::Column> columns_;
  identification::Observation observation_;
  const std::vector<dynamics::FrictionLaw> laws_;
};

}  // namespace knee_robot::tracing
