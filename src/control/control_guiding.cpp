// Hand guiding, the operator's side.
#include <cmath>

#include "control_parts.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::control {

const char* sentenceOf(GuideStop stop) noexcept {
  switch (stop) {
    case GuideStop::None:
      return "";
    case GuideStop::NoModel:
      return "there is no identified model that could carry weight and friction; give one (model:=/path/model.yaml)";
    case GuideStop::UnknownLoad:
      return "the robot carries more than the model and the declared payload explain; declare it (payload_kg)";
    case GuideStop::OutsideRange:
      return "the platform stands at a limit of the robot's or the patient's range; play a reference away from it";
    case GuideStop::Wall:
      return "guided to a limit of the robot's or the patient's range; the robot holds there";
    case GuideStop::TooFast:
      return "guided faster than allowed; the robot holds";
    case GuideStop::LostPose:
      return "the platform's pose is not known";
    case GuideStop::PathFull:
      return "ten minutes were guided, the record is full; save it and begin anew";
    case GuideStop::Silent:
      return "the component HandGuide is silent; the robot holds";
  }
  return "?";
}

Answer ControlSystem::guide() {
  if (const std::string why = whyNobodyMoves(); !why.empty()) return {false, why};
  const Answer answer = request(RequestKind::Guide, 1.0);
  if (!answer.ok) return answer;
  return {true,
          "guiding: the axes tremble for a moment, then the platform follows the hand; letting go of the switch holds"};
}

Answer ControlSystem::saveGuided(const std::string& path) {
  if (parts_->guide == nullptr) return {false, "the deployment has no HandGuide"};
  if (state() == MachineState::Guiding) return {false, "the platform is being guided; let go of the switch first"};
  try {
    GuidedReference guided = guidedReference(parts_->guide->path().points(), robot_, patient());
    std::vector<std::string> comments = {"guided by hand"};
    std::string slower;
    if (guided.slowed > 1.0)
      slower = ", " + shortNumber(guided.slowed, 2) + " times slower than the hand, for the limits' sake";
    trajectory::writeReference(path, guided.reference, comments);
    const double duration = trajectory::kStreamPeriod * static_cast<double>(guided.reference.points.rows() - 1);
    return {true, path + ": " + std::to_string(guided.reference.points.rows()) + " points, " +
                      shortNumber(duration, 4) + " s" + slower + "; it may be played"};
  } catch (const InputError& error) {
    return {false, error.what()};
  }
}

}  // namespace knee_robot::control
