#include "monitor_text.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace knee_robot::nodes {
namespace {

constexpr double kSilence_s = 2.0;
constexpr std::size_t kColumns = 100;
constexpr std::size_t kTextColumn = 13;  // where the text of a line begins

[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

std::string bar(double share, int width) {
  const int full = static_cast<int>(std::lround(std::clamp(std::isfinite(share) ? share : 0.0, 0.0, 1.0) * width));
  return "[" + std::string(static_cast<std::size_t>(full), '#') +
         std::string(static_cast<std::size_t>(width - full), '.') + "]";
}

const char* levelName(int level) {
  static const char* const names[] = {"ok", "WARN", "ERROR", "stale"};
  return names[std::clamp(level, 0, 3)];
}

}  // namespace

std::vector<std::string> brokenLines(const std::vector<std::string>& lines, std::size_t columns) {
  const std::string indent(std::min(kTextColumn, columns / 2), ' ');
  std::vector<std::string> result;
  for (std::string rest : lines) {
    while (rest.size() > columns) {
      const std::size_t blank = rest.rfind(' ', columns);
      const bool breaks = blank != std::string::npos && blank > indent.size();
      result.push_back(rest.substr(0, breaks ? blank : columns));
      rest = indent + rest.substr(breaks ? blank + 1 : columns);
    }
    result.push_back(rest);
  }
  return result;
}

template <typename Message>
void knee_robot::nodes::TextMonitor::listen(ros::NodeHandle& node, const std::string& topic,
                                            std::optional<Message>& kept) {
  const boost::function<void(const boost::shared_ptr<const Message>&)> hear =
      [this, &kept](const boost::shared_ptr<const Message>& message) {
        kept = *message;
        heard_at_ = ros::SteadyTime::now();
      };
  subscribers_.push_back(node.subscribe<Message>(controller_ + "/" + topic, 2, hear));
}

TextMonitor::TextMonitor(ros::NodeHandle& node) : controller_(node.resolveName("controller")) {
  listen(node, "state", state_);
  listen(node, "tracking", tracking_);
  listen(node, "margins", margins_);
  listen(node, "forces", forces_);
  listen(node, "residual", residual_);
  listen(node, "timing", timing_);
  const boost::function<void(const diagnostic_msgs::DiagnosticArray::ConstPtr&)> hear =
      [this](const diagnostic_msgs::DiagnosticArray::ConstPtr& message) {
        const std::string own = controller_.substr(1) + ": ";
        for (const diagnostic_msgs::DiagnosticStatus& status : message->status) {
          if (status.name.rfind(own, 0) == 0) diagnostics_[status.name.substr(own.size())] = status;
        }
      };
  subscribers_.push_back(node.subscribe<diagnostic_msgs::DiagnosticArray>("/diagnostics", 4, hear));
}

bool TextMonitor::isSilent() const {
  return heard_at_.isZero() || (ros::SteadyTime::now() - heard_at_).toSec() > kSilence_s;
}

bool TextMonitor::isComplete() const {
  return !isSilent() && state_ && tracking_ && margins_ && forces_ && timing_ && !diagnostics_.empty();
}

std::vector<std::string> TextMonitor::screen() const {
  std::vector<std::string> lines;
  if (!state_ || isSilent()) {
    lines.push_back(controller_ + ": SILENT - no controller is heard");
    if (!state_) return lines;
  } else {
    lines.push_back(controller_ + ": " + state_->state + (state_->playing.empty() ? "" : " " + state_->playing) +
                    (state_->recording ? ", recording" : ""));
  }
  const ControllerState& state = *state_;
  lines.push_back(state.fault.empty() ? "fault        none" : "FAULT        " + state.fault + ": " + state.cause);
  if (state.fault.empty() && !state.cause.empty()) lines.push_back("guiding      " + state.cause);
  lines.push_back("reference    " + (state.reference_file.empty() ? "none" : state.reference_file));
  lines.push_back(format("progress     %s %5.1f of %5.1f s, speed %3.0f %%, asked for %3.0f %%",
                         bar(state.progress, 30).c_str(), state.path_time_s, state.duration_s, 100.0 * state.time_scale,
                         state.speed_percent));
  addLegs(lines);
  addResidual(lines);
  addTiming(lines);
  addDiagnostics(lines);
  return brokenLines(lines, kColumns);
}

void TextMonitor::addLegs(std::vector<std::string>& lines) const {
  if (!tracking_) return;
  lines.emplace_back("leg    length/m   error/mm   speed/(mm/s)   command/V     force/N   I2t   homed");
  for (std::size_t i = 0; i < tracking_->position_m.size(); ++i) {
    lines.push_back(format("%3zu   %9.5f  %9.3f  %13.2f  %10.3f  %10.1f  %4.2f   %s", i + 1, tracking_->position_m[i],
                           1e3 * tracking_->error_m[i], 1e3 * tracking_->velocity_m_per_s[i], tracking_->command_V[i],
                           tracking_->force_N[i], forces_ ? forces_->thermal[i] : 0.0,
                           state_->homed[i] ? "yes" : "NO"));
  }
  if (margins_)
    lines.push_back("limits       " + bar(margins_->nearest_left, 30) +
                    format(" %.0f %% left to the nearest: ", 100.0 * margins_->nearest_left) + margins_->nearest);
}

void TextMonitor::addResidual(std::vector<std::string>& lines) const {
  if (!residual_ || !residual_->known) return;
  const Residual& r = *residual_;
  const auto shown = [](double value, double step) { return std::abs(value) < 0.5 * step ? 0.0 : value; };  // no "-0"
  lines.push_back(format("residual/N   %6.1f %6.1f %6.1f %6.1f   platform %.0f N, %.0f N, %.1f N m, %.1f N m%s",
                         shown(r.certain_N[0], 0.1), shown(r.certain_N[1], 0.1), shown(r.certain_N[2], 0.1),
                         shown(r.certain_N[3], 0.1), shown(r.wrench[0], 1.0), shown(r.wrench[1], 1.0),
                         shown(r.wrench[2], 0.1), shown(r.wrench[3], 0.1), r.identified ? "" : "   (no model)"));
  for (const std::string& sentence : r.errors)
    lines.push_back("             " + sentence);
  for (const std::string& sentence : r.warnings)
    lines.push_back("             " + sentence);
}

void TextMonitor::addTiming(std::vector<std::string>& lines) const {
  if (!timing_) return;
  lines.emplace_back("thread       lateness mean/99 %/max (us)     execution mean/99 %/max (us)   left out");
  for (const ActivityTiming& timing : timing_->activities) {
    lines.push_back(format("%-10s  %8.1f %8.1f %9.1f     %8.1f %8.1f %9.1f   %9llu", timing.name.c_str(),
                           1e6 * timing.lateness_mean_s, 1e6 * timing.lateness_p99_s, 1e6 * timing.lateness_max_s,
                           1e6 * timing.execution_mean_s, 1e6 * timing.execution_p99_s, 1e6 * timing.execution_max_s,
                           static_cast<unsigned long long>(timing.missed)));
  }
}

void TextMonitor::addDiagnostics(std::vector<std::string>& lines) const {
  for (const auto& [name, status] : diagnostics_)
    lines.push_back(format("%-5s  %-10s  ", levelName(status.level), name.c_str()) + status.message);
}

std::string TextMonitor::line() const {
  if (!state_ || isSilent()) return controller_ + ": silent";
  double largest = 0.0;
  if (tracking_) {
    for (const double error : tracking_->error_m)
      largest = std::max(largest, std::abs(error));
  }
  std::string line = format("%s %s %.1f/%.1f s error %.3f mm", controller_.c_str(), state_->state.c_str(),
                            state_->path_time_s, state_->duration_s, 1e3 * largest);
  if (margins_) line += format(" margin %.0f %% (%s)", 100.0 * margins_->nearest_left, margins_->nearest.c_str());
  if (timing_ && !timing_->activities.empty())
    line += format(" lateness 99 %% %.0f us", 1e6 * timing_->activities.front().lateness_p99_s);
  if (!state_->fault.empty()) line += " FAULT " + state_->fault + ": " + state_->cause;
  return line;
}

}  // namespace knee_robot::nodes
