// workspace_map: a picture (SVG) of where a robot can go, and of where the paper's exercises lie in it.

#include <algorithm>
#include <cmath>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/trajectory/pose_limits.h"
#include "program.h"

using namespace knee_robot;

namespace {

constexpr int kColumns = 90, kRows = 64;
constexpr double kCell = 4.5;  // pixels
constexpr double kLeft = 70.0, kTop = 60.0, kGap = 90.0;

/// One plane through the workspace: pose coordinates `across` and `up` vary, the others are those of `center`.
struct Panel {
  std::string title;
  int across, up;
  double low[2], high[2];  ///< across, up (m, rad)
  mechanism::Pose center;
};

struct Line {
  int axis;
  double from, to;
  std::string name;
};

bool isAngle(int coordinate) {
  return coordinate >= 2;
}
const char* nameOfCoordinate(int coordinate) {
  static const char* const names[] = {"X (m)", "Z (m)", "theta (deg)", "psi (deg)"};
  return names[coordinate];
}

struct Verdict {
  const char* key;
  const char* colour;
  const char* meaning;
};
constexpr Verdict kVerdicts[] = {{"free", "#3a9d5d", "within all limits, condition below half the margin"},
                                 {"margin", "#b9d86b", "within all limits, condition above half the margin"},
                                 {"condition", "#d9534f", "inside the singularity margin, or beyond the singularity"},
                                 {"spherical", "#f0ad4e", "spherical joint beyond its limit"},
                                 {"universal", "#c77cd6", "universal or revolute joint beyond its limit"},
                                 {"length", "#d5d9dd", "a leg too short or too long"}};

int verdictAt(const mechanism::Robot& robot, const mechanism::Pose& pose) {
  const double limit = trajectory::planningCondition(robot);
  const trajectory::Margin margin = trajectory::nearestLimit(robot, pose, limit);
  if (margin.left >= 0.0) return mechanism::conditionNumber(*robot.mechanism, pose) < 0.5 * limit ? 0 : 1;
  switch (margin.quantity) {
    case trajectory::Quantity::PlatformAngle:
      return 3;
    case trajectory::Quantity::BaseAngle:
      return 4;
    case trajectory::Quantity::ShortestLength:
    case trajectory::Quantity::LongestLength:
      return 5;
    default:
      return 2;
  }
}

class Drawing {
 public:
  explicit Drawing(const mechanism::Robot& robot) : robot_(robot) {}

  void panel(const Panel& panel, int index, const std::vector<Line>& lines) {
    const double x0 = kLeft + (index % 2) * (kColumns * kCell + kGap), y0 = kTop + (index / 2) * (kRows * kCell + kGap);
    out_ << "<text x=\"" << x0 << "\" y=\"" << y0 - 8 << "\" class=\"t\">" << panel.title << "</text>\n";
    cells(panel, x0, y0);
    axes(panel, x0, y0);
    for (const Line& line : lines)
      exercise(panel, line, x0, y0);
  }

  std::string finish(const std::string& title) const {
    const double width = 2 * (kLeft + kColumns * kCell) + kGap, height = kTop + 2 * (kRows * kCell + kGap) + 80;
    std::ostringstream all;
    all << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << width << "\" height=\"" << height
        << "\" viewBox=\"0 0 " << width << ' ' << height
        << "\">\n<style>rect{shape-rendering:crispEdges}text{font:12px "
           "sans-serif;fill:#222}.t{font-weight:bold}</style>\n<rect width=\"100%\" "
        << "height=\"100%\" fill=\"white\"/>\n<text x=\"" << kLeft << "\" y=\"24\" class=\"t\">" << title << "</text>\n"
        << out_.str() << legend(height - 90) << "</svg>\n";
    return all.str();
  }

 private:
  static double value(const Panel& p, int which, double share) {
    return p.low[which] + share * (p.high[which] - p.low[which]);
  }

  void cells(const Panel& p, double x0, double y0) {
    for (int row = 0; row < kRows; ++row) {
      int run_start = 0, run_verdict = -1;
      for (int column = 0; column <= kColumns; ++column) {
        int verdict = -1;
        if (column < kColumns) {
          mechanism::Pose pose = p.center;
          pose[p.across] = value(p, 0, (column + 0.5) / kColumns);
          pose[p.up] = value(p, 1, 1.0 - (row + 0.5) / kRows);
          verdict = verdictAt(robot_, pose);
        }
        if (verdict == run_verdict) continue;
        if (run_verdict >= 0) {
          out_ << "<rect x=\"" << x0 + run_start * kCell << "\" y=\"" << y0 + row * kCell << "\" width=\""
               << (column - run_start) * kCell << "\" height=\"" << kCell + 0.2 << "\" fill=\""
               << kVerdicts[run_verdict].colour << "\"/>\n";
        }
        run_start = column;
        run_verdict = verdict;
      }
    }
  }

  void axes(const Panel& p, double x0, double y0) {
    const double w = kColumns * kCell, h = kRows * kCell;
    const auto shown = [](int coordinate, double v) { return shortNumber(isAngle(coordinate) ? v / kDegree : v, 3); };
    out_ << "<rect x=\"" << x0 << "\" y=\"" << y0 << "\" width=\"" << w << "\" height=\"" << h
         << "\" fill=\"none\" stroke=\"#444\"/>\n";
    for (int k = 0; k <= 4; ++k) {
      const double share = k / 4.0;
      out_ << "<text x=\"" << x0 + share * w << "\" y=\"" << y0 + h + 16 << "\" text-anchor=\"middle\">"
           << shown(p.across, value(p, 0, share)) << "</text>\n<text x=\"" << x0 - 6 << "\" y=\""
           << y0 + (1 - share) * h + 4 << "\" text-anchor=\"end\">" << shown(p.up, value(p, 1, share)) << "</text>\n";
    }
    out_ << "<text x=\"" << x0 + w / 2 << "\" y=\"" << y0 + h + 34 << "\" text-anchor=\"middle\">"
         << nameOfCoordinate(p.across) << "</text>\n<text x=\"" << x0 - 46 << "\" y=\"" << y0 + h / 2
         << "\" text-anchor=\"middle\" transform=\"rotate(-90 " << x0 - 46 << ' ' << y0 + h / 2 << ")\">"
         << nameOfCoordinate(p.up) << "</text>\n";
  }

  /// An exercise along one of the panel's two coordinates, through the panel's center.
  void exercise(const Panel& p, const Line& line, double x0, double y0) {
    if (line.axis != p.across && line.axis != p.up) return;
    const double w = kColumns * kCell, h = kRows * kCell;
    const auto pixelOf = [&](double v) {
      mechanism::Pose pose = p.center;
      pose[line.axis] = v;
      const double x = (pose[p.across] - p.low[0]) / (p.high[0] - p.low[0]),
                   y = (pose[p.up] - p.low[1]) / (p.high[1] - p.low[1]);
      return std::make_pair(x0 + std::clamp(x, 0.0, 1.0) * w, y0 + (1.0 - std::clamp(y, 0.0, 1.0)) * h);
    };
    const auto a = pixelOf(line.from), b = pixelOf(line.to);
    out_ << "<line x1=\"" << a.first << "\" y1=\"" << a.second << "\" x2=\"" << b.first << "\" y2=\"" << b.second
         << "\" stroke=\"#111\" stroke-width=\"2.5\"/>\n<text x=\"" << b.first + 5 << "\" y=\"" << b.second - 4 << "\">"
         << line.name << "</text>\n";
  }

  static std::string legend(double y) {
    std::ostringstream out;
    for (int k = 0; k < 6; ++k) {
      const double x = kLeft + (k % 2) * 400, line = y + (k / 2) * 22;
      out << "<rect x=\"" << x << "\" y=\"" << line << "\" width=\"14\" height=\"14\" fill=\"" << kVerdicts[k].colour
          << "\"/><text x=\"" << x + 20 << "\" y=\"" << line + 12 << "\">" << kVerdicts[k].meaning << "</text>\n";
    }
    return out.str();
  }

  const mechanism::Robot& robot_;
  std::ostringstream out_;
};

std::string draw(const mechanism::Robot& robot) {
  // The lowest level pose whose lengths are all allowed; the exercises start there or 0.1 m above.
  double floor = 0.1;
  const auto tooShort = [&robot](double z) {
    const mechanism::Lengths lengths = mechanism::legLengths(*robot.mechanism, mechanism::Pose(0.0, z, 0.0, 0.0));
    for (int i = 0; i < mechanism::kLegs; ++i) {
      if (lengths[i] < robot.actuators[i].position_min_m) return true;
    }
    return false;
  };
  while (floor < 2.0 && tooShort(floor))
    floor += 0.001;
  const double middle = floor + 0.1;
  const mechanism::Pose center(0.0, middle, 0.0, 0.0);
  const double angle = 40 * kDegree;
  const std::vector<Line> lines = {{1, floor, floor + 0.2, "hip flexion"},
                                   {0, -0.11, 0.2, "knee flexion"},
                                   {3, -15 * kDegree, 15 * kDegree, "knee rotation"},
                                   {2, -30 * kDegree, 30 * kDegree, "ankle"}};
  const std::string at = shortNumber(middle, 3) + " m";
  Drawing drawing(robot);
  drawing.panel({"level", 0, 1, {-0.4, floor - 0.1}, {0.5, floor + 0.4}, center}, 0, {lines[0], lines[1]});
  drawing.panel({"X = 0, Z = " + at, 2, 3, {-angle, -angle}, {angle, angle}, center}, 1, {lines[2], lines[3]});
  drawing.panel({"X = 0, psi = 0", 2, 1, {-angle, floor - 0.1}, {angle, floor + 0.4}, center}, 2, {lines[3]});
  drawing.panel({"X = 0, theta = 0", 3, 1, {-angle, floor - 0.1}, {angle, floor + 0.4}, center}, 3, {lines[2]});
  return drawing.finish("Workspace of " + robot.path.substr(robot.path.find_last_of('/') + 1) +
                        ", spherical joints up to " + shortNumber(robot.joints.spherical_max / kDegree, 3) +
                        " deg, condition up to " + shortNumber(trajectory::planningCondition(robot), 4));
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app("Draws where a robot can go, and the paper's exercises in it (SVG).", "workspace_map");
  std::string robot_file, output;
  double spherical_deg = 0.0;
  app.option("--robot", robot_file, "robot file").required();
  app.option("-o,--output", output, "SVG to write").required();
  app.option("--spherical-deg", spherical_deg, "limit of the spherical joints instead of the robot file's")
      .within(1.0, 180.0);
  return nodes::runProgram(app, argc, argv, [&] {
    mechanism::Robot robot = mechanism::loadRobot(robot_file);
    if (!robot.mechanism) throw InputError(robot_file + ": a bench of axes has no workspace to draw");
    if (spherical_deg > 0.0) robot.joints.spherical_max = spherical_deg * kDegree;
    writeFileAtomically(output, draw(robot));
    std::cout << "written: " << output << std::endl;
    return kExitDone;
  });
}
