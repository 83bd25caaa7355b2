#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "knee_robot/trajectory/pose_limits.h"
#include "knee_robot/trajectory/profiles.h"

namespace knee_robot::trajectory {

/// One part of an exercise: platform coordinate `axis` moves by `share` times the exercise's amplitude.
struct ExerciseStroke {
  int axis = 0;        ///< 0: Xm, 1: Zm, 2: theta, 3: psi
  double share = 0.0;  ///< of the amplitude; for a rotation in an exercise whose amplitude is a length: rad per m
};

/// A physiotherapist's movement (paper, sect. 2.2): strokes from rest to rest along one platform coordinate at a time,
/// which together return to the start.
struct Exercise {
  std::string name;
  std::string meaning;
  bool rotation = false;                ///< amplitude in rad (deg on command lines), otherwise m
  double amplitude = 0.0;               ///< default
  std::vector<ExerciseStroke> strokes;  ///< of one repetition
  std::optional<double> start_x;        ///< Xm from which the paper counts
};

/// hip_flexion (Zm + 0.2 m), knee_flexion (Xm 0, 0.2, -0.11 m), knee_rotation (psi +-15 deg), ankle_flexion (theta +-30
/// deg), paper_test (sect. 3.2: Xm, then Zm + 0.2 m, then psi + 15 deg, and backwards; its way along Xm is not printed:
/// 0.1 m here).
const std::vector<Exercise>& exercises();
/// InputError listing the names when there is no such exercise.
const Exercise& exerciseNamed(const std::string& name);

/// What the physiotherapist may change of an exercise.
struct ExerciseOptions {
  std::optional<double>
      amplitude;         ///< m or rad; default: the exercise's own. paper_test: of Zm, the others in proportion
  double speed = 0.020;  ///< m/s of translations (paper: 20 mm/s)
  double turning_speed = 0.0349066;  ///< rad/s of rotations (paper: 2 deg/s)
  int repetitions = 1;
  double pause_s = 1.0;                  ///< at rest between strokes
  std::optional<mechanism::Pose> start;  ///< default: the start from which the exercise keeps furthest from all limits
  bool scale_to_fit = false;             ///< reduce amplitude and speed to what fits instead of refusing
  Space space = Space::Actuator;         ///< of the written reference: actuator or platform
};

/// A planned exercise, checked by checkReference: it may be played.
struct ExercisePlan {
  Reference reference;
  ReferenceCheck check;
  mechanism::Pose start = mechanism::Pose::Zero();
  double amplitude = 0.0;          ///< m or rad, as planned
  double speed_share = 1.0;        ///< of the speeds that were asked for
  std::vector<std::string> notes;  ///< what was scaled and why
};

/// Plans an exercise on a robot. Each stroke is a double S (profiles.h) with 0.1 m/s^2, 1 m/s^3 (rotations 10 deg/s^2,
/// 100 deg/s^3). Limits: those of the robot file, and planningCondition. InputError: options out of range, or a robot
/// without a platform. Refusal: the exercise does not fit; the sentence names the limiting joint, length or singularity
/// and the largest amplitude (by bisection) or speed that fits.
ExercisePlan planExercise(const Exercise& exercise, const mechanism::Robot& robot, const ExerciseOptions& options = {});

}  // namespace knee_robot::trajectory
