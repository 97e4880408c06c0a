// SPDX-License-Identifier: Apache-2.0
// The diagrams of all scenes: nothing lies over anything else, every connection is drawn, every element has its id.
#include "diagram/circuit_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "build_paths.h"
#include "diagram/circuit_svg.h"
#include "scene/scene.h"

namespace slew::diagram {
namespace {

struct Drawn {
  std::string name;
  scene::Scene scene;
  CircuitLayout layout;
};

// Those with a circuit. Those that differ from another one by mechanics alone are left out.
const std::vector<Drawn>& scenes() {
  static const std::vector<Drawn> scenes = [] {
    std::vector<std::string> paths;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(SLEWRING_SOURCE_DIR "/scenes")) {
      if (entry.path().extension() != ".yaml" || entry.path().parent_path().filename() == "beams") continue;
      paths.push_back(entry.path().string());
    }
    std::sort(paths.begin(), paths.end());
    std::vector<Drawn> drawn;
    for (const std::string& path : paths) {
      const std::string name = std::filesystem::path(path).stem().string();
      if (name.starts_with("truck_crane_")) continue;
      scene::Scene scene = scene::load_file(path);
      if (scene.hydraulics.components.empty()) continue;
      CircuitLayout layout = lay_out(scene.hydraulics);
      drawn.push_back({name, std::move(scene), std::move(layout)});
    }
    return drawn;
  }();
  return scenes;
}

bool overlap(const Box& a, const Box& b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

Box box_of(const Segment& one) {
  return {std::min(one.a.x, one.b.x), std::min(one.a.y, one.b.y), std::max(one.a.x, one.b.x),
          std::max(one.a.y, one.b.y)};
}

bool crosses(const Segment& one, Box box) {
  const Box line = box_of(one);
  return line.left < box.right && box.left < line.right && line.top < box.bottom && box.top < line.bottom;
}

TEST(CircuitLayout, ScenesWithCircuitsAreThere) {
  EXPECT_GE(scenes().size(), 15u);
}

TEST(CircuitLayout, NoSymbolsOrTextsOverlap) {
  for (const Drawn& drawn : scenes()) {
    SCOPED_TRACE(drawn.name);
    std::vector<std::pair<std::string, Box>> boxes;
    for (const Block& block : drawn.layout.blocks) boxes.emplace_back(block.name, block.box());
    for (const Chip& chip : drawn.layout.chips) boxes.emplace_back(drawn.layout.nets[chip.net].name, chip.box);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Box& box = boxes[i].second;
      EXPECT_TRUE(box.left >= 0 && box.top >= 0 && box.right <= drawn.layout.width && box.bottom <= drawn.layout.height)
          << boxes[i].first;
      for (std::size_t k = 0; k < i; ++k)
        EXPECT_FALSE(overlap(box, boxes[k].second)) << boxes[i].first << ", " << boxes[k].first;
    }
  }
}

TEST(CircuitLayout, LinesPassNoSymbolAndNoText) {
  for (const Drawn& drawn : scenes()) {
    SCOPED_TRACE(drawn.name);
    for (const Segment& one : drawn.layout.segments) {
      for (const Block& block : drawn.layout.blocks) {
        const bool is_own = std::any_of(block.ports.begin(), block.ports.end(),
                                        [&](const BlockPort& port) { return port.net_index == one.net; });
        // a port's own line leaves from the symbol in its lane
        Box box = block.box();
        if (is_own) box.left = block.symbol_box().right;
        EXPECT_FALSE(crosses(one, box)) << drawn.layout.nets[one.net].name << " over " << block.name;
      }
      for (const Chip& chip : drawn.layout.chips) {
        if (chip.net == one.net) continue;
        EXPECT_FALSE(crosses(one, chip.box))
            << drawn.layout.nets[one.net].name << " over " << drawn.layout.nets[chip.net].name;
      }
    }
  }
}

TEST(CircuitLayout, LinesOfTwoNetsCrossAndDoNotTouch) {
  constexpr double kApart = 4;  // px
  for (const Drawn& drawn : scenes()) {
    SCOPED_TRACE(drawn.name);
    const std::vector<Segment>& all = drawn.layout.segments;
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_TRUE(all[i].a.x == all[i].b.x || all[i].a.y == all[i].b.y) << "a line is neither upright nor level";
      for (std::size_t k = 0; k < i; ++k) {
        if (all[i].net == all[k].net) continue;
        const bool are_level = all[i].a.y == all[i].b.y && all[k].a.y == all[k].b.y;
        const bool are_upright = all[i].a.x == all[i].b.x && all[k].a.x == all[k].b.x;
        if (!are_level && !are_upright) continue;
        const Box a = box_of(all[i]), b = box_of(all[k]);
        const bool touch = a.left < b.right + kApart && b.left < a.right + kApart && a.top < b.bottom + kApart &&
                           b.top < a.bottom + kApart;
        EXPECT_FALSE(touch) << drawn.layout.nets[all[i].net].name << " and " << drawn.layout.nets[all[k].net].name;
      }
    }
  }
}

bool is_on(Point point, const Segment& one) {
  const Box box = box_of(one);
  return box.left <= point.x && point.x <= box.right && box.top <= point.y && point.y <= box.bottom;
}

// Pieces of the net's line that can be reached from its first one.
std::size_t reached_pieces(const std::vector<Segment>& pieces) {
  std::vector<bool> is_reached(pieces.size());
  std::vector<std::size_t> open = {0};
  is_reached[0] = true;
  std::size_t count = 0;
  while (!open.empty()) {
    const Segment& one = pieces[open.back()];
    open.pop_back();
    ++count;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      if (is_reached[k] ||
          !(is_on(one.a, pieces[k]) || is_on(one.b, pieces[k]) || is_on(pieces[k].a, one) || is_on(pieces[k].b, one))) {
        continue;
      }
      is_reached[k] = true;
      open.push_back(k);
    }
  }
  return count;
}

TEST(CircuitLayout, EveryConnectionIsDrawn) {
  for (const Drawn& drawn : scenes()) {
    const CircuitLayout& layout = drawn.layout;
    std::vector<std::vector<Segment>> pieces(layout.nets.size());
    for (const Segment& one : layout.segments) pieces[one.net].push_back(one);
    for (std::size_t net = 0; net < layout.nets.size(); ++net) {
      SCOPED_TRACE(drawn.name + ": " + layout.nets[net].name);
      if (!pieces[net].empty()) EXPECT_EQ(reached_pieces(pieces[net]), pieces[net].size()) << "the line has a gap";
    }
    for (const Block& block : layout.blocks) {
      for (const BlockPort& port : block.ports) {
        SCOPED_TRACE(drawn.name + ": " + block.name + "." + port.key);
        const Point begin = block.begin(port);
        if (port.net_index == kTankNet) {
          EXPECT_TRUE(std::any_of(layout.tanks.begin(), layout.tanks.end(), [&](const TankSign& tank) {
            return tank.volume == port.net && tank.port.x == begin.x && tank.port.y == begin.y;
          }));
        } else {
          EXPECT_EQ(layout.nets[port.net_index].name, port.net);
          EXPECT_TRUE(std::any_of(pieces[port.net_index].begin(), pieces[port.net_index].end(),
                                  [&](const Segment& one) { return is_on(begin, one); }));
        }
      }
    }
  }
}

// Names of the elements that are open where the text ends; a name with "?" where one closes that is not open.
std::string unclosed(const std::string& svg) {
  std::vector<std::string> open;
  for (std::size_t at = 0; (at = svg.find('<', at)) != std::string::npos;) {
    const std::size_t end = svg.find('>', at);
    if (end == std::string::npos) return "an element without an end";
    const std::string tag = svg.substr(at + 1, end - at - 1);
    const std::string name = tag.substr(0, tag.find_first_of(" \n/", tag.starts_with('/') ? 1 : 0));
    if (tag.starts_with('/')) {
      if (open.empty() || "/" + open.back() != name) return name + "?";
      open.pop_back();
    } else if (!tag.ends_with('/')) {
      open.push_back(name);
    }
    if (std::count(tag.begin(), tag.end(), '"') % 2 != 0) return name + ": quotes";
    at = end;
  }
  return open.empty() ? "" : open.back();
}

TEST(CircuitSvg, HasAnIdForEveryComponentAndVolume) {
  for (const Drawn& drawn : scenes()) {
    SCOPED_TRACE(drawn.name);
    const std::string svg = circuit_svg(drawn.layout);
    EXPECT_EQ(unclosed(svg), "");
    for (const auto& component : drawn.scene.hydraulics.components) {
      EXPECT_NE(svg.find("data-element=\"" + component->name + "\""), std::string::npos) << component->name;
    }
    std::set<std::string> connected;
    for (const Block& block : drawn.layout.blocks) {
      for (const BlockPort& port : block.ports) connected.insert(port.net);
    }
    for (const hydraulics::VolumeDef& volume : drawn.scene.hydraulics.volumes) {
      if (!connected.contains(volume.name)) continue;
      EXPECT_NE(svg.find("data-volume=\"" + volume.name + "\""), std::string::npos) << volume.name;
    }
  }
}

TEST(CircuitSvg, ASceneGivesTheSameDiagramEachTime) {
  const Drawn& drawn = scenes().front();
  EXPECT_EQ(circuit_svg(lay_out(drawn.scene.hydraulics)), circuit_svg(drawn.layout));
}

TEST(CircuitSvg, KindsOfLinesDiffer) {
  for (const Drawn& drawn : scenes()) {
    if (drawn.name != "excavator_20t") continue;
    const std::string svg = circuit_svg(drawn.layout);
    for (const char* kind : {"line supply", "line working", "line return", "line pilot", "line shaft"}) {
      EXPECT_NE(svg.find(kind), std::string::npos) << kind;
    }
    return;
  }
  FAIL() << "excavator_20t is not among the scenes";
}

}  // namespace
}  // namespace slew::diagram
