// SPDX-License-Identifier: Apache-2.0
// A multibody program that runs the same mechanism as ours, to be timed beside it.
//
// Peers are compiled with the flags of their own packages, ours with -march of this project, under which types with
// vectors in them are passed and aligned differently: only plain numbers cross this border.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace slew::peers {

using Vector = std::array<double, 3>;
using Rotation = std::array<double, 9>;  // row by row

enum class Joint { revolute, prismatic, universal, spherical, floating };

// A body with its joint, whose frame is the body's: z is the axis of revolute and prismatic joints; universal joints
// turn about z of the joint's frame in the parent, then about the body's z, which is x of that frame at zero.
struct Body {
  int parent = -1;  // -1: Ground
  Joint joint = Joint::revolute;
  Rotation R_PJ{};     // pose of the joint's frame in the parent at zero
  Vector p_PJ{};       // m
  double mass = 0;     // kg
  Vector center{};     // m, body frame
  Rotation inertia{};  // kg m2, about the centre of mass, body axes
  double damping = 0;  // N m s/rad, of a spherical joint, alike about all axes
};

// Two points that coincide.
struct Closure {
  int body1 = 0, body2 = 0;
  Vector point1{}, point2{};  // m
};

struct Mechanism {
  Vector gravity{};  // m/s2, along -y
  std::vector<Body> bodies;
  std::vector<Closure> closures;
  int box = -1;         // body that is a box about its origin and touches the ground below y = 0; -1: none
  Vector box_size{};    // m
  double friction = 0;  // coefficient
};

// State of all bodies in turn. Coordinates: angle, displacement, two angles; spherical: quaternion w x y z of the body
// in the joint's frame; floating: position, then the quaternion, both in Ground. Speeds: their rates; spherical:
// angular velocity from the parent in axes of the joint's frame; floating: velocity, angular velocity in Ground axes.
struct State {
  std::vector<double> q, u;
};

class Peer {
 public:
  virtual ~Peer() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  // Results for the mechanism: accelerations of a state, and their largest difference to ours relative to the largest
  // of them; a step, empty: it has none.
  [[nodiscard]] virtual bool has_dynamics() const = 0;
  [[nodiscard]] virtual double tolerance() const = 0;
  [[nodiscard]] virtual std::string step_method() const = 0;

  // Takes a state and finds the accelerations u'.
  virtual void find_accelerations(const State& state) = 0;
  // accelerations of the last call, by u
  [[nodiscard]] virtual std::vector<double> accelerations() const = 0;

  // Sets the start of a run, and takes a step [s].
  virtual void start(const State& state) = 0;
  virtual void step(double h) = 0;
  // Coordinates now, of joints with one coordinate only; others are zero.
  [[nodiscard]] virtual std::vector<double> angles() const = 0;
};

// One for every program that is built; none: it cannot hold the mechanism.
[[nodiscard]] std::unique_ptr<Peer> make_peer(const Mechanism& mechanism, double h);

// Numbers of coordinates and speeds.
inline std::array<std::size_t, 2> sizes(Joint joint) {
  constexpr std::array<std::array<std::size_t, 2>, 5> kSizes = {{{1, 1}, {1, 1}, {2, 2}, {4, 3}, {7, 6}}};
  return kSizes[static_cast<std::size_t>(joint)];
}

// Calls with every body in turn, its first coordinate and its first speed.
template <typename Call>
void for_each_body(const Mechanism& mechanism, Call call) {
  std::size_t q = 0, u = 0;
  for (std::size_t b = 0; b < mechanism.bodies.size(); ++b) {
    call(b, q, u);
    const auto [coordinates, speeds] = sizes(mechanism.bodies[b].joint);
    q += coordinates;
    u += speeds;
  }
}

}  // namespace slew::peers
