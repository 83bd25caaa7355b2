#include "knee_robot/report/trace_report.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "knee_robot/base/errors.h"
#include "test/report/results.h"
#include "test/temporary_folder.h"

namespace knee_robot::report {
namespace {

TEST(TraceJson, HasTheAgreedShape) {
  const nlohmann::json j = nlohmann::json::parse(traceJson(traced()));
  EXPECT_EQ(j["command"], "trace");
  EXPECT_EQ(j["data"]["train"].size(), 1u);
  EXPECT_EQ(j["data"]["validate"].size(), 1u);
  for (const char* when : {"before", "after"}) {
    EXPECT_TRUE(j[when]["parameters"].is_number_integer());
    for (const char* set : {"train", "validate"}) {
      for (const char* figure : {"rms_N", "rms_moving_N", "rms_raw_N", "rms_percent", "range_percent", "max_N"})
        ASSERT_EQ(j[when][set][figure].size(), 2u) << when << set << figure;
    }
  }
  ASSERT_EQ(j["effects"].size(), traced().result.effects.size());
  for (const auto& e : j["effects"]) {
    for (const char* key : {"name", "actuators", "transfers", "parameters", "explained_rms_N", "null_rms_N", "p",
                            "validate_gain_N", "indistinguishable_from"})
      EXPECT_TRUE(e.contains(key)) << key;
    EXPECT_LE(e["indistinguishable_from"].size(), 2u);
  }
  for (const char* key : {"rms_N", "noise_floor_N", "depends_on"})
    EXPECT_TRUE(j["unexplained"].contains(key)) << key;
  EXPECT_TRUE(j.contains("pose"));
  EXPECT_TRUE(j.contains("next_experiment"));
}

TEST(TraceReport, NamesTheDragOfTheSecondAxisAndShowsThatItsErrorIsGone) {
  const TraceResults& r = traced();
  ASSERT_FALSE(r.result.effects.empty()) << traceSummary(r);
  std::string names;
  for (const tracing::FoundEffect& e : r.result.effects) {
    EXPECT_EQ(e.hypothesis.place.actuator, 1);
    names += e.hypothesis.place.candidate->name();
    for (const std::string& other : e.indistinguishable_from)
      names += " " + other;
  }
  EXPECT_NE(names.find("quadratic_drag"), std::string::npos) << names;
  EXPECT_LT(r.validate_after.accuracy.rms_N[1], 0.5 * r.validate_before.accuracy.rms_N[1]);
  EXPECT_LT(r.validate_after.accuracy.rms_N[0], 1.05 * r.validate_before.accuracy.rms_N[0]);
}

TEST(TraceReport, SaysWhatActsInTheHeldOutRecordingsAndHardlyInTraining) {
  TraceResults r = traced();
  EXPECT_EQ(traceVerdict(r).find("hardly acts in training"), std::string::npos) << traceVerdict(r);
  const double trained = std::max(r.train_before.accuracy.rms_moving_N[0], r.result.floor_N[0]);
  r.validate_after.accuracy.rms_moving_N[0] = r.validate_before.accuracy.rms_moving_N[0] = 5.0 * trained;
  const std::string verdict = traceVerdict(r);
  EXPECT_NE(verdict.find("On the held-out recordings actuator 1 leaves"), std::string::npos) << verdict;
  EXPECT_EQ(verdict.find("actuator 2 leaves"), std::string::npos) << verdict;
  EXPECT_NE(verdict.find("hardly acts in training"), std::string::npos) << verdict;
  r.validate_before.accuracy.rms_moving_N[0] = trained;
  EXPECT_NE(traceVerdict(r).find(" N): what was added is wrong there; trace with"), std::string::npos)
      << traceVerdict(r);
  r.validate.clear();
  EXPECT_EQ(traceVerdict(r).find("hardly acts in training"), std::string::npos) << "nothing was held out";
}

TEST(TraceReport, SaysWhenTheRestBeforeTheFirstMovementDecidesOverTheHeldOutError) {
  TraceResults r = traced();
  r.validate_before.accuracy.rms_N = Eigen::Vector2d(12.0, 5.0);
  r.validate_after.accuracy.rms_N = Eigen::Vector2d(14.0, 5.0);
  r.validate_before.accuracy.rms_since_moved_N = Eigen::Vector2d(8.0, std::nan(""));
  r.validate_after.accuracy.rms_since_moved_N = Eigen::Vector2d(6.0, std::nan(""));
  EXPECT_NE(traceOutcome(r).find("UP by 14 %, rms of all actuators 9.19 -> 10.5 N; from each axis's first movement on "
                                 "it went DOWN by 25 %, 8 -> 6 N"),
            std::string::npos)
      << traceOutcome(r);
  r.validate_after.accuracy.rms_N = Eigen::Vector2d(4.0, 4.0);
  EXPECT_EQ(traceOutcome(r).find("first movement"), std::string::npos) << "both say the same: " << traceOutcome(r);
  r.validate_after.accuracy.rms_since_moved_N[0] = 9.0;
  EXPECT_NE(traceOutcome(r).find("first movement on it went UP by 12 %"), std::string::npos) << traceOutcome(r);
}

TEST(TraceReport, SaysThatTheHeldOutRecordingsRestAndThoseOfTrainingHardlyDo) {
  TraceResults r = traced();
  r.train_before.accuracy.rms_resting_N = r.train_after.accuracy.rms_resting_N = Eigen::Vector2d(0.5, 0.4);
  r.validate_after.accuracy.rms_resting_N = Eigen::Vector2d(0.6, std::nan(""));
  r.result.floor_N.setConstant(0.3);
  EXPECT_EQ(traceVerdict(r).find("At rest"), std::string::npos) << traceVerdict(r);
  r.validate_after.accuracy.rms_resting_N = Eigen::Vector2d(1.2, 0.7);
  EXPECT_NE(
      traceVerdict(r).find("At rest actuator 1 leaves 1.2 N on the held-out recordings, 0.5 N on those of training"),
      std::string::npos)
      << traceVerdict(r);
  EXPECT_NE(traceVerdict(r).find("plan_excitation --near-rest plans one"), std::string::npos) << traceVerdict(r);
  r.validate_after.accuracy.rms_resting_N[1] = 0.9;
  EXPECT_NE(traceVerdict(r).find("At rest actuators 1, 2 leave 1.2, 0.9 N on the held-out recordings, 0.5, 0.4 N"),
            std::string::npos)
      << traceVerdict(r);
}

TEST(TraceReport, SaysTheNamesThatAreNotToldApartAndNoneOfThemWhereThereAreThreeRivals) {
  TraceResults r = traced();
  ASSERT_FALSE(r.result.effects.empty());
  tracing::FoundEffect& e = r.result.effects.front();
  const std::string name = r.model.effects.front().name;
  e.doubted = false;
  e.indistinguishable_from = {"delay", "stribeck"};
  EXPECT_NE(traceVerdict(r).find(" or delay or stribeck"), std::string::npos) << traceVerdict(r);
  e.indistinguishable_from.emplace_back("backlash");
  EXPECT_NE(traceVerdict(r).find("unnamed (" + name + ", delay, stribeck, backlash are not told apart)"),
            std::string::npos)
      << traceVerdict(r);
  EXPECT_EQ(nlohmann::json::parse(traceJson(r))["effects"][0]["name"], "unnamed") << "as the terminal";
}

TEST(TraceReport, SaysThatTheBaselineHasPresliding) {
  TraceResults r = traced();
  EXPECT_EQ(traceVerdict(r).find("presliding"), std::string::npos);
  r.result.presliding = "of actuator 2 (bristles 700 um)";
  EXPECT_NE(traceVerdict(r).find("The baseline has presliding: of actuator 2 (bristles 700 um)."), std::string::npos);
}

TEST(TraceReport, PredictsWhatTheFilesModelSaysAndThatModelRunsInstantByInstant) {
  const TraceResults& r = traced();
  const dynamics::Model read = dynamics::parseModel(dynamics::modelToYaml(r.model), "model.yaml");
  ASSERT_EQ(read.effects.size(), r.result.effects.size());
  for (std::size_t k = 0; k < read.effects.size(); ++k) {
    ASSERT_EQ(read.effects[k].coefficients.size(), static_cast<std::size_t>(r.result.effects[k].coefficients.size()));
    for (std::size_t n = 0; n < read.effects[k].coefficients.size(); ++n)
      EXPECT_DOUBLE_EQ(read.effects[k].coefficients[n].value,
                       r.result.effects[k].coefficients[static_cast<Eigen::Index>(n)]);
  }
  EXPECT_TRUE(dynamics::ForceModel(read, identification::syntheticBench(2)).effects.any());
  for (const bool training : {true, false}) {
    identification::Observation o = (training ? r.train : r.validate).front();
    const Eigen::MatrixXd own = (training ? r.train_after : r.validate_after).predictions.front().force_N;
    EXPECT_LT(
        (tracing::predictModel(identification::syntheticBench(2), read, "model.yaml", o) - own).cwiseAbs().maxCoeff(),
        1e-9);
  }
}

TEST(TraceJson, SaysHowFarEveryCandidateIsFromTheBaseAndWhereTheErrorLies) {
  const nlohmann::json j = nlohmann::json::parse(traceJson(traced()));
  int absorbed = 0, seen = 0;
  for (const auto& a : j["angles"]) {
    ASSERT_LE(a["to_base_deg"][0].get<double>(), a["to_base_deg"][1].get<double>() + 1e-9);
    EXPECT_LE(a["nearest"].size(), 3u);
    for (const auto& n : a["nearest"]) {
      if (n["name"] == "sensor_lag" || a["name"] == "sensor_lag") continue;
      EXPECT_EQ(n["actuator"], a["actuator"]) << "bench axes share nothing but what records them";
    }
    if (a["name"] == "force_offset") {
      ++absorbed;
      EXPECT_LT(a["to_base_deg"][1].get<double>(), 0.1) << "the base has an offset";
    }
    if (a["name"] == "quadratic_drag") {
      ++seen;
      EXPECT_GT(a["to_base_deg"][1].get<double>(), 5.0);
      EXPECT_FALSE(a["nearest"].empty());
    }
  }
  EXPECT_EQ(absorbed, 2);
  EXPECT_EQ(seen, 2);
  for (int i = 0; i < 2; ++i) {
    double error = 0.0, samples = 0.0;
    for (const auto& kind : j["unexplained"]["where"]) {
      error += kind["share_of_squared_error"][i].get<double>();
      samples += kind["share_of_samples"][i].get<double>();
    }
    EXPECT_NEAR(error, 1.0, 1e-9);
    EXPECT_NEAR(samples, 1.0, 1e-9);
  }
}

TEST(TraceJson, WhatIsPredictedInAGapIsNoErrorThatIsLeft) {
  TraceResults r = traced();
  const nlohmann::json whole = nlohmann::json::parse(traceJson(r))["unexplained"]["where"];
  identification::Observation& o = r.validate.front();
  o.judged.assign(static_cast<std::size_t>(o.samples()), 1);
  for (int n = 500; n < 700; ++n) {
    o.usable[static_cast<std::size_t>(n)] = o.judged[static_cast<std::size_t>(n)] = 0;
    r.validate_after.predictions.front().force_filtered_N.row(n).setConstant(1e4);
    r.validate_before.predictions.front().force_filtered_N.row(n).setConstant(-1e4);
  }
  const nlohmann::json j = nlohmann::json::parse(traceJson(r));
  for (const auto& [kind, shares] : j["unexplained"]["where"].items()) {
    for (int i = 0; i < 2; ++i)
      EXPECT_NEAR(shares["share_of_squared_error"][i].get<double>(),
                  whole[kind]["share_of_squared_error"][i].get<double>(), 0.15)
          << kind;
  }
  const GainInterval gain = bootstrapGain(r.validate, r.validate_before, r.validate_after, 1);
  EXPECT_LT(gain.low_N.cwiseAbs().maxCoeff(), 100.0);
}

TEST(WriteTraceFiles, LeavesAPageThatEmbedsTheReportAndTheSeriesOfItsPlots) {
  const TemporaryFolder folder;
  writeTraceFiles(traced(), folder);
  const std::string html = readFile(folder + "/report.html");
  const nlohmann::json report = embedded(html)["report"], series = embedded(html)["series"];
  EXPECT_EQ(report, nlohmann::json::parse(readFile(folder + "/report.json")));
  EXPECT_EQ(report["reproduce"], "trace --output \"<here>\"");
  EXPECT_EQ(report["robot"], "bench.yaml");
  ASSERT_EQ(report["friction_tried"].size(), 2u);
  ASSERT_EQ(series["recordings"].size(), 2u);
  EXPECT_EQ(series["recordings"][0]["name"], "synthetic_1");
  EXPECT_EQ(series["recordings"][1]["kind"], "train");
  EXPECT_EQ(series["maps"]["name"], "synthetic_1");
  for (const char* map : {"over_velocity", "over_position"}) {
    ASSERT_EQ(series["maps"][map].size(), 2u);
    EXPECT_EQ(series["maps"][map][1]["after"].size(), 60u);
  }
  for (const char* outside : {"http:", "https:", "src=", "<link", "@import"})
    EXPECT_EQ(ownPart(html).find(outside), std::string::npos) << outside;
}

TEST(WriteTraceFiles, LeavesAllFilesWithOneFinitePredictionARow) {
  const TemporaryFolder temporary;
  const std::string folder = temporary + "/a/b";
  writeTraceFiles(traced(), folder);
  for (const char* name : {"report.json", "report.html", "model.yaml", "prediction_synthetic_1.csv"})
    EXPECT_TRUE(std::filesystem::exists(folder + "/" + name)) << name;
  EXPECT_EQ(std::filesystem::exists(folder + "/next_experiment.txt"), traced().next.planned);
  std::istringstream csv(readFile(folder + "/prediction_synthetic_1.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "time_s,force_1_N,force_2_N,predicted_1_N,predicted_2_N,before_1_N,before_2_N");
  int rows = 0;
  for (; std::getline(csv, line); ++rows)
    EXPECT_EQ(line.find("n"), std::string::npos) << line;  // nan, inf
  EXPECT_EQ(rows, 3000);
}

TEST(TraceReport, ShowsTheMotionThatSeparatesAPairAndWritesIt) {
  TraceResults r = traced();
  r.next.first = "quadratic_drag on actuator 2";
  r.next.second = "stribeck on actuator 2";
  r.next.planned = true;
  r.next.now = {0.1, 0.5};
  r.next.then = {0.4, 3.0};
  r.next.reference.points = trajectory::Points::Constant(50, 4, 0.2);
  const TemporaryFolder folder;
  writeTraceFiles(r, folder);
  EXPECT_EQ(trajectory::readReference(folder + "/next_experiment.txt").points.rows(), 50);
  const nlohmann::json j = nlohmann::json::parse(readFile(folder + "/report.json"));
  EXPECT_EQ(j["next_experiment"]["reference"], "next_experiment.txt");
  EXPECT_NEAR(j["next_experiment"]["planned"]["angle_deg"].get<double>(), 22.9, 0.1);
  EXPECT_NE(traceSummary(r).find("play next_experiment.txt"), std::string::npos);
  const nlohmann::json planned = embedded(readFile(folder + "/report.html"))["series"]["next_experiment"];
  EXPECT_EQ(planned["time_s"].size(), 50u);
  EXPECT_EQ(planned["length_m"].size(), 4u);
}

TEST(TraceReport, ShowsThePoseBeforeAndAfterWithItsFindings) {
  TraceResults r = traced();
  r.pose = poseOfAWrongRadius();
  const nlohmann::json j = nlohmann::json::parse(traceJson(r))["pose"];
  EXPECT_EQ(j["before"]["of"], "validate");
  for (const char* when : {"before", "after"}) {
    EXPECT_EQ(j[when]["rms_m"].size(), 2u);
    EXPECT_EQ(j[when]["rms_rad"].size(), 2u);
  }
  ASSERT_FALSE(j["findings"].empty());
  EXPECT_EQ(j["findings"][0]["name"], "geometry_error");
  EXPECT_LT(j["after"]["rms_rad"][1].get<double>(), j["before"]["rms_rad"][1].get<double>());
  EXPECT_NE(traceSummary(r).find("geometry_error in Rm_2_m"), std::string::npos) << traceSummary(r);
  const TemporaryFolder folder;
  writeTraceFiles(r, folder);
  const nlohmann::json shown = embedded(readFile(folder + "/report.html"))["series"]["pose"];
  ASSERT_EQ(shown.size(), 2u);
  EXPECT_EQ(shown[0]["kind"], "validate");
  EXPECT_EQ(shown[0]["after"].size(), 4u);
  EXPECT_EQ(shown[0]["after"][3].size(), shown[0]["time_s"].size());
}

}  // namespace
}  // namespace knee_robot::report
