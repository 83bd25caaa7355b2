#include "knee_robot/dynamics/parameter_structure.h"

#include <gtest/gtest.h>

#include <set>

#include "knee_robot/mechanism/constraints.h"
#include "test/dynamics/random_robots.h"

namespace knee_robot::dynamics {
namespace {

const mechanism::Vector3 kGravity(0.0, 0.0, -9.81);

std::vector<mechanism::Motion> richMotions(const mechanism::Mechanism& mechanism, int count, unsigned seed) {
  mechanism::RandomPoses random(seed, 100.0);
  std::vector<mechanism::Motion> motions;
  for (int k = 0; k < count; ++k)
    motions.push_back(randomMotion(random, mechanism, 3.0, 20.0));
  return motions;
}

class Structure : public testing::TestWithParam<int> {
 protected:
  mechanism::Mechanism mechanism() const {
    return GetParam() == 0 ? mechanism::finalMechanism()
                           : (GetParam() == 1 ? mechanism::startingMechanism() : mechanism::mechanismB());
  }
};

TEST_P(Structure, HasTheNullColumnsOfThePapersTableTwo) {
  const ParameterStructure s =
      parameterStructure(observationMatrix(mechanism(), kGravity, richMotions(mechanism(), 100, 1)));
  const std::set<std::string> table = {"m_11",   "m_21",   "m_31",   "m_41",   "IXX_41", "IXY_41", "IXZ_41", "IYY_41",
                                       "IYZ_41", "IXX_42", "IXY_42", "IXZ_42", "IYZ_42", "IZZ_42", "mY_42",  "mZ_41"};
  std::set<std::string> found;
  for (const int column : s.null_columns)
    found.insert(paperParameterNames()[column]);
  EXPECT_EQ(found, table);
}

TEST_P(Structure, Has51RigidAnd22FrictionBaseParametersForRichMotion) {
  // Independent computation of the mechanism's structure: 51 + 22 = 73. (The paper's SVD kept 34 + 22 = 56.)
  const Eigen::MatrixXd w = observationMatrix(mechanism(), kGravity, richMotions(mechanism(), 300, 2));
  const ParameterStructure all = parameterStructure(w), rigid = parameterStructure(w.leftCols<kInertialParameters>());
  EXPECT_EQ(all.rank, 73);
  EXPECT_EQ(all.base.size(), 73u);
  EXPECT_EQ(rigid.rank, 51);
  // No doubt about the number: the 73rd singular value stands far above rounding, the 74th is rounding.
  EXPECT_GT(all.singular_values[72] / all.singular_values[0], 1e-3);
  EXPECT_LT(all.singular_values[73] / all.singular_values[0], 1e-13);
}

TEST_P(Structure, LumpsTheOtherColumnsIntoTheBaseColumns) {
  const std::vector<mechanism::Motion> motions = richMotions(mechanism(), 100, 3);
  const Eigen::MatrixXd w = observationMatrix(mechanism(), kGravity, motions);
  const ParameterStructure s = parameterStructure(w);
  // On other motions the base columns and the lumped parameters give the same forces as all 112.
  const Eigen::MatrixXd fresh = observationMatrix(mechanism(), kGravity, richMotions(mechanism(), 50, 4));
  const Eigen::VectorXd parameters = Eigen::VectorXd::LinSpaced(kPaperParameters, 0.5, 3.0);
  Eigen::VectorXd forces = Eigen::VectorXd::Zero(fresh.rows());
  for (int k = 0; k < s.rank; ++k) {
    forces += fresh.col(s.base[k]) * (parameters[s.base[k]] + s.lumping.row(k).dot(parameters));
  }
  EXPECT_LT((forces - fresh * parameters).norm(), 1e-9 * forces.norm());
}

TEST_P(Structure, SupportsFewerDirectionsOnASlowTrajectory) {
  // 20 s below 0.01 m/s, as the paper's: inertia is hardly excited.
  mechanism::RandomPoses random(5, 100.0);
  const mechanism::Mechanism m = mechanism();
  const mechanism::Pose start = random.pose(m);
  std::vector<mechanism::Motion> motions;
  for (double t = 0.0; t < 20.0; t += 0.1) {
    const mechanism::Vector4 size(0.004, 0.004, 0.01, 0.01), rate(1.0, 1.4, 0.7, 1.7);
    mechanism::Motion motion;
    for (int j = 0; j < 4; ++j) {
      motion.pose[j] = start[j] + size[j] * std::sin(rate[j] * t);
      motion.pose_velocity[j] = size[j] * rate[j] * std::cos(rate[j] * t);
      motion.pose_acceleration[j] = -size[j] * rate[j] * rate[j] * std::sin(rate[j] * t);
    }
    motions.push_back(motion);
  }
  const ParameterStructure slow = parameterStructure(observationMatrix(m, kGravity, motions));
  const ParameterStructure rich = parameterStructure(observationMatrix(m, kGravity, richMotions(m, 200, 9)));
  EXPECT_EQ(rich.supported(1e-4), 73);
  EXPECT_LT(slow.supported(1e-4), 60);
  EXPECT_EQ(slow.null_columns.size(), 16u);
}

INSTANTIATE_TEST_SUITE_P(EveryGeometry, Structure, testing::Values(0, 1, 2));

TEST(ParameterStructure, CountsWhatNoiseLeavesInNewtons) {
  // Two columns of 1 N and 0.01 N rms: 0.1 N of noise hides the second one, however it is scaled.
  Eigen::MatrixXd w(100, 2);
  for (int k = 0; k < 100; ++k)
    w.row(k) << (k % 2 ? 1.0 : -1.0), (k % 4 < 2 ? 0.01 : -0.01);
  EXPECT_EQ(distinguishable(w, Eigen::Vector2d(1.0, 1.0), 0.1), 1);
  EXPECT_EQ(distinguishable(w, Eigen::Vector2d(1.0, 100.0), 0.1), 2);
  EXPECT_EQ(distinguishable(w, Eigen::Vector2d(1.0, 1.0), 0.001), 2);
}

TEST(ParameterStructure, LumpsAsWorkedByHand) {
  // A leg's cylinder and rod turn together; rod i's mass sits at the platform's joint i: at leg 1 (-0.3, 0, 0) it adds
  // m_12 to m_M, 0.09 m_12 to IYY_M and IZZ_M, -0.3 m_12 to mX_M.
  const mechanism::Mechanism m = mechanism::finalMechanism();
  const ParameterStructure s = parameterStructure(observationMatrix(m, kGravity, richMotions(m, 200, 6)));
  std::set<std::string> texts;
  for (int k = 0; k < s.rank; ++k)
    texts.insert(combinationText(s, k, paperParameterNames()));
  for (const char* expected :
       {"IXX_12 + IXX_11", "IYY_12 + IZZ_11", "IZZ_12 + IYY_11", "IXY_12 - IXZ_11", "IXZ_12 + IXY_11",
        "IYZ_12 - IYZ_11", "IYY_42 + IZZ_41", "mX_11", "mZ_12", "IZZ_M + 0.09 m_12 + 0.09 m_22 + 0.09 m_32",
        "m_M + m_12 + m_22 + m_32 + m_42", "mX_M - 0.3 m_12 + 0.19284 m_22", "Fc_41"}) {
    EXPECT_EQ(texts.count(expected), 1u) << expected;
  }
}

TEST(ProjectedRegressor, EqualsThePapersProjectionThroughX) {
  // Eq. (19) and (24): K* = K_i - X^T K_d with X from the constraint Jacobian, against the projection through the pose.
  mechanism::RandomPoses random(7, 200.0);
  for (const mechanism::Mechanism& m :
       {mechanism::finalMechanism(), mechanism::startingMechanism(), mechanism::mechanismB()}) {
    for (int k = 0; k < 200; ++k) {
      const mechanism::Motion motion = randomMotion(random, m);
      RegressorData data;
      TreeRegressor k1;
      TreeFrictionRegressor k1f;
      treeRegressor(m, kGravity, motion, data, k1);
      treeFrictionRegressor(m, motion, data, k1f);
      ASSERT_TRUE(projectedRegressor(m, kGravity, motion, data));
      mechanism::DependentJacobian x;
      ASSERT_TRUE(mechanism::dependentJacobian(m, mechanism::coordinateMotion(m, motion).position, x));
      Eigen::Matrix<double, mechanism::kCoordinates, kPaperParameters> tree;
      tree << k1, k1f;
      Eigen::Matrix<double, mechanism::kLegs, kPaperParameters> expected;
      for (int i = 0; i < mechanism::kLegs; ++i)
        expected.row(i) = tree.row(mechanism::kIndependent[i]);
      for (int j = 0; j < mechanism::kConstraints; ++j)
        expected -= x.row(j).transpose() * tree.row(mechanism::kDependent[j]);
      EXPECT_LT((data.k - expected).norm(), 1e-10 * expected.norm());
    }
  }
}

TEST(ExtendedRegressor, PutsThePapersColumnsIntoTheirBlocks) {
  mechanism::RandomPoses random(8);
  const mechanism::Mechanism m = mechanism::finalMechanism();
  const mechanism::Motion motion = randomMotion(random, m);
  RegressorData data;
  ExtendedRegressor extended;
  ASSERT_TRUE(extendedRegressor(m, kGravity, motion, data, extended));
  const PaperParameters parameters = PaperParameters::LinSpaced(1.0, 5.0);
  EXPECT_LT((extended * toExtended(parameters) - data.k * parameters).norm(), 1e-10);
  const auto& names = extendedParameterNames();
  const std::set<std::string> unique(names.begin(), names.end());
  EXPECT_EQ(unique.size(), 120u);
  EXPECT_EQ(unique.count(""), 0u);
  EXPECT_EQ(names[extended::kPassiveFriction], "Fv_12");
  EXPECT_EQ(names[extended::kViscous + 3], "Fv_42");
  EXPECT_EQ(names[extended::kOffset], "offset_1");
  for (int i = 0; i < mechanism::kLegs; ++i)
    EXPECT_DOUBLE_EQ(extended(i, extended::kOffset + i), 1.0);
}

}  // namespace
}  // namespace knee_robot::dynamics
