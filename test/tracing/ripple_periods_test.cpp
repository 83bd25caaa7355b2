// Further ripples of an actuator are other periods, not the first one with an amplitude that changes along the way.
#include "src/tracing/ripple_periods.h"

#include <cmath>

#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class RipplePeriods : public SearchedMachine {
 protected:
  Hypothesis ripple(double turns, int order) const {
    Hypothesis h = named("screw_ripple", {way_m_ / turns, 0.0});
    h.place.order = order;
    return h;
  }
  void found(const std::vector<double>& turns) {
    for (std::size_t k = 0; k < turns.size(); ++k) {
      FoundEffect e;
      e.hypothesis = ripple(turns[k], static_cast<int>(k));
      search_.effects.push_back(e);
    }
  }
  double way() const {
    double low = 1.0, high = 0.0;
    for (const EffectInput& input : data_.inputs) {
      low = std::min(low, input.signals().position_m.col(kActuator).minCoeff());
      high = std::max(high, input.signals().position_m.col(kActuator).maxCoeff());
    }
    return high - low;
  }
  const double way_m_ = way();
};

TEST_F(RipplePeriods, WithinTwoTurnsAlongTheWayAreOne) {
  found({10.0});
  EXPECT_TRUE(periodCoincides(search_, ripple(11.9, 1)));
  EXPECT_TRUE(periodCoincides(search_, ripple(8.1, 1)));
  EXPECT_FALSE(periodCoincides(search_, ripple(12.1, 1)));
  EXPECT_FALSE(periodCoincides(search_, ripple(7.9, 1)));
  EXPECT_FALSE(periodCoincides(search_, ripple(10.0, 0))) << "itself";
  EXPECT_FALSE(periodCoincides(search_, named("stribeck", {0.01, 2.0, 0.0}))) << "has no period";
}

TEST_F(RipplePeriods, OfWhichOneIsAnOrderOfTheOtherNeedOneTurnOnly) {
  found({1.6});
  EXPECT_FALSE(periodCoincides(search_, ripple(3.2, 1))) << "the second order is no side lobe";
  EXPECT_FALSE(periodCoincides(search_, ripple(3.0, 1)));
  EXPECT_TRUE(periodCoincides(search_, ripple(2.8, 1)));
  EXPECT_TRUE(periodCoincides(search_, ripple(0.8, 1))) << "not a whole turn apart";
  search_.effects.clear();
  found({1.6, 3.2});
  const auto [shortest, longest] = roomOfPeriod(search_, 1);
  EXPECT_NEAR(way_m_ / longest, 2.9, 1e-9);  // by half of what is beyond one turn
}

TEST_F(RipplePeriods, AreRefinedWithoutComingNearerThanThat) {
  found({10.0, 15.0, 18.0});
  const auto turns = [&](std::size_t effect) {
    const auto [shortest, longest] = roomOfPeriod(search_, effect);
    return std::pair<double, double>(way_m_ / longest, way_m_ / shortest);
  };
  EXPECT_NEAR(turns(0).second, 11.5, 1e-9);  // both may move by half of the three turns that are beyond two
  EXPECT_NEAR(turns(1).first, 13.5, 1e-9);
  EXPECT_NEAR(turns(1).second, 15.5, 1e-9);
  EXPECT_NEAR(turns(2).first, 17.5, 1e-9);
  EXPECT_EQ(turns(0).first, 0.0);
  EXPECT_TRUE(std::isinf(turns(2).second));
}

}  // namespace
}  // namespace knee_robot::tracing
