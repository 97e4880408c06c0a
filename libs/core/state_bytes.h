// SPDX-License-Identifier: Apache-2.0
// The whole state of a subsystem as bytes, so that a run can be continued to the bit: raw bits of this architecture
// (little-endian) behind a header.
//
//   magic u32 | layout u32 | model u64 | length u64 | check u64 | `length` bytes
//
// layout: number of the field list, raised when it changes. model: digest of the model that the state belongs to.
// check: XXH3 of the bytes. A state is one list of fields. Both classes below visit it with the same functions, so the
// reader follows the writer's order. Sizes follow from the model and are not written.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/status.h"

namespace slew {

// Header values that saved bytes must have.
struct StateFormat {
  std::uint32_t layout = 0;
  std::uint64_t model = 0;
};

// Limit of step numbers in a state; the sum of two is still a valid step number.
inline constexpr std::int64_t kLastStep = std::int64_t{1} << 60;

// A number of any value: not bool, not an enum.
template <typename T>
concept StateNumber = std::is_arithmetic_v<T> && !std::is_same_v<T, bool>;

// Appends; allocates only beyond the capacity of the bytes.
class StateWriter {
 public:
  static constexpr bool kIsReading = false;

  // bytes outlive the writer.
  StateWriter(std::vector<std::byte>& bytes, StateFormat format);
  // Completes the header; nothing is written after it.
  void finish() noexcept;

  template <StateNumber T>
  void number(const T& value) {
    append(&value, sizeof value);
  }
  template <StateNumber T>
  void numbers(std::span<const T> values) {
    append(values.data(), values.size_bytes());
  }
  void numbers(std::span<const double> values) { append(values.data(), values.size_bytes()); }
  // 0 or 1 in any type.
  template <typename T>
  void flag(const T& value) {
    number(static_cast<std::uint8_t>(value ? 1 : 0));
  }
  // A whole number from 0 to `most`.
  template <std::integral T>
  void count(const T& value, T) {
    number(value);
  }
  // An enum with the values from 0 to `last`.
  template <typename T>
  requires std::is_enum_v<T>
  void choice(const T& value, T) { number(static_cast<std::int32_t>(value)); }

 private:
  void append(const void* data, std::size_t size);

  std::vector<std::byte>& bytes_;
  std::size_t begin_;
};

// Never reads beyond the bytes. After the first fault, targets keep their values.
class StateReader {
 public:
  static constexpr bool kIsReading = true;

  StateReader(std::span<const std::byte> bytes, StateFormat format) noexcept;

  [[nodiscard]] bool is_sound() const noexcept { return fault_ == Fault::none; }
  // Called by the owner if a value read is impossible.
  void refuse() noexcept { note(Fault::damaged); }
  // Ok if everything was sound and no bytes are left. Error (bad_input); whose: "mechanics".
  [[nodiscard]] Status finish(std::string_view whose) const;

  template <StateNumber T>
  void number(T& value) noexcept {
    take(&value, sizeof value);
  }
  template <StateNumber T>
  void numbers(std::span<T> values) noexcept {
    take(values.data(), values.size_bytes());
  }
  void numbers(std::span<double> values) noexcept { take(values.data(), values.size_bytes()); }
  template <typename T>
  void flag(T& value) noexcept {
    std::uint8_t read = 2;
    number(read);
    if (read > 1) return refuse();
    value = static_cast<T>(read);
  }
  template <std::integral T>
  void count(T& value, T most) noexcept {
    T read = 0;
    number(read);
    if (read < 0 || read > most) return refuse();
    if (is_sound()) value = read;
  }
  template <typename T>
  requires std::is_enum_v<T>
  void choice(T& value, T last) noexcept {
    std::int32_t read = -1;
    number(read);
    if (read < 0 || read > static_cast<std::int32_t>(last)) return refuse();
    value = static_cast<T>(read);
  }

 private:
  enum class Fault { none, cut, no_state, layout, model, damaged };
  // keeps the first fault for the report
  void note(Fault fault) noexcept {
    if (fault_ == Fault::none) fault_ = fault;
  }
  [[nodiscard]] Fault open(std::span<const std::byte> bytes, StateFormat format) noexcept;
  void take(void* target, std::size_t size) noexcept;

  std::span<const std::byte> rest_;
  Fault fault_ = Fault::none;
  std::uint32_t layout_ = 0, expected_layout_ = 0;
};

// ---- fields that several states have

template <typename Bytes, typename Report>
void visit_report(Bytes& bytes, Report& report) {
  bytes.number(report.flags);
  bytes.number(report.offender);
  bytes.number(report.substeps);
  bytes.number(report.iterations);
  bytes.number(report.residual);
}

// A StaticVector that holds `size` numbers.
template <typename Bytes, typename Values>
void visit_sized(Bytes& bytes, Values& values, std::size_t size) {
  std::size_t held = values.size();
  bytes.count(held, Values::capacity());
  if constexpr (Bytes::kIsReading) {
    if (held != size) return bytes.refuse();
    values.resize(size);
  }
  bytes.numbers(values.span());
}

// x, y and z.
template <typename Bytes, typename Vector>
void visit_vector(Bytes& bytes, Vector& vector) {
  for (int k = 0; k < 3; ++k) {
    double x = vector[k];
    bytes.number(x);
    if constexpr (Bytes::kIsReading) vector.lanes[k] = x;
  }
}

}  // namespace slew
