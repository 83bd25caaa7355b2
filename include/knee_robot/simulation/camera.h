#pragma once

#include <array>
#include <string>

#include "knee_robot/mechanism/kinematics.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/recording/recording.h"

namespace knee_robot::simulation {

/// A camera beside the simulated robot, and what the robot file does not say about the mechanism it looks at.
struct CameraSimulation {
  double period_s = 0.01;      ///< between pictures
  double delay_s = 0.0;        ///< a picture is stamped this much later than what it shows
  double noise_m = 2e-4;       ///< standard deviation of Xm and Zm, independent from picture to picture
  double noise_rad = 1e-3;     ///< of theta and psi
  double missing_share = 0.0;  ///< of the pictures, at random
  double rotation_rad = 0.0;   ///< robot's frame to camera's: turn about Y, then the shift
  double shift_x_m = 0.0, shift_z_m = 0.0;
  double plate_rad = 0.0;                 ///< how the markers sit, about the platform's normal
  std::array<double, 4> home_offset_m{};  ///< true length minus the length that the encoder says
  std::array<double, 4>
      half_play_m{};           ///< of each leg, taken up by its direction of travel: shorter while it lengthens
  double play_width_m = 1e-4;  ///< of travel that takes the play up
  unsigned seed = 1;
};

/// Gives a recording of the simulated robot camera columns, as a camera would see the mechanism `true_geometry` at the
/// true lengths: those of the encoders with offset and play. Rows without a picture are nan.
void addCamera(const mechanism::Geometry& true_geometry, const CameraSimulation& camera,
               recording::Recording& recording);

/// Camera file (YAML, docs/files.md): keys as the members above, every one optional. InputError names file, line, key
/// and limit.
CameraSimulation loadCameraSimulation(const std::string& path);

/// `content`, the CSV that `recording` was read from, with the four columns of recording.mocap added. InputError when
/// it has camera columns already.
std::string withCameraColumns(const std::string& content, const recording::Recording& recording);

}  // namespace knee_robot::simulation
