#include "../../src/nodes/request_errors.h"

#include <gtest/gtest.h>
#include <xmlrpcpp/XmlRpc.h>

#include <atomic>
#include <stdexcept>
#include <thread>

namespace knee_robot::nodes {
namespace {

struct Throws : XmlRpc::XmlRpcServerMethod {
  explicit Throws(XmlRpc::XmlRpcServer& server) : XmlRpcServerMethod("throws", &server) {}
  void execute(XmlRpc::XmlRpcValue&, XmlRpc::XmlRpcValue&) override { throw std::runtime_error("1 < 2 & 3"); }
};

struct Answers : XmlRpc::XmlRpcServerMethod {
  explicit Answers(XmlRpc::XmlRpcServer& server) : XmlRpcServerMethod("answers", &server) {}
  void execute(XmlRpc::XmlRpcValue&, XmlRpc::XmlRpcValue& result) override { result = 7; }
};

TEST(RequestErrors, AreAnsweredAsFaultsAndTheNextRequestIsServed) {
  answerRequestErrors();
  XmlRpc::XmlRpcServer server;
  const Throws throws(server);
  const Answers answers(server);
  ASSERT_TRUE(server.bindAndListen(0));
  std::atomic<bool> ended{false};
  std::thread serving([&] {
    while (!ended)
      server.work(0.01);  // without it: std::terminate
  });
  XmlRpc::XmlRpcClient client("127.0.0.1", server.get_port(), "/");
  for (int i = 0; i < 3; ++i) {
    XmlRpc::XmlRpcValue none, result;
    EXPECT_TRUE(client.execute("throws", none, result));
    EXPECT_TRUE(client.isFault());
    EXPECT_TRUE(client.execute("answers", none, result));
    EXPECT_FALSE(client.isFault());
    EXPECT_EQ(static_cast<int>(result), 7);
  }
  client.close();
  ended = true;
  serving.join();
}

TEST(RequestErrors, RequestsWithinARequestAreRefused) {
  answerRequestErrors();
  XmlRpc::XmlRpcServer server;
  const Answers answers(server);
  ASSERT_TRUE(server.bindAndListen(0));
  std::atomic<bool> ended{false};
  std::thread serving([&] {
    while (!ended)
      server.work(0.01);
  });
  XmlRpc::XmlRpcClient client("127.0.0.1", server.get_port(), "/");
  XmlRpc::XmlRpcValue none, within, result;
  none.setSize(0);
  within[0][0]["methodName"] = "system.multicall";
  within[0][0]["params"][0] = none;
  EXPECT_TRUE(client.execute("system.multicall", within, result));  // without the refusal: signal 11
  EXPECT_TRUE(client.isFault());
  client.close();
  ended = true;
  serving.join();
}

}  // namespace
}  // namespace knee_robot::nodes
