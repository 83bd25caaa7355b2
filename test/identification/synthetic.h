#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "knee_robot/dynamics/model.h"
#include "knee_robot/dynamics/rigid_body.h"
#include "knee_robot/mechanism/leg_motion.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/recording/recording.h"

namespace knee_robot::identification {

/// A robot whose parameters are known, made without files.
inline mechanism::Robot syntheticRobot() {
  mechanism::Robot robot;
  robot.path = "synthetic.yaml";
  robot.fingerprint = "0123456789abcdef";
  mechanism::Geometry g;
  g.R = {0.5, 0.45, 0.45};
  g.ds = 0.15;
  g.beta_FD = g.beta_FI = 1.221730;
  g.Rm = {0.3, 0.3, 0.3};
  g.beta_MD = g.beta_MI = 0.174533;
  robot.mechanism = mechanism::Mechanism(g);
  robot.actuators.assign(4, mechanism::Actuator());
  for (mechanism::Actuator& a : robot.actuators) {
    a.counts_per_revolution = 5000.0;  // 2 um
    a.force_per_volt_N = 100.0;
  }
  return robot;
}

inline mechanism::Robot syntheticBench(int axes) {
  mechanism::Robot robot = syntheticRobot();
  robot.kind = mechanism::MechanismKind::Axes;
  robot.mechanism.reset();
  robot.actuators.resize(static_cast<std::size_t>(axes));
  return robot;
}

/// Known parameters: links of 1 to 12 kg that a body could have, friction, rotors; widths of 10 um.
inline dynamics::Model syntheticModel(const mechanism::Robot& robot) {
  dynamics::Model m;
  m.kind = robot.kind;
  m.axes = robot.axes();
  m.robot_fingerprint = robot.fingerprint;
  m.data = {{"none.csv", "0"}};
  m.cutoff_hz = 3.0;
  m.moving_m_per_s = 0.0015;
  m.rank = 1;
  m.friction.assign(robot.actuators.size(), dynamics::stopLaw(1e-5));
  m.residual_rms_N.assign(robot.actuators.size(), 0.0);
  const auto add = [&](const std::string& name, double value) {
    dynamics::ModelParameter p;
    p.name = name;
    p.unit = "SI";
    p.value = value;
    m.parameters.push_back(p);
  };
  if (robot.kind == mechanism::MechanismKind::Axes) {
    const std::vector<std::string> names = dynamics::axisParameterNames(robot.axes());
    const double values[] = {200.0, 30.0, 80.0, 10.0};  // Fv, Fc, rotor, offset
    for (std::size_t i = 0; i < names.size(); ++i)
      add(names[i], values[i % 4] * (1.0 + 0.2 * static_cast<double>(i / 4)));
    return m;
  }
  dynamics::ExtendedParameters p = dynamics::ExtendedParameters::Zero();
  for (int link = 0; link < dynamics::kLinks; ++link) {
    dynamics::LinkInertia body;
    body.mass = link == dynamics::kPlatformLink ? 12.0 : 1.0 + 0.5 * link;
    body.center = mechanism::Vector3(0.01 * link, -0.02, link % 2 ? -0.15 : 0.1);
    body.inertia = mechanism::Matrix3(mechanism::Vector3(0.02, 0.03, 0.04).asDiagonal()) * body.mass;
    p.segment<dynamics::kLinkParameters>(link * dynamics::kLinkParameters) = dynamics::toParameters(body);
  }
  for (int leg = 0; leg < mechanism::kLegs; ++leg) {
    p[dynamics::extended::kViscous + leg] = 200.0 + 50.0 * leg;
    p[dynamics::extended::kCoulomb + leg] = 25.0 + 5.0 * leg;
    p[dynamics::extended::kRotor + leg] = 60.0 + 20.0 * leg;
  }
  for (int i = 0; i < dynamics::extended::kParameters; ++i)
    add(dynamics::extendedParameterNames()[static_cast<std::size_t>(i)], p[i]);
  return m;
}

/// Smooth sum of sines in each coordinate, with its derivatives.
struct Sines {
  double center = 0.0;
  std::vector<double> amplitude, hz, phase;

  double at(double t, int derivative) const {
    double sum = derivative == 0 ? center : 0.0;
    for (std::size_t k = 0; k < hz.size(); ++k) {
      const double w = 2.0 * M_PI * hz[k];
      sum += amplitude[k] * std::pow(w, derivative) * std::sin(w * t + phase[k] + derivative * M_PI / 2);
    }
    return sum;
  }
};

/// Four different motions of the platform, or of bench axes; `variant` makes another trajectory.
inline std::vector<Sines> syntheticMotion(bool bench, int variant) {
  const double shift = 0.7 * variant;
  const double f = 1.0 + 0.17 * variant;
  if (bench) {
    std::vector<Sines> s;
    for (int i = 0; i < 4; ++i)
      s.push_back({0.2, {0.05, 0.02}, {(0.2 + 0.05 * i) * f, 0.6 * f}, {shift + i, 2.0 * i}});
    return s;
  }
  return {{0.02, {0.05, 0.02}, {0.21 * f, 0.63 * f}, {shift, 1.0}},
          {0.80, {0.05, 0.02}, {0.17 * f, 0.57 * f}, {shift + 1.0, 0.3}},
          {0.10, {0.12, 0.05}, {0.26 * f, 0.71 * f}, {shift + 2.0, 2.1}},
          {0.00, {0.10, 0.04}, {0.23 * f, 0.49 * f}, {shift + 3.0, 0.9}}};
}

/// Position, velocity, acceleration of the actuators, and the platform's motion, at time t.
struct SyntheticState {
  mechanism::Vector4 q = mechanism::Vector4::Zero(), v = mechanism::Vector4::Zero(), a = mechanism::Vector4::Zero();
  mechanism::Motion motion;
};

/// Clock of a motion that starts and ends at rest: its own time, rate and change of rate, smooth over the first and
/// last 2 s.
struct Clock {
  double at = 0.0, rate = 1.0, change = 0.0;

  Clock(double t, double end) {
    const double x = std::min(1.0, std::max(0.0, t < 2.0 ? t / 2.0 : (end - t) / 2.0));
    rate = x * x * (3.0 - 2.0 * x);
    change = (t < 2.0 ? 3.0 : -3.0) * x * (1.0 - x);
    const double passed = 2.0 * (x * x * x - x * x * x * x / 2.0);  // integral of the rate over a ramp
    if (t < 2.0) {
      at = passed;
    } else {
      at = t <= end - 2.0 ? t - 1.0 : end - 2.0 - passed;
    }
  }
};

inline SyntheticState syntheticState(const mechanism::Robot& robot, const std::vector<Sines>& sines, double t,
                                     double end) {
  SyntheticState s;
  const Clock clock(t, end);
  mechanism::Vector4 x[3];
  for (int i = 0; i < 4; ++i) {
    const Sines& sine = sines[static_cast<std::size_t>(i)];
    x[0][i] = sine.at(clock.at, 0);
    x[1][i] = sine.at(clock.at, 1) * clock.rate;
    x[2][i] = sine.at(clock.at, 2) * clock.rate * clock.rate + sine.at(clock.at, 1) * clock.change;
  }
  if (!robot.mechanism) {
    const int n = robot.axes();
    s.q.head(n) = x[0].head(n);
    s.v.head(n) = x[1].head(n);
    s.a.head(n) = x[2].head(n);
    return s;
  }
  s.motion = {x[0], x[1], x[2]};
  const mechanism::Matrix4 j = mechanism::lengthJacobian(*robot.mechanism, x[0]);
  s.q = mechanism::legLengths(*robot.mechanism, x[0]);
  s.v = j * x[1];
  s.a = j * x[2] + mechanism::lengthBias(*robot.mechanism, x[0], x[1]);
  return s;
}

/// Recording of `seconds` at 100 Hz whose forces follow from the model exactly: row k's force is that in the middle of
/// its hold interval. `noise` adds to each force.
inline recording::Recording syntheticRecording(
    const mechanism::Robot& robot, const dynamics::Model& model, int variant, double seconds,
    const std::function<double()>& noise = [] { return 0.0; }) {
  const std::vector<Sines> sines = syntheticMotion(!robot.mechanism, variant);
  const dynamics::ForceModel force_model(model, robot);
  dynamics::ForceModelData data;
  recording::Recording r;
  r.name = "synthetic_" + std::to_string(variant);
  r.path = r.name + ".csv";
  r.axes = robot.axes();
  const int rows = static_cast<int>(seconds * 100.0);
  r.position_m.resize(rows, r.axes);
  r.force_N.resize(rows, r.axes);
  for (int k = 0; k < rows; ++k) {
    const double t = 0.01 * k;
    r.time_s.push_back(t);
    const SyntheticState middle = syntheticState(robot, sines, t + 0.005, seconds);
    mechanism::Vector4 force;
    dynamics::forceFromModel(force_model, middle.q, middle.v, middle.a, middle.motion, data, force);
    r.position_m.row(k) = syntheticState(robot, sines, t, seconds).q.head(r.axes).transpose();
    for (int i = 0; i < r.axes; ++i)
      r.force_N(k, i) = force[i] + noise();
  }
  return r;
}

inline double parameterValue(const dynamics::Model& model, const std::string& name) {
  for (const dynamics::ModelParameter& p : model.parameters) {
    if (p.name == name) return p.value;
  }
  return std::nan("");
}

}  // namespace knee_robot::identification
