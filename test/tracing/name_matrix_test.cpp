// A matrix over the platform's velocity has no name; a damper that does as well has one.
#include <algorithm>

#include "src/tracing/library.h"
#include "src/tracing/refit.h"
#include "src/tracing/replace_kin.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

const std::vector<double> kDamper = {0.1, 0.15, 0.0, 0.1, 1.0};

class NameMatrix : public SearchedMachine {
 protected:
  NameMatrix() {
    for (auto& candidate : namedCandidates(robot_)) {
      if (candidate->name() == "dashpot") dampers_.push_back(std::move(candidate));
    }
    library_.add(dampers_, data_);
    search_.library = &library_;
  }
  Hypothesis damper() const { return {{dampers_.front().get(), -1}, kDamper}; }
  Hypothesis matrix() const { return {{matrix_.get(), -1}, {}}; }
  /// A wheel that spins on the platform: theta's moment by psi's rate, and the other way.
  Eigen::VectorXd wheel(double momentum_Nms) const {
    Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(16);
    coefficients[11] = momentum_Nms;
    coefficients[14] = -momentum_Nms;
    return effectRows(data_, matrix()) * coefficients;
  }
  void found(const Hypothesis& h) {
    FoundEffect e;
    e.hypothesis = h;
    e.p = 0.004;
    search_.effects.push_back(e);
    refit(search_);
  }
  std::vector<std::string> left() const {
    std::vector<std::string> names;
    for (const FoundEffect& e : search_.effects)
      names.push_back(e.hypothesis.place.candidate->name());
    return names;
  }

  const std::unique_ptr<Candidate> matrix_ = mapCandidate(robot_, "platform_velocity", 0, {});
  Library library_;

 private:
  CandidateList dampers_;
};

TEST_F(NameMatrix, ADamperThatDoesAsWellTakesItsPlace) {
  add(effectRows(data_, damper()) * Eigen::VectorXd::Constant(1, 200.0));
  found(matrix());
  nameMatrix(search_, matrix().place);
  EXPECT_EQ(left(), std::vector<std::string>{"dashpot"});
  EXPECT_EQ(search_.taken_out.size(), 1u);
  EXPECT_NEAR(search_.effects.front().coefficients[0], 200.0, 20.0);
  EXPECT_LT(search_.rms_N.cwiseQuotient(base_.noise_N).maxCoeff(), 1.3);
}

TEST_F(NameMatrix, AWheelThatSpinsStaysWithoutAName) {
  add(wheel(20.0));
  found(matrix());
  nameMatrix(search_, matrix().place);
  EXPECT_EQ(left(), std::vector<std::string>{"unnamed"});
  EXPECT_TRUE(search_.taken_out.empty());
}

}  // namespace
}  // namespace knee_robot::tracing
