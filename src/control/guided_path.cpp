#include "guided_path.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/recording/filter.h"

namespace knee_robot::control {
namespace {

constexpr double kCutoff_hz = 1.5;  // a hand that follows a path with care is slower
constexpr double kMoves_m = 5e-4;   // less is rest
constexpr double kRest_s = 0.5;     // left at both ends
constexpr double kEase_s = 1.0;     // from rest to the hand's own speed, and back
constexpr double kSlower = 1.1;
constexpr double kSlowest = 10.0;

bool differs(const trajectory::Points& points, Eigen::Index a, Eigen::Index b) {
  return (points.row(a) - points.row(b)).cwiseAbs().maxCoeff() > kMoves_m;
}

/// What lies between the rests at both ends, and a little of them.
trajectory::Points withoutRests(const trajectory::Points& points) {
  Eigen::Index first = 0, last = points.rows() - 1;
  while (first < last && !differs(points, 0, first))
    ++first;
  if (first >= last)
    throw InputError("the platform was not moved by more than " + shortNumber(1e3 * kMoves_m) +
                     " mm: there is no path to save; guide it first");
  while (last > first && !differs(points, points.rows() - 1, last))
    --last;
  const auto rest = static_cast<Eigen::Index>(kRest_s / trajectory::kStreamPeriod);
  first = std::max<Eigen::Index>(0, first - rest);
  last = std::min<Eigen::Index>(points.rows() - 1, last + rest);
  return points.middleRows(first, last - first + 1);
}

/// Path time over time: speed rises smoothly from 0 to 1 / slower and falls again; both ends are reached at rest.
trajectory::Points played(const Eigen::MatrixXd& path, double slower) {
  const double whole = static_cast<double>(path.rows() - 1);
  const double ease = std::min(kEase_s / trajectory::kStreamPeriod / slower, 0.5 * whole);  // of the path, samples
  const auto alongPath = [&](double t) {  // t: samples of time; ease takes twice its length
    const double rise = 2.0 * ease * slower, run = (whole - 2.0 * ease) * slower;
    const auto along = [&](double x) {  // integral of the smooth step 3 x^2 - 2 x^3 over the rise
      return ease * 2.0 * (x * x * x - 0.5 * x * x * x * x);
    };
    if (t < rise) return along(t / rise);
    if (t < rise + run) return ease + (t - rise) / slower;
    const double left = std::max(0.0, (2.0 * rise + run - t) / rise);
    return whole - along(left);
  };
  const auto count = static_cast<Eigen::Index>(std::ceil((whole + 2.0 * ease) * slower)) + 1;
  trajectory::Points out(count, 4);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double at = std::clamp(alongPath(static_cast<double>(k)), 0.0, whole);
    const auto i = std::min(static_cast<Eigen::Index>(at), path.rows() - 2);
    // Catmull-Rom: a straight interpolation would step in its velocity.
    const double x = at - static_cast<double>(i);
    const auto row = [&](Eigen::Index r) { return path.row(std::clamp<Eigen::Index>(r, 0, path.rows() - 1)); };
    const Eigen::RowVectorXd slope0 = 0.5 * (row(i + 1) - row(i - 1)), slope1 = 0.5 * (row(i + 2) - row(i));
    const double x2 = x * x, x3 = x2 * x;
    out.row(k) = (2 * x3 - 3 * x2 + 1) * row(i) + (x3 - 2 * x2 + x) * slope0 + (-2 * x3 + 3 * x2) * row(i + 1) +
                 (x3 - x2) * slope1;
  }
  return out;
}

std::string whyNot(const trajectory::Reference& reference, const mechanism::Robot& robot,
                   const std::optional<PatientLimits>& patient) {
  try {
    const trajectory::ReferenceCheck check = trajectory::requirePlayable(reference, robot);
    if (patient) requireWithinPatient(check, reference, *patient);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace

bool GuidedPath::add(const std::array<double, 4>& lengths_m) noexcept {
  const std::size_t count = count_.load(std::memory_order_relaxed);
  if (count >= kMostSamples) return false;
  samples_[count] = lengths_m;
  count_.store(count + 1, std::memory_order_release);
  return true;
}

trajectory::Points GuidedPath::points() const {
  const std::uint32_t number = number_.load(std::memory_order_acquire);
  const std::size_t count = size();
  trajectory::Points out(static_cast<Eigen::Index>(count), 4);
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t i = 0; i < 4; ++i)
      out(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) = samples_[k][i];
  }
  std::atomic_thread_fence(std::memory_order_acquire);
  if (number_.load(std::memory_order_relaxed) != number) out.resize(0, 4);
  return out;
}

GuidedReference guidedReference(const trajectory::Points& guided, const mechanism::Robot& robot,
                                const std::optional<PatientLimits>& patient) {
  if (guided.rows() < 2)
    throw InputError("nothing was guided since the axes know where they are: there is no path to save");
  Eigen::MatrixXd smooth = withoutRests(guided);
  recording::ZeroPhaseLowPass(kCutoff_hz, 1.0 / trajectory::kStreamPeriod).applyToColumns(smooth);
  GuidedReference out;
  out.reference.name = "the guided path";
  std::string why;
  for (; out.slowed <= kSlowest; out.slowed *= kSlower) {
    out.reference.points = played(smooth, out.slowed);
    why = whyNot(out.reference, robot, patient);
    if (why.empty()) return out;
  }
  throw InputError(why);
}

SavedReference saveGuidedReference(const std::string& path, const trajectory::Points& points,
                                   const mechanism::Robot& robot, const std::optional<PatientLimits>& patient) {
  const GuidedReference guided = guidedReference(points, robot, patient);
  trajectory::writeReference(path, guided.reference, {"guided by hand"});
  const auto rows = guided.reference.points.rows();
  const double duration = trajectory::kStreamPeriod * static_cast<double>(rows - 1);
  std::string slower;
  if (guided.slowed > 1.0)
    slower = ", " + shortNumber(guided.slowed, 2) + " times slower than the hand, for the limits' sake";
  const std::string sentence = path + ": " + std::to_string(rows) + " points, " + shortNumber(duration, 4) + " s" +
                               slower + "; it may be played";
  return {{true, sentence}, static_cast<std::uint32_t>(rows), duration};
}

}  // namespace knee_robot::control
