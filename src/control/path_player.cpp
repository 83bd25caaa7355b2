#include "path_player.h"

#include <cmath>

#include "approach_line.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/trajectory/reference_check.h"
#include "operator_sentences.h"

namespace knee_robot::control {
namespace {

constexpr double kPlayerAnswer_s = 1.0;
constexpr double kSlowestApproach = 0.001, kFastestApproach = 0.05;  // m/s

AxisValues rowOf(const trajectory::Points& lengths, Eigen::Index k) {
  AxisValues row{};
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    row[i] = lengths(k, static_cast<Eigen::Index>(i));
  return row;
}

}  // namespace

PlayableReference PathPlayer::check(trajectory::Reference reference) const {
  return {std::move(reference), robot_};
}

Answer PathPlayer::load(const PlayableReference& playable, const Patient& patient) {
  const trajectory::Reference& reference = playable.reference();
  if (!playable.wasCheckedFor(robot_)) return {false, reference.name + " was checked for another robot"};
  try {
    if (patient) requireWithinPatient(playable.check(), reference, *patient);
  } catch (const InputError& error) {
    return {false, error.what()};
  }
  trajectory::Points lengths = playable.check().lengths;
  const auto rows = lengths.rows();
  const double duration = trajectory::kStreamPeriod * static_cast<double>(rows - 1);
  const std::lock_guard<std::mutex> lock(mutex_);
  lengths_ = std::move(lengths);
  name_ = reference.name;
  loaded_ = playable.number();
  return {true, name_ + ": " + std::to_string(rows) + " points, " + shortNumber(duration) +
                    " s, within all limits of the robot"};
}

void PathPlayer::forget() {
  const std::lock_guard<std::mutex> lock(mutex_);
  lengths_ = trajectory::Points();
  name_.clear();
  loaded_ = 0;
}

/// A stop that comes before the Supervisor knows of the path finds nothing to stop: it is seen before, or behind it.
Answer PathPlayer::playLengths(const trajectory::Points& lengths, const std::string& what,
                               const PathExpectation& expected) {
  std::vector<AxisValues> points;
  points.reserve(static_cast<std::size_t>(lengths.rows()));
  for (Eigen::Index k = 0; k < lengths.rows(); ++k)
    points.push_back(rowOf(lengths, k));
  ReferencePath path = ReferencePath::of(std::move(points));
  const std::lock_guard<std::mutex> begin(begin_);
  if (isHalted(expected)) return kHalted;
  if (isPaused(expected)) return kPaused;
  sync_.store().offer(std::move(path));
  const Answer answer = requests_.make(RequestKind::Play, kPlayerAnswer_s);
  if (!answer.ok) return answer;
  if (isHalted(expected)) {
    requests_.make(RequestKind::Stop, kPlayerAnswer_s);
    return kHalted;
  }
  if (isPaused(expected)) requests_.make(RequestKind::Pause, kPlayerAnswer_s);
  const std::lock_guard<std::mutex> lock(mutex_);
  playing_ = what;
  return {true, "playing " + what};
}

/// Empty: the loaded reference may be used. Under the mutex.
std::string PathPlayer::whyNot(const PathExpectation& expected) const {
  if (lengths_.rows() == 0) return "no reference is loaded; load one first";
  const bool same_name = expected.reference.empty() || expected.reference == name_;
  if (same_name && expected.loaded.value_or(loaded_) != loaded_)
    return "somebody else has loaded " + name_ + " since this was asked for";
  if (same_name) return "";
  return "somebody else has loaded " + name_ + " in place of " + expected.reference + " meanwhile";
}

PathExpectation PathPlayer::fromNow(PathExpectation expected) const {
  if (!expected.halts) expected.halts = halts();
  if (!expected.pauses) expected.pauses = pauses();
  return expected;
}

Answer PathPlayer::play(const PathExpectation& wanted) {
  const PathExpectation expected = fromNow(wanted);
  trajectory::Points lengths;
  std::string name;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (const std::string why = whyNot(expected); !why.empty()) return {false, why};
    lengths = lengths_;
    name = name_;
  }
  return playLengths(lengths, name, expected);
}

Answer PathPlayer::approach(double speed_m_per_s, const Patient& patient, const PathExpectation& wanted) {
  const PathExpectation expected = fromNow(wanted);
  if (!(speed_m_per_s >= kSlowestApproach && speed_m_per_s <= kFastestApproach)) {
    return {false, "the approach's speed must lie between 0.001 and 0.05 m/s, not " + shortNumber(speed_m_per_s)};
  }
  const std::optional<TrackingRow> row = panel_.row();
  AxisValues to{};
  trajectory::Reference line;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (const std::string why = whyNot(expected); !why.empty()) return {false, why};
    to = rowOf(lengths_, 0);
    line.name = "the approach to " + name_;
  }
  if (!row) return {false, "nothing has been measured yet"};
  // Slower until the patient's speeds allow it: what turns the platform how fast depends on the pose.
  for (double speed = speed_m_per_s;; speed *= 0.5) {
    line.points = approachLine(row->position_m, to, robot_, speed);
    try {
      const trajectory::ReferenceCheck checked = trajectory::requirePlayable(line, robot_);
      if (patient) requireWithinPatient(checked, line, *patient);
      return playLengths(checked.lengths, line.name, expected);
    } catch (const InputError& error) {
      if (!patient || speed < kSlowestApproach) return {false, error.what()};
    }
  }
}

/// Where Sync would let the loaded reference begin. Under the mutex.
bool PathPlayer::standsAtStart() const {
  const std::optional<TrackingRow> row = panel_.row();
  if (lengths_.rows() == 0 || !row) return false;
  const AxisValues first = rowOf(lengths_, 0);
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    if (!(std::abs(row->position_m[i] - first[i]) <= sync_.start_tolerance_m)) return false;
  }
  return true;
}

void PathPlayer::fill(ControlStatus& status) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  status.reference = name_;
  status.at_start = standsAtStart();
  if (isOnPath(status.state)) status.playing = playing_;
}

}  // namespace knee_robot::control
