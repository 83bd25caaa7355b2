#include "knee_robot/report/identify_report.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "test/identification/synthetic.h"

namespace knee_robot::report {
namespace {

/// A small but complete result, of two bench axes.
IdentifyResults results(bool with_validation) {
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
  r.train_by_rank = identification::errorAgainstRank(r.after, r.train, cutoff);
  if (with_validation) {
    identification::setFriction(r.validate[0], r.after.columns, r.after.model.friction);
    r.validate_before = identification::applyModel(r.before.model, robot, r.validate, cutoff);
    r.validate_after = identification::applyModel(r.after.model, robot, r.validate, cutoff);
    r.validate_by_rank = identification::errorAgainstRank(r.after, r.validate, cutoff);
  }
  return r;
}

TEST(IdentifyJson, HasTheAgreedShape) {
  const IdentifyResults r = results(true);
  const nlohmann::json j = nlohmann::json::parse(identifyJson(r));
  EXPECT_EQ(j["command"], "identify");
  EXPECT_EQ(j["data"]["train"].size(), 1u);
  EXPECT_EQ(j["data"]["validate"].size(), 1u);
  EXPECT_NEAR(j["data"]["rate_hz"].get<double>(), 100.0, 0.1);
  EXPECT_EQ(j["data"]["cutoff_hz"], 3.0);
  EXPECT_EQ(j["data"]["moving_m_per_s"], 0.0015);
  for (const char* when : {"before", "after"}) {
    EXPECT_TRUE(j[when]["parameters"].is_number_integer());
    for (const char* set : {"train", "validate"}) {
      for (const char* figure : {"rms_N", "rms_moving_N", "rms_raw_N", "rms_percent", "range_percent", "max_N"}) {
        ASSERT_EQ(j[when][set][figure].size(), 2u) << when << set << figure;
        EXPECT_TRUE(j[when][set][figure][0].is_number()) << when << set << figure;
      }
    }
  }
  EXPECT_LT(j["after"]["validate"]["rms_N"][0], j["before"]["validate"]["rms_N"][0]);
  EXPECT_TRUE(j["effects"].empty());
  EXPECT_EQ(j["unexplained"]["rms_N"].size(), 2u);
  EXPECT_EQ(j["rank"]["chosen"], r.after.model.rank);
}

TEST(IdentifyJson, SaysNullWhereThereIsNothing) {
  const nlohmann::json j = nlohmann::json::parse(identifyJson(results(false)));
  EXPECT_TRUE(j["after"]["validate"].is_null());
  EXPECT_FALSE(j["data"]["evidence_across_trajectories"]);
}

TEST(IdentifyHtml, IsSelfContainedAndComplete) {
  const std::string html = identifyHtml(results(true));
  EXPECT_EQ(html.find("http"), std::string::npos) << "nothing from outside";
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_NE(html.find("identify --output &quot;&lt;here&gt;&quot;"), std::string::npos);
  for (const char* part : {"<h2>Errors</h2>", "Error against the prior's strength", "Friction near rest", "Parameters",
                           "What was done with the signals", "Reproduce", "Validation: synthetic_1", "Fc_2"}) {
    EXPECT_NE(html.find(part), std::string::npos) << part;
  }
}

TEST(PredictionCsv, HasOneFiniteRowPerRowOfTheRecording) {
  const IdentifyResults r = results(true);
  std::istringstream csv(predictionCsv(r.validate[0], r.validate_after.predictions[0]));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "time_s,force_1_N,force_2_N,predicted_1_N,predicted_2_N");
  int rows = 0;
  while (std::getline(csv, line)) {
    ++rows;
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 4);
    EXPECT_EQ(line.find("n"), std::string::npos) << line;  // nan, inf
  }
  EXPECT_EQ(rows, 2000);
}

TEST(WriteIdentifyFiles, LeavesAllFilesAndAModelThatCanBeRead) {
  char pattern[] = "/tmp/knee_report_XXXXXX";
  const std::string folder = std::string(mkdtemp(pattern)) + "/a/b";
  const IdentifyResults r = results(true);
  writeIdentifyFiles(r, folder);
  for (const char* name : {"report.json", "report.html", "model.yaml", "prediction_synthetic_1.csv"}) {
    EXPECT_TRUE(std::filesystem::exists(folder + "/" + name)) << name;
  }
  const dynamics::Model m = dynamics::loadModel(folder + "/model.yaml");
  EXPECT_EQ(m.parameters.size(), r.after.model.parameters.size());
  EXPECT_EQ(m.parameters[1].value, r.after.model.parameters[1].value);
  EXPECT_THROW(writeIdentifyFiles(r, folder + "/model.yaml"), InputError);  // a file is in its place
  std::filesystem::remove_all(pattern);
}

TEST(IdentifySummary, ShowsErrorsAndTheRankCurve) {
  const std::string text = identifySummary(results(true));
  EXPECT_NE(text.find("validation (2000 samples"), std::string::npos) << text;
  EXPECT_NE(text.find(" *    8"), std::string::npos) << text;
}

}  // namespace
}  // namespace knee_robot::report
