// SPDX-License-Identifier: Apache-2.0
#include "flex/finite_segments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "flex/input_error.h"

namespace slew::flex {

using math::Mat3;
using math::Vec3;

namespace {

// tolerances: distance of nodes from the line over its length, and turns of the section between elements [rad]
constexpr double kOnAxis = 1e-6;

// The beam along s from its first end, piece by piece.
struct Piece {
  double begin = 0, end = 0;  // m
  UniformElement numbers;
};

// Bending in one plane, (2).
struct Plane {
  double vv = 0, vr = 0, rr = 0;
};

class Segmenter {
 public:
  Segmenter(const Reduction& reduction, int segments) : from_(reduction), count_(static_cast<std::size_t>(segments)) {}

  FiniteSegments run() {
    if (from_.elements.empty())
      throw InputError("the files hold no beam elements: segments are made of beams, not of imported matrices");
    order_pieces();
    length_ = pieces_.back().end;
    l_ = length_ / static_cast<double>(count_);
    for (std::size_t i = 0; i <= count_; ++i) out_.lumps.push_back(lump_at(i));
    for (const ReducedNode& node : from_.body.nodes) out_.lump_of.push_back(lump_of(node.position));
    const auto& clamped = from_.source.clamped_nodes;
    out_.root = out_.lump_of[clamped.empty() ? 0 : find_node(from_.body, clamped.front())];
    for (std::size_t i = out_.root; i < count_; ++i) out_.connectors.push_back(connector(i, i + 1));
    for (std::size_t i = out_.root; i > 0; --i) out_.connectors.push_back(connector(i, i - 1));
    return std::move(out_);
  }

 private:
  [[nodiscard]] Vec3 place(int id) const { return from_.body.nodes[find_node(from_.body, id)].position; }

  [[nodiscard]] int elements_at(int id) const {
    return static_cast<int>(std::count_if(from_.elements.begin(), from_.elements.end(),
                                          [id](const auto& e) { return e.node1 == id || e.node2 == id; }));
  }

  // from the end that is first in the files to the other
  void order_pieces() {
    const auto end = std::find_if(from_.body.nodes.begin(), from_.body.nodes.end(),
                                  [&](const ReducedNode& node) { return elements_at(node.id) == 1; });
    if (end == from_.body.nodes.end()) throw InputError("the beam has no end; segments take a beam from end to end");
    std::vector<UniformElement> left = from_.elements;
    int id = end->id;
    start_ = end->position;
    double s = 0;
    while (!left.empty()) {
      const auto next =
          std::find_if(left.begin(), left.end(), [id](const auto& e) { return e.node1 == id || e.node2 == id; });
      if (next == left.end() || elements_at(id) > 2)
        throw InputError(
            fmt::format("the beam branches or ends at node {}; segments take one beam from end to end", id));
      const int other = next->node1 == id ? next->node2 : next->node1;
      const double length = norm(place(other) - place(id));
      if (pieces_.empty()) see_axes(*next, place(other));
      check_piece(*next, other);
      pieces_.push_back({s, s + length, *next});
      s += length;
      id = other;
      left.erase(next);
    }
  }

  void see_axes(const UniformElement& first, Vec3 towards) {
    const Vec3 x = (towards - start_) * (1 / norm(towards - start_));
    axes_ = {x, first.y, cross(x, first.y)};
  }

  void check_piece(const UniformElement& e, int end) const {
    const Vec3 r = place(end) - start_;
    if (norm(cross(axes_.c[0], r)) > kOnAxis * norm(r) || dot(axes_.c[0], r) <= 0)
      throw InputError(
          fmt::format("node {} is off the line of the nodes before it; segments take straight beams", end));
    const bool is_round = e.bend_y == e.bend_z && e.shear_y == e.shear_z && e.rotary_y == e.rotary_z;
    if (!is_round && norm(cross(e.y, axes_.c[1])) > kOnAxis)
      throw InputError(fmt::format(
          "the section before node {} is turned about the beam; segments take sections of one direction", end));
  }

  // visit(piece, begin, end) for every piece of [from, to]
  template <typename Visit>
  void walk(double from, double to, Visit visit) const {
    for (const Piece& piece : pieces_) {
      const double begin = std::max(from, piece.begin), end = std::min(to, piece.end);
      if (end > begin) visit(piece.numbers, begin, end);
    }
  }

  // (1)
  [[nodiscard]] SegmentLump lump_at(std::size_t index) const {
    const double s = l_ * static_cast<double>(index);
    const double from = index == 0 ? 0 : s - l_ / 2, to = index == count_ ? length_ : s + l_ / 2;
    double mass = 0, first = 0, second = 0, rotary_y = 0, rotary_z = 0;
    walk(from, to, [&](const UniformElement& e, double a, double b) {
      mass += e.mass * (b - a);
      first += e.mass * ((b - s) * (b - s) - (a - s) * (a - s)) / 2;
      second += e.mass * ((b - s) * (b - s) * (b - s) - (a - s) * (a - s) * (a - s)) / 3;
      rotary_y += e.rotary_y * (b - a);
      rotary_z += e.rotary_z * (b - a);
    });
    const double c = first / mass, along = second - mass * c * c;
    const Mat3 J = Mat3::diagonal(rotary_y + rotary_z, rotary_y + along, rotary_z + along);
    return {start_ + axes_.c[0] * s, mass, start_ + axes_.c[0] * (s + c), axes_ * J * transpose(axes_)};
  }

  [[nodiscard]] SegmentConnector connector(std::size_t near, std::size_t far) const {
    const bool is_forward = far > near;
    const double from = l_ * static_cast<double>(std::min(near, far)), to = from + l_;
    double uu = 0, tt = 0;
    Plane xy, xz;
    walk(from, to, [&](const UniformElement& e, double a, double b) {
      // distances to the far end
      const double p = is_forward ? to - a : b - from, q = is_forward ? to - b : a - from;
      uu += (b - a) / e.axial;
      tt += (b - a) / e.torsion;
      const auto add = [&](Plane& plane, double EI, double kGA) {
        plane.vv += (p * p * p - q * q * q) / (3 * EI) + (kGA > 0 ? (b - a) / kGA : 0);
        plane.vr += (p * p - q * q) / (2 * EI);
        plane.rr += (b - a) / EI;
      };
      add(xy, e.bend_z, e.shear_y);
      add(xz, e.bend_y, e.shear_z);
    });
    const double d_xy = xy.vv * xy.rr - xy.vr * xy.vr, d_xz = xz.vv * xz.rr - xz.vr * xz.vr;
    const Mat3 axes = is_forward ? axes_ : Mat3{-axes_.c[0], axes_.c[1], -axes_.c[2]};
    return {near,
            far,
            axes,
            l_,
            {.k11 = 1 / uu,
             .k22 = xy.rr / d_xy,
             .k33 = xz.rr / d_xz,
             .k44 = 1 / tt,
             .k55 = xz.vv / d_xz,
             .k66 = xy.vv / d_xy,
             .k26 = -xy.vr / d_xy,
             .k35 = xz.vr / d_xz}};
  }

  [[nodiscard]] std::size_t lump_of(Vec3 position) const {
    const double place = dot(position - start_, axes_.c[0]) / l_;
    return static_cast<std::size_t>(std::clamp(std::floor(place + 0.5), 0.0, static_cast<double>(count_)));
  }

  const Reduction& from_;
  std::size_t count_;
  std::vector<Piece> pieces_;
  Vec3 start_;
  Mat3 axes_ = Mat3::identity();
  double length_ = 0, l_ = 0;
  FiniteSegments out_;
};

}  // namespace

FiniteSegments finite_segments(const Reduction& reduction, int segments) {
  return Segmenter(reduction, segments).run();
}

}  // namespace slew::flex
