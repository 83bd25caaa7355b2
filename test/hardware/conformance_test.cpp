// The conformance suite on the two cards: images on the heap (stepped simulation) and in shared memory (real-time
// simulation).
#include "test/hardware/conformance.h"

#include "test/hardware/card_bench.h"

namespace knee_robot::hardware {
namespace {

/// Owner is HeapCards or SharedCards.
template <typename Owner>
class CardConformance : public ConformanceBench {
 public:
  AxisBus& bus() override { return cards_.bench.bus(); }
  double lowestVolts() const override { return CardBench::lowestVolts(); }
  double highestVolts() const override { return CardBench::highestVolts(); }
  double voltStep() const override { return CardBench::voltStep(); }
  Volts terminalVolts() const override { return cards_.bench.terminalVolts(); }
  std::uint8_t terminalOutputs() const override { return cards_.bench.terminalOutputs(); }
  void setInputs(std::uint8_t bits) override { cards_.bench.setInputs(bits); }
  void move(std::uint32_t counts) override { cards_.bench.move(counts); }
  void keepMoving(bool on) override { cards_.bench.keepMoving(on); }
  std::vector<Volts>& seenOutputs() override { return cards_.bench.seenOutputs(); }
  void disconnect() override { cards_.bench.disconnect(); }
  void reconnect() override { cards_.bench.reconnect(); }

 private:
  Owner cards_;
};

template <typename Owner>
Backend backend(const std::string& name) {
  return {name, [] { return std::make_unique<CardConformance<Owner>>(); }};
}

INSTANTIATE_TEST_SUITE_P(Cards, AxisBusConformance,
                         ::testing::Values(backend<HeapCards>("heap"), backend<SharedCards>("shared_memory")),
                         backendName);

}  // namespace
}  // namespace knee_robot::hardware
