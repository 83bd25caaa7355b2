#include "knee_robot/control/disturbance_sentences.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/numbers.h"

namespace knee_robot::control {
namespace {

constexpr double kErrorBand = 3.0;      // times the band: an error
constexpr double kNoticeable_m = 0.02;  // a load beside the middle

std::string loadSentence(const Disturbance& d) {
  const std::string mass = shortNumber(std::abs(d.load_kg), 2) + " kg";
  if (d.load_kg < 0.0)
    return "the platform carries about " + mass +
           " less than it should: something was taken off, or the declared payload is too large";
  std::string where;
  if (std::abs(d.load_m) >= kNoticeable_m)
    where = ", " + shortNumber(1e3 * std::abs(d.load_m), 2) + " mm from the middle towards " +
            (d.load_m > 0.0 ? "+X" : "-X");
  return "something carries about " + mass + " on the platform that nobody declared" + where;
}

std::string pushSentence(const Disturbance& d) {
  const double force = std::hypot(d.push[0], d.push[1]);
  const double moment = std::max(std::abs(d.push[2]), std::abs(d.push[3]));
  return "someone pushes, or the platform touches something: about " + shortNumber(force, 2) + " N and " +
         shortNumber(moment, 2) + " N m";
}

std::string frictionSentence(const Disturbance& d, std::size_t leg) {
  const double percent = 100.0 * d.friction_growth[leg];
  return "friction of leg " + std::to_string(leg + 1) + (percent > 0.0 ? " has grown by " : " has become less by ") +
         shortNumber(std::abs(percent), 2) + " %";
}

}  // namespace

std::vector<Notice> noticesOf(const Disturbance& d) {
  std::vector<Notice> all;
  if (!d.known || !d.identified) return all;
  double worst = 0.0;
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    worst = std::max(worst, d.rms_N[i] / d.band_N[i]);
  if (!d.model_holds)
    all.push_back({worst > kErrorBand ? Notice::Level::Error : Notice::Level::Warning,
                   "the model no longer holds (residual " + shortNumber(worst, 2) +
                       " times what it promised): record and trace again"});
  if (d.pushed) all.push_back({Notice::Level::Warning, pushSentence(d)});
  if (d.carries) all.push_back({Notice::Level::Warning, loadSentence(d)});
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    if (d.friction_changed[i]) all.push_back({Notice::Level::Warning, frictionSentence(d, i)});
  }
  return all;
}

const char* sentenceWithoutNotices(const Disturbance& d) noexcept {
  if (!d.identified) return "not judged: there is no identified model";
  if (!d.known) return "not evaluated: the drives do not carry the platform, or the filters have not settled";
  return "nothing acts on the robot but what the model expects";
}

}  // namespace knee_robot::control
