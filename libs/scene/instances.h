// SPDX-License-Identifier: Apache-2.0
// Parameters, templates of elements and groups with instances: the tree of a scene without them.
//
//   templates: {Hose: {type: hose, length: 1.5 m}}        components: {Hose_A: {use: Hose, volume: Vol_A}}
//   groups:    {Side: {parameters: {z: 0 m}, bodies: ...}}
//   instances: {Left: {group: Side, parameters: {z: 0.4 m}}}      elements Left_...; or `prefix:` for another prefix
//   include:   [{file: side.yaml, prefix: Left_, parameters: {z: 0.4 m}}]      a file as a group
//
// A template gives the keys that the element lacks; the element's own keys are laid over it. Its expressions are
// evaluated where it is used. A group sees the parameters, templates and groups around its instance. Its elements get
// the prefix and are renamed in the group's own texts; texts that parameters bring in name elements outside. Elements
// of the same name in the sections around an instance are laid over those of the instance, and give their position.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scope.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

// Bounds against scenes that grow without end.
inline constexpr int kMaxInstanceDepth = 8;               // instances in instances, templates under templates
inline constexpr std::size_t kMaxInstances = 1000;        // of a scene
inline constexpr std::size_t kMaxCopiedValues = 200'000;  // values that templates and instances bring in

// Key under which read_with_includes() leaves the files with a prefix: a map from their names to maps of the entry's
// keys and `tree`, the file's own. No file can have this key.
inline constexpr std::string_view kIncludedFiles = "\x01 files";
inline constexpr std::string_view kIncludedTree = "\x01 tree";

// Expands the tree in place, evaluating all expressions in `scope`, which gets the tree's parameters. Problems go to
// the report. warnings: unused parameters, templates and groups of the scene's own file; null: not looked for.
void expand_instances(Node& root, Scope& scope, ScopeContext& context, std::vector<std::string>* warnings);

}  // namespace slew::scene
