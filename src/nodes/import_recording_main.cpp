// import_recording: other recorders' files -> recording.

#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "knee_robot/base/errors.h"
#include "knee_robot/recording/import.h"
#include "program.h"

using namespace knee_robot;

namespace {

struct Arguments {
  std::string source, output, map;
  std::vector<std::string> columns;
  SignalFolder folder;
};

void declare(CLI::App& app, Arguments& a) {
  app.add_option("SOURCE", a.source, "folder of one table per signal, or one table (CSV, TSV)")->required();
  app.add_option("--output,-o", a.output, "recording to write; refused when it exists")->required();
  app.add_option("--command-unit", a.folder.command_unit, "folder: unit of the command, N or V")
      ->check(CLI::IsMember({"N", "V"}));
  app.add_option("--position", a.folder.position, "folder: file of the positions, m; its stamps are the rows")
      ->capture_default_str();
  app.add_option("--command", a.folder.command, "folder: file of the commands")->capture_default_str();
  app.add_option("--reference", a.folder.reference, "folder: file of the references, m ('': none)")
      ->capture_default_str();
  app.add_option("--velocity", a.folder.velocity, "folder: file of the velocities, m/s ('': none)")
      ->capture_default_str();
  app.add_option("--pose", a.folder.pose, "folder: file of the recorder's own pose, m and rad ('': none)")
      ->capture_default_str();
  app.add_option("--map", a.map, "table: YAML file that says what each column becomes, and in which unit it is");
  app.add_option("--column", a.columns, "table: one column, FROM=TO[,UNIT[,SCALE[,OFFSET]]]; may be repeated");
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
      "What was done to the time axis is printed. Rosbags are not read: export their topics to CSV first\n"
      "(rostopic echo -b FILE.bag -p TOPIC), then use a map.");
}

Imported import(const Arguments& a) {
  if (std::filesystem::is_directory(a.source)) {
    if (!a.map.empty() || !a.columns.empty())
      throw InputError(a.source + ": is a folder; --map and --column are for tables");
    if (a.folder.command_unit.empty()) throw InputError("--command-unit N or V is needed: the files do not say it");
    SignalFolder folder = a.folder;
    folder.path = a.source;
    return importFolder(folder);
  }
  if (a.map.empty() && a.columns.empty()) {
    throw InputError(a.source + ": is a table, so --map or --column must say what its columns are");
  }
  ColumnMap map;
  if (!a.map.empty()) map = loadColumnMap(a.map);
  for (const std::string& text : a.columns)
    map.columns.push_back(parseMapping(text));
  return importTable(TextTable::load(a.source, map.format), map);
}

int run(const Arguments& a) {
  const Imported imported = import(a);
  writeImported(imported, a.output);
  for (const std::string& note : imported.notes)
    std::cout << note << "\n";
  std::cout << "written: " << a.output << ", " << imported.rows << " rows" << std::endl;
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Makes a recording of other recorders' files.", "import_recording");
  Arguments arguments;
  declare(app, arguments);
  return runProgram(app, argc, argv, [&] { return run(arguments); });
}
