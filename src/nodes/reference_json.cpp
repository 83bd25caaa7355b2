#include "reference_json.h"

#include <algorithm>

namespace knee_robot::nodes {
namespace {

constexpr Eigen::Index kMostPoints = 300;

nlohmann::json pathJson(const trajectory::Reference& reference, const trajectory::ReferenceCheck& check) {
  const Eigen::Index rows = check.lengths.rows();
  if (rows == 0) return nullptr;
  const Eigen::Index count = std::min(rows, kMostPoints);
  nlohmann::json time = nlohmann::json::array(), lengths = time, pose = time;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index k = count == 1 ? 0 : i * (rows - 1) / (count - 1);  // the first and the last point, too
    time.push_back(static_cast<double>(k) * reference.period_s);
    lengths.push_back({check.lengths(k, 0), check.lengths(k, 1), check.lengths(k, 2), check.lengths(k, 3)});
    if (k < check.poses.rows())
      pose.push_back({check.poses(k, 0), check.poses(k, 1), check.poses(k, 2), check.poses(k, 3)});
  }
  return {
      {"time_s", time}, {"lengths", lengths}, {"pose", pose.size() == time.size() ? pose : nlohmann::json::array()}};
}

}  // namespace

nlohmann::json referenceJson(const trajectory::Reference& reference, const trajectory::ReferenceCheck& check) {
  nlohmann::json margins = nlohmann::json::array();
  for (const trajectory::Margin& margin : check.margins) {
    margins.push_back({{"quantity", nameOf(margin.quantity)},
                       {"value", margin.value},
                       {"limit", margin.limit},
                       {"unit", unitOf(margin.quantity)},
                       {"left", margin.left},
                       {"line", margin.line},
                       {"actuator", margin.actuator}});
  }
  nlohmann::json violation;
  if (check.violation) violation = check.violation->sentence;
  return {{"points", reference.points.rows()},
          {"duration_s", static_cast<double>(reference.points.rows() - 1) * reference.period_s},
          {"margins", margins},
          {"violation", violation},
          {"path", pathJson(reference, check)}};
}

}  // namespace knee_robot::nodes
