// SPDX-License-Identifier: Apache-2.0
#include "gateway/signal_channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <string_view>

#include "core/json.h"

namespace slew::gateway {
namespace {

constexpr const char* kLoneField = "value";  // field of a variable whose name has no part behind the element

// A field: a number, or an object of fields in the order of their first variable.
struct FieldNode {
  std::string name;
  std::string unit{};
  observer::VariablePlace place{};
  bool is_number = false;
  std::vector<FieldNode> fields{};
};

FieldNode* find(FieldNode& node, std::string_view name) {
  const auto found = std::ranges::find(node.fields, name, &FieldNode::name);
  return found == node.fields.end() ? nullptr : &*found;
}

// Adds a variable by the parts of its path. False: a part of it is a number already, or it is an object.
bool add(FieldNode& node, std::string_view path, const NamedPlace& variable) {
  const std::size_t dot = path.find('.');
  const std::string_view name = path.substr(0, dot);
  FieldNode* const present = find(node, name);
  if (dot == std::string_view::npos) {
    if (present != nullptr) return false;
    node.fields.push_back({std::string(name), variable.unit, variable.place, true});
    return true;
  }
  if (present != nullptr) return !present->is_number && add(*present, path.substr(dot + 1), variable);
  node.fields.push_back({std::string(name)});
  return add(node.fields.back(), path.substr(dot + 1), variable);
}

Json schema_of(const FieldNode& node) {
  if (node.is_number) return {{"type", "number"}, {"unit", node.unit}, {"description", node.unit}};
  Json properties = Json::object();
  for (const FieldNode& field : node.fields) properties[field.name] = schema_of(field);
  return {{"type", "object"}, {"properties", std::move(properties)}};
}

// Splits the message into the texts in front of its values.
void add_pieces(const FieldNode& node, std::string& text, std::vector<SignalChannel::Piece>& pieces) {
  if (node.is_number) {
    pieces.push_back({std::exchange(text, {}), node.place});
    return;
  }
  text += '{';
  bool is_first = true;
  for (const FieldNode& field : node.fields) {
    if (!std::exchange(is_first, false)) text += ',';
    text += Json(field.name).dump() + ':';
    add_pieces(field, text, pieces);
  }
  text += '}';
}

SignalChannel channel_of(const FieldNode& element) {
  SignalChannel channel;
  channel.topic = "/" + element.name;
  channel.schema_name = "slewring." + element.name;
  Json schema = schema_of(element);
  schema["title"] = channel.schema_name;
  channel.schema = schema.dump(-1, Json::Order::as_put);
  add_pieces(element, channel.end, channel.pieces);
  return channel;
}

}  // namespace

void put_number(double value, std::string& text) {
  if (std::isfinite(value)) {
    fmt::format_to(std::back_inserter(text), "{}", value);
  } else {
    text += "null";
  }
}

void SignalChannel::encode(const StepSnapshot& snapshot, std::string& message) const {
  for (const Piece& piece : pieces) {
    message += piece.text;
    put_number(snapshot.value(piece.place), message);
  }
  message += end;
}

std::vector<SignalChannel> signal_channels(std::span<const NamedPlace> variables) {
  std::vector<FieldNode> elements;
  std::map<std::string, std::size_t, std::less<>> index;
  for (const NamedPlace& variable : variables) {
    const std::string_view name = variable.name;
    const std::size_t dot = name.find('.');
    const std::string element(name.substr(0, dot));
    const auto [found, is_new] = index.emplace(element, elements.size());
    if (is_new) elements.push_back({element});
    FieldNode& node = elements[found->second];
    const std::string_view path = dot == std::string_view::npos ? kLoneField : name.substr(dot + 1);
    // a name that is a number and an object at once: the later variable keeps its whole path as one field
    if (!add(node, path, variable)) node.fields.push_back({std::string(path), variable.unit, variable.place, true});
  }
  std::vector<SignalChannel> channels;
  for (const FieldNode& element : elements) channels.push_back(channel_of(element));
  return channels;
}

}  // namespace slew::gateway
