#include "knee_robot/report/exercise_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "test/mechanism/configured_robot.h"
#include "test/report/count.h"

namespace knee_robot::report {
namespace {

TEST(ExerciseReport, ShowsEveryExerciseWithPoseActuatorsAndMarginsAsOnePicture) {
  const mechanism::Robot robot = mechanism::configuredRobot("final");
  for (const trajectory::Exercise& exercise : trajectory::exercises()) {
    trajectory::ExerciseOptions options;
    options.scale_to_fit = true;
    const trajectory::ExercisePlan plan = trajectory::planExercise(exercise, robot, options);
    const std::string svg = exerciseSvg(exercise, robot, plan);
    EXPECT_EQ(count(svg, "<svg "), 7u) << exercise.name;  // six panels in one picture
    EXPECT_EQ(count(svg, "<svg "), count(svg, "</svg>"));
    for (const char* label : {"Xm, mm", "Zm, mm", "turn, deg", "length, mm", "velocity, mm/s", "left of the limit, %",
                              "singularity margin", "Nearest limit: "})
      EXPECT_NE(svg.find(label), std::string::npos) << label;
    EXPECT_EQ(svg.find("nan"), std::string::npos) << exercise.name;
    EXPECT_EQ(svg.find("http", svg.find("viewBox")), std::string::npos) << "nothing from outside";
  }
}

TEST(ExerciseReport, NamesTheSameNearestLimitAsTheCheckOfTheWay) {
  const mechanism::Robot robot = mechanism::configuredRobot("final");
  trajectory::ExerciseOptions options;
  options.scale_to_fit = true;
  const trajectory::ExercisePlan plan =
      trajectory::planExercise(trajectory::exerciseNamed("ankle_flexion"), robot, options);
  double least = 1e9;
  for (Eigen::Index k = 0; k < plan.check.poses.rows(); ++k)
    least = std::min(least, trajectory::nearestLimit(robot, plan.check.poses.row(k).transpose(),
                                                     trajectory::planningCondition(robot))
                                .left);
  const std::string svg = exerciseSvg(trajectory::exerciseNamed("ankle_flexion"), robot, plan);
  const std::size_t at = svg.find("% left");
  ASSERT_NE(at, std::string::npos);
  const std::size_t comma = svg.rfind(", ", at);
  EXPECT_NEAR(std::stod(svg.substr(comma + 2, at - comma - 3)), 100.0 * least, 0.01 * 100.0 * least + 0.01);
}

}  // namespace
}  // namespace knee_robot::report
