#include "push_window.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::tracing {
namespace {

/// Until then friction still has what nobody recorded in its memory: a short push that begins there is none.
constexpr double kSettled_s = 0.5, kLong_s = 2.0;

bool isTold(const std::vector<double>& shape) {
  return shape[1] >= kSettled_s || (shape[1] >= 0.0 && shape[2] >= kLong_s);
}

}  // namespace

std::vector<ShapeParameter> PushWindow::shapeParameters() const {
  return {{"recording", 1.0, 1e3, true}, {"from_s", 0.0, 1e6, true}, {"duration_s", 0.5, 1e3, true}};
}

std::vector<std::vector<double>> PushWindow::shapes(const EffectInput& input, int) const {
  std::vector<std::vector<double>> grid;
  const double end = input.time(input.samples() - 1);
  for (const double duration : {1.0, 2.0, 4.0, 8.0}) {
    if (duration > 0.5 * end) continue;
    for (double from = 0.0; from + duration <= end; from += std::max(0.5 * duration, end / 60.0)) {
      std::vector<double> shape{input.recording + 1.0, from, duration};
      if (isTold(shape)) grid.push_back(std::move(shape));
    }
  }
  return grid;
}

std::vector<std::vector<double>> PushWindow::near(const std::vector<double>& s, double step) const {
  const double aside = 0.25 * step * s[2], longer = std::pow(1.4, step);
  std::vector<std::vector<double>> all{
      {s[0], s[1] - aside, s[2]}, {s[0], s[1] + aside, s[2]}, {s[0], s[1], s[2] * longer}, {s[0], s[1], s[2] / longer}};
  all.erase(std::remove_if(all.begin(), all.end(), [](const auto& one) { return !isTold(one); }), all.end());
  return all;
}

PushWindow::Samples PushWindow::samplesOf(const EffectInput& input, int actuator, const std::vector<double>& shape) {
  Samples all;
  all.begin = firstSettled(input, actuator);
  while (all.begin < input.samples() && input.time(all.begin) < shape[1])
    ++all.begin;
  all.end = all.begin;
  while (all.end < input.samples() && input.time(all.end) <= shape[1] + shape[2])
    ++all.end;
  return all;
}

}  // namespace knee_robot::tracing
