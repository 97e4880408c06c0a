// SPDX-License-Identifier: Apache-2.0
// Reading of the sets that flexible_files.cpp writes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "flex/flexible_files.h"
#include "flex/flexible_table.h"
#include "flex/input_error.h"

namespace slew::flex {

using math::Mat3;
using math::Vec3;

namespace {

// |K - K^T| over the largest element, tolerance for edited files
constexpr double kSymmetric = 1e-12;

Vec3 vector_at(const FlexibleTable& table, std::size_t column) {
  return {table.number(column), table.number(column + 1), table.number(column + 2)};
}

Mat3 matrix_at(const FlexibleTable& table, std::size_t column) {
  return transpose(Mat3{vector_at(table, column), vector_at(table, column + 3), vector_at(table, column + 6)});
}

class Reader {
 public:
  explicit Reader(const FlexibleFileSet& set) : files_(set) {}

  Reduction run() {
    // a missing file is reported before any content is checked
    for (const std::string& matrix : flexible_matrices()) {
      const auto file = flexible_file(files_, matrix);
      if (!std::filesystem::exists(file))
        refuse_file(
            file, 0, "the file is missing",
            fmt::format("the {} files {}_{}_*.dat of a set", flexible_matrices().size(), files_.model, files_.prefix),
            "copy the whole set, or write it again");
    }
    read_source();
    read_nodes();
    read_frequencies();
    read_modes();
    read_inertia();
    read_stiffness();
    read_foreshortening();
    read_recovery();
    read_elements();
    return std::move(out_);
  }

 private:
  FlexibleTable open(const std::string& matrix) {
    FlexibleTable table(flexible_file(files_, matrix), matrix);
    if (label_.empty()) label_ = table.set();
    if (table.set() != label_)
      refuse_file(flexible_file(files_, matrix), 1, fmt::format("the file is of the set {}", table.set()),
                  fmt::format("{}, that of {}", label_, flexible_file(files_, "Source").filename().string()),
                  "the files do not belong together; copy a whole set, or write it again");
    if (matrix != "Source") table.expect_columns(form_of(matrix, modes_).columns, fmt::format("with {} modes", modes_));
    return table;
  }

  std::map<std::string, std::string> read_keys(FlexibleTable& table) {
    std::map<std::string, std::string> keys;
    for (std::size_t i = 0; i < table.rows(); ++i) {
      const auto& words = table.next();
      const std::string_view line = table.line();
      const std::size_t space = line.find(' ');
      if (words.size() < 2 || space == std::string_view::npos) table.at().refuse("a key without a value", "key value");
      keys[std::string(words[0])] = line.substr(space + 1);
    }
    table.end();
    return keys;
  }

  void read_source() {
    FlexibleTable table = open("Source");
    const auto keys = read_keys(table);
    const auto file = table.at().file();
    const std::optional<FileOwner> owner = owner_of(file);
    if (owner && owner->shadows(files_.model, files_.prefix))
      refuse_file(file, 0, fmt::format("the files are of model '{}', prefix '{}'", owner->model, owner->prefix),
                  fmt::format("model '{}', prefix '{}'", files_.model, files_.prefix),
                  "name the files' own, or build the set with another prefix");
    const auto text = [&](const char* key) {
      const auto at = keys.find(key);
      if (at == keys.end())
        refuse_file(file, 0, fmt::format("there is no '{}'", key), "that key", "write the set again");
      return at->second;
    };
    const auto one_of = [&](const char* key, const char* first, const char* second) {
      const std::string value = text(key);
      if (value != first && value != second)
        refuse_file(file, 0, fmt::format("{} is '{}'", key, value), fmt::format("{} or {}", first, second));
      return value == first;
    };
    const auto count = [&](const char* key) { return static_cast<int>(table.at().whole_of(text(key), 0)); };
    Source& s = out_.source;
    s.model = text("model");
    s.made_of = text("made_of");
    s.attachment = one_of("attachment", "clamped", "free") ? Attachment::clamped : Attachment::free;
    s.clamped_nodes = ids(table, text("clamped_nodes"));
    s.interface_nodes = ids(table, text("interface_nodes"));
    s.nodes = count("nodes");
    s.elements = count("elements");
    s.boundary_freedoms = count("boundary_freedoms");
    s.interior_freedoms = count("interior_freedoms");
    s.fixed_interface_modes = count("fixed_interface_modes");
    s.stiffening =
        one_of("stiffening", "straight_beam", "none") ? GeometricStiffening::straight_beam : GeometricStiffening::none;
    s.deviation = {table.at().number_of(text("block_deviation")), table.at().number_of(text("modal_deviation"))};
    modes_ = static_cast<std::size_t>(count("modes"));
  }

  static std::vector<int> ids(const FlexibleTable& table, const std::string& text) {
    std::vector<int> out;
    if (text == "-") return out;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = std::min(text.find(' ', at), text.size());
      out.push_back(static_cast<int>(table.at().whole_of(std::string_view(text).substr(at, end - at), 0)));
      at = end + 1;
    }
    return out;
  }

  void read_nodes() {
    FlexibleTable table = open("Nodes");
    table.expect_rows(static_cast<std::size_t>(out_.source.nodes), "as in Source");
    for (int i = 0; i < out_.source.nodes; ++i) {
      const auto& words = table.next();
      const int id = static_cast<int>(table.at().whole_of(words[0], 0));
      for (const ReducedNode& node : out_.body.nodes) {
        if (node.id == id) table.at().refuse(fmt::format("node {} is given twice", id), "each once");
      }
      out_.body.nodes.push_back({id, vector_at(table, 1), {}, {}, {}});
    }
    table.end();
  }

  void read_frequencies() {
    FlexibleTable table = open("Frequencies");
    table.expect_rows(modes_, "the modes of Source");
    for (std::size_t k = 0; k < modes_; ++k) {
      (void)table.next();
      table.expect_whole(0, static_cast<long>(k) + 1, "mode");
      const double omega = table.number(1), before = k == 0 ? 0 : out_.body.omega.back();
      if (!(omega > 0) || omega < before)
        table.at().refuse(fmt::format("omega = {} rad/s after {}", omega, before),
                          "positive numbers in ascending order");
      out_.body.omega.push_back(omega);
    }
    table.end();
  }

  void read_modes() {
    FlexibleTable table = open("Modes");
    table.expect_rows(out_.body.nodes.size() * modes_, "a row for each node and mode");
    for (ReducedNode& node : out_.body.nodes) {
      for (std::size_t k = 0; k < modes_; ++k) {
        (void)table.next();
        table.expect_whole(0, node.id, "node");
        table.expect_whole(1, static_cast<long>(k) + 1, "mode");
        node.phi.push_back(vector_at(table, 2));
        node.psi.push_back(vector_at(table, 5));
      }
    }
    table.end();
  }

  void take(FlexibleTable& table, const char* what, std::size_t k, std::size_t l) {
    (void)table.next();
    table.expect_word(0, what);
    table.expect_whole(1, static_cast<long>(k), "k");
    table.expect_whole(2, static_cast<long>(l), "l");
  }

  void read_inertia() {
    FlexibleTable table = open("Inertia");
    table.expect_rows(3 + 2 * modes_ + modes_ * modes_, "mass, s0, W0, C, Z and Y of all modes");
    ReducedBody& body = out_.body;
    take(table, "mass", 0, 0);
    body.mass = table.number(3);
    if (!(body.mass > 0)) table.at().refuse(fmt::format("a mass of {} kg", body.mass), "a number > 0");
    take(table, "s0", 0, 0);
    body.s0 = vector_at(table, 3);
    take(table, "W0", 0, 0);
    body.W0 = matrix_at(table, 3);
    for (std::size_t k = 0; k < modes_; ++k) {
      take(table, "C", k + 1, 0);
      body.C.push_back(vector_at(table, 3));
    }
    for (std::size_t k = 0; k < modes_; ++k) {
      take(table, "Z", k + 1, 0);
      body.Z.push_back(matrix_at(table, 3));
    }
    for (std::size_t k = 0; k < modes_; ++k) {
      for (std::size_t l = 0; l < modes_; ++l) {
        take(table, "Y", k + 1, l + 1);
        body.Y.push_back(matrix_at(table, 3));
      }
    }
    table.end();
  }

  void read_stiffness() {
    FlexibleTable table = open("Stiffness");
    table.expect_rows(modes_, "the modes of Source");
    double largest = 0;
    for (std::size_t k = 0; k < modes_; ++k) {
      (void)table.next();
      for (std::size_t l = 0; l < modes_; ++l) {
        out_.body.K.push_back(table.number(l));
        largest = std::max(largest, std::abs(out_.body.K.back()));
      }
    }
    table.end();
    for (std::size_t k = 0; k < modes_; ++k) {
      for (std::size_t l = 0; l < k; ++l) {
        if (std::abs(out_.body.K[k * modes_ + l] - out_.body.K[l * modes_ + k]) > kSymmetric * largest)
          refuse_file(table.at().file(), 0, fmt::format("the elements ({0}, {1}) and ({1}, {0}) differ", k + 1, l + 1),
                      "a symmetric matrix");
      }
    }
  }

  // G, H or g of one pair
  void take_pair(FlexibleTable& table, const char* what, int node, std::size_t pair) {
    (void)table.next();
    table.expect_word(0, what);
    table.expect_whole(1, node, "node");
    table.expect_whole(2, static_cast<long>(pair / modes_) + 1, "k");
    table.expect_whole(3, static_cast<long>(pair % modes_) + 1, "l");
  }

  void read_foreshortening() {
    FlexibleTable table = open("Foreshortening");
    const std::size_t pairs = modes_ * modes_;
    const bool is_there = out_.source.stiffening == GeometricStiffening::straight_beam;
    table.expect_rows(is_there ? (2 + out_.body.nodes.size()) * pairs : 0, "the stiffening of Source");
    for (std::size_t p = 0; is_there && p < pairs; ++p) {
      take_pair(table, "G", 0, p);
      out_.body.G.push_back(vector_at(table, 4));
    }
    for (std::size_t p = 0; is_there && p < pairs; ++p) {
      take_pair(table, "H", 0, p);
      out_.body.H.push_back(matrix_at(table, 4));
    }
    for (ReducedNode& node : out_.body.nodes) {
      for (std::size_t p = 0; is_there && p < pairs; ++p) {
        take_pair(table, "g", node.id, p);
        node.g.push_back(vector_at(table, 4));
      }
    }
    table.end();
  }

  void read_recovery() {
    FlexibleTable table = open("Recovery");
    Recovery& recovery = out_.recovery;
    recovery.modes = modes_;
    for (std::size_t i = 0; i < table.rows(); ++i) {
      const auto& words = table.next();
      StressPoint point{static_cast<int>(table.at().whole_of(words[0], 1)),
                        static_cast<int>(table.at().whole_of(words[1], 0)), table.number(2), table.number(3),
                        table.at().whole_of(words[4], 0) == 1};
      const bool is_known = std::any_of(out_.body.nodes.begin(), out_.body.nodes.end(),
                                        [&](const ReducedNode& node) { return node.id == point.node; });
      if (!is_known || point.element > out_.source.elements)
        table.at().refuse(fmt::format("element {}, node {}", point.element, point.node), "one of this body",
                          "the files do not belong together; write the set again");
      recovery.points.push_back(point);
      for (std::size_t k = 0; k < modes_; ++k) recovery.normal.push_back(table.number(5 + k));
      for (std::size_t k = 0; k < modes_; ++k) recovery.shear.push_back(table.number(5 + modes_ + k));
    }
    table.end();
  }

  void read_elements() {
    constexpr double kUnit = 1e-9;
    FlexibleTable table = open("Elements");
    table.expect_rows(static_cast<std::size_t>(out_.source.elements), "as in Source");
    for (int i = 0; i < out_.source.elements; ++i) {
      const auto& words = table.next();
      table.expect_whole(0, i + 1, "element");
      const int node1 = static_cast<int>(table.at().whole_of(words[1], 0));
      const int node2 = static_cast<int>(table.at().whole_of(words[2], 0));
      const auto place = [&](int id) {
        const auto at = std::find_if(out_.body.nodes.begin(), out_.body.nodes.end(),
                                     [id](const ReducedNode& node) { return node.id == id; });
        if (at == out_.body.nodes.end())
          table.at().refuse(fmt::format("node {}", id), "one of this body",
                            "the files do not belong together; write the set again");
        return at->position;
      };
      const Vec3 along = place(node2) - place(node1), y = vector_at(table, 12);
      if (!(norm(along) > 0)) table.at().refuse("an element without length", "two nodes at different places");
      for (std::size_t k = 3; k < 12; ++k) {
        const bool may_be_zero = k == 7 || k == 8 || k > 9;  // rigid in shear, without rotary inertia
        if (table.number(k) < 0 || (table.number(k) == 0 && !may_be_zero))
          table.at().refuse(fmt::format("{} in column {}", table.number(k), k + 1),
                            may_be_zero ? "a number >= 0" : "a number > 0");
      }
      if (std::abs(norm(y) - 1) > kUnit || std::abs(dot(y, along)) > kUnit * norm(along))
        table.at().refuse(fmt::format("y axis {} {} {}", y.x(), y.y(), y.z()), "a unit vector across the element");
      out_.elements.push_back({node1, node2, table.number(3), table.number(4), table.number(5), table.number(6),
                               table.number(7), table.number(8), table.number(9), table.number(10), table.number(11),
                               y});
    }
    table.end();
  }

  FlexibleFileSet files_;
  std::string label_;
  std::size_t modes_ = 0;
  Reduction out_;
};

}  // namespace

FlexibleFileSet find_flexible_files(const std::filesystem::path& stem) {
  const auto source = std::filesystem::path(stem.string() + "_Source.dat");
  if (!std::filesystem::exists(source))
    refuse_file(source, 0, "the file is missing", "the 9 files of a set", "name a set as FOLDER/Model_Prefix");
  const std::string name = stem.filename().string();
  const std::optional<FileOwner> owner = owner_of(source);
  if (owner && owner->model + '_' + owner->prefix == name) return {stem.parent_path(), owner->model, owner->prefix};
  const std::size_t cut = name.rfind('_');
  if (cut == std::string::npos)
    refuse_file(source, 0, fmt::format("'{}' is not Model_Prefix", name), "a '_' between the two");
  return {stem.parent_path(), name.substr(0, cut), name.substr(cut + 1)};
}

Reduction read_flexible_files(const FlexibleFileSet& set) {
  return Reader(set).run();
}

}  // namespace slew::flex
