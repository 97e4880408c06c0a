// SPDX-License-Identifier: Apache-2.0
#include "analysis/drawing/mechanism_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "analysis/animation/machine_drawing.h"
#include "analysis/drawing/body_faces.h"
#include "analysis/drawing/margin_names.h"
#include "analysis/drawing/mechanism_look.h"
#include "analysis/drawing/mechanism_marks.h"
#include "core/display.h"
#include "core/escaped.h"
#include "plotting/svg_text.h"

namespace slew::analysis {
namespace {

using math::Vec3;

constexpr double kPictureWide = 760, kPictureHigh = 560;  // px, of the machine itself, at most
constexpr double kPictureMargin = 28;                     // px, between the machine and the names

// Something that is filled: a face, or a bar between two points of a body.
struct Piece {
  double depth = 0;
  std::size_t body = 0;
  int shade = 0;  // -1: a bar
  std::vector<Vec3> points{};
  std::string tint{};  // colour of a mesh on Ground; empty: that of the body
};

class MechanismDrawer {
 public:
  MechanismDrawer(const scene::Scene& scene, const std::string& folder, ViewFrom view)
      : scene_(scene),
        lines_(analysis::draw_machine(scene.mechanics)),
        machine_(scene),
        view_(view),
        camera_(camera_of(lines_, view)) {
    collect(folder);
    find_cylinders();
    hold();
  }

  MechanismPicture draw() {
    // names first: they state how wide the margins are
    camera_.fit(0, 0, kPictureWide, kPictureHigh);
    collect_names();
    const double margin = margin_width(names_) + 10;
    const double height = camera_.fit(margin + kPictureMargin, kPictureMargin, kPictureWide, kPictureHigh);
    names_.clear();
    collect_names();
    MechanismPicture picture;
    const double right = margin + 2 * kPictureMargin + kPictureWide;
    const double needed = spread_names(names_, (margin + right) / 2, kPictureMargin, height);
    picture.width = right + margin;
    picture.height = 2 * kPictureMargin + std::max(height, needed) + 30;
    picture.group = fmt::format(
        "<g class=\"mechanism\">\n<clipPath id=\"machine\"><rect x=\"{:.1f}\" y=\"0\" width=\"{:.1f}\" "
        "height=\"{:.1f}\"/>"
        "</clipPath>\n<g clip-path=\"url(#machine)\">\n",
        margin, right - margin, picture.height - 30);
    put_supports(picture.group);
    put_pieces(picture.group);
    put_forces(picture.group);
    put_marks(picture.group);
    picture.group += "</g>\n" + margin_group(names_, margin, right);
    put_scale(picture.group, margin, picture.height - 12);
    picture.group += "</g>\n";
    picture.left_out = std::move(left_out_);
    return picture;
  }

 private:
  static Camera camera_of(const MachineDrawing& lines, ViewFrom view) {
    const Vec3 right(lines.axes[0]), viewer(lines.axes[1]), up(lines.axes[2]);
    switch (view) {
      case ViewFrom::top:
        return {right, -viewer};
      case ViewFrom::front:
        return {-viewer, up};
      default:
        return {right, up};
    }
  }
  [[nodiscard]] Vec3 placed(std::size_t body, Vec3 point) const {
    return machine_.body(body).p_WB + machine_.body(body).R_WB * point;
  }

  void add_face(std::size_t body, const Face& face, const std::string& tint = "") {
    const Vec3 a = placed(body, face[0]), b = placed(body, face[1]), c = placed(body, face[2]);
    const Vec3 across = math::cross(b - a, c - a);
    const double size = math::norm(across);
    if (!(size > 0)) return;
    const double facing = std::fabs(camera_.facing((1 / size) * across));
    const int shade = std::min(kShades - 1, static_cast<int>(facing * kShades));
    pieces_.push_back({(camera_.depth(a) + camera_.depth(b) + camera_.depth(c)) / 3, body, shade, {a, b, c}, tint});
  }
  void collect(const std::string& folder) {
    std::set<std::size_t> has_faces;
    for (const scene::GraphicDef& graphic : scene_.graphics) {
      const auto body = machine_.index(graphic.body);
      if (!body) continue;
      const std::vector<Face> faces = faces_of(graphic, folder, left_out_);
      for (const Face& face : faces) add_face(*body, face, *body == 0 ? hex_colour(graphic.color) : "");
      if (!faces.empty()) has_faces.insert(*body);
      if (*body == 0) ground_meshes_.push_back(faces);
    }
    const std::set<std::size_t> has_meshes = has_faces;
    for (const multibody::ShapeDef& shape : scene_.mechanics.shapes) {
      const auto body = machine_.index(shape.body);
      if (!body || has_meshes.contains(*body)) continue;
      for (const Face& face : faces_of(shape)) {
        add_face(*body, face);
        has_faces.insert(*body);
      }
    }
    for (std::size_t body = 1; body < lines_.bodies.size(); ++body) {
      if (has_faces.contains(body) || is_bare(body)) continue;  // a bare one has the sign of its centre of mass
      for (const Polyline& line : lines_.bodies[body].lines) {
        const Vec3 a = placed(body, Vec3(line.front())), b = placed(body, Vec3(line.back()));
        pieces_.push_back({(camera_.depth(a) + camera_.depth(b)) / 2, body, -1, {a, b}});
      }
    }
    // Ground lies behind the machine
    std::stable_sort(pieces_.begin(), pieces_.end(), [](const Piece& a, const Piece& b) {
      return std::pair(a.body != 0, a.depth) < std::pair(b.body != 0, b.depth);
    });
  }
  // Only the cross that marks a body without any line of its own.
  [[nodiscard]] bool is_bare(std::size_t body) const {
    const Vec3 mass(scene_.mechanics.bodies[body - 1].center_of_mass);
    const std::vector<Polyline>& lines = lines_.bodies[body].lines;
    return std::all_of(lines.begin(), lines.end(), [&](const Polyline& line) {
      return math::norm(0.5 * (Vec3(line.front()) + Vec3(line.back())) - mass) < 1e-9;
    });
  }
  void find_cylinders() {
    for (const auto& component : scene_.hydraulics.components) {
      const auto actuator = component->actuator();
      if (actuator) drives_.emplace(actuator->force, component->name);
    }
  }
  void hold() {
    for (const Piece& piece : pieces_) {
      if (piece.body == 0) continue;
      for (const Vec3& point : piece.points) camera_.hold(point);
    }
    for (const multibody::JointDef& joint : scene_.mechanics.joints) {
      for (const auto& at : {machine_.point(joint.body1, joint.point1), machine_.point(joint.body2, joint.point2)}) {
        if (at) camera_.hold(*at);
      }
    }
    for (const multibody::TranslationalForceDef& force : scene_.mechanics.translational_forces) {
      for (const auto& at : {machine_.point(force.body1, force.point1), machine_.point(force.body2, force.point2)}) {
        if (at) camera_.hold(*at);
      }
    }
    for (const multibody::BodyDef& body : scene_.mechanics.bodies) {
      camera_.hold(*machine_.point(body.name, body.center_of_mass));
    }
    for (const multibody::RopeDef& rope : scene_.mechanics.ropes) {
      for (std::size_t i = 0; i < rope.points.size(); ++i) {
        if (const auto at = machine_.point(rope.bodies[i], rope.points[i])) camera_.hold(*at);
      }
    }
    for (const multibody::TyreDummyDef& tyre : scene_.mechanics.tyre_dummies) {
      for (const Vec3& point : rim_of(tyre)) camera_.hold(point);
    }
    // meshes on Ground, but those beside which the machine would be small
    constexpr double kMostGround = 2;
    const double size = camera_.size();
    for (const std::vector<Face>& mesh : ground_meshes_) {
      Camera all = camera_;
      for (const Face& face : mesh) {
        for (const Vec3& corner : face) all.hold(placed(0, corner));
      }
      if (all.size() <= kMostGround * size) camera_ = all;
    }
  }

  // ---- names

  void add_name(const std::string& element, const std::string& text, std::string_view style, Vec3 at) {
    names_.push_back({.text = text, .element = element, .style = std::string(style), .at = camera_.at(at)});
  }
  void collect_names() {
    const multibody::MechanicsDef& mechanics = scene_.mechanics;
    for (const multibody::BodyDef& body : mechanics.bodies) {
      add_name(body.name, fmt::format("{}, {}", body.name, quantity_text(body.mass, "kg")), "of-body",
               *machine_.point(body.name, body.center_of_mass));
    }
    for (const multibody::JointDef& joint : mechanics.joints) {
      if (const auto at = machine_.point(joint.body2, joint.point2)) {
        add_name(joint.name, fmt::format("{} ({})", joint.name, joint_word(joint.type)), "of-joint", *at);
      }
    }
    for (const multibody::TranslationalForceDef& force : mechanics.translational_forces) {
      const auto a = machine_.point(force.body1, force.point1), b = machine_.point(force.body2, force.point2);
      if (!a || !b) continue;
      const auto drive = drives_.find(force.name);
      const std::string& name = drive == drives_.end() ? force.name : drive->second;
      add_name(name, name, "of-force", *a + 0.4 * (*b - *a));
    }
    for (const multibody::RopeDef& rope : mechanics.ropes) {
      const auto at = rope.bodies.empty() ? std::nullopt : machine_.point(rope.bodies.front(), rope.points.front());
      if (at) add_name(rope.name, rope.name, "of-force", *at);
    }
  }

  // ---- parts

  // Attributes of a piece's path.
  static std::string look_of(const Piece& piece) {
    if (!piece.tint.empty()) {
      const std::string mixed = with_white(piece.tint, 0.4 + 0.08 * piece.shade);
      return fmt::format("class=\"g\" style=\"fill:{0};stroke:{0};stroke-width:.5\"", mixed);
    }
    if (piece.body == 0) return fmt::format("class=\"g s{}\"", piece.shade);
    return fmt::format("class=\"b{} {}\"", (piece.body - 1) % plotting::kColours.size(),
                       piece.shade < 0 ? "bar" : fmt::format("s{}", piece.shade));
  }
  void put_pieces(std::string& out) {
    std::string last;
    for (const Piece& piece : pieces_) {
      const std::string kind = look_of(piece);
      if (kind != last) {
        if (!last.empty()) out += "\"/>\n";
        fmt::format_to(std::back_inserter(out), "<path {} d=\"", kind);
        last = kind;
      }
      for (std::size_t i = 0; i < piece.points.size(); ++i) {
        const Point at = camera_.at(piece.points[i]);
        fmt::format_to(std::back_inserter(out), "{}{:.1f} {:.1f}", i == 0 ? 'M' : 'L', at.x, at.y);
      }
      if (piece.shade >= 0) out += 'Z';
    }
    if (!last.empty()) out += "\"/>\n";
  }
  void put_forces(std::string& out) {
    out += "<g class=\"forces\">\n";
    for (const multibody::TranslationalForceDef& force : scene_.mechanics.translational_forces) {
      const auto a = machine_.point(force.body1, force.point1), b = machine_.point(force.body2, force.point2);
      if (!a || !b) continue;
      const auto drive = drives_.find(force.name);
      const bool is_cylinder = drive != drives_.end();
      fmt::format_to(
          std::back_inserter(out), "<g class=\"{}\" data-element=\"{}\">{}</g>\n", is_cylinder ? "cylinder" : "spring",
          escaped(is_cylinder ? drive->second : force.name),
          is_cylinder ? cylinder_sign(camera_.at(*a), camera_.at(*b)) : spring_sign(camera_.at(*a), camera_.at(*b)));
    }
    // massless links between the points of a joint
    for (const multibody::JointDef& joint : scene_.mechanics.joints) {
      const auto a = machine_.point(joint.body1, joint.point1), b = machine_.point(joint.body2, joint.point2);
      if (!a || !b || math::norm(*b - *a) < 1e-9 || joint.type == multibody::JointType::floating) continue;
      const Point from = camera_.at(*a), to = camera_.at(*b);
      fmt::format_to(std::back_inserter(out),
                     "<path class=\"rope\" data-element=\"{}\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n",
                     escaped(joint.name), from.x, from.y, to.x, to.y);
    }
    for (const multibody::RopeDef& rope : scene_.mechanics.ropes) put_rope(out, rope);
    for (const multibody::TyreDummyDef& tyre : scene_.mechanics.tyre_dummies) put_tyre(out, tyre);
    out += "</g>\n";
  }
  void put_rope(std::string& out, const multibody::RopeDef& rope) {
    fmt::format_to(std::back_inserter(out), "<path class=\"rope\" data-element=\"{}\" d=\"", escaped(rope.name));
    char command = 'M';
    for (std::size_t i = 0; i < rope.points.size(); ++i) {
      const auto at = machine_.point(rope.bodies[i], rope.points[i]);
      if (!at) continue;
      const Point in_picture = camera_.at(*at);
      fmt::format_to(std::back_inserter(out), "{}{:.1f} {:.1f}", std::exchange(command, 'L'), in_picture.x,
                     in_picture.y);
    }
    out += "\"/>\n";
  }
  // Points of the tread, in Ground.
  [[nodiscard]] std::vector<Vec3> rim_of(const multibody::TyreDummyDef& tyre) const {
    constexpr int kPoints = 32;
    const auto body = machine_.index(tyre.relative_to);
    if (!body) return {};
    const math::Mat3 R = math::rotation_zxz(tyre.orientation);
    std::vector<Vec3> rim;
    for (int i = 0; i < kPoints; ++i) {
      const double angle = 2 * std::numbers::pi * i / kPoints;
      rim.push_back(placed(
          *body, Vec3(tyre.position) + R * Vec3(tyre.radius * std::cos(angle), tyre.radius * std::sin(angle), 0)));
    }
    return rim;
  }
  void put_tyre(std::string& out, const multibody::TyreDummyDef& tyre) {
    char command = 'M';
    fmt::format_to(std::back_inserter(out), "<path class=\"tyre\" data-element=\"{}\" d=\"", escaped(tyre.name));
    for (const Vec3& point : rim_of(tyre)) {
      const Point at = camera_.at(point);
      fmt::format_to(std::back_inserter(out), "{}{:.1f} {:.1f}", std::exchange(command, 'L'), at.x, at.y);
    }
    out += "Z\"/>\n";
  }
  // Supports of the machine, where no mesh or shape of Ground shows them; not from above.
  void put_supports(std::string& out) {
    const multibody::MechanicsDef& mechanics = scene_.mechanics;
    if (view_ == ViewFrom::top ||
        std::any_of(pieces_.begin(), pieces_.end(), [](const Piece& p) { return p.body == 0; }))
      return;
    out += "<g class=\"supports\">";
    const auto put = [&](const std::string& body, const Triple& point) {
      if (body == multibody::kGroundName) out += support_sign(camera_.at(Vec3(point)));
    };
    for (const multibody::JointDef& joint : mechanics.joints) {
      if (joint.type != multibody::JointType::floating) put(joint.body1, joint.point1);
    }
    for (const multibody::TranslationalForceDef& force : mechanics.translational_forces) {
      put(force.body1, force.point1);
      put(force.body2, force.point2);
    }
    out += "</g>\n";
  }
  void put_marks(std::string& out) {
    const multibody::MechanicsDef& mechanics = scene_.mechanics;
    out += "<g class=\"frames\">";
    for (std::size_t body = 0; body < lines_.bodies.size(); ++body) out += frame_sign(machine_.body(body), camera_);
    out += "</g>\n<g class=\"masses\">";
    for (const multibody::BodyDef& body : mechanics.bodies) {
      fmt::format_to(std::back_inserter(out), "<g data-element=\"{}\">{}</g>", escaped(body.name),
                     mass_sign(camera_.at(*machine_.point(body.name, body.center_of_mass))));
    }
    out += "</g>\n<g class=\"joints\">\n";
    for (const multibody::JointDef& joint : mechanics.joints) {
      const auto at = machine_.point(joint.body2, joint.point2);
      if (!at) continue;
      Vec3 axis = math::rotation_xyz(joint.orientation1) * Vec3(0, 0, 1);
      if (const auto body1 = machine_.index(joint.body1)) axis = machine_.body(*body1).R_WB * axis;
      fmt::format_to(std::back_inserter(out), "<g data-element=\"{}\"><title>{} ({})</title>{}</g>\n",
                     escaped(joint.name), escaped(joint.name), joint_word(joint.type),
                     joint_sign(joint.type, *at, axis, camera_));
    }
    out += "</g>\n";
  }
  // A bar of a round length.
  void put_scale(std::string& out, double left, double y) const {
    constexpr double kScaleSteps[] = {2, 2.5, 2};  // 1, 2, 5, 10, ...
    double length = 1e-3;
    for (std::size_t i = 0; length * kScaleSteps[i % 3] * camera_.scale() < 130; ++i) length *= kScaleSteps[i % 3];
    fmt::format_to(std::back_inserter(out),
                   "<path class=\"scale\" d=\"M{0:.1f} {1:.1f}v6h{2:.1f}v-6\"/><text class=\"figure\" x=\"{3:.1f}\" "
                   "y=\"{4:.1f}\">{5}</text>\n",
                   left + kPictureMargin, y - 6, length * camera_.scale(),
                   left + kPictureMargin + length * camera_.scale() + 8, y + 2, chosen_text(length, "m"));
  }

  const scene::Scene& scene_;
  MachineDrawing lines_;
  MachineAtStart machine_;
  ViewFrom view_;
  Camera camera_;
  std::vector<Piece> pieces_;
  std::vector<std::vector<Face>> ground_meshes_;
  std::map<std::string, std::string> drives_;  // actuator by force
  std::vector<MarginName> names_;
  std::vector<std::string> left_out_;
};

}  // namespace

MechanismPicture draw_mechanism(const scene::Scene& scene, const std::string& folder, ViewFrom view) {
  return MechanismDrawer(scene, folder, view).draw();
}

}  // namespace slew::analysis
