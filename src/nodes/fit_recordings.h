#pragma once

#include <memory>
#include <string>
#include <vector>

#include "knee_robot/identification/identify.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/recording/cutoff.h"
#include "knee_robot/recording/recording.h"

namespace knee_robot::nodes {

/// What identify and trace do with the recordings that they are given, before they differ.

/// A recording counts once in the fit, and one that the model is fitted to cannot validate it, under whatever name; and
/// prediction_NAME.csv must be one file per validation recording. Throws InputError. Reads all of them: before the work, which may take minutes.
void requireFitAndValidation(const std::vector<std::string>& train, const std::vector<std::string>& validate);

/// InputError when two recordings are one measurement, written twice in different ways: it would count as two, or be
/// validated on what it was fitted to.
void requireDifferent(const std::vector<recording::Recording>& training,
                      const std::vector<recording::Recording>& validation);

/// As they are in their files; says on standard error which is being read.
std::vector<recording::Recording> readAll(const std::vector<std::string>& files);

/// In metres and newtons of the robot's actuators.
std::vector<recording::Recording> inUnits(mechanism::Robot& robot, std::vector<recording::Recording> recordings);

/// InputError where a low-pass at this frequency would leave a recording as it is: its rows are too slow.
void requireFiltering(const std::vector<recording::Recording>& recordings, double cutoff_hz);

/// The low-pass of both sides: chosen on training recordings, unless it was `given_hz` (0: it was not).
recording::CutoffChoice cutoffOf(const mechanism::Robot& robot, const std::vector<recording::Recording>& training,
                                 double given_hz);

/// Observes the training recordings anew where their positions are to be smoothed in another way (motion_band.h), and
/// says so. Returns what was fitted to them on the way, without standard errors; null: nothing.
std::shared_ptr<const identification::Identification> chooseSmoothing(
    const mechanism::Robot& robot, const std::vector<identification::Column>& columns,
    const std::vector<recording::Recording>& recordings, identification::ObservationOptions& options,
    std::vector<identification::Observation>& training, std::string& sentence);

}  // namespace knee_robot::nodes
