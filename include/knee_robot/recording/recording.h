#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace knee_robot::recording {

/// One recording (docs/contract.md, section 2), as it stands in the file: not resampled, not filtered. Matrices have
/// one row per row of the file and one column per actuator; a signal that the file does not have is a matrix without
/// columns.
struct Recording {
  std::string path;             ///< as given to loadRecording
  std::string name;             ///< file name without folder and ".csv": NAME of prediction_NAME.csv
  std::string fingerprint;      ///< of the file's bytes
  std::int64_t home_id = 0;     ///< changes whenever the axes are homed anew; 0: not known, or homed anew in between
  int axes = 0;                 ///< number of actuators, from the position_i_m columns
  std::vector<double> time_s;   ///< strictly increasing
  Eigen::MatrixXd position_m;   ///< as the file has it: in position_unit
  Eigen::MatrixXd reference_m;  ///< optional
  Eigen::MatrixXd velocity_m_per_s;  ///< optional
  Eigen::MatrixXd command_V;         ///< optional, but one of command and force is there
  Eigen::MatrixXd force_N;           ///< optional: the commanded actuator force; in force_unit
  Eigen::MatrixXd current_A;         ///< optional: motor current (chains)
  Eigen::MatrixXd motor_m;  ///< optional: a second encoder before the gear, at the joint's scale; unit as position
  Eigen::MatrixXd temperature_degC;        ///< optional: of drive or gear
  std::vector<std::string> position_unit;  ///< per actuator: m, or rad (chains)
  std::vector<std::string> force_unit;     ///< per actuator: N, or Nm (chains)
  Eigen::VectorXd test_pulse;              ///< optional: not 0 while the controller asked an encoder whether it counts
  bool force_is_measured = false;  ///< true: the force belongs to its row's time; false: it holds until the next row
  Eigen::MatrixXd mocap;  ///< optional: x, z (m), theta, psi (rad) of the camera; nan where there was no picture
  std::vector<std::string> notes;  ///< what the reader tolerated, one sentence each

  int rows() const { return static_cast<int>(time_s.size()); }
  /// Line of the file that holds this row, for messages.
  static int line(int row) { return row + 2; }
};

/// Reads a recording strictly. Columns are found by name, in any order; unknown ones are ignored. CRLF, blanks around
/// values, a byte order mark and empty lines at the end are accepted; a last line that a crash cut off is left out with
/// a note. InputError (file, line, value, limit) for anything else: a missing or doubled column, a wrong number of
/// values, a value that is not a finite number (nan is allowed in mocap columns only) or is beyond 1e6 (time: 1e11),
/// time that does not increase.
Recording loadRecording(const std::string& path);
/// The same from memory; `path` stands for the file in messages.
Recording parseRecording(const std::string& content, const std::string& path);

/// Smallest change of a 12-bit analog output of +-10 V.
inline constexpr double kDacStep_V = 20.0 / 4096.0;

/// Commanded actuator force (N), rows x axes: the force columns, or the command times `force_per_volt_N` (one signed
/// factor per axis) when there are none. Where both exist, force wins, and a disagreement of more than one DAC step is
/// an InputError.
Eigen::MatrixXd commandedForce(const Recording& recording, const std::vector<double>& force_per_volt_N);

/// InputError unless the recording has as many actuators as the robot.
void requireAxes(const Recording& recording, int axes, const std::string& robot_path);

}  // namespace knee_robot::recording
