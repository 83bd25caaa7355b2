#include <cmath>
#include <cstdio>

#include "knee_robot/base/numbers.h"
#include "knee_robot/report/identify_report.h"

namespace knee_robot::report {
namespace {

std::string cell(double value, int width) {
  char text[32];
  if (!std::isfinite(value)) {
    std::snprintf(text, sizeof text, "%*s", width, "-");
  } else {
    std::snprintf(text, sizeof text, "%*.2f", width, value);
  }
  return text;
}

std::string row(const std::string& name, const Eigen::VectorXd& values, const char* unit) {
  char label[64];
  std::snprintf(label, sizeof label, "  %-34s", name.c_str());
  std::string line = label;
  for (const double value : values)
    line += cell(value, 9);
  return line + "  " + unit + "\n";
}

std::string accuracyText(const std::string& title, const identification::Accuracy& a) {
  std::string out =
      title + " (" + std::to_string(a.samples) + " samples, " + std::to_string(a.moving_samples) + " moving)\n";
  out += row("rms, moving samples", a.rms_moving_N, "N") + row("rms, all samples", a.rms_N, "N");
  out += row("rms, all rows, full band", a.rms_raw_N, "N") +
         row("rms / rms(force), rows, full band", a.raw_percent, "%") +
         row("rms / rms(force), all samples", a.rms_percent, "%") +
         row("the same, all actuators together", Eigen::VectorXd::Constant(1, a.togetherPercent()), "%");
  return out + row("rms / range(force), all samples", a.range_percent, "%") + row("largest error", a.max_N, "N");
}

std::string frictionText(const std::vector<dynamics::FrictionLaw>& laws) {
  std::string out = "friction near rest, chosen on training data:\n";
  for (std::size_t i = 0; i < laws.size(); ++i)
    out += "  actuator " + std::to_string(i + 1) + ": " + dynamics::describe(laws[i]) + "\n";
  return out;
}

std::string strengthText(const IdentifyResults& r) {
  std::string out =
      "error against the directions that the data decide rather than the prior: rms of moving samples, N; * = chosen "
      "on training "
      "data (held back: rms / noise on left-out blocks)\n";
  out += "   rank  held back | training";
  out += std::string(static_cast<std::size_t>(8 * r.after.model.axes - 8), ' ');
  out += r.validate_by_strength.empty() ? "\n" : "  | validation\n";
  const std::vector<identification::StrengthPoint>& curve = r.after.prior.curve;
  for (std::size_t k = 0; k < curve.size(); ++k) {
    char head[48];
    std::snprintf(head, sizeof head, " %c %4d  %9.3f |", curve[k].rank == r.after.model.rank ? '*' : ' ', curve[k].rank,
                  std::sqrt(curve[k].held_back));
    out += head;
    for (const double value : r.train_by_strength[k])
      out += cell(value, 8);
    if (!r.validate_by_strength.empty()) {
      out += "  |";
      for (const double value : r.validate_by_strength[k])
        out += cell(value, 8);
    }
    out += "\n";
  }
  return out;
}

/// Parameters with a value of their own; the others as a count.
std::string parameterText(const identification::Identification& id) {
  std::string out =
      "parameters (standard errors: bootstrap over blocks of " + shortNumber(id.bootstrap_block_s, 2) + " s)\n";
  int silent = 0;
  for (const dynamics::ModelParameter& p : id.model.parameters) {
    if (!std::isfinite(p.std)) {
      ++silent;
      continue;
    }
    char line[128];
    std::snprintf(line, sizeof line, "  %-12s %10.4g +- %-9.2g %-9s %s\n", p.name.c_str(), p.value, p.std,
                  p.unit.c_str(), verdictText(p.verdict).c_str());
    out += line;
  }
  return out + "  " + std::to_string(silent) + " others: not identifiable on this data (" +
         std::to_string(id.model.base.size()) + " combinations of them are; see model.yaml)\n";
}

std::string gainsText(const IdentifyResults& r) {
  std::string out = r.drive_gains.empty() ? "" : "gains of the drives\n";
  for (const std::string& sentence : r.drive_gains)
    out += "  " + sentence + "\n";
  return out;
}

std::string physicalText(const IdentifyResults& r) {
  if (!r.physical) return "physically consistent parameters: not fitted, " + r.no_physical + "\n";
  const bool validated = !r.validate.empty();
  const identification::Accuracy& physical = (validated ? r.validate_physical : r.train_physical).accuracy;
  const identification::Accuracy& base = (validated ? r.validate_after : r.train_after).accuracy;
  std::string out = "physically consistent parameters: the data decide " + shortNumber(r.physical->supported, 3) +
                    " directions, the URDF the rest; " + (validated ? "validation" : "training") + "\n";
  out += row("physically consistent, moving", physical.rms_moving_N, "N") +
         row("base fit, moving", base.rms_moving_N, "N");
  return out + row("physically consistent, all", physical.rms_N, "N") + row("base fit, all", base.rms_N, "N");
}

}  // namespace

std::string identifySummary(const IdentifyResults& r) {
  std::string out;
  for (const auto* group : {&r.train, &r.validate}) {
    for (const identification::Observation& o : *group) {
      out += o.path + "\n";
      for (const std::string& note : o.notes)
        out += "  " + note + "\n";
    }
  }
  out += r.cutoff.sentence + "\n" + (r.full_band.sentence.empty() ? "" : r.full_band.sentence + "\n") + "\n" +
         strengthText(r) + "\n" + frictionText(r.after.model.friction) + "\n" + parameterText(r.after) + gainsText(r) +
         "\n" + accuracyText("training", r.train_after.accuracy);
  if (!r.validate.empty()) out += accuracyText("validation", r.validate_after.accuracy);
  out += physicalText(r);
  for (const std::string& doubt : r.doubts)
    out += doubt + "\n";
  return out;
}

std::string verdictText(const std::string& verdict) {
  return verdict == "not identifiable" ? "not identifiable on this data" : verdict;
}

std::string outlierText(identification::OutlierRule rule) {
  switch (rule) {
    case identification::OutlierRule::Bisquare:
      return "iteratively reweighted least squares with Tukey's weights";
    case identification::OutlierRule::None:
      return "none, plain least squares";
    default:
      return "Huber's loss (beyond 1.345 times the noise linear)";
  }
}

}  // namespace knee_robot::report
