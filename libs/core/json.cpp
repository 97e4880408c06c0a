// SPDX-License-Identifier: Apache-2.0
#include "core/json.h"

#include <map>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>

#include "core/check.h"
#include "core/failure.h"

namespace slew {
namespace {

using Members = std::map<std::string, Json, std::less<>>;

struct Object {
  Members members;
  std::vector<std::string> as_put;  // names
};

[[noreturn]] void refuse(const std::string& what) {
  throw Failure(ExitCode::bad_input, "JSON: " + what);
}

}  // namespace

struct Json::Value {
  std::variant<bool, std::int64_t, std::uint64_t, double, std::string, std::vector<Json>, Object> held;

  template <class Held>
  [[nodiscard]] static const Held* in(const Json& json) noexcept {
    return json.value_ ? std::get_if<Held>(&json.value_->held) : nullptr;
  }
  // requires a kind of value; the message names it
  template <class Held>
  [[nodiscard]] static const Held& as(const Json& json, const char* kind) {
    const Held* held = in<Held>(json);
    if (held == nullptr) refuse(json.dump() + " is not " + kind);
    return *held;
  }
  template <class Held>
  [[nodiscard]] static Held& made_as(Json& json) {
    if (!json.value_) json.value_ = std::make_unique<Value>(Value{Held{}});
    Held* held = std::get_if<Held>(&json.value_->held);
    SLEW_CHECK(held != nullptr);
    return *held;
  }

  template <class Foreign>
  [[nodiscard]] static Foreign to_foreign(const Json& json) {
    if (!json.value_) return nullptr;
    return std::visit(
        [&](const auto& content) -> Foreign {
          using Held = std::decay_t<decltype(content)>;
          if constexpr (std::is_same_v<Held, std::vector<Json>>) {
            Foreign items = Foreign::array();
            for (const Json& item : content) items.push_back(to_foreign<Foreign>(item));
            return items;
          } else if constexpr (std::is_same_v<Held, Object>) {
            Foreign object = Foreign::object();
            for (const std::string& name : content.as_put) object[name] = to_foreign<Foreign>(content.members.at(name));
            return object;
          } else {
            return content;
          }
        },
        json.value_->held);
  }

  [[nodiscard]] static Json from_foreign(const nlohmann::json& foreign) {
    switch (foreign.type()) {
      case nlohmann::json::value_t::boolean:
        return foreign.get<bool>();
      case nlohmann::json::value_t::number_integer:
        return foreign.get<std::int64_t>();
      case nlohmann::json::value_t::number_unsigned:
        return foreign.get<std::uint64_t>();
      case nlohmann::json::value_t::number_float:
        return foreign.get<double>();
      case nlohmann::json::value_t::string:
        return foreign.get_ref<const std::string&>();
      case nlohmann::json::value_t::array: {
        Json array = Json::array();
        for (const nlohmann::json& item : foreign) array.push_back(from_foreign(item));
        return array;
      }
      case nlohmann::json::value_t::object: {
        Json object = Json::object();
        for (const auto& [name, value] : foreign.items()) object[name] = from_foreign(value);
        return object;
      }
      default:
        return {};
    }
  }
};

Json::Json() noexcept = default;
Json::Json(Truth truth) : value_(std::make_unique<Value>(Value{truth.value})) {}
Json::Json(double value) : value_(std::make_unique<Value>(Value{value})) {}
Json::Json(Signed number) : value_(std::make_unique<Value>(Value{number.value})) {}
Json::Json(Unsigned number) : value_(std::make_unique<Value>(Value{number.value})) {}
Json::Json(const char* text) : Json(std::string_view(text)) {}
Json::Json(std::string_view text) : value_(std::make_unique<Value>(Value{std::string(text)})) {}
Json::Json(const std::string& text) : Json(std::string_view(text)) {}

Json::Json(std::initializer_list<Member> members) : Json(object()) {
  put_all(members);
}

Json Json::array(std::initializer_list<Json> items) {
  Json array;
  Value::made_as<std::vector<Json>>(array) = items;
  return array;
}

Json Json::object() {
  Json object;
  static_cast<void>(Value::made_as<Object>(object));
  return object;
}

Json::Json(const Json& other) : value_(other.value_ ? std::make_unique<Value>(*other.value_) : nullptr) {}
Json::Json(Json&& other) noexcept = default;
Json::~Json() = default;

Json& Json::operator=(Json other) noexcept {
  value_ = std::move(other.value_);
  return *this;
}

Json& Json::operator[](std::string_view name) {
  auto& [members, as_put] = Value::made_as<Object>(*this);
  if (const auto at = members.find(name); at != members.end()) return at->second;
  as_put.emplace_back(name);
  return members[as_put.back()];
}

void Json::push_back(Json item) {
  Value::made_as<std::vector<Json>>(*this).push_back(std::move(item));
}

void Json::put_all(std::initializer_list<Member> members) {
  for (const Member& member : members) (*this)[member.name] = std::move(member.value);
}

void Json::erase(std::string_view name) {
  auto& [members, as_put] = Value::made_as<Object>(*this);
  std::erase(as_put, name);
  if (const auto at = members.find(name); at != members.end()) members.erase(at);
}

bool Json::is_null() const noexcept {
  return value_ == nullptr;
}
bool Json::is_number() const noexcept {
  return Value::in<double>(*this) != nullptr || Value::in<std::int64_t>(*this) != nullptr ||
         Value::in<std::uint64_t>(*this) != nullptr;
}
bool Json::is_object() const noexcept {
  return Value::in<Object>(*this) != nullptr;
}
bool Json::is_array() const noexcept {
  return Value::in<std::vector<Json>>(*this) != nullptr;
}

const Json* Json::find(std::string_view name) const noexcept {
  const Object* object = Value::in<Object>(*this);
  if (object == nullptr) return nullptr;
  const auto at = object->members.find(name);
  return at == object->members.end() ? nullptr : &at->second;
}

const Json& Json::at(std::string_view name) const {
  if (const Json* member = find(name)) return *member;
  refuse("there is no member '" + std::string(name) + "' in " + dump());
}

std::string Json::text_or(std::string_view name, std::string_view otherwise) const {
  const Json* member = find(name);
  return member != nullptr ? member->text() : std::string(otherwise);
}

const std::vector<Json>& Json::items() const {
  static const std::vector<Json> none;
  return is_null() ? none : Value::as<std::vector<Json>>(*this, "an array");
}

bool Json::boolean() const {
  return Value::as<bool>(*this, "true or false");
}

double Json::number() const {
  if (const auto* number = Value::in<std::int64_t>(*this)) return static_cast<double>(*number);
  if (const auto* number = Value::in<std::uint64_t>(*this)) return static_cast<double>(*number);
  return Value::as<double>(*this, "a number");
}

std::int64_t Json::integer() const {
  if (const auto* number = Value::in<std::uint64_t>(*this); number != nullptr && std::in_range<std::int64_t>(*number)) {
    return static_cast<std::int64_t>(*number);
  }
  return Value::as<std::int64_t>(*this, "an integer");
}

const std::string& Json::text() const {
  return Value::as<std::string>(*this, "a text");
}

std::vector<std::string> Json::texts() const {
  std::vector<std::string> texts;
  for (const Json& item : items()) texts.push_back(item.text());
  return texts;
}

std::string Json::dump(int indent, Order order) const {
  constexpr auto kReplace = nlohmann::json::error_handler_t::replace;
  if (order == Order::as_put)
    return Value::to_foreign<nlohmann::ordered_json>(*this).dump(indent, ' ', false, kReplace);
  return Value::to_foreign<nlohmann::json>(*this).dump(indent, ' ', false, kReplace);
}

std::optional<Json> Json::parse(std::string_view text) {
  const nlohmann::json foreign = nlohmann::json::parse(text, nullptr, false);
  if (foreign.is_discarded()) return std::nullopt;
  return Value::from_foreign(foreign);
}

}  // namespace slew
