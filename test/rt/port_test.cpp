#include "knee_robot/rt/port.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "knee_robot/base/errors.h"
#include "test/refusal.h"

namespace knee_robot::rt {
namespace {

/// Large enough to be torn if a channel were wrong: all entries are made from one number.
struct Sample {
  std::uint64_t number = 0;
  std::array<std::uint64_t, 11> copies{};

  static Sample of(std::uint64_t n) {
    Sample sample;
    sample.number = n;
    for (std::size_t i = 0; i < sample.copies.size(); ++i)
      sample.copies[i] = n * (i + 3);
    return sample;
  }
  bool whole() const {
    for (std::size_t i = 0; i < copies.size(); ++i) {
      if (copies[i] != number * (i + 3)) return false;
    }
    return true;
  }
};

struct ConnectablePair {
  TaskContext writer{"Writer"}, reader{"Reader"};
  OutputPort<int> out{writer, "out", ""};
  InputPort<int> in{reader, "in", ""};
};

TEST(Port, AnswersNoDataThenNewDataThenOldData) {
  ConnectablePair pair;
  int value = -1;
  EXPECT_EQ(pair.in.read(value), FlowStatus::NoData);
  connect(pair.out, pair.in);
  EXPECT_EQ(pair.in.read(value), FlowStatus::NoData);
  EXPECT_EQ(value, -1);
  pair.out.write(5);
  pair.out.write(6);
  EXPECT_EQ(pair.in.read(value), FlowStatus::NewData);
  EXPECT_EQ(value, 6) << "a data connection keeps the newest";
  value = 0;
  EXPECT_EQ(pair.in.read(value), FlowStatus::OldData);
  EXPECT_EQ(value, 6);
}

TEST(Port, BufferKeepsTheOldestAndSaysThatItIsFull) {
  ConnectablePair pair;
  connect(pair.out, pair.in, ConnPolicy::buffer(2));
  EXPECT_TRUE(pair.out.write(1));
  EXPECT_TRUE(pair.out.write(2));
  EXPECT_FALSE(pair.out.write(3));
  int value = 0;
  EXPECT_EQ(pair.in.read(value), FlowStatus::NewData);
  EXPECT_EQ(value, 1);
  EXPECT_EQ(pair.in.read(value), FlowStatus::NewData);
  EXPECT_EQ(value, 2);
  EXPECT_EQ(pair.in.read(value), FlowStatus::OldData);
}

TEST(Port, OneOutputFeedsSeveralInputsEachWithItsOwnPolicy) {
  ConnectablePair pair;
  InputPort<int> second(pair.reader, "second", "");
  connect(pair.out, pair.in);
  connect(pair.out, second, ConnPolicy::buffer(3));
  for (int i = 1; i <= 3; ++i)
    pair.out.write(i);
  int value = 0;
  pair.in.read(value);
  EXPECT_EQ(value, 3);
  second.read(value);
  EXPECT_EQ(value, 1);
}

std::string refusalToConnect(PortBase& from, PortBase& to, const ConnPolicy& policy = ConnPolicy::data()) {
  return refusalOf([&] { connect(from, to, policy); });
}

TEST(Port, RefusesSenselessConnectionsInASentence) {
  ConnectablePair pair;
  InputPort<double> other(pair.reader, "other", "");
  EXPECT_EQ(refusalToConnect(pair.out, other),
            "Writer.out sends int, but Reader.other takes double: connect ports of one type");
  EXPECT_NE(refusalToConnect(pair.in, pair.out), "");
  EXPECT_NE(refusalToConnect(pair.out, pair.out), "");
  EXPECT_NE(refusalToConnect(pair.out, pair.in, ConnPolicy::buffer(0)), "");
  EXPECT_EQ(refusalToConnect(pair.out, pair.in), "");
  EXPECT_NE(refusalToConnect(pair.out, pair.in).find("connected already"), std::string::npos);
}

TEST(Port, IsFoundByNameInItsComponentAndIsThereOnce) {
  ConnectablePair pair;
  EXPECT_EQ(pair.writer.port("out"), &pair.out);
  EXPECT_EQ(pair.writer.port("nothing"), nullptr);
  EXPECT_THROW(OutputPort<int>(pair.writer, "out", ""), InputError);
}

/// Two threads, many values: none torn, order kept; answers how many arrived.
template <typename Check>
std::uint64_t stress(const ConnPolicy& policy, std::uint64_t count, Check&& check) {
  TaskContext writer("Writer"), reader("Reader");
  OutputPort<Sample> out(writer, "out", "");
  InputPort<Sample> in(reader, "in", "");
  connect(out, in, policy);
  std::atomic<bool> done{false};
  std::thread thread([&] {
    for (std::uint64_t n = 1; n <= count; ++n) {
      while (!out.write(Sample::of(n)) && policy.kind == ConnPolicy::Kind::Buffer)
        std::this_thread::yield();
    }
    done.store(true);
  });
  std::uint64_t received = 0, last = 0;
  for (;;) {
    const bool finished = done.load();
    Sample sample;
    if (in.read(sample) == FlowStatus::NewData) {
      ++received;
      EXPECT_TRUE(sample.whole());
      EXPECT_GT(sample.number, last);
      check(sample.number, last);
      last = sample.number;
    } else if (finished) {
      break;
    } else {
      std::this_thread::yield();
    }
    if (::testing::Test::HasFailure()) break;
  }
  thread.join();
  EXPECT_EQ(last, count) << "the newest value arrives whatever the policy";
  return received;
}

TEST(Port, NeverTearsAValueBetweenTwoThreads) {
  constexpr std::uint64_t kCount = 100'000;
  stress(ConnPolicy::data(), kCount, [](std::uint64_t, std::uint64_t) {});
}

TEST(Port, LosesNothingThroughABufferBetweenTwoThreads) {
  constexpr std::uint64_t kCount = 100'000;
  const auto next = [](std::uint64_t number, std::uint64_t last) { EXPECT_EQ(number, last + 1); };
  EXPECT_EQ(stress(ConnPolicy::buffer(16), kCount, next), kCount);
}

}  // namespace
}  // namespace knee_robot::rt
