// check_reference FILE --robot R [--space S]: whether a reference may be played, and its margins.

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/mechanism/singularity.h"
#include "knee_robot/trajectory/reference_check.h"
#include "program.h"
#include "reference_json.h"

namespace {

using namespace knee_robot;

void printMargins(const trajectory::ReferenceCheck& check) {
  std::printf("%-24s %12s %12s %-5s %8s %6s %9s\n", "closest approach", "value", "limit", "", "left", "line",
              "actuator");
  for (const trajectory::Margin& margin : check.margins) {
    const bool angle =
        margin.quantity == trajectory::Quantity::BaseAngle || margin.quantity == trajectory::Quantity::PlatformAngle;
    const double scale = angle ? kDegrees : 1.0;
    std::printf("%-24s %12.6g %12.6g %-5s %6.1f %% %6d %9s\n", trajectory::nameOf(margin.quantity),
                scale * margin.value, scale * margin.limit, angle ? "deg" : trajectory::unitOf(margin.quantity),
                100.0 * margin.left, margin.line,
                margin.actuator == 0 ? "all" : std::to_string(margin.actuator).c_str());
  }
}

void printPath(const trajectory::Reference& reference, const trajectory::ReferenceCheck& check, int axes) {
  std::printf("%s: %ld points, %.2f s, space %s\n", reference.name.c_str(), static_cast<long>(reference.points.rows()),
              static_cast<double>(reference.points.rows() - 1) * reference.period_s,
              trajectory::nameOf(reference.space));
  for (int i = 0; i < axes; ++i) {
    std::printf("  actuator %d: %.6f to %.6f m, starts at %.6f m\n", i + 1, check.lengths.col(i).minCoeff(),
                check.lengths.col(i).maxCoeff(), check.lengths(0, i));
  }
  if (check.poses.rows() == 0) return;
  const char* names[] = {"Xm (m)", "Zm (m)", "theta (deg)", "psi (deg)"};
  for (int i = 0; i < 4; ++i) {
    const double scale = i < 2 ? 1.0 : kDegrees;
    std::printf("  %-11s %9.4f to %9.4f, starts at %9.4f\n", names[i], scale * check.poses.col(i).minCoeff(),
                scale * check.poses.col(i).maxCoeff(), scale * check.poses(0, i));
  }
}

/// One measure along the path: its worst value and where.
struct Worst {
  const char* name;
  bool small_is_bad;
  double value;
  int line = 0;

  void see(double now, int at) {
    if (line != 0 && (small_is_bad ? now >= value : now <= value)) return;
    value = now;
    line = at;
  }
};

/// Both kinds of singularity (mechanism/singularity.h) along the path. Only the condition number has a limit of its
/// own.
void printSingularity(const trajectory::Reference& reference, const trajectory::ReferenceCheck& check,
                      const mechanism::Mechanism& mechanism) {
  Worst worst[] = {{"type I, product of cos q2", true, 0.0},
                   {"type II, |det dq/dx|", true, 0.0},
                   {"condition, scaled", false, 0.0},
                   {"condition, dependent part", false, 0.0},
                   {"force amplification", false, 0.0}};
  double spherical = 0.0;
  for (Eigen::Index k = 0; k < check.poses.rows(); ++k) {
    const mechanism::Pose pose = check.poses.row(k).transpose();
    const mechanism::Singularity at = mechanism::singularityAt(mechanism, pose);
    const double values[] = {at.type_one, std::abs(at.determinant), at.scaled_condition, at.dependent_condition,
                             at.force_amplification};
    for (std::size_t i = 0; i < std::size(values); ++i)
      worst[i].see(values[i], reference.lineOf(k));
    const mechanism::JointAngles angles = mechanism::jointAngles(mechanism, pose);
    spherical = std::max(spherical, *std::max_element(angles.platform.begin(), angles.platform.end()));
  }
  std::printf("nearest to a singularity\n");
  for (const Worst& measure : worst)
    std::printf("  %-26s %10.4g  line %d\n", measure.name, measure.value, measure.line);
  std::printf("spherical joints reach %.1f deg: %s the 30 deg as built, %s the 50 deg of the paper's Adams study\n",
              kDegrees * spherical, kDegrees * spherical <= 30.0 ? "within" : "beyond",
              kDegrees * spherical <= 50.0 ? "within" : "beyond");
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app(
      "Says whether a reference file may be played on a robot, and shows its margins to every limit.",
      "check_reference");
  std::string file, robot_file, space_name;
  app.option("FILE", file, "reference file: four columns, one point every 10 ms").required();
  app.option("--robot", robot_file, "robot file (YAML)").required();
  app.option("--space", space_name, "what the columns are, when the file's header does not say it")
      .oneOf({"actuator", "platform", "relative"});
  bool json = false;
  app.flag(
      "--json", json,
      "print margins and path for programs, also of a reference that may not be played: then \"violation\" holds the "
      "sentence, and the exit status is 0 as well");
  return nodes::runProgram(app, argc, argv, [&]() -> int {
    const mechanism::Robot robot = mechanism::loadRobot(robot_file);
    const trajectory::Reference reference = trajectory::readReference(file, trajectory::spaceNamed(space_name));
    for (const std::string& note : reference.notes)
      std::fprintf(stderr, "%s\n", note.c_str());
    const trajectory::ReferenceCheck check = trajectory::checkReference(reference, robot);
    if (json) {
      std::printf("%s\n", nodes::referenceJson(reference, check).dump().c_str());
      return kExitDone;
    }
    printPath(reference, check, robot.axes());
    printMargins(check);
    if (robot.mechanism && check.poses.rows() > 0) printSingularity(reference, check, *robot.mechanism);
    if (check.violation) throw InputError(check.violation->sentence);
    std::printf("may be played on %s\n", robot_file.c_str());
    return kExitDone;
  });
}
