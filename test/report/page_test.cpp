#include "knee_robot/report/page.h"

#include <gtest/gtest.h>

#include "knee_robot/base/errors.h"
#include "test/refusal.h"
#include "test/report/count.h"
#include "test/report/results.h"

namespace knee_robot::report {
namespace {

TEST(Page, EmbedsItsDataSoThatNoTextOfItCanEndTheScript) {
  const std::string hostile = "</script><script>alert(1)</script><!--<script {{library}} \\u2028";
  const std::string json = nlohmann::json{{"command", "compare"}, {"notes", {hostile}}}.dump();
  const std::string html = Page("compare").with(json, "{}");
  EXPECT_EQ(html.find("alert(1)</"), std::string::npos);
  EXPECT_EQ(embedded(html)["report"]["notes"][0], hostile);
  EXPECT_EQ(count(html, "<script"), count(Page("compare").with("{}", "{}"), "<script"));
}

TEST(Page, OfEveryKindHasAllItsPartsAndForbidsTheNetwork) {
  for (const char* command : {"identify", "trace", "compare", "predict", "drive_gains", "tune_pid"}) {
    const std::string html = Page(command).with("{}", "{}");
    EXPECT_EQ(count(html, "{{"), 0u + count(readFile("/usr/share/javascript/chart.js/chart.min.js"), "{{")) << command;
    EXPECT_EQ(count(ownPart(html), "<script"), 4u);
    EXPECT_EQ(count(ownPart(html), "</script>"), 4u) << "no script ends early";
    EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
    EXPECT_NE(html.find("report.json beside it"), std::string::npos) << "for browsers without scripts";
    EXPECT_EQ(ownPart(html).find("innerHTML"), std::string::npos);
  }
}

TEST(Page, WhoseScriptIsNotThereIsRefusedWithAWayOut) {
  const std::string said = refusalOf([&] { Page("no_such_program"); });
  EXPECT_NE(said.find("pages/no_such_program.js"), std::string::npos);
  EXPECT_NE(said.find("KNEE_ROBOT_PATH"), std::string::npos);
}

}  // namespace
}  // namespace knee_robot::report
