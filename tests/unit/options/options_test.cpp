// Accepted command lines, and the errors for others.
#include "options/options.h"

#include <gtest/gtest.h>

#include <optional>

#include "core/failure.h"

namespace slew::options {
namespace options_test {

std::string problem_of(Program& program, const std::vector<std::string>& arguments) {
  try {
    program.parse(arguments);
  } catch (const Failure& failure) {
    return failure.what();
  }
  return "";
}

class Numbers : public ::testing::Test {
 protected:
  Numbers() {
    program_.option("--share", share_, "a share").between(0.5, 100.0);
    program_.option("--count", count_, "a count").between(1, 9);
    program_.option("--all", all_, "a list").comma_separated().one_value_each();
  }
  Program program_{"test", "a test"};
  std::optional<double> share_;
  int count_ = 3;
  std::vector<std::string> all_;
};

TEST_F(Numbers, BoundsAndWhatIsBetweenAreTaken) {
  for (const char* text : {"0.5", "100", "3e1", "7"}) EXPECT_EQ(problem_of(program_, {"--share", text}), "") << text;
  EXPECT_EQ(*share_, 7);
  EXPECT_EQ(count_, 3);
  for (const char* text : {"101", "0.4"}) {
    EXPECT_EQ(problem_of(program_, {"--share", text}), "--share: '" + std::string(text) +
                                                           "' is no number from 0.5 to 100; nothing was done; see "
                                                           "'test --help'");
  }
}

TEST_F(Numbers, NoNumberThatIsNotFiniteIsTaken) {
  for (const char* text : {"nan", "-nan", "NAN", "nan(1)", "inf", "-inf", "infinity", "1e999", "x"}) {
    EXPECT_NE(problem_of(program_, {std::string("--share=") + text}), "") << text;
  }
}

TEST_F(Numbers, AnIntegerHasItsBounds) {
  EXPECT_EQ(problem_of(program_, {"--count", "9"}), "");
  EXPECT_EQ(count_, 9);
  for (const char* text : {"0", "10", "2.5", "nan"}) EXPECT_NE(problem_of(program_, {"--count", text}), "") << text;
}

TEST_F(Numbers, AListTakesCommasAndRepeats) {
  EXPECT_EQ(problem_of(program_, {"--all", "a,b", "--all", "c"}), "");
  EXPECT_EQ(all_, (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_NE(problem_of(program_, {"--all", "a", "b"}), "");
}

class Verbs : public ::testing::Test {
 protected:
  Verbs() {
    program_.require_command();
    Command run = program_.command("run", "runs");
    const Option file = run.option("scene", file_, "scene"), from = run.option("--from", from_, "state");
    run.require_one_of(file, from);
    run.action([this] {
      has_run_ = true;
      return ExitCode::losses;
    });
    program_.command("replay", "replays").action([] { return ExitCode::ok; });
  }
  Program program_{"test", "a test"};
  std::string file_, from_;
  bool has_run_ = false;
};

TEST_F(Verbs, TheActionOfTheGivenOneRuns) {
  program_.parse({"run", "x.yaml"});
  EXPECT_FALSE(has_run_);
  EXPECT_EQ(program_.run(), ExitCode::losses);
  EXPECT_TRUE(has_run_);
}

TEST_F(Verbs, AWordThatIsNoVerbGetsTheNearest) {
  EXPECT_EQ(problem_of(program_, {"rum"}),
            "there is no 'rum' here; did you mean 'run'?; nothing was done; see 'test --help'");
}

TEST_F(Verbs, OneOfTwoMustBeGiven) {
  EXPECT_EQ(problem_of(program_, {"run"}), "scene is required; nothing was done; see 'test run --help'");
  EXPECT_EQ(problem_of(program_, {"run", "--from", "a"}), "");
  EXPECT_EQ(problem_of(program_, {"run", "x", "--from", "a"}),
            "--from excludes scene; nothing was done; see 'test run --help'");
}

}  // namespace options_test
}  // namespace slew::options
