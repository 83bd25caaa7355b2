// paper_findings: computes what this project found out about its paper, and prints it with the numbers.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/parameter_structure.h"
#include "knee_robot/mechanism/singularity.h"
#include "knee_robot/trajectory/pose_limits.h"
#include "program.h"

using namespace knee_robot;

namespace {

void title(const char* text) {
  std::printf("\n%s\n", text);
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * (values.size() - 1))];
}

/// A pose drawn evenly from a box that holds the workspace of both geometries (m, 34 deg).
mechanism::Pose randomPose(std::mt19937& engine) {
  const auto uniform = [&engine](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  return {uniform(-0.3, 0.4), uniform(0.3, 0.95), uniform(-0.6, 0.6), uniform(-0.6, 0.6)};
}

/// Conditions of dq/dx at random poses whose lengths are within the robot's limits.
std::vector<double> conditionsWithinLengths(const mechanism::Robot& robot) {
  std::mt19937 engine(1);
  std::vector<double> conditions;
  while (conditions.size() < 20000) {
    const mechanism::Pose pose = randomPose(engine);
    const mechanism::Lengths lengths = mechanism::legLengths(*robot.mechanism, pose);
    bool within = true;
    for (int i = 0; i < mechanism::kLegs; ++i) {
      within =
          within && lengths[i] >= robot.actuators[i].position_min_m && lengths[i] <= robot.actuators[i].position_max_m;
    }
    if (within) conditions.push_back(mechanism::conditionNumber(*robot.mechanism, pose));
  }
  return conditions;
}

/// The random pose that keeps furthest from all of the robot's limits.
mechanism::Pose roomiestPose(const mechanism::Robot& robot) {
  std::mt19937 engine(4);
  mechanism::Pose best = mechanism::Pose::Zero();
  double left = -1e300;
  for (int k = 0; k < 20000; ++k) {
    const mechanism::Pose pose = randomPose(engine);
    const trajectory::Margin margin = trajectory::nearestLimit(robot, pose, robot.singularity_condition_max);
    if (margin.left > left) {
      left = margin.left;
      best = pose;
    }
  }
  return best;
}

void startingGeometry(const mechanism::Robot& starting, const mechanism::Robot& final_robot) {
  title("1. The limits of eq. (31) belong to the starting geometry of Table 1, which is close to singular there");
  std::printf("   shortest leg 1 of eq. (31): 0.4257 m; sqrt(0.2^2 + 0.3758^2) = %.4f m: level, Z = shortest leg 4\n",
              std::hypot(0.2, 0.3758));
  double low = 1e300, high = 0.0;
  for (double z = 0.3758; z <= 0.57531; z += 0.0005) {
    const double condition = mechanism::conditionNumber(*starting.mechanism, mechanism::Pose(0.0, z, 0.0, 0.0));
    low = std::min(low, condition);
    high = std::max(high, condition);
  }
  std::printf("   condition of dq/dx (m, rad) level over all of that range: %.1f to %.1f\n", low, high);
  const std::vector<double> conditions = conditionsWithinLengths(final_robot);
  std::printf(
      "   final geometry, 20000 random poses (X -0.3..0.4 m, angles up to 34 deg) with lengths 0.6 to 0.9 m: median "
      "%.1f, "
      "90th percentile %.0f\n",
      percentile(conditions, 0.5), percentile(conditions, 0.9));
}

void printedPoint() {
  title("2. The printed singular point is neither column of Table 1");
  const mechanism::Mechanism m(
      {{0.3, 0.3, 0.3}, 0.0, 50 * kDegree, 40 * kDegree, {0.2, 0.2, 0.2}, 40 * kDegree, 30 * kDegree});
  const mechanism::Pose pose(0.0, 0.2, 0.0, 0.0);
  const mechanism::Lengths q = mechanism::legLengths(m, pose);
  std::printf("   printed:                               0.2236067977 0.2276468090 0.2276468089 0.2000000000\n");
  std::printf("   R = 0.3, Rm = 0.2, starting angles, ds = 0, level at Z = 0.2: %.10f %.10f %.10f %.10f\n", q[0], q[1],
              q[2], q[3]);
  const mechanism::Singularity s = mechanism::singularityAt(m, pose);
  std::printf("   there det J = %.2e, condition %.0f\n", s.determinant, s.condition);
}

void exercises(const mechanism::Robot& robot, const char* name) {
  title((std::string("3. The paper's exercises in the ") + name + " geometry").c_str());
  struct Movement {
    const char* what;
    int axis;
    double from, to;
  };
  const double z0 = std::string(name) == "final" ? 0.6 : 0.3758, middle = z0 + 0.1;
  const Movement movements[] = {{"hip flexion: Z by 0.2 m", 1, z0, z0 + 0.2},
                                {"knee flexion: X to 0.2 m", 0, 0.0, 0.2},
                                {"knee extension: X to -0.11 m", 0, 0.0, -0.11},
                                {"knee rotation: psi to 15 deg", 3, 0.0, 15 * kDegree},
                                {"knee rotation: psi to -15 deg", 3, 0.0, -15 * kDegree},
                                {"ankle: theta to 30 deg", 2, 0.0, 30 * kDegree},
                                {"ankle: theta to -30 deg", 2, 0.0, -30 * kDegree}};
  std::printf("   X = 0, Z = %.4g m, level, one coordinate moved (%%: how far it gets before the first limit)\n",
              middle);
  for (const Movement& movement : movements) {
    for (const double spherical : {30.0, 50.0}) {
      mechanism::Robot limits = robot;
      limits.joints.spherical_max = spherical * kDegree;
      double reached = 0.0;
      std::string obstacle = "fits";
      mechanism::Pose pose(0.0, middle, 0.0, 0.0);
      for (int k = 0; k <= 200; ++k) {
        pose[movement.axis] = movement.from + (movement.to - movement.from) * k / 200.0;
        const trajectory::Margin margin = trajectory::nearestLimit(limits, pose, robot.singularity_condition_max);
        if (margin.left < -1e-9) {
          obstacle = trajectory::limitText(margin);
          break;
        }
        reached = k / 2.0;
      }
      std::printf("   %-31s spherical %2.0f deg: %5.1f %%  %s\n", movement.what, spherical, reached, obstacle.c_str());
    }
  }
  std::printf("   condition at theta = -30 deg, Z = 0.7 m: %.0f\n",
              mechanism::conditionNumber(*robot.mechanism, mechanism::Pose(0.0, 0.7, -30 * kDegree, 0.0)));
  const mechanism::Lengths low = mechanism::legLengths(*robot.mechanism, mechanism::Pose(0.0, z0, 0.0, 0.0)),
                           high = mechanism::legLengths(*robot.mechanism, mechanism::Pose(0.0, z0 + 0.2, 0.0, 0.0));
  std::printf("   stroke that Z by 0.2 m needs: %.0f %.0f %.0f %.0f mm (type code 100 mm, text 300 mm)\n",
              1e3 * (high - low)[0], 1e3 * (high - low)[1], 1e3 * (high - low)[2], 1e3 * (high - low)[3]);
}

/// Rich motion: independent random poses, velocities and accelerations.
std::vector<mechanism::Motion> richMotion(const mechanism::Mechanism& mechanism) {
  std::mt19937 engine(2);
  const auto uniform = [&engine](double size) { return std::uniform_real_distribution<double>(-size, size)(engine); };
  std::vector<mechanism::Motion> motions;
  while (motions.size() < 300) {
    mechanism::Motion m;
    m.pose = mechanism::Pose(uniform(0.15), 0.65 + uniform(0.15), uniform(0.4), uniform(0.4));
    for (int j = 0; j < 4; ++j) {
      m.pose_velocity[j] = uniform(3.0);
      m.pose_acceleration[j] = uniform(20.0);
    }
    if (mechanism::conditionNumber(mechanism, m.pose) < 100.0) motions.push_back(m);
  }
  return motions;
}

/// 20 s of 7 harmonics sampled every 0.1 s as in section 2.1.5, in platform coordinates around `center`, its size
/// scaled until the fastest actuator moves at `speed` (or the condition would exceed `condition_max`).
std::vector<mechanism::Motion> fourierMotion(const mechanism::Mechanism& mechanism, const mechanism::Pose& center,
                                             double speed, double condition_max, unsigned seed) {
  constexpr int kHarmonics = 7;
  constexpr double kDuration = 20.0, kStep = 0.1;
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  double sine[4][kHarmonics], cosine[4][kHarmonics];
  for (auto& row : sine)
    for (double& v : row)
      v = normal(engine);
  for (auto& row : cosine)
    for (double& v : row)
      v = normal(engine);
  const mechanism::Vector4 unit(1.0, 1.0, 4.0, 4.0);  // 1 m against 4 rad
  const auto motionAt = [&](double t, double scale) {
    mechanism::Motion m;
    m.pose = center;
    for (int j = 0; j < 4; ++j) {
      for (int k = 0; k < kHarmonics; ++k) {
        const double w = kTwoPi * (k + 1) / kDuration, a = scale * unit[j] / (k + 1), s = std::sin(w * t),
                     c = std::cos(w * t);
        m.pose[j] += a * (sine[j][k] * s + cosine[j][k] * c);
        m.pose_velocity[j] += a * w * (sine[j][k] * c - cosine[j][k] * s);
        m.pose_acceleration[j] -= a * w * w * (sine[j][k] * s + cosine[j][k] * c);
      }
    }
    return m;
  };
  const auto fits = [&](double scale) {
    for (double t = 0.0; t < kDuration; t += kStep) {
      const mechanism::Motion m = motionAt(t, scale);
      const mechanism::Vector4 rate = mechanism::lengthJacobian(mechanism, m.pose) * m.pose_velocity;
      if (rate.cwiseAbs().maxCoeff() > speed || mechanism::conditionNumber(mechanism, m.pose) > condition_max)
        return false;
    }
    return true;
  };
  double scale = 1.0;
  while (!fits(scale))
    scale *= 0.9;
  std::vector<mechanism::Motion> motions;
  for (double t = 0.0; t < kDuration; t += kStep)
    motions.push_back(motionAt(t, scale));
  return motions;
}

/// Sizes that one would not be surprised by: kg m^2, kg m, kg; N s/m and N along, N m s and N m about.
Eigen::VectorXd typicalSizes() {
  Eigen::VectorXd sizes(dynamics::kPaperParameters);
  for (int link = 0; link < dynamics::kLinks; ++link) {
    sizes.segment<6>(10 * link).setConstant(0.1);
    sizes.segment<3>(10 * link + 6).setConstant(0.3);
    sizes[10 * link + 9] = 1.0;
  }
  for (int k = 0; k < dynamics::kFrictionParameters; ++k) {
    const std::string& name = dynamics::frictionParameterNames()[k];
    const bool along = name.back() == '3' || name == "Fv_42" || name == "Fc_42";
    sizes[dynamics::kInertialParameters + k] = along ? (name[1] == 'v' ? 500.0 : 20.0) : 0.5;
  }
  return sizes;
}

/// How many directions of the parameters a trajectory supports, in newtons per typical size: Coulomb columns count
/// fully at any speed, inertia hardly at 0.01 m/s.
void trajectoryCount(const mechanism::Robot& robot, const mechanism::Pose& center, double speed, double noise) {
  const mechanism::Mechanism& m = *robot.mechanism;
  const std::vector<mechanism::Motion> motions =
      fourierMotion(m, center, speed, std::max(60.0, robot.singularity_condition_max), 3);
  double fastest = 0.0;
  for (const mechanism::Motion& motion : motions) {
    fastest =
        std::max(fastest, (mechanism::lengthJacobian(m, motion.pose) * motion.pose_velocity).cwiseAbs().maxCoeff());
  }
  const Eigen::MatrixXd w = dynamics::observationMatrix(m, robot.gravity, motions);
  const Eigen::MatrixXd rigid = w.leftCols<dynamics::kInertialParameters>();
  const Eigen::VectorXd sizes = typicalSizes(), rigid_sizes = sizes.head<dynamics::kInertialParameters>();
  const double averaged = noise / std::sqrt(double(w.rows()));
  std::printf(
      "   20 s of 7 harmonics, fastest actuator %.3f m/s: %d (rigid alone %d) change the forces by more than %.2f N "
      "rms;\n",
      fastest, dynamics::distinguishable(w, sizes, noise), dynamics::distinguishable(rigid, rigid_sizes, noise), noise);
  std::printf(
      "     least squares over all %d equations with white noise of that size finds %d (rigid alone %d) better than "
      "their typical size\n",
      int(w.rows()), dynamics::distinguishable(w, sizes, averaged),
      dynamics::distinguishable(rigid, rigid_sizes, averaged));
}

void parameterCounts(const mechanism::Robot& robot, const char* name) {
  title((std::string("4. Base parameters of the ") + name + " geometry (the paper: 16 null columns, 34 + 22 = 56)")
            .c_str());
  const mechanism::Mechanism& m = *robot.mechanism;
  const Eigen::MatrixXd w = dynamics::observationMatrix(m, robot.gravity, richMotion(m));
  const dynamics::ParameterStructure all = dynamics::parameterStructure(w),
                                     rigid = dynamics::parameterStructure(w.leftCols<dynamics::kInertialParameters>());
  std::printf("   null columns: %zu:", all.null_columns.size());
  for (const int column : all.null_columns)
    std::printf(" %s", dynamics::paperParameterNames()[column].c_str());
  std::printf("\n   structural number for rich motion: %d rigid + %d friction = %d\n", rigid.rank,
              all.rank - rigid.rank, all.rank);
  std::printf("   relative singular values %d and %d: %.1e and %.1e\n", all.rank, all.rank + 1,
              all.singular_values[all.rank - 1] / all.singular_values[0],
              all.singular_values[all.rank] / all.singular_values[0]);
  const mechanism::Pose center = roomiestPose(robot);
  constexpr double kNoise = 0.28;  // N: one DAC step
  for (const double speed : {0.01, 0.2})
    trajectoryCount(robot, center, speed, kNoise);
  if (std::string(name) != "final") return;
  std::printf("   what is lumped into what (the others stand alone):\n");
  for (int k = 0; k < all.rank; ++k) {
    const std::string text = dynamics::combinationText(all, k, dynamics::paperParameterNames());
    if (text.find(' ') != std::string::npos) std::printf("     %s\n", text.c_str());
  }
}

void percentages() {
  title("5. The percentages of Tables 3 and 4 have no stated denominator; what they would be percentages of (N)");
  const double error[2][4] = {{0.2918, 0.0957, 0.4196, 0.6259}, {0.5050, 0.1805, 1.1703, 1.4822}};
  const double percent[2][4] = {{1.869, 0.696, 1.457, 0.847}, {3.458, 4.492, 14.537, 15.806}};
  const char* names[2] = {"identification", "verification"};
  for (int row = 0; row < 2; ++row) {
    std::printf("   %-15s", names[row]);
    for (int leg = 0; leg < 4; ++leg)
      std::printf(" leg %d: %.1f", leg + 1, 100.0 * error[row][leg] / percent[row][leg]);
    std::printf("\n");
  }
  std::printf("   Leg 4 carries the platform in both. This project prints rms/rms and rms/range.\n");
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app("Computes and prints the findings about the paper (docs/paper.md).", "paper_findings");
  std::string final_file, starting_file;
  app.option("--final", final_file, "robot file of the final geometry (config/robots/final.yaml)").required();
  app.option("--starting", starting_file, "robot file of the starting geometry (config/robots/starting.yaml)")
      .required();
  return nodes::runProgram(app, argc, argv, [&] {
    const mechanism::Robot final_robot = mechanism::loadRobot(final_file),
                           starting = mechanism::loadRobot(starting_file);
    if (!final_robot.mechanism || !starting.mechanism) throw InputError("both robot files must describe a 3UPS+1RPU");
    startingGeometry(starting, final_robot);
    printedPoint();
    exercises(final_robot, "final");
    exercises(starting, "starting");
    parameterCounts(final_robot, "final");
    parameterCounts(starting, "starting");
    percentages();
    return kExitDone;
  });
}
