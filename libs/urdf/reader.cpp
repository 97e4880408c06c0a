// SPDX-License-Identifier: Apache-2.0
#include "urdf/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "urdf/element.h"
#include "urdf/tree.h"

namespace slew::urdf {
namespace {

using scene::Report;

constexpr std::pair<std::string_view, JointKind> kJointKinds[] = {
    {"revolute", JointKind::revolute}, {"continuous", JointKind::continuous}, {"prismatic", JointKind::prismatic},
    {"fixed", JointKind::fixed},       {"floating", JointKind::floating},     {"planar", JointKind::planar}};
constexpr const char* kKindList = "revolute, continuous, prismatic, fixed, floating or planar";

bool has_axis(const Joint& joint) {
  return joint.has_coordinate() || joint.kind == JointKind::planar;
}

bool has_limits(JointKind kind) {
  return kind == JointKind::revolute || kind == JointKind::prismatic;
}

class Reader {
 public:
  Reader(int source, Report& report) : source_(source), report_(report), values_(source, report, robot_.notes) {}

  std::optional<Robot> read(const XMLElement& root) {
    const std::size_t problems = report_.size();
    read_root(root);
    if (report_.size() > problems) return std::nullopt;
    const ReportProblem report_problem = [&](int line, std::string what, std::string expected) {
      report_.add({source_, line, 0}, "", {std::move(what), std::move(expected), ""});
    };
    find_leaders(robot_, report_problem);
    if (report_.size() > problems) return std::nullopt;
    find_tree(robot_, report_problem);
    if (report_.size() > problems) return std::nullopt;
    return std::move(robot_);
  }

 private:
  void read_root(const XMLElement& root) {
    if (std::string_view(root.Name()) != "robot") {
      values_.report_problem(root, fmt::format("the root element is <{}>", root.Name()),
                             "<robot>, the root of a URDF file");
      return;
    }
    read_robot_name(root);
    // joints may name later links
    for_each_child(root, [&](const XMLElement& child, std::string_view tag) {
      if (tag == "link") read_link(child);
    });
    for_each_child(root, [&](const XMLElement& child, std::string_view tag) {
      values_.set_owner("");
      if (tag == "joint") {
        read_joint(child);
      } else if (tag == "material") {
        note_material(child);
      } else if (tag != "link") {
        note_element(child);
      }
    });
    values_.set_owner("");
    note_once();
    if (robot_.links.empty()) values_.report_problem(root, "the robot has no links", "at least one <link>");
  }

  void read_robot_name(const XMLElement& root) {
    const char* name = root.Attribute("name");
    robot_.name = name == nullptr || *name == '\0' ? "robot" : name;
    if (robot_.name != (name == nullptr ? "" : name)) values_.note(root, "the robot has no name: the scene is 'robot'");
  }

  template <typename Use>
  void for_each_child(const XMLElement& element, const Use& use) {
    for (const auto* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
      use(*child, child->Name());
    }
  }

  void note_element(const XMLElement& element) {
    const std::string_view tag = element.Name();
    if (tag.starts_with("xacro:")) {
      values_.report_problem(element, fmt::format("<{}> is a macro", tag),
                             "a file without macros: xacro robot.urdf.xacro > robot.urdf");
      return;
    }
    const char* name = element.Attribute("name");
    values_.note(element, name != nullptr ? fmt::format("<{} name=\"{}\"> is not taken over", tag, name)
                                          : fmt::format("<{}> is not taken over", tag));
  }

  void note_material(const XMLElement& element) {
    if (material_line_ == 0 || element.GetLineNum() < material_line_) material_line_ = element.GetLineNum();
  }

  // contents of most joints or links: one line for all
  void note_once() {
    if (material_line_ > 0) robot_.notes.push_back({material_line_, "materials and colours are not taken over"});
    if (bounds_line_ > 0) {
      robot_.notes.push_back({bounds_line_, "bounds of effort and velocity are not taken over: " + bounded_joints_});
    }
  }

  // A link's or joint's name; nothing after a reported problem.
  std::optional<std::string> name_of_element(const XMLElement& element, std::map<std::string, int>& taken) {
    values_.set_owner("");
    std::optional<std::string> name = values_.name(element, "name");
    if (!name) return std::nullopt;
    values_.set_owner(fmt::format("{} '{}'", element.Name(), *name));
    const auto [first, is_new] = taken.emplace(*name, element.GetLineNum());
    if (!is_new) {
      values_.report_problem(element, fmt::format("is there twice (first in line {})", first->second),
                             "a name of its own");
    }
    return name;
  }

  void read_link(const XMLElement& element) {
    const auto name = name_of_element(element, link_lines_);
    if (!name) return;
    constexpr std::string_view kKnown[] = {"name"};
    values_.note_other_attributes(element, kKnown);
    const std::size_t problems = report_.size();
    Link link{.name = *name, .inertial = std::nullopt, .geometries = {}, .line = element.GetLineNum()};
    for_each_child(element, [&](const XMLElement& child, std::string_view tag) {
      if (tag == "inertial") {
        if (link.inertial) values_.report_problem(child, "has a second <inertial>", "one");
        link.inertial = read_inertial(child);
      } else if (tag == "visual" || tag == "collision") {
        read_shape(child, tag == "visual" ? Geometry::Use::visual : Geometry::Use::collision, link);
      } else {
        note_element(child);
      }
    });
    if (report_.size() == problems && link.inertial && is_nothing(*link.inertial)) link.inertial.reset();
    link_index_.emplace(*name, static_cast<int>(robot_.links.size()));
    robot_.links.push_back(std::move(link));
  }

  // a link without mass is a frame
  static bool is_nothing(const Inertial& inertial) {
    double largest = inertial.mass;
    for (const Triple& triple : {inertial.moments, inertial.products}) {
      for (const double value : triple) largest = std::max(largest, std::abs(value));
    }
    return largest <= kRoundOff;
  }

  Inertial read_inertial(const XMLElement& element) {
    Inertial inertial{.origin = values_.origin(element), .line = element.GetLineNum()};
    const XMLElement* mass = values_.only_child(element, "mass");
    const XMLElement* tensor = values_.only_child(element, "inertia");
    if (mass == nullptr) {
      values_.report_problem(element, "<inertial> has no <mass>", "<mass value=\"...\"/>");
    } else {
      inertial.mass = values_.number_not_negative(*mass, "value", std::nullopt);
    }
    if (tensor == nullptr) {
      values_.report_problem(element, "<inertial> has no <inertia>",
                             "<inertia ixx=... ixy=... .../>; 0 for a point mass");
    } else {
      inertial.moments = {values_.moment(*tensor, "ixx"), values_.moment(*tensor, "iyy"),
                          values_.moment(*tensor, "izz")};
      inertial.products = {values_.number(*tensor, "ixy", 0), values_.number(*tensor, "ixz", 0),
                           values_.number(*tensor, "iyz", 0)};
    }
    return inertial;
  }

  void read_shape(const XMLElement& element, Geometry::Use use, Link& link) {
    const std::size_t problems = report_.size();
    Geometry shape{.use = use, .origin = values_.origin(element), .file = {}, .line = element.GetLineNum()};
    if (const XMLElement* material = values_.only_child(element, "material")) note_material(*material);
    const XMLElement* geometry = values_.only_child(element, "geometry");
    const XMLElement* kind = geometry == nullptr ? nullptr : geometry->FirstChildElement();
    if (kind == nullptr) {
      values_.report_problem(element, fmt::format("<{}> has no geometry", element.Name()),
                             "<geometry> with a shape in it");
      return;
    }
    if (const XMLElement* other = kind->NextSiblingElement()) {
      values_.report_problem(*other, fmt::format("<geometry> has a second shape, <{}>", other->Name()),
                             fmt::format("one; a <{}> for each shape", element.Name()));
      return;
    }
    const std::string_view tag = kind->Name();
    if (tag == "box") {
      shape.kind = Geometry::Kind::box;
      shape.size = values_.triple(*kind, "size", std::nullopt);
    } else if (tag == "sphere") {
      shape.kind = Geometry::Kind::sphere;
      shape.radius = values_.number(*kind, "radius", std::nullopt);
    } else if (tag == "cylinder" || tag == "capsule") {
      shape.kind = tag == "cylinder" ? Geometry::Kind::cylinder : Geometry::Kind::capsule;
      shape.radius = values_.number(*kind, "radius", std::nullopt);
      shape.length = values_.number(*kind, "length", std::nullopt);
    } else if (tag == "mesh") {
      shape.kind = Geometry::Kind::mesh;
      shape.file = values_.name(*kind, "filename").value_or("");
      shape.scale = values_.triple(*kind, "scale", Triple{1, 1, 1});
    } else {
      values_.report_problem(*kind, fmt::format("<{}> is no shape", tag), "box, sphere, cylinder, capsule or mesh");
      return;
    }
    if (report_.size() > problems) return;
    if (!has_extent(shape)) {
      values_.note(*kind, fmt::format("<{}>: a {} without extent is not taken over", element.Name(), tag));
      return;
    }
    link.geometries.push_back(std::move(shape));
  }

  // size 0: a placeholder of another program
  static bool has_extent(const Geometry& shape) {
    switch (shape.kind) {
      case Geometry::Kind::box:
        return std::all_of(shape.size.begin(), shape.size.end(), [](double size) { return size > 0; });
      case Geometry::Kind::sphere:
        return shape.radius > 0;
      case Geometry::Kind::cylinder:
      case Geometry::Kind::capsule:
        return shape.radius > 0 && shape.length > 0;
      case Geometry::Kind::mesh:
        break;
    }
    return true;
  }

  void read_joint(const XMLElement& element) {
    const auto name = name_of_element(element, joint_lines_);
    if (!name) return;
    constexpr std::string_view kKnown[] = {"name", "type"};
    values_.note_other_attributes(element, kKnown);
    Joint joint{.name = *name, .origin = values_.origin(element), .line = element.GetLineNum()};
    const auto kind = read_kind(element);
    if (!kind) return;
    joint.kind = *kind;
    joint.parent = read_end(element, "parent");
    joint.child = read_end(element, "child");
    if (joint.parent >= 0 && joint.parent == joint.child) {
      values_.report_problem(element, "parent and child are the same link", "two links");
    }
    read_axis(element, joint);
    read_limit(element, joint);
    read_dynamics(element, joint);
    read_mimic(element, joint);
    for_each_child(element, [&](const XMLElement& child, std::string_view tag) {
      constexpr std::string_view kRead[] = {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic"};
      if (std::find(std::begin(kRead), std::end(kRead), tag) == std::end(kRead)) note_element(child);
    });
    robot_.joints.push_back(std::move(joint));
  }

  void read_mimic(const XMLElement& element, Joint& joint) {
    const XMLElement* mimic = values_.only_child(element, "mimic");
    if (mimic == nullptr) return;
    constexpr std::string_view kKnown[] = {"joint", "multiplier", "offset"};
    values_.note_other_attributes(*mimic, kKnown);
    const auto leader = values_.name(*mimic, "joint");
    const double multiplier = values_.number(*mimic, "multiplier", 1), offset = values_.number(*mimic, "offset", 0);
    if (!leader) return;
    if (!joint.has_coordinate()) {
      values_.note(*mimic, "<mimic> of a joint without a coordinate is not taken over");
      return;
    }
    joint.mimic = {.joint = *leader, .multiplier = multiplier, .offset = offset, .line = mimic->GetLineNum()};
  }

  std::optional<JointKind> read_kind(const XMLElement& element) {
    const auto type = values_.name(element, "type");
    if (!type) return std::nullopt;
    for (const auto& [word, kind] : kJointKinds) {
      if (*type == word) return kind;
    }
    values_.report_problem(element, fmt::format("the type '{}' is unknown", *type), kKindList);
    return std::nullopt;
  }

  // Index of the link that <parent> or <child> names; -1 after a reported problem.
  int read_end(const XMLElement& element, const char* tag) {
    const XMLElement* end = values_.only_child(element, tag);
    if (end == nullptr) {
      values_.report_problem(element, fmt::format("has no <{}>", tag), fmt::format("<{} link=\"...\"/>", tag));
      return -1;
    }
    const auto link = values_.name(*end, "link");
    if (!link) return -1;
    const auto found = link_index_.find(*link);
    if (found != link_index_.end()) return found->second;
    values_.report_problem(*end, fmt::format("there is no link '{}'", *link), "the name of a link");
    return -1;
  }

  void read_axis(const XMLElement& element, Joint& joint) {
    const XMLElement* axis = values_.only_child(element, "axis");
    if (axis == nullptr || !has_axis(joint)) return;
    joint.axis = values_.triple(*axis, "xyz", Triple{1, 0, 0});
    const double size = std::hypot(joint.axis[0], joint.axis[1], joint.axis[2]);
    if (size == 0) values_.report_problem(*axis, "the axis is zero", "a direction");
    if (size == 0 || size == 1) return;
    for (double& component : joint.axis) component /= size;
  }

  void read_limit(const XMLElement& element, Joint& joint) {
    const XMLElement* limit = values_.only_child(element, "limit");
    if (limit == nullptr) {
      if (has_limits(joint.kind)) values_.note(element, "has no <limit>: it moves without limits");
      return;
    }
    constexpr std::string_view kKnown[] = {"lower", "upper", "effort", "velocity"};
    values_.note_other_attributes(*limit, kKnown);
    if (limit->Attribute("effort") != nullptr || limit->Attribute("velocity") != nullptr) {
      if (bounds_line_ == 0) bounds_line_ = limit->GetLineNum();
      bounded_joints_ += (bounded_joints_.empty() ? "" : ", ") + joint.name;
    }
    if (!has_limits(joint.kind)) return;
    const std::size_t problems = report_.size();
    joint.lower = values_.number(*limit, "lower", 0);
    joint.upper = values_.number(*limit, "upper", 0);
    joint.is_limited = joint.lower < joint.upper;
    if (report_.size() > problems || joint.is_limited) return;
    values_.note(
        *limit, fmt::format("the limits {} and {} leave no motion and are not taken over: the joint is {}", joint.lower,
                            joint.upper, joint.kind == JointKind::revolute ? "continuous" : "without limits"));
    if (joint.kind == JointKind::revolute) joint.kind = JointKind::continuous;
  }

  void read_dynamics(const XMLElement& element, Joint& joint) {
    const XMLElement* dynamics = values_.only_child(element, "dynamics");
    if (dynamics == nullptr) return;
    constexpr std::string_view kKnown[] = {"damping", "friction"};
    values_.note_other_attributes(*dynamics, kKnown);
    joint.damping = values_.number_not_negative(*dynamics, "damping", 0);
    joint.friction = values_.number_not_negative(*dynamics, "friction", 0);
    if (!joint.has_coordinate() && (joint.damping > 0 || joint.friction > 0)) {
      values_.note(*dynamics, "<dynamics> of a joint without a coordinate is not taken over");
    }
  }

  Robot robot_;
  int source_;
  Report& report_;
  ElementValues values_;
  int material_line_ = 0, bounds_line_ = 0;
  std::string bounded_joints_;
  std::map<std::string, int> link_lines_, joint_lines_, link_index_;
};

// "mismatched element" of XML_ERROR_MISMATCHED_ELEMENT
std::string words_of(const char* error_name) {
  std::string words = error_name;
  if (words.starts_with("XML_ERROR_")) words.erase(0, 10);
  for (char& c : words) c = c == '_' ? ' ' : c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  return words;
}

}  // namespace

std::optional<Robot> read_robot(const scene::SourceText& source, Report& report) {
  tinyxml2::XMLDocument document;
  if (document.Parse(source.text.data(), source.text.size()) != tinyxml2::XML_SUCCESS) {
    report.add({source.source, document.ErrorLineNum(), 0}, "",
               {"is not well-formed XML: " + words_of(document.ErrorName()), "a URDF file", ""});
    return std::nullopt;
  }
  if (document.RootElement() == nullptr) {
    report.add({source.source, 0, 0}, "", {"holds no element", "a URDF file", ""});
    return std::nullopt;
  }
  return Reader(source.source, report).read(*document.RootElement());
}

}  // namespace slew::urdf
