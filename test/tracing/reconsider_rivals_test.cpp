// A name's rivals are asked for again beside all that was found.
#include "src/tracing/library.h"
#include "src/tracing/refit.h"
#include "src/tracing/rivals.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class ReconsiderRivals : public SearchedMachine {
 protected:
  ReconsiderRivals() {
    for (auto& candidate : namedCandidates(robot_)) {
      const std::string name = candidate->name();
      if (name == "force_gain" || name == "delay" || name == "drive_lag") few_.push_back(std::move(candidate));
    }
    library_.add(few_, data_);
    search_.library = &library_;
    search_.options = &options_;
    search_.floor.rms_N = search_.floor.of_names_N = base_.noise_N;
  }
  Hypothesis of(const std::string& name) const {
    for (const PlaceColumns& p : library_.places()) {
      if (p.place().candidate->name() == name && p.place().actuator == kActuator) return p.tried[p.tried.size() / 2];
    }
    return {};
  }
  /// What is said in the end of a name that was found with a rival.
  FoundEffect said(const std::string& name, const std::string& rival) {
    FoundEffect e;
    e.hypothesis = of(name);
    e.p = 0.004;
    e.probability = 0.6;
    e.indistinguishable_from = {rival};
    search_.effects = {e};
    refit(search_);
    reconsiderRivals(search_);
    return search_.effects.front();
  }

  const TraceOptions options_;
  Library library_;

 private:
  CandidateList few_;
};

TEST_F(ReconsiderRivals, FindsNoneWhereItFitsMuchWorse) {
  add(effectRows(data_, of("force_gain")) * 0.2);
  const FoundEffect gain = said("force_gain", "delay");
  EXPECT_TRUE(gain.indistinguishable_from.empty());
  EXPECT_GT(gain.probability, 0.95);
}

TEST_F(ReconsiderRivals, FindsTheOneThatFitsAsWell) {
  add(effectRows(data_, of("delay")).col(0));
  const FoundEffect late = said("delay", "force_gain");
  EXPECT_EQ(late.indistinguishable_from, std::vector<std::string>{"drive_lag"});
}

TEST_F(ReconsiderRivals, AsksNothingOfAGivenModel) {
  add(effectRows(data_, of("force_gain")) * 0.2);
  FoundEffect given;
  given.hypothesis = of("force_gain");
  given.p = std::nan("");
  given.indistinguishable_from = {"delay"};
  search_.effects = {given};
  refit(search_);
  reconsiderRivals(search_);
  EXPECT_EQ(search_.effects.front().indistinguishable_from, std::vector<std::string>{"delay"});
}

}  // namespace
}  // namespace knee_robot::tracing
