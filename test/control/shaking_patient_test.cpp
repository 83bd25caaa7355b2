// The whole controller with a patient, stepped: what goes to and fro, and what sags once.
#include "holding_robot.h"
#include "knee_robot/base/files.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

using namespace holding;

class ShakingPatient : public ::testing::Test {
 protected:
  std::string patient(const std::string& more) const {
    const std::string path = folder + "/p.yaml";
    writeFileAtomically(path,
                        "patient: \"1\"\npose: {X_m: [-0.08, 0.08], Z_m: [0.55, 0.70], theta_deg: [-20, 20], "
                        "psi_deg: [-20, 20]}\n" +
                            more);
    return path;
  }
  /// A force of `newton` to and fro along X, `hertz` times a second. Seconds until the robot stops, at most 4.
  static double shake(HoldingRobot& robot, double newton, double hertz, double& fastest) {
    fastest = 0.0;
    int k = 0;
    for (; k < 4000 && robot.system->state() == MachineState::Holding; ++k) {
      robot.image.surroundings.pose_force[0].store(newton * std::sin(2.0 * M_PI * hertz * 1e-3 * k));
      robot.system->step();
      fastest = std::max(fastest, robot.plant.state().pose_velocity.head<2>().norm());
    }
    robot.image.surroundings.pose_force[0].store(0.0);
    return 1e-3 * k;
  }
  const TemporaryFolder folder;
};

TEST_F(ShakingPatient, StopsTheRobotThoughNothingGetsAnywhere) {
  Truth truth;
  truth.model = true;
  truth.patient = patient("force: {force_N: 60}\n");
  for (const double newton : {60.0, 120.0}) {
    HoldingRobot robot(truth);
    double fastest = 0.0;
    const double after = shake(robot, newton, 8.0, fastest);
    std::printf("%.0f N at 8 Hz: %.0f mm/s; %s after %.2f s\n", newton, 1e3 * fastest,
                robot.system->status().fault_name.c_str(), after);
    EXPECT_EQ(robot.system->status().fault_name, "patient_speed") << "20 mm/s are allowed";
    EXPECT_LT(after, newton > 100.0 ? 0.6 : 1.5);
  }
  HoldingRobot robot(truth);
  double fastest = 0.0;
  EXPECT_GE(shake(robot, 20.0, 8.0, fastest), 4.0) << "a tremor";
}

TEST_F(ShakingPatient, IsNotMistakenForALegThatNobodyDeclaredWhenTheBrakesOpen) {
  for (const double payload_kg : {10.0, 15.0}) {
    Truth truth;
    truth.robot = "final";
    truth.payload_kg = payload_kg;
    truth.patient = patient("");
    HoldingRobot robot(truth);
    EXPECT_EQ(robot.system->state(), MachineState::Holding)
        << payload_kg << " kg: " << robot.system->status().fault_name << " after a sag of "
        << 1e3 * (robot.stood - robot.lowest) << " mm";
  }
}

}  // namespace
}  // namespace knee_robot::control
