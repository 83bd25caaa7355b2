#include "../../src/nodes/request_depth.h"

#include <gtest/gtest.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <string>

namespace knee_robot::nodes {
namespace {

std::string nested(int depth) {
  std::string text;
  for (int i = 0; i < depth; ++i)
    text += "<value><array><data>";
  text += "<value><i4>7</i4></value>";
  for (int i = 0; i < depth; ++i)
    text += "</data></array></value>";
  return text;
}

TEST(RequestDepth, LeavesWhatRosSendsAloneAndReadsNothingThatWouldEndTheProcess) {
  limitRequestDepth();
  int offset = 0;
  XmlRpc::XmlRpcValue shallow;
  ASSERT_TRUE(shallow.fromXml(nested(10), &offset));
  EXPECT_EQ(shallow.size(), 1);
  offset = 0;
  XmlRpc::XmlRpcValue deep;
  deep.fromXml(nested(200'000), &offset);  // without the limit: a segmentation fault
  offset = 0;
  XmlRpc::XmlRpcValue after;
  EXPECT_TRUE(after.fromXml(nested(10), &offset)) << "the next request begins from above";
}

}  // namespace
}  // namespace knee_robot::nodes
