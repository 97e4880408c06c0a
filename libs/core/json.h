// SPDX-License-Identifier: Apache-2.0
// A JSON value (RFC 8259) that is built, read and written: null, truth value, number, text, array or object.
//
//   Json json = {{"scene", scene.name}, {"steps", steps}};   an object
//   json["ports"].push_back(port_json);                      null becomes an array or an object where it is used as one
//   fmt::print("{}\n", json.dump(2));
//
// Numbers are int64, uint64 or double; a double that is not finite is written as null, bytes that are not UTF-8 as
// U+FFFD. The header stands for the JSON library, which one unit compiles.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slew {

class Json {
 public:
  struct Member;
  enum class Order { by_name, as_put };  // order of the members in every written object

  Json() noexcept;                    // null
  template <std::same_as<bool> Bool>  // and no pointer
  Json(Bool value) : Json(Truth{value}) {}
  Json(double value);
  template <std::signed_integral Integer>
  Json(Integer value) : Json(Signed{value}) {}
  template <std::unsigned_integral Integer>
  requires(!std::same_as<Integer, bool>) Json(Integer value) : Json(Unsigned{value}) {}
  Json(const char* text);
  Json(std::string_view text);
  Json(const std::string& text);
  template <std::ranges::input_range Items>  // an array
  requires(std::convertible_to<std::ranges::range_value_t<Items>, Json> &&
           !std::convertible_to<const Items&, std::string_view>) Json(const Items& items)
      : Json(array()) {
    for (const auto& item : items) push_back(item);
  }
  Json(std::initializer_list<Member> members);  // an object
  [[nodiscard]] static Json array(std::initializer_list<Json> items = {});
  [[nodiscard]] static Json object();

  Json(const Json& other);
  Json(Json&& other) noexcept;
  Json& operator=(Json other) noexcept;
  ~Json();

  // ---- building: of a null value or of the right kind; SLEW_CHECK otherwise -----------------------------------------
  Json& operator[](std::string_view name);  // made as null when it is not there
  void push_back(Json item);
  void put_all(std::initializer_list<Member> members);
  void erase(std::string_view name);

  // ---- reading: throws Failure (bad_input) when the value is of another kind or the member is not there -------------
  [[nodiscard]] bool is_null() const noexcept;
  [[nodiscard]] bool is_number() const noexcept;
  [[nodiscard]] bool is_object() const noexcept;
  [[nodiscard]] bool is_array() const noexcept;
  [[nodiscard]] const Json& at(std::string_view name) const;
  [[nodiscard]] const Json* find(std::string_view name) const noexcept;  // null: not there, or no object
  [[nodiscard]] std::string text_or(std::string_view name, std::string_view otherwise) const;  // member or otherwise
  [[nodiscard]] const std::vector<Json>& items() const;  // elements of an array; null has none
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] double number() const;
  [[nodiscard]] std::int64_t integer() const;
  [[nodiscard]] const std::string& text() const;
  [[nodiscard]] std::vector<std::string> texts() const;

  // ---- as text ------------------------------------------------------------------------------------------------------
  // indent: spaces of a level; below 0: one line.
  [[nodiscard]] std::string dump(int indent = -1, Order order = Order::by_name) const;
  // Nothing when the text is not JSON.
  [[nodiscard]] static std::optional<Json> parse(std::string_view text);

 private:
  struct Value;
  struct Truth {
    bool value;
  };
  struct Signed {
    std::int64_t value;
  };
  struct Unsigned {
    std::uint64_t value;
  };
  explicit Json(Truth truth);
  explicit Json(Signed number);
  explicit Json(Unsigned number);

  std::unique_ptr<Value> value_;  // null pointer: null
};

struct Json::Member {
  std::string_view name;
  mutable Json value;  // moved from: the elements of an initializer list are const
};

}  // namespace slew
