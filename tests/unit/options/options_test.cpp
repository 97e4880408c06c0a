// SPDX-License-Identifier: Apache-2.0
// Accepted command lines, and the errors for others.
#include "options/options.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <string>

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
    program_.option("--seed", seed_, "a seed");
    program_.option("--number", number_, "a number");
    program_.option("--lines", lines_, "a number").not_negative();
    program_.option("--all", all_, "a list").comma_separated().one_value_each();
  }
  Program program_{"test", "a test"};
  std::optional<double> share_;
  int count_ = 3;
  std::uint64_t seed_ = 1;
  std::int64_t number_ = 1;
  int lines_ = 1;
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

TEST_F(Numbers, BelowZeroAreRefusedWithAReadableBound) {
  EXPECT_EQ(problem_of(program_, {"--lines", "0"}), "");
  EXPECT_EQ(problem_of(program_, {"--lines=-1"}),
            "--lines: '-1' is no number from 0; nothing was done; see 'test --help'");
  EXPECT_NE(problem_of(program_, {"--lines=nan"}), "");
}

TEST_F(Numbers, AWholeNumberThatDoesNotFitIsRefused) {
  EXPECT_EQ(problem_of(program_, {"--seed", "18446744073709551615", "--number=-9223372036854775808"}), "");
  EXPECT_EQ(seed_, std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(number_, std::numeric_limits<std::int64_t>::min());
  for (const char* text : {"-1", "18446744073709551616", "99999999999999999999"}) {
    EXPECT_NE(
        problem_of(program_, {std::string("--seed=") + text}).find("is no whole number from 0 to 18446744073709551615"),
        std::string::npos)
        << text;
  }
  for (const char* text : {"9223372036854775808", "-9223372036854775809", "x"}) {
    EXPECT_NE(problem_of(program_, {std::string("--number=") + text}), "") << text;
  }
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

TEST_F(Verbs, AWordThatIsNoOptionGetsTheNearest) {
  EXPECT_EQ(problem_of(program_, {"run", "x", "--form", "5"}),
            "there is no option '--form' here; did you mean '--from'?; nothing was done; see 'test run --help'");
  EXPECT_EQ(problem_of(program_, {"run", "x", "--form=5"}),
            "there is no option '--form' here; did you mean '--from'?; nothing was done; see 'test run --help'");
  EXPECT_EQ(problem_of(program_, {"run", "x", "--quite-different"}),
            "there is no option '--quite-different' here; nothing was done; see 'test run --help'");
}

TEST_F(Verbs, AHiddenVerbIsNotSuggested) {
  Command hidden = program_.command("runner", "not for users");
  hidden.hide();
  EXPECT_EQ(problem_of(program_, {"runne"}).find("runner"), std::string::npos);
}

class Environment : public ::testing::Test {
 protected:
  Environment() {
    Command run = program_.command("run", "runs");
    run.option("--domain", domain_, "a domain").between(0, 230).environment("SLEWRING_TEST_DOMAIN");
    run.flag("--fast", is_fast_, "a flag");
    run_ = std::make_unique<Command>(run);
    program_.command("check", "checks").action([] { return ExitCode::ok; });
  }
  ~Environment() override { unsetenv("SLEWRING_TEST_DOMAIN"); }

  Program program_{"test", "a test"};
  std::unique_ptr<Command> run_;
  int domain_ = 3;
  bool is_fast_ = false;
};

TEST_F(Environment, GivesAValueThatTheCommandLineDoesNot) {
  setenv("SLEWRING_TEST_DOMAIN", "7", 1);
  EXPECT_EQ(problem_of(program_, {"run", "--fast"}), "");
  EXPECT_EQ(domain_, 7);
  EXPECT_FALSE(run_->has("--domain"));
  EXPECT_TRUE(run_->has("--fast"));
  EXPECT_EQ(problem_of(program_, {"run", "--domain", "9"}), "");
  EXPECT_EQ(domain_, 9);
  EXPECT_TRUE(run_->has("--domain"));
}

TEST_F(Environment, AnEmptyVariableIsNone) {
  setenv("SLEWRING_TEST_DOMAIN", "", 1);
  EXPECT_EQ(problem_of(program_, {"run"}), "");
  EXPECT_EQ(domain_, 3);
}

TEST_F(Environment, AWrongValueNamesItsVariable) {
  setenv("SLEWRING_TEST_DOMAIN", "500", 1);
  EXPECT_EQ(problem_of(program_, {"run"}),
            "--domain: Value 500 not in range 0 to 230 (from the environment variable SLEWRING_TEST_DOMAIN); nothing "
            "was done; see 'test run --help'");
  EXPECT_EQ(problem_of(program_, {"run", "--domain", "501"}),
            "--domain: Value 501 not in range 0 to 230; nothing was done; see 'test run --help'");
}

TEST_F(Environment, DoesNotEndAVerbThatHasNoUseForIt) {
  setenv("SLEWRING_TEST_DOMAIN", "500", 1);
  EXPECT_EQ(problem_of(program_, {"check"}), "");
}

TEST(Help, DescriptionsEndAtEightyColumns) {
  Program program("test", "a test");
  std::string way;
  const std::string words = "one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen";
  program.option("--way", way, words);
  program.command("go", words);
  std::istringstream lines(program.help());
  std::string joined;
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(line.size(), 80U) << line;
    joined += ' ' + line.substr(std::min(line.size(), line.find_first_not_of(' ')));
  }
  EXPECT_NE(joined.find("--way TEXT                  " + words), std::string::npos) << joined;
  EXPECT_NE(joined.find("go                          " + words), std::string::npos) << joined;
}

TEST(Value, MayBeReplacedByAnother) {
  Program program("test", "a test");
  std::string file;
  program.option("file", file, "a file").replaced_by([](const std::string& text) { return "folder/" + text; });
  EXPECT_EQ(problem_of(program, {"a.yaml"}), "");
  EXPECT_EQ(file, "folder/a.yaml");
}

}  // namespace options_test
}  // namespace slew::options
