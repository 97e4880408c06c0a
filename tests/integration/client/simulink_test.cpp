// SPDX-License-Identifier: Apache-2.0
// The Simulink block of the examples, called as Simulink calls it, against a session of real processes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "client/slewring_client.h"
#include "session.h"
#include "simulink_stub/simstruc.h"

int mxGetString(const mxArray* value, char* text, int size) {
  std::strncpy(text, value->text, static_cast<std::size_t>(size - 1));
  text[size - 1] = '\0';
  return 0;
}

double mxGetScalar(const mxArray* value) {
  return value->number;
}

namespace slew::testing {
namespace simulink_test {

constexpr int kInterface = 6;

class SimulinkBlock : public ::testing::Test {
 protected:
  SimulinkBlock() {
    for (const wire::Role role : kAllNodes) session_.start(role);
    block_.parameters[0] = {session_.name().c_str(), 0};
    block_.parameters[1] = {"simulink", 0};
    block_.parameters[2] = {nullptr, static_cast<double>(session_.domain())};
    block_.parameters[3] = {"Cyl_Lift.stroke,Input_Lift.raw", 0};
    block_.parameters[4] = {"Input_Lift", 0};
    block_.parameters[5] = {nullptr, 0.01};
    block_.parameters[kInterface] = {"lo", 0};
    block_.parameters[7] = {"", 0};
    block_.given = 8;
  }
  void begin() {
    stub_block.sizes(&block_);
    stub_block.sample_times(&block_);
    stub_block.start(&block_);
  }
  void step() {
    stub_block.outputs(&block_, 0);
    if (block_.error == nullptr) stub_block.update(&block_, 0);
  }

  Session session_{{"--pace", "real", "--duration", "60s", "--input", "none"}};
  SimStruct block_{};
};

TEST_F(SimulinkBlock, ReadsVariablesAndMovesItsChannel) {
  begin();
  ASSERT_EQ(block_.error, nullptr) << block_.error << session_.errors();
  EXPECT_EQ(block_.wanted, block_.given);
  EXPECT_EQ(block_.outputs, 2);
  EXPECT_EQ(block_.inputs, 1);
  EXPECT_EQ(block_.handles, 4);  // and the number of blocks
  EXPECT_EQ(block_.period, 0.01);
  step();
  const double before = block_.y[0];
  EXPECT_GT(before, 0.5);
  block_.u[0] = 0.7;
  // its answers arrive, and the cylinder moves by them
  for (int k = 0; k < 2000 && (block_.y[1] != 0.7 || std::fabs(block_.y[0] - before) < 1e-3); ++k) {
    step();
    ASSERT_EQ(block_.error, nullptr) << block_.error;
  }
  EXPECT_EQ(block_.y[1], 0.7);
  EXPECT_GE(std::fabs(block_.y[0] - before), 1e-3);
  stub_block.terminate(&block_);
  EXPECT_EQ(block_.pwork, nullptr);
}

TEST_F(SimulinkBlock, APeriodThatIsNotTheSessionsEndsTheModel) {
  block_.parameters[5].number = 0.02;
  begin();
  ASSERT_EQ(block_.error, nullptr) << block_.error << session_.errors();
  for (int k = 0; k < 20 && block_.error == nullptr; ++k) step();
  ASSERT_NE(block_.error, nullptr);
  EXPECT_STREQ(block_.error,
               "slewring_sfun: the period is 0.02 s, and the session has a block of variables every 0.01 s "
               "(session.step times recording.every); give the block and the solver that period");
  stub_block.terminate(&block_);
}

TEST_F(SimulinkBlock, MoreNamesThanItReadsAreAnErrorAndNotCutOff) {
  std::string names = "a";
  for (int i = 0; i < 64; ++i) names += ",a" + std::to_string(i);
  block_.parameters[3].text = names.c_str();
  stub_block.sizes(&block_);
  ASSERT_NE(block_.error, nullptr);
  EXPECT_NE(std::string(block_.error).find("parameter 4 has too many names: at most 64"), std::string::npos)
      << block_.error;
  block_.error = nullptr;
  names.resize(5000, 'x');
  block_.parameters[3].text = names.c_str();
  stub_block.sizes(&block_);
  EXPECT_NE(block_.error, nullptr);
}

TEST_F(SimulinkBlock, EndsTheModelWithTheReasonOfTheLibrary) {
  block_.parameters[kInterface].text = "nowhere0";
  begin();
  ASSERT_NE(block_.error, nullptr);
  EXPECT_NE(std::string(block_.error).find("network interface 'nowhere0' does not exist"), std::string::npos)
      << block_.error;
  stub_block.terminate(&block_);
}

}  // namespace simulink_test
}  // namespace slew::testing
