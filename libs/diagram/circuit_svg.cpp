// SPDX-License-Identifier: Apache-2.0
#include "diagram/circuit_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "core/escaped.h"
#include "diagram/graph.h"
#include "plotting/svg_text.h"

namespace slew::diagram {

const std::string_view kDiagramStyle =
    ".diagram{--ground:#fff;--ink:#1d2227;--quiet:#5d656e;--supply:#b8262b;--return:#1b6ca8;--pilot:#a85a00;"
    "--shaft:#7b838b;--chip:#f1f4f6;--chip-line:#aab2b9;color:var(--ink)}"
    "@media (prefers-color-scheme:dark){.diagram{--ground:#15181b;--ink:#e4e7ea;--quiet:#9aa3ab;--supply:#ff7b72;"
    "--return:#5ea9f5;--pilot:#e5a13a;--shaft:#8a929a;--chip:#23282d;--chip-line:#59636c}}"
    ".diagram text{fill:var(--ink)}.diagram .ground{fill:var(--ground)}"
    ".diagram .name{font-size:11px;font-weight:600}"
    ".diagram .figure,.diagram .value{font-size:10px;fill:var(--quiet)}"
    ".diagram .symbol path,.diagram .symbol circle,.diagram .symbol rect,.diagram .tank "
    "path{fill:none;stroke:var(--ink);"
    "stroke-width:1.3;stroke-linejoin:round;stroke-linecap:round}"
    ".diagram .symbol .solid{fill:var(--ink);stroke:none}.diagram .symbol "
    ".pilot{stroke:var(--pilot);stroke-dasharray:4 3}"
    ".diagram .symbol .unit-border{stroke:var(--quiet);stroke-width:1;stroke-dasharray:8 3 2 3}"
    ".diagram .symbol .hit{fill:transparent;stroke:none}"
    ".diagram .line{fill:none;stroke-width:1.6;stroke-linejoin:round}"
    ".diagram .supply{stroke:var(--supply)}.diagram .working{stroke:var(--ink)}.diagram .return{stroke:var(--return)}"
    ".diagram .pilot{stroke:var(--pilot);stroke-dasharray:5 3.5}.diagram .line.pilot{stroke-width:1.2}"
    ".diagram .shaft{stroke:var(--shaft);stroke-width:5}.diagram .core{stroke:var(--ground);stroke-width:2.4}"
    ".diagram .dot{fill:currentColor;stroke:none}.diagram .tank path{stroke:var(--return)}"
    ".diagram g.supply{color:var(--supply)}.diagram g.return{color:var(--return)}.diagram g.pilot{color:var(--pilot)}"
    ".diagram g.working{color:var(--ink)}.diagram g.shaft{color:var(--shaft)}"
    ".diagram .chip{fill:var(--chip);stroke:var(--chip-line);stroke-width:1}";

namespace {

constexpr double kLegendHeight = 44;

std::string_view class_of(LineKind kind) noexcept {
  constexpr std::string_view kNames[] = {"supply", "working", "return", "pilot", "shaft"};
  return kNames[static_cast<std::size_t>(kind)];
}

template <typename... Arguments>
void put(std::string& out, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  fmt::format_to(std::back_inserter(out), format, std::forward<Arguments>(arguments)...);
}

void put_line(std::string& out, std::string_view kind, Point a, Point b) {
  put(out, "<path class=\"line {}\" d=\"M{:g} {:g}L{:g} {:g}\"/>", kind, a.x, a.y, b.x, b.y);
}

// Lines and dots of a net; a shaft is a double line.
void put_net(std::string& out, const CircuitLayout& layout, std::size_t index) {
  const Net& net = layout.nets[index];
  put(out, "<g class=\"net {}\" {}=\"{}\">", class_of(net.line),
      net.kind == NetKind::volume ? "data-volume" : "data-of", escaped(net.name));
  std::string cores;
  for (const Segment& one : layout.segments) {
    if (one.net != index) continue;
    put_line(out, class_of(one.kind), one.a, one.b);
    if (one.kind == LineKind::shaft) put_line(cores, "core", one.a, one.b);
  }
  out += cores;
  for (const auto& [of_net, dot] : layout.dots) {
    if (of_net == index) put(out, "<circle class=\"dot\" cx=\"{:g}\" cy=\"{:g}\" r=\"2.8\"/>", dot.x, dot.y);
  }
  out += "</g>\n";
}

void put_chip(std::string& out, const CircuitLayout& layout, const Chip& chip) {
  const Net& net = layout.nets[chip.net];
  const double middle = (chip.box.left + chip.box.right) / 2;
  put(out, "<g class=\"volume\" data-volume=\"{}\"><rect class=\"chip\" x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" ",
      escaped(net.name), chip.box.left, chip.box.top, chip.box.right - chip.box.left);
  put(out, "height=\"{:g}\" rx=\"4\"/>", chip.box.bottom - chip.box.top);
  const bool is_alone = net.figures.empty();
  put(out, "<text class=\"name mid{}\" x=\"{:g}\" y=\"{:g}\">{}</text>", is_alone ? " alone" : "", middle,
      chip.box.top + (is_alone ? 18 : 12), escaped(net.name));
  put(out, "<text class=\"value mid\" x=\"{:g}\" y=\"{:g}\">{}</text></g>\n", middle, chip.box.top + 23.5,
      is_alone ? "" : escaped(net.figures.front()));
}

// A tank stands below its port; at a port on the top the line turns downwards into it.
void put_tank(std::string& out, const TankSign& tank) {
  const double x = tank.port.x, y = tank.port.y;
  put(out, "<g class=\"tank\" data-volume=\"{}\">", escaped(tank.volume));
  if (tank.side == Side::bottom) {
    put_line(out, tank.is_pilot ? "pilot" : "return", {x, y}, {x, y + 14});
    put(out, "<path d=\"M{:g} {:g}v8h12v-8\"/>", x - 6, y + 10);
  } else {
    put(out, "<path class=\"line {}\" d=\"M{:g} {:g}V{:g}H{:g}V{:g}\"/>", tank.is_pilot ? "pilot" : "return", x, y,
        y - 22, x + 12 * tank.way, y - 8);
    put(out, "<path d=\"M{:g} {:g}v8h12v-8\"/>", x + 12 * tank.way - 6, y - 12);
  }
  out += "</g>\n";
}

void put_block(std::string& out, const Block& block) {
  const Box box = block.box(), symbol = block.symbol_box();
  put(out, "<g class=\"symbol\" {}=\"{}\"><title>{}</title>", block.is_volume ? "data-volume" : "data-element",
      escaped(block.name), escaped(block.name));
  put(out, "<rect class=\"hit\" x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" height=\"{:g}\"/>", box.left, box.top,
      box.right - box.left, box.bottom - box.top);
  put(out, "<g transform=\"translate({:g} {:g}){}\">{}</g>", symbol.left,
      block.symbol.is_turned ? symbol.bottom : symbol.top, block.symbol.is_turned ? "scale(1 -1)" : "",
      block.symbol.drawing);
  const double x = symbol.right + kTextGap;
  const std::size_t lines = block.lines.size() + (block.has_values ? 1 : 0);
  double y = (symbol.top + symbol.bottom) / 2 - kTextLine * static_cast<double>(lines) / 2 + 9.5;
  for (std::size_t i = 0; i < block.lines.size(); ++i, y += kTextLine) {
    put(out, "<text class=\"{}\" x=\"{:g}\" y=\"{:g}\">{}</text>", i == 0 ? "name" : "figure", x, y,
        escaped(block.lines[i]));
  }
  if (block.has_values) put(out, "<text class=\"value\" x=\"{:g}\" y=\"{:g}\"></text>", x, y);
  out += "</g>\n";
}

// ---- legend: kinds of lines that are there, and tanks

struct LegendEntry {
  std::string_view kind, text;
  double width = 0;
};

std::vector<LegendEntry> legend_of(const CircuitLayout& layout) {
  std::set<std::string_view> kinds;
  for (const Segment& one : layout.segments) kinds.insert(class_of(one.kind));
  if (!layout.tanks.empty()) kinds.insert("return");
  std::vector<LegendEntry> entries;
  for (const auto& [kind, text] :
       {std::pair("supply", "pressure line"), std::pair("working", "working line"), std::pair("return", "tank line"),
        std::pair("pilot", "pilot line"), std::pair("shaft", "shaft")}) {
    if (kinds.contains(kind)) entries.push_back({kind, text, 46 + figure_width(text)});
  }
  return entries;
}

std::string tank_text(const CircuitLayout& layout) {
  std::set<std::string> names;
  for (const TankSign& tank : layout.tanks) names.insert(tank.volume);
  if (names.empty()) return "";
  return fmt::format("tank: {}", fmt::join(names, ", "));
}

double legend_width(const CircuitLayout& layout) {
  double width = 32 + figure_width(tank_text(layout));
  for (const LegendEntry& entry : legend_of(layout)) width += entry.width;
  return width;
}

void put_legend(std::string& out, const CircuitLayout& layout) {
  double x = 16;
  const double y = layout.height + kLegendHeight - 22;
  out += "<g class=\"legend\">";
  for (const LegendEntry& entry : legend_of(layout)) {
    put_line(out, entry.kind, {x, y - 3.5}, {x + 24, y - 3.5});
    if (entry.kind == "shaft") put_line(out, "core", {x, y - 3.5}, {x + 24, y - 3.5});
    put(out, "<text class=\"figure\" x=\"{:g}\" y=\"{:g}\">{}</text>", x + 30, y, entry.text);
    x += entry.width;
  }
  put(out, "<text class=\"figure\" x=\"{:g}\" y=\"{:g}\">{}</text></g>\n", x, y, escaped(tank_text(layout)));
}

}  // namespace

PictureSize circuit_size(const CircuitLayout& layout) {
  return {std::max(layout.width, legend_width(layout)), layout.height + kLegendHeight};
}

std::string circuit_group(const CircuitLayout& layout) {
  std::string out = "<g class=\"circuit\">\n";
  for (std::size_t net = 0; net < layout.nets.size(); ++net) put_net(out, layout, net);
  for (const TankSign& tank : layout.tanks) put_tank(out, tank);
  for (const Chip& chip : layout.chips) put_chip(out, layout, chip);
  for (const Block& block : layout.blocks) put_block(out, block);
  put_legend(out, layout);
  return out + "</g>\n";
}

std::string circuit_svg(const CircuitLayout& layout) {
  const auto [width, height] = circuit_size(layout);
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"diagram\" width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 "
      "{0:g} "
      "{1:g}\">\n<style>{2}{3}</style>\n<rect class=\"ground\" width=\"100%\" height=\"100%\"/>\n{4}</svg>\n",
      width, height, plotting::kStyle, kDiagramStyle, circuit_group(layout));
}

}  // namespace slew::diagram
