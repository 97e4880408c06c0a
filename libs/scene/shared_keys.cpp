// SPDX-License-Identifier: Apache-2.0
#include "scene/shared_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

namespace slew::scene {
namespace {

constexpr std::size_t kLeastOfFamily = 4;  // keys that a type has of an earlier one to be shown as its relative
constexpr std::size_t kLeastSaved = 60;    // letters that a reference to an earlier type saves
constexpr std::size_t kLeastTypes = 3;     // types of a key that is shown before all types

// What keys of two types must have alike: all but the unit, or all but the default.
auto beside_unit(const FieldEntry& one) {
  return std::tie(one.kind, one.range, one.value, one.is_live, one.meaning);
}
auto beside_default(const FieldEntry& one) {
  return std::tie(one.key, one.kind, one.unit, one.range, one.meaning);
}

const FieldEntry* entry_with(const std::vector<FieldEntry>& entries, std::string_view key) {
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const auto& one) { return one.key == key; });
  return found == entries.end() ? nullptr : &*found;
}

struct Relation {
  std::size_t of_type = 0;                  // the earlier type
  std::vector<std::string> alike, missing;  // its keys: as there but for units, and those that the type lacks
  std::string units;                        // ", in N for N m"
};

// ", in N for N m; `limit_min` in m": by unit where all keys of it change alike, else by key.
std::string units_text(const std::vector<FieldEntry>& one, const std::vector<FieldEntry>& earlier,
                       const std::vector<std::string>& alike) {
  std::map<std::string, std::map<std::string, std::vector<std::string>>> keys;  // by unit there, then by unit here
  for (const std::string& key : alike) keys[entry_with(earlier, key)->unit][entry_with(one, key)->unit].push_back(key);
  std::string by_unit, by_key;
  for (const auto& [unit_there, units] : keys) {
    for (const auto& [unit, of_unit] : units) {
      if (unit == unit_there) continue;
      if (units.size() == 1) {
        by_unit += fmt::format("{}{} for {}", by_unit.empty() ? ", in " : ", ", unit, unit_there);
      } else {
        by_key += fmt::format("; {} in {}", joined_keys(of_unit), unit);
      }
    }
  }
  return by_unit + by_key;
}

// Keys of `one` that `earlier` has alike but for units.
Relation relation_of(const std::vector<FieldEntry>& one, const std::vector<FieldEntry>& earlier) {
  Relation relation;
  for (const FieldEntry& other : earlier) {
    const FieldEntry* const entry = entry_with(one, other.key);
    if (entry == nullptr) {
      relation.missing.emplace_back(other.key);
    } else if (beside_unit(*entry) == beside_unit(other)) {
      relation.alike.emplace_back(other.key);
    }
  }
  relation.units = units_text(one, earlier, relation.alike);
  return relation;
}

class Sharing {
 public:
  explicit Sharing(const std::vector<TypeOfSection>& types) : types_(types) {}

  SharedKeys result() {
    // what is common follows from the families; a type that has only common keys of its family is then shown without it
    collect();
    const std::vector<FieldEntry> common = shared_.common;
    for (std::size_t i = 0; i < types_.size(); ++i) {
      const auto is_common = [&](const std::string& key) {
        return std::any_of(common.begin(), common.end(), [&](const FieldEntry& one) {
          return beside_default(one) == beside_default(*entry_with(types_[i].entries, key));
        });
      };
      std::optional<Relation>& family = families_[i];
      if (family && std::all_of(family->alike.begin(), family->alike.end(), is_common)) family.reset();
    }
    collect();
    for (std::size_t i = 0; i < types_.size(); ++i) {
      name_common(i);
      name_others(i);
    }
    return std::move(shared_);
  }

 private:
  void remove_own(std::size_t i, const std::vector<std::string>& keys) {
    std::erase_if(shared_.own[i],
                  [&](const FieldEntry& one) { return std::find(keys.begin(), keys.end(), one.key) != keys.end(); });
  }

  void add_sentence(std::size_t i, const std::string& sentence) {
    std::string& text = shared_.references[i];
    text += (text.empty() ? "" : " ") + sentence;
  }

  void collect() {
    shared_ = {};
    shared_.references.resize(types_.size());
    for (const TypeOfSection& type : types_) shared_.own.push_back(type.entries);
    const bool is_first = families_.empty();
    for (std::size_t i = 0; i < types_.size(); ++i) {
      if (is_first) families_.push_back(family_of(i));
      refer_to_family(i);
    }
    for (std::size_t i = 0; i < types_.size(); ++i) refer_to_ends(i);
    collect_common();
  }

  // "All keys of `revolute` but `start_turns`, in N for N m."
  void refer_to_family(std::size_t i) {
    const std::optional<Relation>& family = families_[i];
    if (!family) return;
    remove_own(i, family->alike);
    add_sentence(i, fmt::format("All keys of `{}`{}{}{}.", types_[family->of_type].name,
                                family->missing.empty() ? "" : " but ", joined_keys(family->missing), family->units));
  }

  // The earlier type that has most keys alike, if it has few others.
  [[nodiscard]] std::optional<Relation> family_of(std::size_t i) const {
    std::optional<Relation> best;
    for (std::size_t j = 0; j < i; ++j) {
      Relation relation = relation_of(types_[i].entries, types_[j].entries);
      if (relation.alike.size() < kLeastOfFamily || relation.alike.size() < 2 * relation.missing.size()) continue;
      if (best && best->alike.size() >= relation.alike.size()) continue;
      relation.of_type = j;
      best = std::move(relation);
    }
    return best;
  }

  // "With `_1`, `_2` behind the key, as for `revolute`: `limit_min`."
  void refer_to_ends(std::size_t i) {
    for (std::size_t j = 0; j < i; ++j) {
      std::map<std::string, std::vector<std::string>> keys;  // by end: keys of the earlier type
      for (const FieldEntry& one : shared_.own[i]) {
        const std::size_t begin = one.key.rfind('_');
        if (begin == std::string_view::npos) continue;
        const FieldEntry* const other = entry_with(types_[j].entries, one.key.substr(0, begin));
        const bool is_alike = other != nullptr && other->unit == one.unit && beside_unit(*other) == beside_unit(one);
        if (is_alike) keys[std::string(one.key.substr(begin))].emplace_back(other->key);
      }
      std::map<std::vector<std::string>, std::vector<std::string>> ends;  // by keys
      for (const auto& [end, of_end] : keys) {
        if (of_end.size() < kLeastOfFamily) continue;
        ends[of_end].push_back(end);
        for (const std::string& key : of_end) remove_own(i, {key + end});
      }
      for (const auto& [of_ends, with] : ends) {
        add_sentence(i, fmt::format("With {} behind the key, as for `{}`: {}.", joined_keys(with), types_[j].name,
                                    joined_keys(of_ends)));
      }
    }
  }

  // Keys of several types, each with its most frequent default.
  void collect_common() {
    std::vector<FieldEntry> all;
    for (const auto& own : shared_.own) all.insert(all.end(), own.begin(), own.end());
    for (const FieldEntry& one : all) {
      const auto is_same = [&](const FieldEntry& other) { return beside_default(one) == beside_default(other); };
      if (one.is_port || entry_with(shared_.common, one.key) != nullptr) continue;
      std::map<std::string, std::size_t> counts;
      for (const FieldEntry& other : all) {
        if (is_same(other)) ++counts[default_text(other)];
      }
      std::size_t total = 0, most = 0;
      for (const auto& [text, count] : counts) total += count, most = std::max(most, count);
      if (total < kLeastTypes) continue;
      shared_.common.push_back(*std::find_if(all.begin(), all.end(), [&](const FieldEntry& other) {
        return is_same(other) && counts[default_text(other)] == most;
      }));
    }
  }

  // "Common: `nominal_flow`, `step_response` (0.1 s)."
  void name_common(std::size_t i) {
    std::string text;
    std::vector<std::string> named;
    for (const FieldEntry& one : shared_.own[i]) {
      const auto found = std::find_if(shared_.common.begin(), shared_.common.end(), [&](const FieldEntry& other) {
        return beside_default(one) == beside_default(other);
      });
      if (found == shared_.common.end()) continue;
      named.emplace_back(one.key);
      const std::string own = default_text(one);
      text += fmt::format("{}`{}`", text.empty() ? "" : ", ", one.key);
      if (own != default_text(*found)) text += fmt::format(" ({})", own.empty() ? "optional" : own);
    }
    remove_own(i, named);
    if (!text.empty()) add_sentence(i, fmt::format("Common: {}.", text));
  }

  // "As for `pressure`: `delay`, `offset` in K.", where that is shorter.
  void name_others(std::size_t i) {
    for (std::size_t j = 0; j < i; ++j) {
      std::vector<std::string> keys;
      std::string text;
      std::vector<FieldEntry> alike;
      for (const FieldEntry& one : shared_.own[i]) {
        const FieldEntry* const other = entry_with(types_[j].entries, one.key);
        if (one.is_port || other == nullptr || beside_unit(*other) != beside_unit(one)) continue;
        keys.emplace_back(one.key);
        alike.push_back(one);
        text += fmt::format("{}`{}`", text.empty() ? "" : ", ", one.key);
        if (other->unit != one.unit) text += " in " + one.unit;
      }
      const std::string sentence = fmt::format("As for `{}`: {}.", types_[j].name, text);
      if (keys.empty() || items_of(alike).size() < sentence.size() + kLeastSaved) continue;
      remove_own(i, keys);
      add_sentence(i, sentence);
    }
  }

  const std::vector<TypeOfSection>& types_;
  std::vector<std::optional<Relation>> families_;  // by type
  SharedKeys shared_;
};

}  // namespace

SharedKeys shared_keys(const std::vector<TypeOfSection>& types) {
  return Sharing(types).result();
}

}  // namespace slew::scene
