// virtual_plant REFERENCE -o RECORDING: the paper's virtual plant (section 3.1.1), in Simbody: forces that the
// actuators exert to move exactly along a reference, with friction in the joints, written as a recording.

#include <cstdio>

#include "knee_robot/base/errors.h"
#include "knee_robot/simulation/virtual_recording.h"
#include "knee_robot/trajectory/reference_check.h"
#include "program.h"

namespace {

using namespace knee_robot;

struct Arguments {
  std::string file, robot, output, space;
  std::vector<double> actuator = {0.0, 0.0}, passive = {0.0, 0.0}, spherical = {0.0, 0.0}, presliding = {0.0, 0.0};
  double rotor_mass_kg = 0.0;
  simulation::VirtualRecorder recorder;
};

void declare(nodes::CommandLine& app, Arguments& a) {
  app.option("FILE", a.file, "reference file").required();
  app.option("--robot", a.robot, "robot file (YAML) with a URDF").required();
  app.option("-o,--output", a.output, "recording to write (CSV); must not exist").required();
  app.option("--space", a.space, "what the columns are, when the file's header does not say it")
      .oneOf({"actuator", "platform", "relative"});
  app.option("--actuator-friction", a.actuator, "viscous (N s/m) and Coulomb (N) friction of each actuator (0 0)")
      .values(2)
      .within(0.0, 1e5);
  app.option("--passive-friction", a.passive,
             "viscous (N m s/rad) and Coulomb (N m) friction of each of the legs' seven passive joints of eq. (23) "
             "(0 0)")
      .values(2)
      .within(0.0, 1e5);
  app.option("--spherical-friction", a.spherical,
             "viscous (N m s/rad) and Coulomb (N m) friction of each spherical joint, which the paper's model does "
             "not have (0 0)")
      .values(2)
      .within(0.0, 1e5);
  app.option(
         "--presliding", a.presliding,
         "displacement (m for actuators, rad for passive joints) over which Coulomb friction reverses; 0 0: at once")
      .values(2)
      .within(0.0, 1.0);
  app.option("--rotor-mass", a.rotor_mass_kg, "rotor and screw inertia reflected to each actuator, kg")
      .within(0.0, 1e5)
      .showDefault();
  app.option("--noise", a.recorder.force_noise_N, "standard deviation of each recorded force's noise, N")
      .within(0.0, 1e5)
      .showDefault();
  app.option("--seed", a.recorder.seed, "random seed of the noise").showDefault();
  app.option("--period", a.recorder.period_s, "time between rows, s").within(1e-4, 0.1).showDefault();
  app.flag("--exact-encoders", a.recorder.exact_encoders, "record positions as they are, not as whole counts");
}

/// "VISCOUS COULOMB" after an option.
simulation::JointFriction frictionOf(const std::vector<double>& values) {
  return {values[0], values[1]};
}

simulation::VirtualPlantParameters parametersOf(const Arguments& a) {
  simulation::VirtualPlantParameters parameters;
  parameters.friction = simulation::equalFriction(frictionOf(a.actuator), frictionOf(a.passive));
  parameters.spherical = frictionOf(a.spherical);
  parameters.rotor_mass.setConstant(a.rotor_mass_kg);
  parameters.presliding_m = a.presliding[0];
  parameters.presliding_rad = a.presliding[1];
  return parameters;
}

void report(const simulation::VirtualRun& run, const std::string& output) {
  std::printf("%d rows; forces rms %.1f %.1f %.1f %.1f N, largest %.1f %.1f %.1f %.1f N\n", run.rows, run.force_rms[0],
              run.force_rms[1], run.force_rms[2], run.force_rms[3], run.force_max[0], run.force_max[1],
              run.force_max[2], run.force_max[3]);
  std::printf("friction took %.4g J; the energy books are open by at most %.2g J\n", run.dissipated_J,
              run.energy_error_J);
  std::printf("written to %s\n", output.c_str());
}

int run(const Arguments& a) {
  const mechanism::Robot robot = mechanism::loadRobot(a.robot);
  if (!robot.mechanism) throw InputError(a.robot + ": describes separate axes; the virtual plant is a 3UPS+1RPU");
  const trajectory::ReferenceCheck check =
      trajectory::requirePlayable(trajectory::readReference(a.file, trajectory::spaceNamed(a.space)), robot);
  simulation::VirtualPlant plant(*robot.mechanism, robot.gravity, dynamics::loadRobotInertia(robot),
                                 check.poses.row(0).transpose(), parametersOf(a));
  const simulation::VirtualRun moved = simulation::recordVirtualPlant(
      robot, plant, simulation::AxisPath(check.lengths, trajectory::kStreamPeriod), a.recorder, a.output);
  report(moved, a.output);
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app(
      "Moves a virtual plant (Simbody, independent of this project's model) exactly along a reference and records the "
      "forces of its actuators.",
      "virtual_plant");
  Arguments a;
  declare(app, a);
  return nodes::runProgram(app, argc, argv, [&] { return run(a); });
}
