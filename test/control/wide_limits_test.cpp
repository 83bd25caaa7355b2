// What an engineer may open for trials keeps a patient away: limits of the deployment, and a model of another weight.
#include "holding_robot.h"
#include "knee_robot/base/files.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

using namespace holding;

/// The answer to loading a patient on the disabled robot.
std::string answerToPatient(HoldingRobot& robot) {
  const TemporaryFolder folder;
  writeFileAtomically(
      folder + "/p.yaml",
      "patient: '17'\npose: {X_m: [-0.3, 0.3], Z_m: [0.3, 0.9], theta_deg: [-30, 30], psi_deg: [-30, 30]}\n");
  EXPECT_TRUE(robot.system->disable().ok);
  const Answer answer = robot.system->loadPatient(folder + "/p.yaml");
  EXPECT_TRUE(answer.ok) << "only told on a simulated robot: " << answer.sentence;
  return answer.sentence;
}

rt::Property<double>& propertyOf(HoldingRobot& robot, const std::string& component, const std::string& name) {
  return dynamic_cast<rt::Property<double>&>(*robot.system->deployment().component(component)->property(name));
}

TEST(WideLimits, OfTheDeploymentAreToldEachWithItsBound) {
  HoldingRobot robot;
  const std::string usual = answerToPatient(robot);  // the simulated robot's own monitors are patient
  for (const char* one : {"Supervisor.", "Driver", "AxesOutput.", "patient_"})
    EXPECT_EQ(usual.find(one), std::string::npos) << usual;
  ASSERT_TRUE(robot.system->clearPatient().ok);
  ASSERT_TRUE(robot.system->declareEmpty().ok);
  ASSERT_TRUE(robot.system->enable().ok);
  propertyOf(robot, "Supervisor", "brake_test_N").set(0.0);
  propertyOf(robot, "Monitors", "patient_speed_factor").set(3.0);
  propertyOf(robot, "Driver4", "following_error_m").set(0.1);
  propertyOf(robot, "AxesOutput", "transfer_s").set(0.0);
  const std::string told = answerToPatient(robot);
  for (const char* one : {"Supervisor.brake_test_N 0 (at least 60)", "Monitors.patient_speed_factor 3 (at most 1.5)",
                          "Driver4.following_error_m 0.1 (at most 0.02)", "AxesOutput.transfer_s 0 (at least 0.04)"})
    EXPECT_NE(told.find(one), std::string::npos) << told;
}

TEST(WideLimits, AModelOfAnotherWeightWouldThrowThePlatformUp) {
  for (const double weights : {1.0, 0.5, 1.7, 4.0, 0.2, 0.1, -1.0}) {
    Truth truth;
    truth.model = true;
    truth.weights = weights;
    HoldingRobot robot(truth);
    if (weights < 0.0) {  // what it carries has told, too
      EXPECT_EQ(robot.system->status().fault_name, "weight_opposite");
      EXPECT_TRUE(robot.system->resetFaults().ok);
    }
    const bool strange = weights > 2.0 || weights < 0.4;
    EXPECT_EQ(answerToPatient(robot).find("would jump when the brakes open") != std::string::npos, strange) << weights;
  }
}

}  // namespace
}  // namespace knee_robot::control
