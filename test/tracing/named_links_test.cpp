// What relaxes or yields between base and platform is named on the simulated robot.
#include "test/tracing/simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

const FoundEffect* namedLink(const TracedCase& c, const std::string& name) {
  for (const FoundEffect& e : c.result.effects) {
    const Candidate& candidate = *e.hypothesis.place.candidate;
    std::cout << candidate.name() << " " << candidate.dependsOn(0) << " on " << e.hypothesis.place.actuator + 1 << ":";
    for (const double number : e.hypothesis.shape)
      std::cout << " " << number;
    std::cout << "; " << e.coefficients.transpose() << (e.doubted ? ", doubted\n" : "\n");
  }
  for (const std::string& note : c.result.notes)
    std::cout << note << "\n";
  std::cout << "error " << c.before_N.transpose() << " -> " << c.after_N.transpose() << " N\n";
  for (const FoundEffect& e : c.result.effects) {
    if (e.hypothesis.place.candidate->name() == name) return &e;
  }
  return nullptr;
}

/// Of legs 1 to 3: what leg 4 leaves is its stiction.
double ofThreeLegs(const Eigen::VectorXd& error_N) {
  return error_N.head(3).norm();
}

TEST(Trace, NamesASpringThatRelaxesBetweenBaseAndPlatform) {
  const TracedCase c = traceSimulated(
      "  - {name: viscoelastic_link, stiffness_N_per_m: 1500, relaxation_s: 1, anchor_m: [0.2, 0.3, 0], "
      "point_m: [0.2, 0.2, 0]}\n");
  const FoundEffect* link = namedLink(c, "viscoelastic_link");
  ASSERT_NE(link, nullptr);
  EXPECT_NEAR(link->coefficients[0], 1500.0, 300.0);
  EXPECT_NEAR(link->hypothesis.shape[4], 1.0, 0.2);
  EXPECT_LT(ofThreeLegs(c.after_N), 0.6 * ofThreeLegs(c.before_N));
}

TEST(Trace, NamesACableThatYieldsBetweenBaseAndPlatform) {
  const TracedCase c = traceSimulated(
      "  - {name: elastoplastic_link, yield_N: 40, yield_m: 0.005, anchor_m: [0.2, 0.3, 0], "
      "point_m: [0.2, 0.2, 0]}\n");
  const FoundEffect* link = namedLink(c, "elastoplastic_link");
  ASSERT_NE(link, nullptr);
  EXPECT_NEAR(link->coefficients[0], 40.0, 10.0);
  EXPECT_NEAR(link->hypothesis.shape[5], 0.005, 0.003);
  EXPECT_LT(ofThreeLegs(c.after_N), 0.6 * ofThreeLegs(c.before_N));
}

TEST(Trace, NamesARopeThatRubsOnAPulleyAboveThePlatform) {
  const TracedCase c = traceSimulated(
      "  - {name: line_friction, friction_N: 30, proportional_below_m_per_s: 0.004, anchor_m: [0, 0.1, 1.8], "
      "point_m: [0.1, -0.1, 0]}\n",
      [](recording::Recording&) {}, {1, 3});
  const FoundEffect* rope = namedLink(c, "line_friction");
  ASSERT_NE(rope, nullptr);
  EXPECT_NEAR(rope->coefficients[0], 30.0, 3.0);
  EXPECT_LT(ofThreeLegs(c.after_N), 0.6 * ofThreeLegs(c.before_N));
}

TEST(Trace, NamesAJointThatDampsAndYields) {
  const TracedCase c = traceSimulated(
      "  - {name: passive_joint, coordinate: theta, width_rad: 0.1, towards_positive_Nm: 3, towards_negative_Nm: 3, "
      "damping_Nm_s_per_rad: 12, yield_Nm: 4, yield_rad: 0.03}\n");
  const FoundEffect* joint = namedLink(c, "passive_joint");
  ASSERT_NE(joint, nullptr);
  EXPECT_EQ(joint->hypothesis.shape[0], 2.0) << "theta";
  EXPECT_NEAR(joint->hypothesis.shape[1], 0.1, 0.02);
  EXPECT_NEAR(joint->coefficients[2], 12.0, 2.0);
  EXPECT_NEAR(joint->coefficients[3], 4.0, 1.0);
  EXPECT_NEAR(joint->hypothesis.shape[2], 0.03, 0.01);
  EXPECT_LT(ofThreeLegs(c.after_N), 0.5 * ofThreeLegs(c.before_N));
}

TEST(Trace, NamesAHoseThatGoesTautBetweenTwoLegs) {
  const TracedCase c = traceSimulated(
      "  - {name: link_between_legs, first_leg: 1, second_leg: 3, between: lengths, acts_from_m: 0.0, side: longer, "
      "stiffness_N_per_m: 300, damping_N_s_per_m: 60}\n",
      [](recording::Recording&) {}, {1, 3});
  const FoundEffect* hose = namedLink(c, "link_between_legs");
  ASSERT_NE(hose, nullptr);
  EXPECT_EQ(hose->hypothesis.shape[0], 1.0);
  EXPECT_EQ(hose->hypothesis.shape[1], 3.0);
  EXPECT_EQ(hose->hypothesis.shape[2], 0.0);
  EXPECT_LT(ofThreeLegs(c.after_N), 0.6 * ofThreeLegs(c.before_N));
}

}  // namespace
}  // namespace knee_robot::tracing
