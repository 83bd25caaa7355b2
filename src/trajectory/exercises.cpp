#include "knee_robot/trajectory/exercises.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/words.h"
#include "knee_robot/trajectory/exercise_fit.h"

namespace knee_robot::trajectory {
namespace {

constexpr double kRestSeconds = 0.5;                  ///< at rest before the first and after the last stroke
constexpr ProfileLimits kTranslation{0.0, 0.1, 1.0};  ///< m; velocity is an option
constexpr ProfileLimits kRotation{0.0, 10.0 * kDegree, 100.0 * kDegree};  ///< rad

std::string amplitudeText(const Exercise& exercise, double amplitude) {
  return exercise.rotation ? shortNumber(amplitude / kDegree, 3) + " deg" : shortNumber(amplitude, 3) + " m";
}

void refuseOptions(const Exercise& exercise, const mechanism::Robot& robot, const ExerciseOptions& options) {
  const auto demand = [](bool holds, const std::string& sentence) {
    if (!holds) throw InputError(sentence);
  };
  demand(robot.kind == mechanism::MechanismKind::ThreeUpsOneRpu,
         robot.path + " describes separate axes; exercises move a platform");
  const double amplitude = options.amplitude.value_or(exercise.amplitude);
  const double largest = exercise.rotation ? 90.0 * kDegree : 1.0;
  demand(amplitude > 0.0 && amplitude <= largest, "amplitude " + amplitudeText(exercise, amplitude) +
                                                      " is not in (0, " + amplitudeText(exercise, largest) + "]");
  demand(options.speed > 0.0 && options.speed <= 1.0, "speed " + shortNumber(options.speed) + " is not in (0, 1] m/s");
  demand(options.turning_speed > 0.0 && options.turning_speed <= 180.0 * kDegree,
         "turning speed " + shortNumber(options.turning_speed / kDegree) + " is not in (0, 180] deg/s");
  demand(options.repetitions >= 1 && options.repetitions <= 1000,
         "repetitions " + std::to_string(options.repetitions) + " is not in 1 to 1000");
  demand(options.pause_s >= 0.0 && options.pause_s <= 60.0,
         "pause " + shortNumber(options.pause_s) + " is not in 0 to 60 s");
  demand(!options.start || options.start->allFinite(), "the start pose is not finite");
  demand(options.space != Space::Relative, "exercises are written in actuator or platform space");
}

/// Appends rows to a reference's poses, as many as a reference may have.
class PoseWriter {
 public:
  PoseWriter(const std::string& name, const mechanism::Pose& start) : name_(name), pose_(start) {
    rows_.push_back(start);
  }

  void rest(double seconds) {
    const long rows = std::lround(seconds / kStreamPeriod);
    requireRoom(static_cast<double>(rows));
    for (long n = rows; n > 0; --n)
      rows_.push_back(pose_);
  }
  void stroke(int axis, double distance, const ProfileLimits& limits) {
    const PointToPoint profile(distance, limits);
    const mechanism::Pose from = pose_;
    const double rows = std::ceil(profile.duration() / kStreamPeriod - 1e-9);
    requireRoom(rows);
    const long steps = static_cast<long>(rows);
    for (long k = 1; k <= steps; ++k) {
      pose_ = from;
      pose_[axis] += profile.at(static_cast<double>(k) * kStreamPeriod).position;
      rows_.push_back(pose_);
    }
    pose_ = from;
    pose_[axis] += distance;
    rows_.back() = pose_;
  }
  Points points() const {
    Points points(static_cast<Eigen::Index>(rows_.size()), 4);
    for (std::size_t k = 0; k < rows_.size(); ++k)
      points.row(static_cast<Eigen::Index>(k)) = rows_[k].transpose();
    return points;
  }

 private:
  /// Before they take memory: a stroke may be as slow as it likes.
  void requireRoom(double rows) const {
    if (static_cast<double>(rows_.size()) + rows <= static_cast<double>(kMaxReferencePoints)) return;
    throw InputError(name_ + " would take longer than the " +
                     shortNumber(kStreamPeriod * static_cast<double>(kMaxReferencePoints)) +
                     " s that a reference may last (" + std::to_string(kMaxReferencePoints) +
                     " points); plan fewer repetitions or a higher speed");
  }

  const std::string& name_;
  mechanism::Pose pose_;
  std::vector<mechanism::Pose> rows_;
};

Points sampled(const Exercise& exercise, const ExercisePlan& plan, const ExerciseOptions& options) {
  ProfileLimits translation = kTranslation, rotation = kRotation;
  translation.velocity = options.speed * plan.speed_share;
  rotation.velocity = options.turning_speed * plan.speed_share;
  PoseWriter writer(exercise.name, plan.start);
  writer.rest(kRestSeconds);
  for (int repetition = 0; repetition < options.repetitions; ++repetition) {
    for (std::size_t k = 0; k < exercise.strokes.size(); ++k) {
      const ExerciseStroke& stroke = exercise.strokes[k];
      writer.stroke(stroke.axis, stroke.share * plan.amplitude, stroke.axis < 2 ? translation : rotation);
      const bool last = repetition + 1 == options.repetitions && k + 1 == exercise.strokes.size();
      writer.rest(last ? kRestSeconds : options.pause_s);
    }
  }
  return writer.points();
}

/// The largest amplitude that fits, or the one asked for when that does.
double fittingAmplitude(const Exercise& exercise, const mechanism::Robot& robot, const ExerciseOptions& options,
                        ExercisePlan& plan) {
  const double asked = options.amplitude.value_or(exercise.amplitude);
  plan.start = options.start ? *options.start : startThatFitsMost(exercise, robot, asked);
  const Margin limiting = nearestOnWay(exercise, robot, plan.start, asked);
  if (limiting.left >= 0.0) return asked;
  const Margin at_start = nearestLimit(robot, plan.start, planningCondition(robot));
  if (at_start.left < 0.0) {
    throw Refusal(exercise.name + " on " + robot.path + ": already the start pose is beyond " + limitText(at_start) +
                  "; choose another start");
  }
  const double largest = largestAmplitude(exercise, robot, plan.start, asked);
  const std::string reason = exercise.name + " of " + amplitudeText(exercise, asked) + " on " + robot.path +
                             " does not fit: it goes beyond " + limitText(limiting);
  if (!options.scale_to_fit) {
    throw Refusal(reason + "; up to " + amplitudeText(exercise, largest) + " fits from this start");
  }
  plan.notes.push_back(reason + "; reduced to " + amplitudeText(exercise, largest));
  return largest;
}

void fill(const Exercise& exercise, const mechanism::Robot& robot, const ExerciseOptions& options, ExercisePlan& plan) {
  plan.reference.name = exercise.name;
  plan.reference.space = Space::Platform;
  plan.reference.points = sampled(exercise, plan, options);
  plan.check = checkReference(plan.reference, robot);
  if (options.space == Space::Actuator) {
    plan.reference.space = Space::Actuator;
    plan.reference.points = plan.check.lengths;
    if (plan.check.ok()) plan.check = checkReference(plan.reference, robot);
  }
}

}  // namespace

const std::vector<Exercise>& exercises() {
  constexpr double kDegreesPerMetre = 15.0 * kDegree / 0.2;
  static const std::vector<Exercise> all = {
      {"hip_flexion", "hip flexion: the platform rises", false, 0.2, {{1, 1.0}, {1, -1.0}}, std::nullopt},
      {"knee_flexion",
       "knee flexion and extension: forward, back beyond the start, return",
       false,
       0.2,
       {{0, 1.0}, {0, -1.55}, {0, 0.55}},
       0.0},
      {"knee_rotation",
       "internal and external rotation of the knee",
       true,
       15.0 * kDegree,
       {{3, 1.0}, {3, -2.0}, {3, 1.0}},
       std::nullopt},
      {"ankle_flexion",
       "ankle flexion and extension",
       true,
       30.0 * kDegree,
       {{2, 1.0}, {2, -2.0}, {2, 1.0}},
       std::nullopt},
      {"paper_test",
       "the paper's test movement: along Xm, up, turn, and backwards",
       false,
       0.2,
       {{0, 0.5}, {1, 1.0}, {3, kDegreesPerMetre}, {3, -kDegreesPerMetre}, {1, -1.0}, {0, -0.5}},
       std::nullopt},
  };
  return all;
}

const Exercise& exerciseNamed(const std::string& name) {
  for (const Exercise& exercise : exercises()) {
    if (exercise.name == name) return exercise;
  }
  throw InputError("there is no exercise '" + name + "'; choose one of " +
                   joined(exercises(), [](const Exercise& exercise) { return exercise.name; }));
}

ExercisePlan planExercise(const Exercise& exercise, const mechanism::Robot& robot, const ExerciseOptions& options) {
  refuseOptions(exercise, robot, options);
  ExercisePlan plan;
  plan.amplitude = fittingAmplitude(exercise, robot, options, plan);
  fill(exercise, robot, options, plan);
  // The way fits; what may still be too much is the speed that it asks of an actuator.
  for (int round = 0; !plan.check.ok() && plan.check.violation->at.quantity == Quantity::Velocity && round < 5;
       ++round) {
    const auto fastest = std::find_if(plan.check.margins.begin(), plan.check.margins.end(),
                                      [](const Margin& margin) { return margin.quantity == Quantity::Velocity; });
    plan.speed_share *= 0.99 * fastest->limit / fastest->value;
    fill(exercise, robot, options, plan);
  }
  if (!plan.check.ok()) throw Refusal(exercise.name + " on " + robot.path + ": " + plan.check.violation->sentence);
  if (plan.speed_share < 1.0) {
    const std::string note = exercise.name + " at this speed is beyond an actuator's velocity limit in " + robot.path;
    const std::string fitting = shortNumber(options.speed * plan.speed_share, 3) + " m/s and " +
                                shortNumber(options.turning_speed * plan.speed_share / kDegree, 3) + " deg/s";
    if (!options.scale_to_fit) throw Refusal(note + "; " + fitting + " fits");
    plan.notes.push_back(note + "; reduced to " + fitting);
  }
  return plan;
}

}  // namespace knee_robot::trajectory
