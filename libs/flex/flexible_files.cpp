// SPDX-License-Identifier: Apache-2.0
// Writing of the sets; reading is in flexible_files_read.cpp.
#include "flex/flexible_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>

#include "flex/flexible_table.h"
#include "flex/input_error.h"
#include "flex/text_lines.h"

namespace slew::flex {

using math::Mat3;
using math::Vec3;

namespace {

class Rows {
 public:
  Rows& word(const std::string& text) {
    separate();
    text_ += text;
    return *this;
  }
  Rows& whole(std::size_t value) { return word(std::to_string(value)); }
  Rows& number(double value) {
    separate();
    fmt::format_to(std::back_inserter(text_), "{:.16e}", value);
    return *this;
  }
  Rows& vector(Vec3 v) { return number(v.x()).number(v.y()).number(v.z()); }
  // rows of the matrix one after the other
  Rows& matrix(const Mat3& a) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) number(a(i, j));
    }
    return *this;
  }
  Rows& zeros(int count) {
    for (int i = 0; i < count; ++i) word("0");
    return *this;
  }
  void end() {
    text_ += '\n';
    ++count_;
    is_new_ = true;
  }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  void separate() {
    if (!is_new_) text_ += ' ';
    is_new_ = false;
  }
  std::string text_;
  std::size_t count_ = 0;
  bool is_new_ = true;
};

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text.empty() ? "-" : text;
}

std::string ids_of(const std::vector<int>& ids) {
  return ids.empty() ? "-" : fmt::format("{}", fmt::join(ids, " "));
}

Rows source_rows(const FlexibleFileSet& set, const Source& s, std::size_t modes) {
  Rows rows;
  const auto add = [&](const std::string& key, const std::string& value) { rows.word(key).word(value).end(); };
  add("files", set.model + ' ' + set.prefix);
  add("model", one_line(s.model));
  add("made_of", one_line(s.made_of));
  add("attachment", s.attachment == Attachment::clamped ? "clamped" : "free");
  add("clamped_nodes", ids_of(s.clamped_nodes));
  add("interface_nodes", ids_of(s.interface_nodes));
  add("nodes", std::to_string(s.nodes));
  add("elements", std::to_string(s.elements));
  add("boundary_freedoms", std::to_string(s.boundary_freedoms));
  add("interior_freedoms", std::to_string(s.interior_freedoms));
  add("fixed_interface_modes", std::to_string(s.fixed_interface_modes));
  add("modes", std::to_string(modes));
  add("stiffening", s.stiffening == GeometricStiffening::straight_beam ? "straight_beam" : "none");
  add("block_deviation", fmt::format("{:.16e}", s.deviation.block));
  add("modal_deviation", fmt::format("{:.16e}", s.deviation.modal));
  return rows;
}

Rows node_rows(const ReducedBody& body) {
  Rows rows;
  for (const ReducedNode& node : body.nodes) rows.word(std::to_string(node.id)).vector(node.position).end();
  return rows;
}

Rows frequency_rows(const ReducedBody& body) {
  Rows rows;
  for (std::size_t k = 0; k < body.modes(); ++k) rows.whole(k + 1).number(body.omega[k]).end();
  return rows;
}

Rows mode_rows(const ReducedBody& body) {
  Rows rows;
  for (const ReducedNode& node : body.nodes) {
    for (std::size_t k = 0; k < body.modes(); ++k)
      rows.word(std::to_string(node.id)).whole(k + 1).vector(node.phi[k]).vector(node.psi[k]).end();
  }
  return rows;
}

Rows inertia_rows(const ReducedBody& body) {
  Rows rows;
  const auto start = [&](const char* what, std::size_t k, std::size_t l) -> Rows& {
    return rows.word(what).whole(k).whole(l);
  };
  start("mass", 0, 0).number(body.mass).zeros(8).end();
  start("s0", 0, 0).vector(body.s0).zeros(6).end();
  start("W0", 0, 0).matrix(body.W0).end();
  for (std::size_t k = 0; k < body.modes(); ++k) start("C", k + 1, 0).vector(body.C[k]).zeros(6).end();
  for (std::size_t k = 0; k < body.modes(); ++k) start("Z", k + 1, 0).matrix(body.Z[k]).end();
  for (std::size_t k = 0; k < body.modes(); ++k) {
    for (std::size_t l = 0; l < body.modes(); ++l) start("Y", k + 1, l + 1).matrix(body.Y[body.pair(k, l)]).end();
  }
  return rows;
}

Rows stiffness_rows(const ReducedBody& body) {
  Rows rows;
  for (std::size_t k = 0; k < body.modes(); ++k) {
    for (std::size_t l = 0; l < body.modes(); ++l) rows.number(body.K[body.pair(k, l)]);
    rows.end();
  }
  return rows;
}

Rows foreshortening_rows(const ReducedBody& body) {
  Rows rows;
  if (!body.has_foreshortening()) return rows;
  const std::size_t m = body.modes();
  const auto start = [&](const char* what, int node, std::size_t p) -> Rows& {
    return rows.word(what).word(std::to_string(node)).whole(p / m + 1).whole(p % m + 1);
  };
  for (std::size_t p = 0; p < m * m; ++p) start("G", 0, p).vector(body.G[p]).zeros(6).end();
  for (std::size_t p = 0; p < m * m; ++p) start("H", 0, p).matrix(body.H[p]).end();
  for (const ReducedNode& node : body.nodes) {
    for (std::size_t p = 0; p < m * m; ++p) start("g", node.id, p).vector(node.g[p]).zeros(6).end();
  }
  return rows;
}

Rows recovery_rows(const Recovery& recovery) {
  Rows rows;
  for (std::size_t i = 0; i < recovery.points.size(); ++i) {
    const StressPoint& p = recovery.points[i];
    rows.word(std::to_string(p.element))
        .word(std::to_string(p.node))
        .number(p.y)
        .number(p.z)
        .whole(p.has_shear ? 1 : 0);
    for (std::size_t k = 0; k < recovery.modes; ++k) rows.number(recovery.normal[i * recovery.modes + k]);
    for (std::size_t k = 0; k < recovery.modes; ++k) rows.number(recovery.shear[i * recovery.modes + k]);
    rows.end();
  }
  return rows;
}

Rows element_rows(const std::vector<UniformElement>& elements) {
  Rows rows;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const UniformElement& e = elements[i];
    rows.whole(i + 1).word(std::to_string(e.node1)).word(std::to_string(e.node2));
    for (const double number :
         {e.axial, e.torsion, e.bend_y, e.bend_z, e.shear_y, e.shear_z, e.mass, e.rotary_y, e.rotary_z})
      rows.number(number);
    rows.vector(e.y).end();
  }
  return rows;
}

// Fowler, Noll & Vo, FNV-1a
std::uint64_t digest(std::uint64_t hash, const std::string& text) noexcept {
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return hash;
}

void check_name(const char* what, const std::string& name) {
  if (!is_flexible_name(name))
    throw InputError(
        fmt::format("the {} '{}' cannot be part of a file's name; expected letters, digits, _ - .", what, name));
}

// Checks that existing files may be replaced: regular files, not of another model.
void check_places(const FlexibleFileSet& set) {
  for (const std::string& matrix : flexible_matrices()) {
    const auto file = flexible_file(set, matrix);
    if (std::filesystem::exists(file) && !std::filesystem::is_regular_file(file))
      refuse_file(file, 0, "this is no file", "a file, or none", "nothing was written; take another folder or prefix");
  }
  const auto source = flexible_file(set, "Source");
  std::optional<FileOwner> owner;
  try {
    if (std::filesystem::exists(source)) owner = owner_of(source);
  } catch (const InputError&) {
    return;  // a damaged set has no owner
  }
  if (owner && owner->shadows(set.model, set.prefix))
    refuse_file(source, 0, fmt::format("this is of model '{}', prefix '{}'", owner->model, owner->prefix),
                fmt::format("model '{}', prefix '{}'", set.model, set.prefix),
                "nothing was written; take another prefix or folder");
}

std::filesystem::path beside(const std::filesystem::path& file) {
  return file.string() + ".new";
}

// The files under the names of beside(), all or none.
void write_beside(const FlexibleFileSet& set, const std::vector<std::string>& texts) {
  try {
    for (std::size_t i = 0; i < texts.size(); ++i)
      write_text(beside(flexible_file(set, flexible_matrices()[i])), texts[i]);
  } catch (const InputError&) {
    std::error_code ignored;
    for (const std::string& matrix : flexible_matrices())
      std::filesystem::remove(beside(flexible_file(set, matrix)), ignored);
    throw;
  }
}

}  // namespace

bool is_flexible_name(std::string_view name) noexcept {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           c == '.';
  });
}

const std::vector<std::string>& flexible_matrices() {
  static const std::vector<std::string> names = {"Source",    "Nodes",          "Frequencies", "Modes",   "Inertia",
                                                 "Stiffness", "Foreshortening", "Recovery",    "Elements"};
  return names;
}

std::filesystem::path flexible_file(const FlexibleFileSet& set, const std::string& matrix) {
  return set.folder / fmt::format("{}_{}_{}.dat", set.model, set.prefix, matrix);
}

void write_flexible_files(const FlexibleFileSet& set, const Reduction& reduction) {
  check_name("model's name", set.model);
  check_name("prefix", set.prefix);
  check_places(set);
  const ReducedBody& body = reduction.body;
  const std::vector<Rows> rows = {source_rows(set, reduction.source, body.modes()),
                                  node_rows(body),
                                  frequency_rows(body),
                                  mode_rows(body),
                                  inertia_rows(body),
                                  stiffness_rows(body),
                                  foreshortening_rows(body),
                                  recovery_rows(reduction.recovery),
                                  element_rows(reduction.elements)};
  std::uint64_t hash = 14695981039346656037u;
  for (const Rows& part : rows) hash = digest(hash, part.text());
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const TableForm form = form_of(flexible_matrices()[i], body.modes());
    const std::string header =
        fmt::format("{} {} {} rows={} columns={} set={:016x} units={}\n# {}\n", kFormatName, kFormatVersion, form.what,
                    rows[i].count(), form.columns, hash, form.units, form.names);
    texts.push_back(header + rows[i].text());
  }
  write_beside(set, texts);
  for (const std::string& matrix : flexible_matrices()) {
    const auto file = flexible_file(set, matrix);
    std::error_code error;
    std::filesystem::rename(beside(file), file, error);
    if (error)
      throw OutputError(
          fmt::format("{}: the file cannot be replaced ({}); write the set again", file.string(), error.message()));
  }
}

}  // namespace slew::flex
