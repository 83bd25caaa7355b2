#pragma once

#include <functional>
#include <string>
#include <vector>

#include "knee_robot/identification/observation.h"

namespace knee_robot::identification {

/// The band in which a model predicts row by row. What is fitted is low-passed; what is predicted for a recording's
/// rows follows its motion as fast as that was measured.
struct FullBand {
  double motion_cutoff_hz = 0.0;  ///< low-pass of the positions before they are differentiated; 0: that of the fit
  std::vector<double> tried_hz;   ///< that of the fit first
  std::vector<double> error;      ///< of each: rms of the rows' error over rms of their force, all actuators alike
  std::string sentence;           ///< for the report
};

/// Force (N, samples of the grid x actuators) that a finished model predicts along an observation. `recording`: index
/// among the training recordings, -1 for others. Called by several threads at once.
using RowPredictor = std::function<Eigen::MatrixXd(Observation&, int recording)>;

/// How a recording is observed for predictions of its rows: positions low-passed at `motion_cutoff_hz`, on a grid fine
/// enough for it, at most the recording's own. Where the fit's low-pass was chosen (motion_band.h) or given, friction acts
/// along positions of that one, if it is wider: they are not differentiated.
ObservationOptions fullBandOptions(const ObservationOptions& fit, double motion_cutoff_hz);

/// Chooses the low-pass of the positions, narrower or wider than that of the fit, by the error of the training
/// recordings' rows, forces not filtered: encoders' noise, twice differentiated, ends the band. Another one than the
/// fit's is taken only where it lowers that error by a twentieth and does not raise the error in the fit's band by more
/// than half a hundredth.
FullBand chooseFullBand(const mechanism::Robot& robot, const std::vector<Column>& columns,
                        const std::vector<recording::Recording>& training, const ObservationOptions& fit,
                        const RowPredictor& predict);

/// Predicted force of every row of a recording, in the band `motion_cutoff_hz`.
Eigen::MatrixXd predictRows(const mechanism::Robot& robot, const std::vector<Column>& columns,
                            const recording::Recording& recording, const ObservationOptions& fit,
                            double motion_cutoff_hz, const RowPredictor& predict, int index);

}  // namespace knee_robot::identification
