// Operations say what they do, and do it.
#include "knee_robot/rt/operation.h"

#include <gtest/gtest.h>

#include "knee_robot/base/errors.h"
#include "knee_robot/rt/component_page.h"
#include "knee_robot/rt/port.h"
#include "knee_robot/rt/property.h"

namespace knee_robot::rt {
namespace {

class CountsByOperation : public TaskContext {
 public:
  using TaskContext::TaskContext;
  OutputPort<int> value{*this, "value", "counted so far"};
  Property<double> step{*this, "step", 1.0, "1", 0.0, 10.0, "of one count"};
  Operation<int(int, double)> add{*this, "add", {"times", "more"}, "counts so often", [this](int times, double more) {
                                    return count_ += static_cast<int>(times * (step.value() + more));
                                  }};

 private:
  int count_ = 0;
};

TEST(Operation, IsCalledAndSaysItsSignature) {
  CountsByOperation counter("counter");
  EXPECT_EQ(counter.add(2, 0.5), 3);
  EXPECT_EQ(counter.add(1, 0.0), 4);
  ASSERT_EQ(counter.operations().size(), 1u);
  EXPECT_EQ(counter.operations()[0]->signature(), "int add(int times, double more)");
  EXPECT_EQ(counter.operation("add")->description(), "counts so often");
  EXPECT_EQ(counter.operation("subtract"), nullptr);
}

TEST(Operation, NeedsANameOfItsOwnAndOneForEveryArgument) {
  CountsByOperation counter("counter");
  const auto nothing = [](int) {};
  EXPECT_THROW(Operation<void(int)>(counter, "add", {"a"}, "", nothing), InputError);
  EXPECT_THROW(Operation<void(int)>(counter, "other", {}, "", nothing), InputError);
  EXPECT_EQ(counter.operations().size(), 1u);
}

TEST(ComponentPage, NamesPortsPropertiesAndOperations) {
  TypeFactory types;
  types["CountsByOperation"] = [](const std::string& name) { return std::make_unique<CountsByOperation>(name); };
  const std::string page = componentPage(types);
  for (const char* row :
       {"## CountsByOperation", "| `value` | `int` | out: counted so far |",
        "| `step` | 1 1 | 0 .. 10 | of one count |", "| `int add(int times, double more)` | counts so often |"})
    EXPECT_NE(page.find(row), std::string::npos) << row << " in\n" << page;
}

}  // namespace
}  // namespace knee_robot::rt
