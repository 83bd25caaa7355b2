#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "knee_robot/identification/observation.h"

namespace knee_robot::report {

/// Colours of what every report shows.
inline constexpr const char* kMeasuredColor = "#1b6ca8";
inline constexpr const char* kModelColor = "#d1495b";
inline constexpr const char* kBeforeColor = "#9a9a9a";
inline constexpr const char* kActuatorColors[] = {"#1b6ca8", "#d1495b", "#2a9d55", "#8e5ea2"};

/// Doctype, head with the reports' style, and the heading; ends inside <body>.
std::string pageHead(const std::string& title);

/// Three digits; a dash where there is no number.
std::string htmlNumber(double value);
/// "<table>" and its first row: `first`, then one column an actuator.
std::string tableHead(const std::string& first, int axes);
/// A row of numbers under a title that spans the table.
std::string tableRow(const std::string& name, const Eigen::VectorXd& values);
std::string tableGroup(const std::string& title, int axes);
/// <h2> and a list of sentences; nothing when there is none.
std::string sentenceList(const std::string& title, const std::vector<std::string>& sentences);
/// What holds when a single recording was trained on; empty otherwise.
std::string singleRecordingNote(std::size_t recordings);
/// How to run it again, and the end of the page.
std::string pageEnd(const std::string& command_line);

/// Column of a matrix for a plot.
std::vector<double> series(const Eigen::MatrixXd& matrix, int column);
/// Stretches of time in which every axis moves.
std::vector<std::pair<double, double>> movingStretches(const identification::Observation& observation);

}  // namespace knee_robot::report
