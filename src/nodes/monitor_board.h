#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <string>

#include "knee_robot/mechanism/geometry.h"

namespace knee_robot::nodes {

struct Color {
  float r = 1.0F, g = 1.0F, b = 1.0F, a = 1.0F;
};
inline constexpr Color kGood{0.20F, 0.62F, 0.30F, 1.0F}, kNear{0.90F, 0.62F, 0.05F, 1.0F},
    kBad{0.85F, 0.15F, 0.12F, 1.0F}, kInk{0.15F, 0.17F, 0.20F, 1.0F}, kTrack{0.78F, 0.79F, 0.82F, 1.0F};

geometry_msgs::Point pointOf(const mechanism::Vector3& p);

/// Collects markers of one scene in frame `base`; numbers them per namespace.
class Scene {
 public:
  explicit Scene(visualization_msgs::MarkerArray& out) : out_(out) {}

  visualization_msgs::Marker& add(const std::string& subject, int type, const Color& color);
  /// Text of this height (m), centred at `at`, facing the viewer.
  void text(const std::string& subject, const std::string& words, const mechanism::Vector3& at, double height,
            const Color& color);
  /// Box between two corners.
  void box(const std::string& subject, const mechanism::Vector3& corner, const mechanism::Vector3& opposite,
           const Color& color);

 private:
  visualization_msgs::MarkerArray& out_;
};

/// Rows of bars beside the robot, from `top` downwards; a bar grows towards -x.
class Board {
 public:
  Board(Scene& scene, const mechanism::Vector3& top) : scene_(scene), at_(top) {}
  void title(const std::string& subject, const std::string& words);
  /// `share` 0 to 1 of the bar's whole length; `value` is written behind it.
  void bar(const std::string& subject, const std::string& name, double share, const std::string& value,
           const Color& color);
  void gap() { at_.z() -= 0.03; }

 private:
  Scene& scene_;
  mechanism::Vector3 at_;
};

/// `value` with so many decimals.
std::string fixedNumber(double value, int decimals);

/// Lines of at most `width` letters, broken between words.
std::string wrapped(const std::string& words, std::size_t width);

}  // namespace knee_robot::nodes
