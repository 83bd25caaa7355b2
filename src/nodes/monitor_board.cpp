#include "monitor_board.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "controller_pose.h"

namespace knee_robot::nodes {
namespace {

constexpr double kLifetime = 1.0;  // s: what is not drawn any more goes by itself
constexpr double kLine = 0.058, kLetters = 0.036, kBarLength = 0.30, kBarHeight = 0.026;  // m
constexpr double kNameWidth = 0.20, kValueWidth = 0.17;                                   // m

}  // namespace

geometry_msgs::Point pointOf(const mechanism::Vector3& p) {
  geometry_msgs::Point point;
  point.x = p.x();
  point.y = p.y();
  point.z = p.z();
  return point;
}

visualization_msgs::Marker& Scene::add(const std::string& subject, int type, const Color& color) {
  const auto number = std::count_if(out_.markers.begin(), out_.markers.end(),
                                    [&](const visualization_msgs::Marker& marker) { return marker.ns == subject; });
  visualization_msgs::Marker marker;
  marker.header.frame_id = kBaseFrame;
  marker.ns = subject;
  marker.id = static_cast<int>(number);
  marker.type = type;
  marker.action = visualization_msgs::Marker::ADD;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color.r = color.r;
  marker.color.g = color.g;
  marker.color.b = color.b;
  marker.color.a = color.a;
  marker.lifetime = ros::Duration(kLifetime);
  out_.markers.push_back(marker);
  return out_.markers.back();
}

void Scene::text(const std::string& subject, const std::string& words, const mechanism::Vector3& at, double height,
                 const Color& color) {
  visualization_msgs::Marker& marker = add(subject, visualization_msgs::Marker::TEXT_VIEW_FACING, color);
  marker.pose.position = pointOf(at);
  marker.scale.z = height;
  marker.text = words;
}

void Scene::box(const std::string& subject, const mechanism::Vector3& corner, const mechanism::Vector3& opposite,
                const Color& color) {
  visualization_msgs::Marker& marker = add(subject, visualization_msgs::Marker::CUBE, color);
  marker.pose.position = pointOf(0.5 * (corner + opposite));
  const mechanism::Vector3 size = (opposite - corner).cwiseAbs().cwiseMax(1e-4);
  marker.scale.x = size.x();
  marker.scale.y = size.y();
  marker.scale.z = size.z();
}

void Board::title(const std::string& subject, const std::string& words) {
  const double middle = 0.5 * (kNameWidth + kBarLength + kValueWidth);
  scene_.text(subject, words, at_ - mechanism::Vector3(middle, 0.0, 0.0), kLetters, kInk);
  at_.z() -= kLine;
}

void Board::bar(const std::string& subject, const std::string& name, double share, const std::string& value,
                const Color& color) {
  const double length = kBarLength * std::clamp(std::isfinite(share) ? share : 0.0, 0.0, 1.0);
  const mechanism::Vector3 begin = at_ - mechanism::Vector3(kNameWidth, 0.0, 0.0), half(0.0, 0.004, 0.5 * kBarHeight);
  scene_.text(subject, name, at_ - mechanism::Vector3(0.5 * kNameWidth - 0.01, 0.0, 0.0), kLetters, kInk);
  scene_.box(subject, begin - half, begin + half / 3.0 - mechanism::Vector3(kBarLength, 0.0, 0.0), kTrack);
  scene_.box(subject, begin - half, begin + half - mechanism::Vector3(length, 0.0, 0.0), color);
  scene_.text(subject, value, at_ - mechanism::Vector3(kNameWidth + kBarLength + 0.5 * kValueWidth, 0.0, 0.0), kLetters,
              kInk);
  at_.z() -= kLine;
}

std::string fixedNumber(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  const bool zero = std::string(text).find_first_of("123456789in") == std::string::npos;
  return zero && text[0] == '-' ? text + 1 : text;
}

std::string wrapped(const std::string& words, std::size_t width) {
  std::istringstream in(words);
  std::string out, word;
  std::size_t column = 0;
  while (in >> word) {
    if (column > 0 && column + 1 + word.size() > width) {
      out += '\n';
      column = 0;
    } else if (column > 0) {
      out += ' ';
      ++column;
    }
    out += word;
    column += word.size();
  }
  return out;
}

}  // namespace knee_robot::nodes
