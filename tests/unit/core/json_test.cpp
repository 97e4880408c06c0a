// SPDX-License-Identifier: Apache-2.0
// A JSON value: it is written as built, and read as written.
#include "core/json.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "core/failure.h"

namespace slew {
namespace json_test {

TEST(Json, IsWrittenByNameOrAsItWasPut) {
  Json json = {{"b", 1}, {"a", Json::array({1.5, "x", true, Json()})}};
  json["c"]["d"] = -2;
  EXPECT_EQ(json.dump(), R"({"a":[1.5,"x",true,null],"b":1,"c":{"d":-2}})");
  EXPECT_EQ(json.dump(-1, Json::Order::as_put), R"({"b":1,"a":[1.5,"x",true,null],"c":{"d":-2}})");
  json["b"] = "again";  // keeps its place
  json.erase("a");
  EXPECT_EQ(json.dump(-1, Json::Order::as_put), R"({"b":"again","c":{"d":-2}})");
}

TEST(Json, ARangeIsAnArray) {
  EXPECT_EQ(Json(std::vector<std::string>{"a", "b"}).dump(), R"(["a","b"])");
  EXPECT_EQ(Json(std::array<double, 2>{1, 2.5}).dump(), "[1.0,2.5]");
  EXPECT_EQ(Json(std::vector<std::vector<int>>{{1}, {}}).dump(), "[[1],[]]");
  EXPECT_EQ(Json::array().dump(), "[]");
  EXPECT_EQ(Json::object().dump(), "{}");
}

TEST(Json, KeepsEveryBitOfNumbers) {
  const double third = 1.0 / 3;
  const Json json = {{"third", third},
                     {"most", std::numeric_limits<std::uint64_t>::max()},
                     {"least", std::numeric_limits<std::int64_t>::min()}};
  const Json again = Json::parse(json.dump()).value();
  EXPECT_EQ(again.at("third").number(), third);
  EXPECT_EQ(again.at("least").integer(), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(again.dump(), json.dump());
  EXPECT_THROW(static_cast<void>(again.at("most").integer()), Failure);
}

TEST(Json, WritesNoNumberThatIsNotFiniteAndNoBytesThatAreNotText) {
  EXPECT_EQ(Json(std::nan("")).dump(), "null");
  EXPECT_EQ(Json(std::numeric_limits<double>::infinity()).dump(), "null");
  EXPECT_EQ(Json("a\xff\"").dump(), "\"a\xef\xbf\xbd\\\"\"");
}

TEST(Json, ACopyIsAValueOfItsOwn) {
  Json json = {{"a", Json::array({1})}};
  const Json copy = json;
  json["a"].push_back(2);
  EXPECT_EQ(copy.dump(), R"({"a":[1]})");
  EXPECT_EQ(json.dump(), R"({"a":[1,2]})");
}

TEST(Json, ReadingReportsWhatIsWrong) {
  const Json json = Json::parse(R"({"name": "x", "list": [1, 2], "no": false})").value();
  EXPECT_EQ(json.at("name").text(), "x");
  EXPECT_EQ(json.at("list").items().size(), 2u);
  EXPECT_FALSE(json.at("no").boolean());
  EXPECT_EQ(json.text_or("name", "y"), "x");
  EXPECT_EQ(json.text_or("other", "y"), "y");
  EXPECT_EQ(json.find("other"), nullptr);
  EXPECT_TRUE(Json().items().empty());
  try {
    static_cast<void>(json.at("other"));
    FAIL() << "a member that is not there was read";
  } catch (const Failure& failure) {
    EXPECT_STREQ(failure.what(), R"(JSON: there is no member 'other' in {"list":[1,2],"name":"x","no":false})");
  }
  EXPECT_THROW(static_cast<void>(json.at("name").number()), Failure);
  EXPECT_THROW(static_cast<void>(json.at("list").texts()), Failure);
  EXPECT_FALSE(Json::parse("{\"a\": }"));
}

}  // namespace json_test
}  // namespace slew
