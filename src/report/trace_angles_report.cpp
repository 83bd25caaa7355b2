#include "trace_angles_report.h"

#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/words.h"
#include "knee_robot/report/json_parts.h"

namespace knee_robot::report {
namespace {

std::string placeText(const tracing::Place& p) {
  return p.candidate->name() + (p.actuator < 0 ? "" : " on actuator " + std::to_string(p.actuator + 1));
}

std::string degrees(double angle) {
  return shortNumber(std::round(kDegrees * angle), 3);
}

std::string nearestText(const tracing::PlaceAngles& a) {
  const std::string out = joined(a.nearest, [](const tracing::PlaceAngles::Neighbour& n) {
    return n.place.candidate->name() + " " + degrees(n.angle) + " deg";
  });
  return out.empty() ? "-" : out;
}

enum Kind { kMoving, kAtRest, kBeginning, kMasked, kKindCount };
constexpr const char* kKinds[] = {"moving", "at_rest", "beginning", "masked"};
constexpr const char* kKindTexts[] = {"while the axis moves", "at rest (friction may take any value)",
                                      "before it first moves (friction unknown)",
                                      "masked (near a singular pose, at a limit)"};
constexpr double kFirstMove =
    1e-3;  ///< m, rad: from there on friction no longer rests on what was before the recording

/// Share of the squared error that is left, and share of the samples, by kind of sample.
struct Shares {
  Eigen::MatrixXd error, samples;  ///< Kind x actuators
};

/// First sample at which the axis has left where the recording began.
int firstMove(const identification::Observation& o, int axis) {
  const auto& position = o.signals.position_m;
  int n = 0;
  while (n < o.samples() && std::abs(position(n, axis) - position(0, axis)) < kFirstMove)
    ++n;
  return n;
}

Shares sharesOf(const TraceResults& r) {
  const bool validated = !r.validate.empty();
  const std::vector<identification::Observation>& list = validated ? r.validate : r.train;
  const identification::Applied& applied = validated ? r.validate_after : r.train_after;
  const int axes = list.front().axes();
  Shares s{Eigen::MatrixXd::Zero(kKindCount, axes), Eigen::MatrixXd::Zero(kKindCount, axes)};
  for (std::size_t f = 0; f < list.size(); ++f) {
    const identification::Observation& o = list[f];
    const Eigen::MatrixXd error = applied.predictions[f].force_filtered_N - o.force_filtered_N;
    for (int i = 0; i < axes; ++i) {
      const int first = firstMove(o, i);
      for (int n = 0; n < o.samples(); ++n) {
        if (!o.isJudged(n)) continue;
        const Kind kind = !o.usable[static_cast<std::size_t>(n)] ? kMasked
                          : n < first                            ? kBeginning
                          : o.axis_moving(n, i)                  ? kMoving
                                                                 : kAtRest;
        s.error(kind, i) += error(n, i) * error(n, i);
        s.samples(kind, i) += 1.0;
      }
    }
  }
  for (int i = 0; i < axes; ++i) {
    s.error.col(i) /= std::max(1e-300, s.error.col(i).sum());
    s.samples.col(i) /= std::max(1.0, s.samples.col(i).sum());
  }
  return s;
}

std::string shareLine(const std::string& name, const Eigen::VectorXd& error, const Eigen::VectorXd& samples) {
  std::string line = "  " + name;
  line.resize(46, ' ');
  for (Eigen::Index i = 0; i < error.size(); ++i)
    line += " " + shortNumber(std::round(100.0 * error[i]), 3) + " (" + shortNumber(std::round(100.0 * samples[i]), 3) +
            ")";
  return line + "\n";
}

}  // namespace

nlohmann::ordered_json anglesJson(const TraceResults& r) {
  Json list = Json::array();
  for (const tracing::PlaceAngles& a : r.result.angles) {
    Json j = {{"name", a.place.candidate->name()},
              {"actuator", a.place.actuator < 0 ? Json() : Json(a.place.actuator + 1)},
              {"to_base_deg", {kDegrees * a.base_smallest, kDegrees * a.base_largest}},
              {"nearest", Json::array()}};
    for (const tracing::PlaceAngles::Neighbour& n : a.nearest)
      j["nearest"].push_back({{"name", n.place.candidate->name()},
                              {"actuator", n.place.actuator < 0 ? Json() : Json(n.place.actuator + 1)},
                              {"angle_deg", kDegrees * n.angle}});
    list.push_back(j);
  }
  return list;
}

nlohmann::ordered_json errorSharesJson(const TraceResults& r) {
  const Shares s = sharesOf(r);
  Json j;
  for (int k = 0; k < kKindCount; ++k)
    j[kKinds[k]] = {{"share_of_squared_error", jsonArray(s.error.row(k).transpose())},
                    {"share_of_samples", jsonArray(s.samples.row(k).transpose())}};
  return j;
}

std::string anglesSummary(const TraceResults& r) {
  std::string out;
  for (const tracing::FoundEffect& e : r.result.effects) {
    for (const tracing::PlaceAngles& a : r.result.angles) {
      if (a.place == e.hypothesis.place)
        out += "  " + placeText(a.place) + ": " + degrees(a.base_largest) +
               " deg from the base; nearest: " + nearestText(a) + "\n";
    }
  }
  return out.empty() ? out : "angles along the training recordings\n" + out;
}

std::string errorSharesSummary(const TraceResults& r) {
  const Shares s = sharesOf(r);
  std::string out = std::string("left on ") + (r.validate.empty() ? "training" : "validation") +
                    ", % of the squared error (of the samples)\n";
  for (int k = 0; k < kKindCount; ++k)
    out += shareLine(kKindTexts[k], s.error.row(k).transpose(), s.samples.row(k).transpose());
  return out;
}

}  // namespace knee_robot::report
