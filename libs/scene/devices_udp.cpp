// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "devices/udp_address.h"
#include "scene/device_readers.h"
#include "scene/units.h"

namespace slew::scene {
namespace {

std::vector<Field> make_udp_in_fields() {
  std::vector<Field> fields = {
      field<&UdpInDef::listen>("listen",
                               {.presence = Presence::required, .doc = "own address and port, as 127.0.0.1:5005"}),
      field<&UdpInDef::from>("from", {.doc = "addresses of the accepted senders"}),
      field<&UdpInDef::timeout>(
          "timeout",
          {.dimension = Dimension::time, .range = kSilenceRange, .doc = "silence after which inputs go to neutral"}),
  };
  add_layout_fields<UdpInDef>(fields);
  fields.push_back(lent<&UdpInDef::layout, &devices::LayoutDef::most_lost>(devices::layout_fields(), "most_lost"));
  add_enable_fields<UdpInDef>(fields, "field that must not be 0 before an input leaves neutral");
  return fields;
}

std::vector<Field> make_udp_out_fields() {
  std::vector<Field> fields = {
      field<&UdpOutDef::send>(
          "send", {.presence = Presence::required, .doc = "address and port of the receiver, as 127.0.0.1:5006"}),
      field<&UdpOutDef::every>(
          "every",
          {.dimension = Dimension::time, .range = kOftenRange, .doc = "shortest session time between two packets"}),
  };
  add_layout_fields<UdpOutDef>(fields);
  return fields;
}

}  // namespace

std::span<const Field> udp_in_fields() {
  static const std::vector<Field> fields = make_udp_in_fields();
  return fields;
}
std::span<const Field> udp_out_fields() {
  static const std::vector<Field> fields = make_udp_out_fields();
  return fields;
}

void read_udp_in(UdpInDef& def, InputUse& use, Problems& problems) {
  const bool has_address = check_address(def.name + ".listen", def.listen, problems);
  for (const std::string& host : def.from) {
    if (devices::parse_host(host)) continue;
    problems.push_back({def.name + ".from", fmt::format("'{}' is no address", host), "IPv4, as 127.0.0.1", ""});
  }
  if (def.from.empty()) {
    problems.push_back({def.name + ".from", "every packet would be refused", "addresses of the senders", ""});
  }
  read_enable(def.name, def.enable, def.timeout, problems);
  const auto layout = read_layout(def.name, def.layout, problems);
  if (!layout || !has_address) return;
  bool has_input = false, has_dead_man = def.enable.dead_man.empty();
  for (const devices::PlacedField& placed : layout->fields) {
    const devices::LayoutFieldDef& f = placed.def;
    const std::string path = fmt::format("{}.{}", def.name, f.name);
    if (!f.variable.empty() || !f.output.empty()) {
      problems.push_back({path, "a received field takes nothing from the session", "input", ""});
    }
    has_dead_man = has_dead_man || (placed.has_value && f.name == def.enable.dead_man);
    if (f.input.empty()) continue;
    has_input = true;
    if (!placed.has_value) {
      problems.push_back({path + ".input", "a sequence, a checksum or a divided integer has no value", "no input", ""});
    } else if (const InputDef* const input = use.find(f.input)) {
      use.use(path + ".input", def.name, *input);
    }
  }
  if (!has_input) problems.push_back({def.name, "the device moves nothing", "a field with an input", ""});
  if (!has_dead_man) {
    problems.push_back({def.name + ".dead_man", fmt::format("there is no field '{}'", def.enable.dead_man),
                        "a field of the layout that has a value", ""});
  }
}

// Variables are sent in SI: a field's scale and offset make raw numbers in another unit.
void check_unit_of_variable(const std::string& path, const devices::LayoutFieldDef& f, Problems& problems) {
  if (f.variable.empty() || f.unit.empty() || f.unit == "1") return;
  UnitSystem units;
  const Unit* const unit = units.find(f.unit);
  if (unit == nullptr || unit->has_other_base) {
    problems.push_back({path + ".unit",
                        fmt::format("{} '{}'", unit == nullptr ? "there is no unit" : "no variable is in", f.unit),
                        "the SI unit of the variable, as m, N or Pa", ""});
  } else if (unit->scale != 1 || unit->offset != 0) {
    const std::string si = si_unit_of(unit->exponent);
    std::string change = fmt::format("unit: {}", si.empty() ? "1" : si);
    if (unit->scale != 1) change += fmt::format(", scale: {:.15g}", static_cast<double>(unit->scale));
    if (unit->offset != 0) change += fmt::format(", offset: {:.15g}", static_cast<double>(unit->offset));
    problems.push_back({path + ".unit", fmt::format("a variable is sent in SI, not in '{}'", f.unit),
                        fmt::format("'{}' for raw numbers in {}", change, f.unit), ""});
  }
}

void check_sent_fields(const std::string& device, const devices::ByteLayout& layout, Problems& problems) {
  bool shows_something = false;
  for (const devices::PlacedField& placed : layout.fields) {
    const devices::LayoutFieldDef& f = placed.def;
    const std::string path = fmt::format("{}.{}", device, f.name);
    const bool is_used = !f.variable.empty() || !f.output.empty();
    shows_something = shows_something || is_used;
    if (!f.input.empty()) problems.push_back({path + ".input", "a sent field moves nothing", "variable or output", ""});
    if (!f.variable.empty() && !f.output.empty()) {
      problems.push_back({path, "the field has two sources", "variable or output", ""});
    }
    check_unit_of_variable(path, f, problems);
    if (is_used && !placed.has_value) {
      problems.push_back(
          {path, "a sequence, a checksum or a divided integer has no value", "no variable or output", ""});
    }
  }
  if (!shows_something) {
    problems.push_back({device, "the device shows nothing", "a field with a variable or an output", ""});
  }
}

void read_udp_out(UdpOutDef& def, Problems& problems) {
  check_address(def.name + ".send", def.send, problems);
  if (const auto layout = read_layout(def.name, def.layout, problems)) check_sent_fields(def.name, *layout, problems);
}

}  // namespace slew::scene
