#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "knee_robot/base/files.h"
#include "knee_robot/mechanism/kinematics.h"
#include "knee_robot/report/compare.h"
#include "knee_robot/report/identify_report.h"
#include "knee_robot/report/trace_report.h"
#include "knee_robot/simulation/camera.h"
#include "knee_robot/tracing/model_prediction.h"
#include "test/identification/synthetic.h"

/// Small but complete results of identify, trace and compare, and what a page embeds.
namespace knee_robot::report {

/// A small but complete result, of two bench axes.
inline IdentifyResults identified(bool with_validation) {
  const mechanism::Robot robot = identification::syntheticBench(2);
  const dynamics::Model truth = identification::syntheticModel(robot);
  IdentifyResults r;
  r.command_line = "identify --output \"<here>\"";
  r.robot_path = "bench.yaml";
  const auto add = [&](std::vector<identification::Observation>& list, int variant) {
    list.push_back(identification::observe(robot, identification::columnsOf(robot),
                                           identification::syntheticRecording(robot, truth, variant, 20.0),
                                           r.options.observation));
  };
  add(r.train, 0);
  if (with_validation) add(r.validate, 1);
  r.after = identification::identify(robot, r.train, r.options);
  identification::IdentifyOptions without = r.options;
  without.friction = false;
  r.before = identification::identify(robot, r.train, without);
  const double cutoff = r.options.observation.cutoff_hz;
  r.train_before = identification::applyModel(r.before.model, robot, r.train, cutoff);
  r.train_after = identification::applyModel(r.after.model, robot, r.train, cutoff);
  r.train_by_strength = identification::errorAgainstRank(r.after, r.train, cutoff);
  if (with_validation) {
    identification::setFriction(r.validate[0], r.after.columns, r.after.model.friction);
    r.validate_before = identification::applyModel(r.before.model, robot, r.validate, cutoff);
    r.validate_after = identification::applyModel(r.after.model, robot, r.validate, cutoff);
    r.validate_by_strength = identification::errorAgainstRank(r.after, r.validate, cutoff);
  }
  return r;
}

/// Two bench axes, the second with a drag that the model lacks, traced on one recording and validated on another.
inline const TraceResults& traced() {
  static const TraceResults results = [] {
    mechanism::Robot robot = identification::syntheticBench(2);
    for (mechanism::Actuator& a : robot.actuators) {
      a.position_max_m = 0.4;
      a.velocity_max_m_per_s = 0.3;
      a.acceleration_max_m_per_s2 = 5.0;
    }
    TraceResults r;
    r.command_line = "trace --output \"<here>\"";
    r.robot_path = "bench.yaml";
    r.options.surrogates = 3;
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0.0, 0.5);
    std::vector<recording::Recording> recordings;
    for (int variant = 0; variant < 2; ++variant) {
      recordings.push_back(identification::syntheticRecording(robot, identification::syntheticModel(robot), variant,
                                                              30.0, [&] { return noise(random); }));
      recording::Recording& recording = recordings.back();
      recording.fingerprint = "run" + std::to_string(variant);
      for (int k = 0; k + 1 < recording.rows(); ++k) {
        const double v = (recording.position_m(k + 1, 1) - recording.position_m(k, 1)) / 0.01;
        recording.force_N(k, 1) += 4000.0 * v * std::abs(v);
      }
      recording.reference_m = recording.position_m;
    }
    r.train.push_back(
        identification::observe(robot, identification::columnsOf(robot), recordings[0], r.options.observation));
    r.validate.push_back(
        identification::observe(robot, identification::columnsOf(robot), recordings[1], r.options.observation));
    r.result = tracing::trace(robot, {recordings[0]}, r.train, r.options);
    r.model = tracing::tracedModel(robot, r.result, r.train, r.options);
    const auto apply = [&](std::vector<identification::Observation>& list, bool after, int recording) {
      identification::Applied applied;
      for (identification::Observation& o : list)
        applied.predictions.push_back(identification::makePrediction(
            o, after ? tracing::predictTraced(robot, r.result, o, recording, 1) : tracing::predictBaseline(r.result, o),
            3.0));
      applied.accuracy = identification::accuracyOf(list, applied.predictions);
      return applied;
    };
    r.train_before = apply(r.train, false, 0);
    r.train_after = apply(r.train, true, 0);
    r.validate_before = apply(r.validate, false, -1);
    r.validate_after = apply(r.validate, true, -1);
    for (std::size_t k = 0; k < r.result.effects.size(); ++k)
      r.validate_gain_N.push_back(r.validate_before.accuracy.rms_N - r.validate_after.accuracy.rms_N);
    tracing::NextExperimentOptions quick;
    quick.duration_s = 15.0;
    quick.random = quick.improving = 6;
    r.next = tracing::planNextExperiment(robot, r.result, r.train, r.options, quick);
    return r;
  }();
  return results;
}

inline mechanism::Robot robotB() {
  return mechanism::loadRobot(KNEE_SOURCE_DIR "/config/robots/B.yaml");
}

inline mechanism::Pose poseAt(double t) {
  return {0.05 * std::sin(0.9 * t), 0.76 + 0.03 * std::sin(1.3 * t), 0.12 + 0.1 * std::sin(0.7 * t),
          0.05 * std::sin(1.1 * t)};
}

/// 20 s along poseAt; the measured pose is the reference's plus `error`.
inline recording::Recording recorded(const mechanism::Robot& robot,
                                     const mechanism::Pose& error = mechanism::Pose::Zero(), double period_s = 0.01) {
  recording::Recording r;
  r.path = "run <1>.csv";
  r.name = "run <1>";
  r.axes = 4;
  const auto rows = static_cast<Eigen::Index>(20.0 / period_s);
  r.position_m.resize(rows, 4);
  r.reference_m.resize(rows, 4);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double t = static_cast<double>(i) * period_s;
    r.time_s.push_back(t);
    r.reference_m.row(i) = mechanism::legLengths(*robot.mechanism, poseAt(t)).transpose();
    r.position_m.row(i) = mechanism::legLengths(*robot.mechanism, poseAt(t) + error).transpose();
  }
  return r;
}

/// What a camera sees of poseAt: late, in a turned and shifted frame, with markers put on askew.
inline void film(recording::Recording& r, double delay_s, double turn, double shift_x, double shift_z, double plate) {
  r.mocap.resize(r.rows(), 4);
  for (int i = 0; i < r.rows(); ++i) {
    const mechanism::Pose p = poseAt(r.time_s[static_cast<std::size_t>(i)] - delay_s);
    const double x = p[0] - shift_x, z = p[1] - shift_z, c = std::cos(turn), s = std::sin(turn);
    r.mocap.row(i) << c * x - s * z, s * x + c * z, p[2] - turn, p[3] - plate;
  }
}

/// What the page embeds: {"report", "series"}.
inline nlohmann::json embedded(const std::string& html) {
  const std::string mark = "<script id=\"data\" type=\"application/json\">";
  const std::size_t from = html.find(mark) + mark.size();
  return nlohmann::json::parse(html.substr(from, html.find("</script>", from) - from));
}

/// The page without the plotting library.
inline std::string ownPart(std::string html) {
  const std::string library = readFile("/usr/share/javascript/chart.js/chart.min.js");
  return html.replace(html.find(library), library.size(), "");
}

/// A camera that another geometry is seen by: one radius of the platform is 6 mm larger.
inline tracing::PoseTrace poseOfAWrongRadius() {
  const mechanism::Robot robot = identification::syntheticRobot();
  std::vector<recording::Recording> recordings;
  mechanism::Geometry other = robot.mechanism->geometry;
  other.Rm[1] += 0.006;
  for (int variant = 0; variant < 2; ++variant) {
    recordings.push_back(
        identification::syntheticRecording(robot, identification::syntheticModel(robot), variant, 25.0));
    simulation::addCamera(other, {}, recordings.back());
  }
  return tracing::tracePose(robot, {recordings[0]}, {recordings[1]}, {});
}

}  // namespace knee_robot::report
