// SPDX-License-Identifier: Apache-2.0
// Messages with random contents of every length up to the caps, made by the same field lists as the codec.
#pragma once

#include <bit>
#include <cstdint>
#include <random>
#include <string>
#include <type_traits>

#include "transport/cdr/codec_fields.h"

namespace slew::testing {

class RandomFields {
 public:
  template <typename T>
  using Of = T;

  // `longest`: cap of texts and lists below their own
  RandomFields(std::mt19937_64& random, std::size_t longest) : random_(random), longest_(longest) {}

  template <typename... T>
  void operator()(T&&... values) {
    (item(values), ...);
  }

 private:
  std::size_t below(std::size_t limit) { return static_cast<std::size_t>(random_() % limit); }

  template <typename T>
  void item(T& value) {
    using transport::detail::fields;
    if constexpr (std::is_same_v<T, bool>) {
      value = below(2) == 1;
    } else if constexpr (std::is_enum_v<T>) {
      value = static_cast<T>(below(transport::detail::kEnumerators<T>));
    } else if constexpr (std::is_same_v<T, double>) {
      // any finite number, so that comparing for equality means the same bits
      do {
        value = std::bit_cast<double>(random_());
      } while (value - value != 0.0);
    } else if constexpr (std::is_arithmetic_v<T>) {
      value = static_cast<T>(random_());
    } else {
      fields(*this, value);
    }
  }

  template <std::size_t N>
  void item(std::array<std::uint8_t, N>& octets) {
    for (std::uint8_t& octet : octets) item(octet);
  }

  template <typename T, std::size_t N>
  void item(StaticVector<T, N>& values) {
    values.resize(below(std::min(N, longest_) + 1));
    for (T& value : values) item(value);
  }

  void item(transport::detail::Text<std::string>& text) {
    text.value.resize(below(std::min(text.cap, longest_) + 1));
    for (char& character : text.value) character = static_cast<char>(1 + below(255));
  }

  template <typename F>
  void item(transport::detail::Appended<F> appended) {
    item(appended.field);
  }

  template <typename N>
  void item(transport::detail::Bounded<N> number) {
    const auto span = static_cast<std::uint64_t>(number.most - number.least) + 1;
    number.value = static_cast<N>(number.least + static_cast<std::int64_t>(random_() % span));
  }

  template <typename T>
  void item(transport::detail::List<std::vector<T>>& list) {
    using transport::detail::fields;
    list.values.resize(below(std::min(list.cap, longest_) + 1));
    for (T& value : list.values) fields(*this, value);
  }

  std::mt19937_64& random_;
  std::size_t longest_;
};

template <typename M>
[[nodiscard]] M random_message(std::mt19937_64& random, std::size_t longest) {
  using transport::detail::fields;
  M message;
  RandomFields filler(random, longest);
  fields(filler, message);
  return message;
}

}  // namespace slew::testing
