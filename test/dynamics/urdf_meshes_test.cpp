// What the URDFs draw: every mesh that they name is there, and is a body (closed, outward, finite, of a joint's or a
// plate's size).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "knee_robot/base/files.h"

namespace knee_robot::dynamics {
namespace {

using Point = std::array<float, 3>;
using Triangle = std::array<Point, 3>;

const std::string kSource = KNEE_SOURCE_DIR;

std::vector<Triangle> triangles(const std::string& path) {
  constexpr std::size_t kHead = 84, kRecord = 50;
  const std::string bytes = readFile(path);
  std::uint32_t count = 0;
  if (bytes.size() >= kHead) std::memcpy(&count, bytes.data() + 80, sizeof count);
  EXPECT_EQ(bytes.size(), kHead + kRecord * count) << path << " is no binary STL";
  EXPECT_NE(bytes.substr(0, 5), "solid") << path << " would be taken for a text STL";
  std::vector<Triangle> result;
  for (std::size_t k = 0; kHead + kRecord * (k + 1) <= bytes.size(); ++k) {
    Triangle triangle;
    std::memcpy(&triangle, bytes.data() + kHead + kRecord * k + 12, sizeof triangle);
    result.push_back(triangle);
  }
  return result;
}

double volume(const Triangle& t) {
  const auto& [a, b, c] = t;
  return (a[0] * (double(b[1]) * c[2] - double(b[2]) * c[1]) + a[1] * (double(b[2]) * c[0] - double(b[0]) * c[2]) +
          a[2] * (double(b[0]) * c[1] - double(b[1]) * c[0])) /
         6.0;
}

/// Volumes of the bodies that a mesh consists of: triangles that share points.
std::vector<double> volumes(const std::vector<Triangle>& mesh) {
  std::map<Point, Point> parent;
  const auto root = [&](Point p) {
    while (parent.emplace(p, p).first->second != p)
      p = parent[p];
    return p;
  };
  for (const Triangle& t : mesh)
    for (const Point& p : t)
      parent[root(p)] = root(t[0]);
  std::map<Point, double> sums;
  for (const Triangle& t : mesh)
    sums[root(t[0])] += volume(t);
  std::vector<double> result;
  for (const auto& [point, sum] : sums)
    result.push_back(sum);
  return result;
}

std::set<std::string> meshesOf(const std::string& robot) {
  const std::string text = readFile(kSource + "/urdf/" + robot + ".urdf");
  const std::regex name("<mesh filename=\"package://knee_robot/([^\"]*)\"");
  std::set<std::string> result;
  for (std::sregex_iterator found(text.begin(), text.end(), name), end; found != end; ++found)
    result.insert((*found)[1]);
  return result;
}

TEST(UrdfMeshes, ThatARobotNamesAreThere) {
  for (const char* robot : {"A", "B", "final", "starting"}) {
    const std::set<std::string> names = meshesOf(robot);
    EXPECT_GE(names.size(), 10U) << robot;
    for (const std::string& name : names)
      EXPECT_TRUE(std::filesystem::exists(kSource + "/" + name)) << robot << " names " << name;
  }
}

TEST(UrdfMeshes, AreNamedByARobot) {
  std::set<std::string> named = meshesOf("final");
  for (const auto& file : std::filesystem::directory_iterator(kSource + "/urdf/meshes"))
    EXPECT_EQ(named.count("urdf/meshes/" + file.path().filename().string()), 1U) << file.path();
}

TEST(UrdfMeshes, AreClosedBodiesOfASensibleSize) {
  for (const std::string& name : meshesOf("final")) {
    const std::vector<Triangle> mesh = triangles(kSource + "/" + name);
    ASSERT_FALSE(mesh.empty()) << name;
    std::map<std::pair<Point, Point>, int> edges;
    float reach = 0.0F;
    for (const Triangle& t : mesh) {
      for (int k = 0; k < 3; ++k) {
        ++edges[{t[k], t[(k + 1) % 3]}];
        --edges[{t[(k + 1) % 3], t[k]}];
        for (float coordinate : t[k]) {
          ASSERT_TRUE(std::isfinite(coordinate)) << name;
          reach = std::max(reach, std::abs(coordinate));
        }
      }
    }
    for (const auto& [edge, count] : edges)
      ASSERT_EQ(count, 0) << name << " has an open edge";
    for (double one : volumes(mesh))
      EXPECT_GT(one, 1e-7) << name << " has a body that is inside out, or a tenth of a cubic centimetre";
    EXPECT_GT(reach, 0.01F) << name;
    EXPECT_LE(reach, name == "urdf/meshes/disc.stl" ? 1.0F : 0.2F) << name << ": metres, not millimetres";
  }
}

}  // namespace
}  // namespace knee_robot::dynamics
