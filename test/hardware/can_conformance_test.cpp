// The conformance suite on four CiA 402 drives on a CAN bus, all in this process.
#include "test/hardware/can_bench.h"
#include "test/hardware/conformance.h"

namespace knee_robot::hardware {
namespace {

class CanConformance : public ConformanceBench {
 public:
  AxisBus& bus() override { return drives_.bus(); }
  double lowestVolts() const override { return drives_.lowestVolts(); }
  double highestVolts() const override { return drives_.highestVolts(); }
  double voltStep() const override { return drives_.voltStep(); }
  Volts terminalVolts() const override { return drives_.terminalVolts(); }
  std::uint8_t terminalOutputs() const override { return drives_.terminalOutputs(); }
  void setInputs(std::uint8_t bits) override { drives_.setInputs(bits); }
  void move(std::uint32_t counts) override { drives_.move(counts); }
  void keepMoving(bool on) override { drives_.keepMoving(on); }
  std::vector<Volts>& seenOutputs() override { return drives_.seenOutputs(); }
  void disconnect() override { drives_.disconnect(); }
  void reconnect() override { drives_.reconnect(); }
  bool answerLate(bool on) override {
    drives_.holdFeedbackBack(on);
    return true;
  }
  bool energise() override { return drives_.energise(); }
  void settle() override { drives_.sample(); }

 private:
  can::CanBench drives_;
};

INSTANTIATE_TEST_SUITE_P(Can, AxisBusConformance,
                         ::testing::Values(Backend{"can", [] { return std::make_unique<CanConformance>(); }}),
                         backendName);

}  // namespace
}  // namespace knee_robot::hardware
