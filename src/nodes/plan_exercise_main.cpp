// plan_exercise NAME --robot R -o FILE: a physiotherapist's movement as a checked reference file.

#include <cstdio>
#include <filesystem>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/file_set.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/output_paths.h"
#include "knee_robot/report/exercise_report.h"
#include "knee_robot/trajectory/exercises.h"
#include "program.h"

namespace {

using namespace knee_robot;

struct Arguments {
  std::string name, robot, output, picture, space = "actuator";
  double amplitude = 0.0, speed = 0.020, turning_speed_deg = 2.0, pause = 1.0;
  int repetitions = 1;
  bool scale = false;
  std::vector<double> start;
};

trajectory::ExerciseOptions optionsOf(const Arguments& arguments, const trajectory::Exercise& exercise,
                                      bool has_amplitude) {
  trajectory::ExerciseOptions options;
  if (has_amplitude) options.amplitude = arguments.amplitude * (exercise.rotation ? kDegree : 1.0);
  options.speed = arguments.speed;
  options.turning_speed = arguments.turning_speed_deg * kDegree;
  options.repetitions = arguments.repetitions;
  options.pause_s = arguments.pause;
  options.scale_to_fit = arguments.scale;
  options.space = *trajectory::spaceNamed(arguments.space);
  if (!arguments.start.empty()) {
    const std::vector<double>& s = arguments.start;
    options.start = mechanism::Pose(s[0], s[1], s[2] * kDegree, s[3] * kDegree);
  }
  return options;
}

std::string poseText(const mechanism::Pose& pose) {
  return "Xm " + shortNumber(pose[0], 4) + " m, Zm " + shortNumber(pose[1], 4) + " m, theta " +
         shortNumber(pose[2] / kDegree, 4) + " deg, psi " + shortNumber(pose[3] / kDegree, 4) + " deg";
}

void tell(const Arguments& arguments, const trajectory::Exercise& exercise, const trajectory::ExercisePlan& plan) {
  for (const std::string& note : plan.notes)
    std::printf("note: %s\n", note.c_str());
  std::printf("%s (%s): amplitude %s %s, %d repetition(s), %.1f s\n", exercise.name.c_str(), exercise.meaning.c_str(),
              shortNumber(exercise.rotation ? plan.amplitude / kDegree : plan.amplitude, 4).c_str(),
              exercise.rotation ? "deg" : "m", arguments.repetitions,
              static_cast<double>(plan.reference.points.rows() - 1) * trajectory::kStreamPeriod);
  std::printf("starts at %s\n", poseText(plan.start).c_str());
  for (const trajectory::Margin& margin : plan.check.margins) {
    std::printf("  %-24s %5.1f %% of its limit left, line %d\n", trajectory::nameOf(margin.quantity),
                100.0 * margin.left, margin.line);
  }
  std::printf("written to %s, picture to %s\n", arguments.output.c_str(), arguments.picture.c_str());
}

/// Both files have a place, and it is not the other's.
void requireOutput(Arguments& arguments, const mechanism::Robot& robot) {
  if (arguments.picture.empty())
    arguments.picture = std::filesystem::path(arguments.output).replace_extension(".svg").string();
  for (const std::string& file : {arguments.output, arguments.picture}) {
    requireWritable(file);
    requireNoneOverwritten({arguments.robot, robot.urdf}, {file});
  }
  if (isSameFile(arguments.picture, arguments.output))
    throw InputError(arguments.output + ": is the reference file's name; give the picture another one with --picture");
}

int run(Arguments arguments, bool has_amplitude) {
  const trajectory::Exercise& exercise = trajectory::exerciseNamed(arguments.name);
  const mechanism::Robot robot = mechanism::loadRobot(arguments.robot);
  requireOutput(arguments, robot);
  const trajectory::ExercisePlan plan =
      trajectory::planExercise(exercise, robot, optionsOf(arguments, exercise, has_amplitude));
  FileSet files;
  files.add(arguments.output, trajectory::formatReference(
                                  plan.reference, {exercise.name + ": " + exercise.meaning, "for " + arguments.robot,
                                                   "starts at " + poseText(plan.start)}));
  files.add(arguments.picture, report::exerciseSvg(exercise, robot, plan));
  files.commit();
  tell(arguments, exercise, plan);
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app(
      "Plans a physiotherapist's movement, checks it against the robot's limits and writes it as a reference file.",
      "plan_exercise");
  Arguments arguments;
  std::string names = "one of";
  for (const trajectory::Exercise& exercise : trajectory::exercises())
    names += " " + exercise.name;
  app.option("NAME", arguments.name, names).required();
  app.option("--robot", arguments.robot, "robot file (YAML)").required();
  app.option("-o,--output", arguments.output, "reference file to write").required();
  app.option("--picture", arguments.picture,
             "SVG of pose, actuators and margins against time (default: the output's name with .svg)");
  const nodes::Option amplitude =
      app.option("--amplitude", arguments.amplitude,
                 "amplitude: m, or deg for knee_rotation and ankle_flexion; for paper_test that of the "
                 "rise, the rest in proportion (default: the paper's)");
  app.option("--speed", arguments.speed, "speed of translations, m/s").showDefault();
  app.option("--turning-speed", arguments.turning_speed_deg, "speed of rotations, deg/s").showDefault();
  app.option("--repetitions", arguments.repetitions, "number of repetitions").showDefault();
  app.option("--pause", arguments.pause, "rest between strokes, s").showDefault();
  app.option("--start", arguments.start,
             "start pose: Xm Zm (m) theta psi (deg); default: the one furthest from all limits")
      .values(4);
  app.option("--space", arguments.space, "coordinates of the written file")
      .oneOf({"actuator", "platform"})
      .showDefault();
  app.flag("--scale", arguments.scale, "reduce amplitude and speed to what fits instead of refusing");
  return nodes::runProgram(app, argc, argv, [&] { return run(arguments, amplitude.given()); });
}
