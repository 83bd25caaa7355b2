// simulated_camera: what a camera beside the simulated robot would have recorded, as columns added to a recording.

#include <iostream>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/output_paths.h"
#include "knee_robot/simulation/camera.h"
#include "program.h"

using namespace knee_robot;

namespace {

struct Arguments {
  std::string robot, geometry, camera, recording, output;
};

int run(const Arguments& a) {
  requireWritable(a.output);
  requireNoneOverwritten({a.recording, a.robot, a.geometry, a.camera}, {a.output});
  const mechanism::Robot robot = mechanism::loadRobot(a.robot);
  const mechanism::Robot real = a.geometry.empty() ? robot : mechanism::loadRobot(a.geometry);
  if (!robot.mechanism || !real.mechanism) throw InputError(a.robot + ": bench axes have no platform to look at");
  const simulation::CameraSimulation camera = simulation::loadCameraSimulation(a.camera);
  const std::string content = readFile(a.recording);
  recording::Recording r = recording::parseRecording(content, a.recording);
  recording::requireAxes(r, robot.axes(), a.robot);
  simulation::addCamera(real.mechanism->geometry, camera, r);
  writeFileAtomically(a.output, simulation::withCameraColumns(content, r));
  std::cout << "written: " << a.output << std::endl;
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app("Adds the columns of a simulated camera to a recording of the simulated robot.",
                         "simulated_camera");
  Arguments a;
  app.option("RECORDING", a.recording, "recording (CSV)").required();
  app.option("--robot", a.robot, "robot file of the recording").required();
  app.option("--camera", a.camera, "camera file: rate, delay, noise, play in the joints (YAML)").required();
  app.option("--geometry", a.geometry, "robot file with the true geometry, where it differs from --robot's");
  app.option("-o,--output", a.output, "recording to write").required();
  return nodes::runProgram(app, argc, argv, [&] { return run(a); });
}
