#include "taut_string.h"

#include <deque>
#include <vector>

namespace knee_robot::recording {
namespace {

struct Vertex {
  double at = 0.0, value = 0.0;
};

double slope(const Vertex& from, const Vertex& to) {
  return (to.value - from.value) / (to.at - from.at);
}

/// The shortest path through a corridor, wall by wall (a funnel): from the last corner that is sure, one chain hangs on
/// the lower wall and one on the upper wall, and the string lies between them. Every point is added and taken once.
class Funnel {
 public:
  explicit Funnel(const Vertex& start) : corners_({start}) {}

  void add(const Vertex& lower, const Vertex& upper) {
    stretch(lower, lower_, upper_, 1.0);
    stretch(upper, upper_, lower_, -1.0);
  }
  /// The corners of the string to `end`, which is a point of both walls.
  std::vector<Vertex> to(const Vertex& end) {
    add(end, end);
    corners_.insert(corners_.end(), lower_.begin(), lower_.end());
    if (corners_.back().at < end.at) corners_.push_back(end);
    return corners_;
  }

 private:
  /// `side`: 1 where the string lies above this wall, -1 where below.
  void stretch(const Vertex& v, std::deque<Vertex>& own, std::deque<Vertex>& other, double side) {
    const auto before = [&] { return own.size() > 1 ? own[own.size() - 2] : corners_.back(); };
    while (!own.empty() && side * slope(own.back(), v) >= side * slope(before(), own.back()))
      own.pop_back();
    // The walls cross as seen from the corner: the string bends around the other one.
    while (own.empty() && !other.empty() &&
           side * slope(corners_.back(), v) > side * slope(corners_.back(), other.front())) {
      if (other.front().at >= v.at) break;
      corners_.push_back(other.front());
      other.pop_front();
    }
    own.push_back(v);
  }

  std::vector<Vertex> corners_;
  std::deque<Vertex> lower_, upper_;
};

}  // namespace

Eigen::VectorXd tautString(const Eigen::VectorXd& y, double half) {
  const Eigen::Index n = y.size();
  if (n < 3 || half <= 0.0) return y;
  Funnel funnel({0.0, y[0]});
  for (Eigen::Index k = 1; k + 1 < n; ++k)
    funnel.add({static_cast<double>(k), y[k] - half}, {static_cast<double>(k), y[k] + half});
  const std::vector<Vertex> corners = funnel.to({static_cast<double>(n - 1), y[n - 1]});
  Eigen::VectorXd out(n);
  std::size_t next = 1;
  for (Eigen::Index k = 0; k < n; ++k) {
    const double at = static_cast<double>(k);
    while (next + 1 < corners.size() && corners[next].at < at)
      ++next;
    out[k] = corners[next - 1].value + (at - corners[next - 1].at) * slope(corners[next - 1], corners[next]);
  }
  return out;
}

}  // namespace knee_robot::recording
