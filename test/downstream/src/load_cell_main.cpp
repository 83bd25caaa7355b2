// Two components of another package on knee_robot's deployer: a platform that hangs still, and a load cell that says
// what leg 4 carries. Usage: load_cell ROBOT.yaml DEPLOYMENT.yaml; exit status 0 when a second of simulated time gives
// the platform's weight.
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

#include "knee_robot/base/errors.h"
#include "knee_robot/mechanism/constraints.h"
#include "knee_robot/mechanism/kinematics.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/rt/deployer.h"
#include "knee_robot/rt/port.h"
#include "knee_robot/rt/property.h"

namespace rt = knee_robot::rt;
namespace mechanism = knee_robot::mechanism;

namespace {

constexpr double kGravity = 9.81;

/// Lengths of the four legs, and the force along the vertical that they carry together.
struct Hanging {
  double lengths_m[4];
  double weight_N;
};

class HangingPlatform : public rt::TaskContext {
 public:
  HangingPlatform(const std::string& name, const mechanism::Robot& robot) : TaskContext(name), robot_(robot) {}
  rt::OutputPort<Hanging> lengths{*this, "lengths", "of the legs, and what they carry"};
  rt::Property<double> mass{*this, "mass_kg", 10.0, "kg", 0.0, 100.0, "of the platform"};

 protected:
  void updateHook(const rt::Cycle&) override {
    Hanging out{};
    for (int i = 0; i < 4; ++i)
      out.lengths_m[i] = robot_.actuators[static_cast<std::size_t>(i)].home_length_m;
    out.weight_N = mass * kGravity;
    lengths.write(out);
  }

 private:
  const mechanism::Robot& robot_;
};

class LoadCell : public rt::TaskContext {
 public:
  LoadCell(const std::string& name, const mechanism::Robot& robot) : TaskContext(name), robot_(robot) {}
  rt::InputPort<Hanging> lengths{*this, "lengths", "from the platform"};
  rt::Property<double> cutoff{*this, "cutoff_hz", 20.0, "Hz", 0.1, 500.0, "low-pass of the force"};
  double force_N = 0.0;  ///< low-passed
  double height_m = 0.0;

 protected:
  bool configureHook() override {
    return robot_.mechanism.has_value() || refuse("the robot file describes no platform");
  }
  void updateHook(const rt::Cycle& cycle) override {
    Hanging now{};
    if (lengths.read(now) == rt::FlowStatus::NoData) return;
    const mechanism::Lengths legs(now.lengths_m[0], now.lengths_m[1], now.lengths_m[2], now.lengths_m[3]);
    const auto pose = mechanism::forwardKinematicsFromHome(*robot_.mechanism, legs);
    if (pose.status != mechanism::ForwardStatus::Converged) return error();
    height_m = pose.pose[1];
    const double keep = std::exp(-2.0 * M_PI * cutoff * rt::toSeconds(cycle.period));
    force_N = keep * force_N + (1.0 - keep) * now.weight_N;
  }

 private:
  const mechanism::Robot& robot_;
};

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) throw knee_robot::InputError("load_cell: needs a robot file and a deployment file");
  const mechanism::Robot robot = mechanism::loadRobot(argv[1]);
  const rt::TypeFactory types = {
      {"HangingPlatform", [&](const std::string& name) { return std::make_unique<HangingPlatform>(name, robot); }},
      {"LoadCell", [&](const std::string& name) { return std::make_unique<LoadCell>(name, robot); }}};
  rt::Deployment deployment(argv[2], types, rt::Execution::Stepped);
  deployment.start();
  deployment.stepUntil(rt::fromSeconds(1.0));
  const auto& cell = dynamic_cast<const LoadCell&>(*deployment.component("LoadCell"));
  const auto& platform = dynamic_cast<const HangingPlatform&>(*deployment.component("Platform"));
  std::printf("%.3f N at %.3f m\n", cell.force_N, cell.height_m);
  return std::abs(cell.force_N - platform.mass * kGravity) < 1e-3 && cell.height_m > 0.1 ? 0 : 1;
} catch (const knee_robot::InputError& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
