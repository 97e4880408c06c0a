// SPDX-License-Identifier: Apache-2.0
// Places of all elements and keys of a scene in its files, for problems found after reading.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "scene/diagnostic.h"

namespace slew::scene {

class PlaceMap {
 public:
  void add(std::string path, const Mark& mark) { places_.insert_or_assign(std::move(path), mark); }

  // Mark of the path or of the nearest path around it ("Bag.mass", then "Bag"); else `fallback`.
  [[nodiscard]] Mark nearest(std::string_view path, const Mark& fallback) const {
    while (true) {
      const auto found = places_.find(path);
      if (found != places_.end()) return found->second;
      const std::size_t cut = path.find_last_of(".[");
      if (cut == std::string_view::npos) return fallback;
      path = path.substr(0, cut);
    }
  }
  [[nodiscard]] bool contains(std::string_view path) const { return places_.contains(path); }

 private:
  std::map<std::string, Mark, std::less<>> places_;
};

}  // namespace slew::scene
