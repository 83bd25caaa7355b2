#include "knee_robot/report/identify_report.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "knee_robot/base/errors.h"
#include "knee_robot/report/recorded_units.h"
#include "test/report/results.h"
#include "test/temporary_folder.h"

namespace knee_robot::report {
namespace {

TEST(IdentifyJson, HasTheAgreedShape) {
  const IdentifyResults r = identified(true);
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
  const nlohmann::json j = nlohmann::json::parse(identifyJson(identified(false)));
  EXPECT_TRUE(j["after"]["validate"].is_null());
  EXPECT_FALSE(j["data"]["evidence_across_trajectories"]);
}

TEST(IdentifyJson, HasWhatThePageShowsBesideTheFigures) {
  const IdentifyResults r = identified(true);
  const nlohmann::json j = nlohmann::json::parse(identifyJson(r));
  EXPECT_EQ(j["robot"], "bench.yaml");
  EXPECT_EQ(j["reproduce"], "identify --output \"<here>\"");
  EXPECT_EQ(j["combinations"], r.after.model.base.size());
  EXPECT_EQ(j["fit"]["equations"], r.after.equations);
  EXPECT_EQ(j["residual_moving_N"].size(), 2u);
  for (const auto& point : j["rank"]["curve"])
    EXPECT_GT(point["training"].get<double>(), 0.0);
  ASSERT_EQ(j["friction_tried"].size(), 2u);
  for (const auto& tried : j["friction_tried"]) {
    int chosen = 0;
    for (const auto& law : tried)
      chosen += law["chosen"].get<bool>();
    EXPECT_EQ(chosen, 1);
  }
}

TEST(IdentifyJson, OfAChainHasItsUnitsInKeysAndSentencesButBodiesInKilograms) {
  IdentifyResults r = identified(false);
  r.units = {{"Nm", "Nm"}, {1, 1}, {"shoulder", "elbow"}};
  r.physical.emplace();
  r.physical->bodies.resize(1);
  r.physical->bodies[0].fitted.mass = 2.5;
  const nlohmann::json j = nlohmann::json::parse(jsonWithUnits(r.units, identifyJson(r)));
  EXPECT_EQ(j["position_units"], nlohmann::json({"rad", "rad"}));
  EXPECT_TRUE(j["after"]["train"].contains("rms_Nm"));
  EXPECT_EQ(j["physical"]["links"][0]["mass_kg"], 2.5);
  EXPECT_NE(j["friction_near_rest"][0]["in_words"].get<std::string>().find("rad"), std::string::npos);
  for (const auto& [reason, share] : j["masks"].begin()->items())
    EXPECT_EQ(reason.find(" mm"), std::string::npos) << reason;
}

TEST(PredictionCsv, HasOneFiniteRowPerRowOfTheRecording) {
  const IdentifyResults r = identified(true);
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
  const TemporaryFolder temporary;
  const std::string folder = temporary + "/a/b";
  const IdentifyResults r = identified(true);
  writeIdentifyFiles(r, folder);
  for (const char* name : {"report.json", "report.html", "model.yaml", "prediction_synthetic_1.csv"}) {
    EXPECT_TRUE(std::filesystem::exists(folder + "/" + name)) << name;
  }
  const std::string html = readFile(folder + "/report.html");
  EXPECT_EQ(embedded(html)["report"], nlohmann::json::parse(readFile(folder + "/report.json")));
  const nlohmann::json series = embedded(html)["series"];
  ASSERT_EQ(series["recordings"].size(), 2u);
  EXPECT_EQ(series["recordings"][0]["name"], "synthetic_1");
  for (const char* line : {"measured", "predicted", "residual", "residual_before"}) {
    ASSERT_EQ(series["recordings"][0][line].size(), 2u);
    EXPECT_EQ(series["recordings"][0][line][1].size(), series["recordings"][0]["time_s"].size()) << line;
  }
  EXPECT_EQ(series["spectra"]["residual"][1].size(), series["spectra"]["frequency_hz"].size());
  EXPECT_EQ(series["friction"]["share_of_coulomb"].size(), 2u);
  for (const char* outside : {"http:", "https:", "src=", "<link", "@import"})
    EXPECT_EQ(ownPart(html).find(outside), std::string::npos) << outside;
  const dynamics::Model m = dynamics::loadModel(folder + "/model.yaml");
  EXPECT_EQ(m.parameters.size(), r.after.model.parameters.size());
  EXPECT_EQ(m.parameters[1].value, r.after.model.parameters[1].value);
  EXPECT_THROW(writeIdentifyFiles(r, folder + "/model.yaml"), InputError);  // a file is in its place
}

TEST(IdentifySummary, ShowsErrorsAndTheRankCurve) {
  const std::string text = identifySummary(identified(true));
  EXPECT_NE(text.find("validation (2000 samples"), std::string::npos) << text;
  EXPECT_NE(text.find(" *    8"), std::string::npos) << text;
}

TEST(WriteIdentifyFiles, RemovesWhatItsOwnEarlierRunLeftAndNothingElse) {
  const TemporaryFolder folder;
  IdentifyResults r = identified(true);
  writeIdentifyFiles(r, folder / "");
  writeFileAtomically(folder / "prediction_mine.csv", "of somebody else");
  writeFileAtomically(folder / "identified.urdf", "no earlier run had bodies");
  r.validate.front().name = "another";
  r.validate.front().path = "runs/another.csv";
  writeIdentifyFiles(r, folder / "");
  EXPECT_FALSE(std::filesystem::exists(folder / "prediction_synthetic_1.csv"));
  for (const char* name : {"prediction_another.csv", "prediction_mine.csv", "identified.urdf"})
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  writeFileAtomically(folder / "report.json", "{\"command\": \"trace\", \"data\": {\"validate\": [\"another.csv\"]}}");
  r.validate.clear();
  writeIdentifyFiles(r, folder / "");
  EXPECT_TRUE(std::filesystem::exists(folder / "prediction_another.csv")) << "trace wrote it";
}

}  // namespace
}  // namespace knee_robot::report
