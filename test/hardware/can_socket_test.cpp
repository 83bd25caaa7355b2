// The raw socket: on SEQPACKET socket pairs everywhere, and on a real CAN interface where KNEE_CAN_INTERFACE names one
// (scripts/test_can_in_qemu).
#include "knee_robot/hardware/can/can_socket.h"

#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>

#include "knee_robot/base/errors.h"
#include "knee_robot/simulation/bus_server.h"
#include "src/hardware/can/bus_errors.h"
#include "test/refusal.h"

namespace knee_robot::hardware::can {
namespace {

struct Pair {
  explicit Pair(const std::vector<Filter>& filters = {}) {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends) != 0) std::abort();
    ours = CanSocket::adopt(ends[0], filters);
    theirs = ends[1];
  }
  ~Pair() { ::close(theirs); }
  void feed(const ::can_frame& raw) {
    ASSERT_EQ(::send(theirs, &raw, sizeof raw, 0), static_cast<ssize_t>(sizeof raw));
  }
  void feedBytes(const void* bytes, std::size_t count) {
    ASSERT_EQ(::send(theirs, bytes, count, 0), static_cast<ssize_t>(count));
  }
  std::unique_ptr<CanSocket> ours;
  int theirs = -1;
};

::can_frame rawFrame(std::uint32_t id, std::initializer_list<std::uint8_t> data) {
  ::can_frame raw{};
  raw.can_id = id;
  for (const std::uint8_t byte : data)
    raw.data[raw.can_dlc++] = byte;
  return raw;
}

Frame frameOf(std::uint32_t id, std::initializer_list<std::uint8_t> data) {
  Frame frame;
  frame.id = id;
  for (const std::uint8_t byte : data)
    frame.data[frame.length++] = byte;
  return frame;
}

TEST(CanSocketPair, CarriesAFrameBothWays) {
  Pair pair;
  ASSERT_EQ(pair.ours->send(frameOf(0x201, {0x0F, 0x00, 0x18, 0xFC})), PortStatus::Ok);
  ::can_frame raw{};
  ASSERT_EQ(::recv(pair.theirs, &raw, sizeof raw, 0), static_cast<ssize_t>(sizeof raw));
  EXPECT_EQ(raw.can_id, 0x201u);
  EXPECT_EQ(raw.can_dlc, 4);
  EXPECT_EQ(raw.data[3], 0xFC);
  pair.feed(rawFrame(0x181, {1, 2, 3, 4, 5, 6, 7, 8}));
  Frame frame;
  ASSERT_EQ(pair.ours->receive(frame), PortStatus::Ok);
  EXPECT_EQ(frame.id, 0x181u);
  EXPECT_EQ(frame.length, 8);
  EXPECT_EQ(frame.data[7], 8);
  EXPECT_LE(frame.received_ns, pair.ours->now());
}

TEST(CanSocketPair, NeverWaitsAndSaysWhenItIsEmptyFullOrClosed) {
  Pair pair;
  Frame frame;
  EXPECT_EQ(pair.ours->receive(frame), PortStatus::Empty);
  PortStatus status = PortStatus::Ok;
  for (int i = 0; i < 100000 && status == PortStatus::Ok; ++i)
    status = pair.ours->send(frameOf(0x80, {}));
  EXPECT_EQ(status, PortStatus::Full);
  ::close(pair.theirs);
  pair.theirs = ::dup(0);
  EXPECT_EQ(pair.ours->send(frameOf(0x80, {})), PortStatus::Down);
  EXPECT_EQ(pair.ours->receive(frame), PortStatus::Down);
}

TEST(CanSocketPair, LeavesTheFrameAloneUnlessOneCame) {
  Pair pair;
  Frame frame = frameOf(0x123, {9});
  pair.feedBytes("short", 5);
  EXPECT_EQ(pair.ours->receive(frame), PortStatus::Malformed);
  const char long_bytes[40] = {};
  pair.feedBytes(long_bytes, sizeof long_bytes);
  EXPECT_EQ(pair.ours->receive(frame), PortStatus::Malformed);
  ::can_frame impossible = rawFrame(0x181, {1});
  impossible.can_dlc = 9;
  pair.feed(impossible);
  EXPECT_EQ(pair.ours->receive(frame), PortStatus::Malformed);
  EXPECT_EQ(pair.ours->receive(frame), PortStatus::Empty);
  EXPECT_EQ(frame.id, 0x123u);
  EXPECT_EQ(frame.data[0], 9);
}

TEST(CanSocketPair, FiltersIdentifiersButNeverErrors) {
  Pair pair({{0x181, 0x7FF}, {0x700, 0x780}});
  for (const std::uint32_t id : {0x182u, 0x181u, 0x601u, 0x705u, 0x181u | CAN_EFF_FLAG, 0x181u | CAN_RTR_FLAG})
    pair.feed(rawFrame(id, {}));
  ::can_frame error = rawFrame(CAN_ERR_FLAG | CAN_ERR_BUSOFF, {0, 0, 0, 0, 0, 0, 0, 0});
  pair.feed(error);
  Frame frame;
  ASSERT_EQ(pair.ours->receive(frame), PortStatus::Ok);
  EXPECT_EQ(frame.id, 0x181u);
  ASSERT_EQ(pair.ours->receive(frame), PortStatus::Ok);
  EXPECT_EQ(frame.id, 0x705u);
  ASSERT_EQ(pair.ours->receive(frame), PortStatus::Ok);
  EXPECT_TRUE(frame.error);
  EXPECT_TRUE(busErrors(frame).bus_off);
  EXPECT_EQ(pair.ours->receive(frame), PortStatus::Empty);
}

TEST(BusErrors, AreNamed) {
  Frame frame;
  EXPECT_EQ(toText(busErrors(frame)), "no error");
  frame.id = CAN_ERR_BUSOFF;
  EXPECT_EQ(toText(busErrors(frame)), "no error") << "a data frame with that number is no error frame";
  frame.error = true;
  frame.id = CAN_ERR_ACK | CAN_ERR_CRTL;
  frame.data[1] = CAN_ERR_CRTL_TX_PASSIVE | CAN_ERR_CRTL_RX_OVERFLOW;
  EXPECT_EQ(toText(busErrors(frame)), "error passive, frames lost in the controller, nobody acknowledges");
  frame.id = CAN_ERR_RESTARTED;
  EXPECT_TRUE(busErrors(frame).restarted);
}

TEST(BusServer, PassesAFrameToAllOthersAndSurvivesAPeerThatGoes) {
  const std::string path = ::testing::TempDir() + "knee_can_" + std::to_string(::getpid());
  simulation::BusServer server(path);
  auto first = CanSocket::open(path, {});
  auto second = CanSocket::open(path, {});
  server.wait(server.now());
  ASSERT_EQ(first->send(frameOf(0x80, {})), PortStatus::Ok);
  Frame frame;
  ASSERT_EQ(server.receive(frame), PortStatus::Ok);
  EXPECT_EQ(frame.id, 0x80u);
  ASSERT_EQ(second->receive(frame), PortStatus::Ok);
  EXPECT_EQ(first->receive(frame), PortStatus::Empty);
  second.reset();
  ASSERT_EQ(server.send(frameOf(0x181, {1})), PortStatus::Ok);
  ASSERT_EQ(first->receive(frame), PortStatus::Ok);
  EXPECT_EQ(server.receive(frame), PortStatus::Empty);
  EXPECT_THROW(simulation::BusServer{path}, InputError) << "it is served already";
}

TEST(CanSocket, SaysHowToMendWhatIsMissing) {
  const std::string said = refusalOf([&] { CanSocket::open("/nonexistent/bus", {}); });
  EXPECT_NE(said.find("cia402_simulator --bus /nonexistent/bus"), std::string::npos) << said;
  EXPECT_THROW(CanSocket::open("nocan7", {}), InputError);
}

class RealCan : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* name = std::getenv("KNEE_CAN_INTERFACE");
    if (name == nullptr) GTEST_SKIP() << "no CAN interface here; scripts/test_can_in_qemu runs this";
    interface = name;
  }
  /// Next frame within some seconds.
  static PortStatus await(CanSocket& socket, Frame& frame) {
    PortStatus status = PortStatus::Empty;
    for (int i = 0; i < 5000 && status == PortStatus::Empty; ++i) {
      status = socket.receive(frame);
      if (status == PortStatus::Empty) socket.pause(1'000'000);
    }
    return status;
  }
  std::string interface;
};

TEST_F(RealCan, CarriesFramesWithTheKernelsTimeStampsAndFilters) {
  const auto sender = CanSocket::open(interface, {});
  const auto all = CanSocket::open(interface, {});
  const auto one = CanSocket::open(interface, {{0x181, 0x7FF}});
  // The kernel begins to stamp a moment after the first socket has asked for it.
  Frame frame;
  sender->pause(100'000'000);
  const std::int64_t before = all->now();
  ASSERT_EQ(sender->send(frameOf(0x182, {1, 2})), PortStatus::Ok);
  ASSERT_EQ(sender->send(frameOf(0x181, {3})), PortStatus::Ok);
  all->pause(50'000'000);
  const std::int64_t after = all->now();
  ASSERT_EQ(await(*all, frame), PortStatus::Ok);
  EXPECT_EQ(frame.id, 0x182u);
  EXPECT_EQ(frame.length, 2);
  EXPECT_GT(frame.received_ns, before - 1'000'000);
  EXPECT_LT(frame.received_ns, after - 20'000'000) << "the stamp has to be of the reception, not of the reading";
  ASSERT_EQ(await(*one, frame), PortStatus::Ok);
  EXPECT_EQ(frame.id, 0x181u);
  EXPECT_EQ(one->receive(frame), PortStatus::Empty);
  EXPECT_EQ(sender->receive(frame), PortStatus::Empty) << "no echo of its own frames";
}

TEST_F(RealCan, RefusesAnInterfaceThatIsNotThere) {
  EXPECT_THROW(CanSocket::open("nocan7", {}), InputError);
  EXPECT_THROW(CanSocket::open("lo", {}), InputError) << "no CAN interface";
}

}  // namespace
}  // namespace knee_robot::hardware::can
