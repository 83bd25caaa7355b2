// A hat of a map acts at one place: what a left-out block leaves of it says nothing about its height.
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class LeftOutHat : public SearchedMachine {};

TEST_F(LeftOutHat, IsNotSetByARemnantOfItsSamples) {
  const std::unique_ptr<Candidate> map = mapCandidate(robot_, "pose_x_m", kActuator, {0, 1, 2, 3, 4, 5, 6, 7});
  const Eigen::Index first = kActuator * data_.stack.size();
  Eigen::MatrixXd hats = Eigen::MatrixXd::Zero(data_.base_rows.rows(), 8);
  bool remnant = false;
  for (int row = 0; row < data_.stack.size(); ++row) {
    const int block = data_.stack.picks[static_cast<std::size_t>(row)].block;
    hats(first + row, 1 + row % 7) = 1.0;  // all but the first act everywhere
    if (block == 0) hats(first + row, 0) = 1.0;
    if (block != 0 && !remnant) {
      hats(first + row, 0) = 1e-4;
      remnant = true;
    }
  }
  ASSERT_TRUE(remnant);
  const JointFit without = JointProblem(data_, base_, base_.noise_N, {}, {}).fit();
  const JointFit with = JointProblem(data_, base_, base_.noise_N, {{{map.get(), kActuator}, {}}}, {hats}).fit();
  EXPECT_LT(with.held_back[0], 2.0 * without.held_back[0]);
}

}  // namespace
}  // namespace knee_robot::tracing
