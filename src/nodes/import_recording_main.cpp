// import_recording: other recorders' files -> recording; motion capture beside a recording.

#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "bag_import.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/identification/observation.h"
#include "knee_robot/recording/import.h"
#include "knee_robot/recording/markers.h"
#include "knee_robot/tracing/pose_registration.h"
#include "program.h"

using namespace knee_robot;

namespace {

struct Arguments {
  std::string source, output, map, markers, marker_map, robot;
  std::vector<std::string> columns;
  recording::SignalFolder folder;
  nodes::BagSource bag;
};

void declare(nodes::CommandLine& app, Arguments& a) {
  app.option("SOURCE", a.source,
             "folder of one table per signal, one table (CSV, TSV), a rosbag, or with --markers a recording")
      .required();
  app.option("--output,-o", a.output, "recording to write; refused when it exists").required();
  app.option("--command-unit", a.folder.command_unit, "folder: unit of the command, N or V").oneOf({"N", "V"});
  app.option("--position", a.folder.position, "folder: file of the positions, m; its stamps are the rows")
      .showDefault();
  app.option("--command", a.folder.command, "folder: file of the commands").showDefault();
  app.option("--reference", a.folder.reference, "folder: file of the references, m ('': none)").showDefault();
  app.option("--velocity", a.folder.velocity, "folder: file of the velocities, m/s ('': none)").showDefault();
  app.option("--pose", a.folder.pose, "folder: file of the recorder's own pose, m and rad ('': none)").showDefault();
  app.option("--map", a.map, "table: YAML file that says what each column becomes, and in which unit it is");
  app.option("--column", a.columns, "table: one column, FROM=TO[,UNIT[,SCALE[,OFFSET]]]; may be repeated");
  app.option("--topic", a.bag.topic,
             "rosbag: topic of type knee_robot/Tracking (default: the only one) or sensor_msgs/JointState");
  app.option("--joints", a.bag.joints, "rosbag: joints of a JointState topic that are the actuators, in order")
      .separatedBy(',');
  app.option("--camera-topic", a.bag.camera, "rosbag: geometry_msgs/PoseStamped of the platform by a camera");
  const nodes::Option markers =
      app.option("--markers", a.markers, "motion-capture export (CSV, TSV) to be put beside the recording SOURCE");
  app.option("--marker-map", a.marker_map, "YAML file: the export's columns and where each marker sits").needs(markers);
  app.option("--robot", a.robot, "robot file, for --markers").needs(markers);
  app.footer(
      "A folder:  import_recording exp_20 --command-unit N -o run.csv\n"
      "  each file has the columns time_sec and time_nanosec, then one value an axis.\n"
      "A table:   import_recording log.csv -o run.csv --column 't=time_s,ms' --column 'q1=position_1_m,mm' ...\n"
      "  or --map map.yaml:\n"
      "    columns:\n"
      "      - {from: t, to: time_s, unit: ms}\n"
      "      - {from: enc1, to: position_1_m, unit: counts, scale: 5e-6, offset: 0.6}\n"
      "    separator: tab      # comma, semicolon, blank; found in the first line when left out\n"
      "    decimal: comma      # point when left out\n"
      "    header: true        # false: columns are named by number, from 1\n"
      "    skip_lines: 0       # in front of the header\n"
      "A rosbag:  import_recording run.bag -o run.csv\n"
      "Markers:   import_recording run.csv --markers capture.tsv --marker-map markers.yaml --robot B.yaml -o "
      "with_camera.csv\n"
      "    time: {from: Time, unit: s}      # or rate_hz: 120\n"
      "    unit: mm\n"
      "    markers:                         # at least three\n"
      "      - {columns: [M1X, M1Y, M1Z], platform_m: [-0.30, 0.00, 0.02]}\n"
      "  rigid fit row by row; delay by cross-correlation, frame by rigid registration, both printed.\n"
      "What was done to the time axis is printed.");
}

/// The recording with camera columns from a motion-capture export.
recording::Imported importMarkers(const Arguments& a) {
  if (a.marker_map.empty()) throw InputError("--markers needs --marker-map: the export does not say where markers sit");
  if (a.robot.empty()) throw InputError("--markers needs --robot: time and frame are aligned with forward kinematics");
  const mechanism::Robot robot = mechanism::loadRobot(a.robot);
  const std::string content = readFile(a.source);
  const recording::Recording recording = recording::parseRecording(content, a.source);
  const recording::MarkerMap map = recording::loadMarkerMap(a.marker_map);
  const recording::MarkerPoses capture = recording::fitMarkers(recording::TextTable::load(a.markers, map.format), map);
  const tracing::RegisteredCapture registered =
      tracing::registerCapture(robot, recording, capture, identification::conditionLimit(robot, {}));
  recording::Imported out;
  out.csv = recording::withCameraColumns(content, a.source, registered.pose);
  out.rows = recording::parseRecording(out.csv, a.source + " (with camera)").rows();
  out.notes = recording.notes;
  out.notes.insert(out.notes.end(), registered.notes.begin(), registered.notes.end());
  return out;
}

bool isBag(const std::string& path) {
  return std::filesystem::path(path).extension() == ".bag";
}

recording::Imported import(const Arguments& a) {
  if (!a.markers.empty()) return importMarkers(a);
  if (isBag(a.source) && !std::filesystem::is_directory(a.source)) {
    nodes::BagSource bag = a.bag;
    bag.path = a.source;
    return nodes::importBag(bag);
  }
  if (std::filesystem::is_directory(a.source)) {
    if (!a.map.empty() || !a.columns.empty())
      throw InputError(a.source + ": is a folder; --map and --column are for tables");
    if (a.folder.command_unit.empty()) throw InputError("--command-unit N or V is needed: the files do not say it");
    recording::SignalFolder folder = a.folder;
    folder.path = a.source;
    return recording::importFolder(folder);
  }
  if (a.map.empty() && a.columns.empty()) {
    throw InputError(a.source + ": is a table, so --map or --column must say what its columns are");
  }
  recording::ColumnMap map;
  if (!a.map.empty()) map = recording::loadColumnMap(a.map);
  for (const std::string& text : a.columns)
    map.columns.push_back(recording::parseMapping(text));
  return recording::importTable(recording::TextTable::load(a.source, map.format), map);
}

int run(const Arguments& a) {
  const recording::Imported imported = import(a);
  recording::writeImported(imported, a.output);
  for (const std::string& note : imported.notes)
    std::cout << note << "\n";
  std::cout << "written: " << a.output << ", " << imported.rows << " rows" << std::endl;
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app("Converts files of other recorders into a recording.", "import_recording");
  Arguments arguments;
  declare(app, arguments);
  return nodes::runProgram(app, argc, argv, [&] { return run(arguments); });
}
