#include "operator_sentences.h"

#include "knee_robot/base/numbers.h"

namespace knee_robot::control {
namespace {

/// home() and confirmHome(), each where the hardware file asks for the other.
Answer noProcedure(HomingMethod homing) {
  if (homing == HomingMethod::HandPlaced) {
    return {false, "home is set by hand: place the robot at its home lengths with the drives off, then confirm"};
  }
  return {false, "there is nothing to confirm: the hardware file's homing method is another"};
}

}  // namespace

const char* sentenceOf(GuideStop stop) noexcept {
  switch (stop) {
    case GuideStop::None:
      return "";
    case GuideStop::NoModel:
      return "there is no identified model that could carry weight and friction; give one (model:=/path/model.yaml)";
    case GuideStop::UnknownLoad:
      return "the robot carries more than the model and the declared payload explain; declare it (payload_kg), and let "
             "go of the platform until the axes have trembled";
    case GuideStop::OutsideRange:
      return "the platform stands at a limit of the robot's or the patient's range; play a reference away from it";
    case GuideStop::Wall:
      return "guided to a limit of the robot's or the patient's range; the robot holds there";
    case GuideStop::TooFast:
      return "guided faster than allowed; the robot holds";
    case GuideStop::LostPose:
      return "the platform's pose is not known: it stands too near a singularity, or home is wrong; play a reference "
             "away from there, or home the robot again";
    case GuideStop::PathFull:
      return "ten minutes were guided, the record is full; save it and begin anew";
    case GuideStop::Silent:
      return "the component HandGuide is silent; the robot holds";
  }
  return "?";
}

Answer sentenceOf(RequestKind asked, const RequestAnswer& answer, const ControlStatus& now, HomingMethod homing,
                  double start_tolerance_m) {
  const std::string state = toString(now.state);
  switch (answer.result) {
    case RequestResult::Done:
      return {true, "the robot is " + state};
    case RequestResult::WrongState:
      if (isPossible(now.state, asked))  // somebody else's request was carried out since it was refused
        return {false, "not possible in the state that the robot has just left; now it is " + state + ": try again"};
      return {false, "not possible while the robot is " + state +
                         (now.fault_sentence.empty() ? "" : " (" + now.fault_sentence + ")")};
    case RequestResult::NoReference:
      return {false, "no reference is loaded; load one first"};
    case RequestResult::NotAtStart:
      return {false, "axis " + std::to_string(answer.axis) + " stands " + shortNumber(1e3 * answer.distance_m, 4) +
                         " mm from the reference's first point, more than the " + shortNumber(1e3 * start_tolerance_m) +
                         " mm allowed; approach it first"};
    case RequestResult::NotReady:
      return {false, "the components, the encoders or the outputs are not ready; try again, then look at their states"};
    case RequestResult::CauseRemains:
      return {false, "the cause is still there: " + now.fault_sentence};
    case RequestResult::NeedsRestart:
      return {false, "only a restart of the controller clears this: " + now.fault_sentence};
    case RequestResult::Superseded:
      return {false, "another request came in between; the robot is " + state};
    case RequestResult::NotHomed:
      return {false, "the axes do not know where they are; home the robot first"};
    case RequestResult::NoProcedure:
      return noProcedure(homing);
    case RequestResult::HomeShifted:
      return {false,
              "axis " + std::to_string(answer.axis) + " stands " + shortNumber(1e3 * answer.distance_m, 4) +
                  " mm from the home that was confirmed first, by the counters: either they lost counts (restart the "
                  "controller) or the robot was not placed at home"};
    case RequestResult::HomeMoves:
      return {false, "axis " + std::to_string(answer.axis) +
                         " moves: support the platform and confirm home when it stands still"};
    case RequestResult::OutOfRange:
      return {false, "the value is not allowed"};
    case RequestResult::NoEnablingSwitch:
      return {false, "no enabling switch is configured (hardware file: digital_inputs: enabling_switch)"};
    case RequestResult::NoGuide:
      return {false, "the deployment has no HandGuide; add that component (docs/guiding.md)"};
    case RequestResult::BrakesUntested:
      return {false,
              "the brakes are not tested at enabling: all axes need hold_device: brake, and Supervisor.brake_test_N "
              "more than 0"};
    case RequestResult::SwitchNotHeld:
      return {false, "the enabling switch is not held: hold it, then ask again"};
    case RequestResult::SwitchNotReleased:
      return {false, "release the enabling switch first: it has been held since enabling or the last guiding"};
    case RequestResult::GuideRefused:
      return {false, now.guiding};
    case RequestResult::TooLate:
      return {false, "the request was taken up too late, and nothing was done; the robot is " + state + "; ask again"};
    case RequestResult::Failed:
      return {false, "a fault came in between: " + now.fault_sentence};
  }
  return {false, "?"};
}

}  // namespace knee_robot::control
