// virtual_plant REFERENCE -o RECORDING: the paper's virtual plant (section 3.1.1), in Simbody: forces that the
// actuators exert to move exactly along a reference, with friction in the joints, written as a recording.

#include <cstdio>

#include "knee_robot/base/errors.h"
#include "knee_robot/simulation/virtual_recording.h"
#include "knee_robot/trajectory/reference_check.h"
#include "program.h"

namespace {

using namespace knee_robot;

/// "VISCOUS COULOMB" after an option.
simulation::JointFriction frictionOf(const std::vector<double>& values) {
  return {values[0], values[1]};
}

void report(const simulation::VirtualRun& run, const std::string& output) {
  std::printf("%d rows; forces rms %.1f %.1f %.1f %.1f N, largest %.1f %.1f %.1f %.1f N\n", run.rows, run.force_rms[0],
              run.force_rms[1], run.force_rms[2], run.force_rms[3], run.force_max[0], run.force_max[1],
              run.force_max[2], run.force_max[3]);
  std::printf("friction took %.4g J; the energy books are open by at most %.2g J\n", run.dissipated_J,
              run.energy_error_J);
  std::printf("written to %s\n", output.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Moves a virtual plant (Simbody, independent of this project's model) exactly along a reference and records the "
      "forces of its actuators.",
      "virtual_plant");
  std::string file, robot_file, output, space_name;
  std::vector<double> actuator = {0.0, 0.0}, passive = {0.0, 0.0}, spherical = {0.0, 0.0}, presliding = {0.0, 0.0};
  double rotor_mass = 0.0;
  simulation::VirtualRecorder recorder;
  const auto amount = CLI::Range(0.0, 1e5);
  app.add_option("FILE", file, "reference file")->required();
  app.add_option("--robot", robot_file, "robot file (YAML) with a URDF")->required();
  app.add_option("-o,--output", output, "recording to write (CSV); must not exist")->required();
  app.add_option("--space", space_name, "what the columns are, when the file's header does not say it")
      ->check(CLI::IsMember({"actuator", "platform", "relative"}));
  app.add_option("--actuator-friction", actuator, "viscous (N s/m) and Coulomb (N) friction of each actuator (0 0)")
      ->expected(2)
      ->check(amount);
  app.add_option("--passive-friction", passive,
                 "viscous (N m s/rad) and Coulomb (N m) friction of each of the legs' seven passive joints of eq. (23) "
                 "(0 0)")
      ->expected(2)
      ->check(amount);
  app.add_option("--spherical-friction", spherical,
                 "viscous (N m s/rad) and Coulomb (N m) friction of each spherical joint, which the paper's model does "
                 "not have (0 0)")
      ->expected(2)
      ->check(amount);
  app.add_option(
         "--presliding", presliding,
         "displacement (m for actuators, rad for passive joints) over which Coulomb friction reverses; 0 0: at once")
      ->expected(2)
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--rotor-mass", rotor_mass, "rotor and screw inertia reflected to each actuator, kg")
      ->check(amount)
      ->capture_default_str();
  app.add_option("--noise", recorder.force_noise_N, "standard deviation of each recorded force's noise, N")
      ->check(amount)
      ->capture_default_str();
  app.add_option("--seed", recorder.seed, "random seed of the noise")->capture_default_str();
  app.add_option("--period", recorder.period_s, "time between rows, s")
      ->check(CLI::Range(1e-4, 0.1))
      ->capture_default_str();
  app.add_flag("--exact-encoders", recorder.exact_encoders, "record positions as they are, not as whole counts");
  return nodes::runProgram(app, argc, argv, [&]() -> int {
    const mechanism::Robot robot = mechanism::loadRobot(robot_file);
    if (!robot.mechanism) throw InputError(robot_file + ": describes separate axes; the virtual plant is a 3UPS+1RPU");
    const trajectory::ReferenceCheck check =
        trajectory::requirePlayable(trajectory::readReference(file, trajectory::spaceNamed(space_name)), robot);
    simulation::VirtualPlantParameters parameters;
    parameters.friction = simulation::equalFriction(frictionOf(actuator), frictionOf(passive));
    parameters.spherical = frictionOf(spherical);
    parameters.rotor_mass.setConstant(rotor_mass);
    parameters.presliding_m = presliding[0];
    parameters.presliding_rad = presliding[1];
    simulation::VirtualPlant plant(*robot.mechanism, robot.gravity, dynamics::loadRobotInertia(robot),
                                   check.poses.row(0).transpose(), parameters);
    const simulation::VirtualRun run = simulation::recordVirtualPlant(
        robot, plant, simulation::AxisPath(check.lengths, trajectory::kStreamPeriod), recorder, output);
    report(run, output);
    return kExitDone;
  });
}
