// SPDX-License-Identifier: Apache-2.0
// What one writes the other reads, and nothing else.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/state_bytes.h"
#include "core/static_vector.h"

namespace slew {
namespace state_bytes_test {

enum class Colour : std::uint8_t { red, green, blue };

struct Fields {
  double x = 0;
  std::int64_t step = 0;
  std::vector<double> row = std::vector<double>(3);
  bool is_open = false;
  char is_active = 0;
  std::size_t current = 0;
  Colour colour = Colour::red;
  StaticVector<double, 4> ports{};
};

template <typename Self, typename Bytes>
void visit(Self& fields, Bytes& bytes) {
  bytes.number(fields.x);
  bytes.number(fields.step);
  bytes.numbers(fields.row);
  bytes.flag(fields.is_open);
  bytes.flag(fields.is_active);
  bytes.count(fields.current, std::size_t{9});
  bytes.choice(fields.colour, Colour::blue);
  visit_sized(bytes, fields.ports, 2);
}

constexpr StateFormat kFormat{3, 17};

std::vector<std::byte> saved(const Fields& fields) {
  std::vector<std::byte> bytes;
  StateWriter writer(bytes, kFormat);
  visit(fields, writer);
  writer.finish();
  return bytes;
}

Status loaded(std::span<const std::byte> bytes, Fields& fields, StateFormat format = kFormat) {
  StateReader reader(bytes, format);
  visit(fields, reader);
  return reader.finish("a test");
}

Fields some() {
  return {-0.0, -5, {1, std::numeric_limits<double>::quiet_NaN(), 3}, true, 1, 9, Colour::blue, {7, 8}};
}

TEST(StateBytes, BringBackEveryBit) {
  Fields fields;
  ASSERT_TRUE(loaded(saved(some()), fields).is_ok());
  EXPECT_TRUE(std::signbit(fields.x));
  EXPECT_EQ(fields.step, -5);
  EXPECT_TRUE(std::isnan(fields.row[1]));
  EXPECT_TRUE(fields.is_open);
  EXPECT_EQ(fields.is_active, 1);
  EXPECT_EQ(fields.current, 9u);
  EXPECT_EQ(fields.colour, Colour::blue);
  EXPECT_EQ(fields.ports, (StaticVector<double, 4>{7, 8}));
  EXPECT_EQ(saved(fields), saved(some()));
}

TEST(StateBytes, StandBehindWhatIsThereAlready) {
  std::vector<std::byte> bytes(5);
  StateWriter writer(bytes, kFormat);
  const Fields written = some();
  visit(written, writer);
  writer.finish();
  Fields fields;
  EXPECT_TRUE(loaded(std::span(bytes).subspan(5), fields).is_ok());
}

TEST(StateBytes, AreRefusedWithTheReason) {
  const auto text = [](std::span<const std::byte> bytes, StateFormat format = kFormat) {
    Fields fields;
    const Status status = loaded(bytes, fields, format);
    EXPECT_EQ(status.code, ExitCode::bad_input);
    return status.text;
  };
  std::vector<std::byte> bytes = saved(some());
  EXPECT_EQ(text({}),
            "the saved state of a test is cut; nothing of it was taken. Save it again, or start from the beginning");
  EXPECT_NE(text(std::span(bytes).first(bytes.size() - 1)).find("is cut"), std::string::npos);
  EXPECT_NE(text(bytes, {4, 17}).find("has layout 3, this build reads layout 4"), std::string::npos);
  EXPECT_NE(text(bytes, {3, 18}).find("is of another scene"), std::string::npos);
  bytes.back() ^= std::byte{1};
  EXPECT_NE(text(bytes).find("is damaged"), std::string::npos);
  bytes.front() ^= std::byte{1};
  EXPECT_NE(text(bytes).find("is no saved state"), std::string::npos);
}

TEST(StateBytes, ThatTheModelCannotHaveAreRefused) {
  const auto is_refused = [](auto write, auto read) {
    std::vector<std::byte> bytes;
    StateWriter writer(bytes, kFormat);
    write(writer);
    writer.finish();
    StateReader reader(bytes, kFormat);
    read(reader);
    return !reader.finish("a test").is_ok();
  };
  std::size_t count = 5;
  EXPECT_TRUE(is_refused([](auto& bytes) { bytes.number(std::size_t{10}); },
                         [&](auto& bytes) { bytes.count(count, std::size_t{9}); }));
  EXPECT_EQ(count, 5u);
  bool flag = false;
  EXPECT_TRUE(is_refused([](auto& bytes) { bytes.number(std::uint8_t{2}); }, [&](auto& bytes) { bytes.flag(flag); }));
  Colour colour = Colour::green;
  for (const std::int32_t number : {-1, 3}) {
    EXPECT_TRUE(is_refused([number](auto& bytes) { bytes.number(number); },
                           [&](auto& bytes) { bytes.choice(colour, Colour::blue); }));
  }
  EXPECT_EQ(colour, Colour::green);
  StaticVector<double, 4> ports = {1, 2};
  const StaticVector<double, 4> more = {1, 2, 3};
  EXPECT_TRUE(is_refused([&](auto& bytes) { visit_sized(bytes, more, 3); },
                         [&](auto& bytes) { visit_sized(bytes, ports, 2); }));
  double x = 1;
  // more, and less, than was written
  EXPECT_TRUE(is_refused([](auto&) {}, [&](auto& bytes) { bytes.number(x); }));
  EXPECT_TRUE(is_refused([](auto& bytes) { bytes.number(2.0); }, [](auto&) {}));
  EXPECT_EQ(x, 1);
}

}  // namespace state_bytes_test
}  // namespace slew
