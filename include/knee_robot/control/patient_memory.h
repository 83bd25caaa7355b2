#pragma once

#include <string>

namespace knee_robot::control {

/// Who is on the robot, as somebody has declared it. Nothing moves while it is Unknown.
enum class Occupancy {
  Unknown,  ///< nobody has said anything yet, or the patient's file was cleared
  Patient,  ///< a patient file is loaded
  Empty,    ///< declared explicitly, or a bench that never carries a patient
};
const char* toString(Occupancy occupancy) noexcept;

/// Remembers the loaded patient file from one start of the controller to the next: a patient does not leave the robot
/// because a process ended. A small file beside the black box; ordinary threads only.
class PatientMemory {
 public:
  /// An empty path: nothing is remembered.
  explicit PatientMemory(std::string path) : path_(std::move(path)) {}

  /// A patient file, and the fingerprint of what was loaded from it: by the next start it may be another.
  struct File {
    std::string path, mark;
  };

  /// Throws InputError when it cannot be kept.
  void remember(const File& patient) const;
  void forget() const;
  /// False: somebody has removed it, or nobody is remembered.
  bool isThere() const noexcept;
  /// The patient file that was loaded last and not cleared; no path: none. InputError: the memory cannot be read.
  File remembered() const;

 private:
  std::string path_;
};

}  // namespace knee_robot::control
