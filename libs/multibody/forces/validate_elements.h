// SPDX-License-Identifier: Apache-2.0
// Rules of force kinds and dummies. Internal to the library: build/validate.cpp calls them.
#pragma once

#include <span>
#include <string>

#include "core/problem.h"
#include "multibody/model/defs.h"
#include "multibody/model/topology.h"

namespace slew::multibody {

// Tables of a spring or a damper at `path`: two points or more, increasing; a damper's pass through [0, 0] and never
// drive. An empty table is none.
enum class TableUse : std::uint8_t { any, spring, damper, rope_spring };
void check_table(const std::string& path, const Table& table, TableUse use, Problems& problems);

// The problems that a row's check() finds.
class ElementRules {
 public:
  ElementRules(const MechanicsDef& mechanics, Problems& problems) : number_of_(mechanics), problems_(problems) {}

  void add(std::string path, std::string what, std::string expected) {
    problems_.push_back({std::move(path), std::move(what), std::move(expected), {}});
  }
  // The same where a name is that of nothing: poses then cannot be looked at.
  void add_broken_reference(std::string path, std::string what, std::string expected) {
    names_hold_ = false;
    add(std::move(path), std::move(what), std::move(expected));
  }
  // False when there is no such body.
  bool check_body(const std::string& owner, std::string_view key, const std::string& body);
  void check_direction(const std::string& path, const Triple& direction);
  void check_connector(const std::string& name, const ConnectorFrames& frames);
  void check_inertia(const std::string& name, Triple moments);
  void check_table(const std::string& path, const Table& table, TableUse use) {
    multibody::check_table(path, table, use, problems_);
  }
  [[nodiscard]] bool names_hold() const noexcept { return names_hold_; }

 private:
  BodyNumbers number_of_;
  Problems& problems_;
  bool names_hold_ = true;
};

// The poses that a scene starts from, and the problems that a row's check_start() finds.
class ElementStartRules {
 public:
  // poses: of all bodies; all names are known.
  ElementStartRules(const MechanicsDef& mechanics, std::span<const Pose> poses, Problems& problems)
      : number_of_(mechanics), poses_(poses), problems_(problems) {}

  void add(std::string path, std::string what, std::string expected) {
    problems_.push_back({std::move(path), std::move(what), std::move(expected), {}});
  }
  [[nodiscard]] const Pose& pose_of(const std::string& body) const {
    return poses_[static_cast<std::size_t>(number_of_(body))];
  }
  // Deflection of the frames, without rest length.
  [[nodiscard]] Deflection deflection(const ConnectorFrames& def) const;

 private:
  BodyNumbers number_of_;
  std::span<const Pose> poses_;
  Problems& problems_;
};

// visit(defs, fields) for every list of force kinds and of dummy_defs.h.
template <typename Visit>
void for_each_element_list(const MechanicsDef& mechanics, Visit&& visit) {
  for_each_force_type(mechanics, [&](auto, const auto& type, const auto& defs) { visit(defs, type.fields()); });
  visit(mechanics.part_dummies, part_dummy_fields());
  visit(mechanics.constraint_dummies, constraint_dummy_fields());
}

// Rules that need no poses. False when a name is that of nothing: poses then cannot be looked at.
[[nodiscard]] bool check_elements(const MechanicsDef& mechanics, Problems& problems);

// Rules of the start. poses: of all bodies; all names are known.
void check_element_starts(const MechanicsDef& mechanics, std::span<const Pose> poses, Problems& problems);

}  // namespace slew::multibody
