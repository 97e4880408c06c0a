// SPDX-License-Identifier: Apache-2.0
// The only way to FCL: a shared library of its own with plain numbers at its border.
//
// FCL as Debian builds it is for baseline x86-64, where Eigen's types are aligned to 16 bytes; with our instruction set
// they are aligned to 32, and an object made on one side would be read wrongly on the other. So the code behind this
// header is built with FCL's own flags, hides all its symbols but these, and no type of FCL or Eigen crosses.
//
// Sensors search with it, outside of the step; it allocates. The contact points of a step come from our own search,
// which tests compare with FCL (docs/decisions/own-contact-search.md).
//
// Vectors are x, y, z [m]; a rotation is three columns of three. Queries on one Geometries object may run in several
// threads at once as long as each has a Scratch or Groups of its own.
#pragma once

#include <cstddef>
#include <cstdint>

#if defined(__GNUC__)
#define SLEWRING_FCL_EXPORT __attribute__((visibility("default")))
#endif

namespace slew::sensors::fcl_border {

struct Geometries;  // immutable once all shapes are added
struct Scratch;     // memory of queries of pairs
struct Groups;      // shapes at their places, in groups

struct Placement {
  const double* p_W;  // 3
  const double* R_W;  // 9, column by column
};

// Overlap of two shapes at one place.
struct RawContact {
  double p_W[3];  // m, half way between both surfaces
  double n_W[3];  // unit, from the second shape to the first
  double depth;   // m, > 0
};

enum class QueryResult : std::int32_t { fine, more_than_fit, failed };

SLEWRING_FCL_EXPORT Geometries* create_geometries();
SLEWRING_FCL_EXPORT void destroy(Geometries* geometries) noexcept;
SLEWRING_FCL_EXPORT Scratch* create_scratch(std::size_t max_contacts);
SLEWRING_FCL_EXPORT void destroy(Scratch* scratch) noexcept;
SLEWRING_FCL_EXPORT Groups* create_groups(const Geometries& geometries);  // geometries outlive the groups
SLEWRING_FCL_EXPORT void destroy(Groups* groups) noexcept;

// Each returns the index of the new shape; at build only.
SLEWRING_FCL_EXPORT std::size_t add_sphere(Geometries& geometries, double radius);
SLEWRING_FCL_EXPORT std::size_t add_box(Geometries& geometries, double x, double y, double z);       // edges
SLEWRING_FCL_EXPORT std::size_t add_cylinder(Geometries& geometries, double radius, double length);  // along z
SLEWRING_FCL_EXPORT std::size_t add_capsule(Geometries& geometries, double radius, double length);   // along z
SLEWRING_FCL_EXPORT std::size_t add_plane(Geometries& geometries);                                   // solid z <= 0
SLEWRING_FCL_EXPORT std::size_t add_convex(Geometries& geometries, const double* vertices, std::size_t vertex_count,
                                           const std::uint32_t* triangles, std::size_t triangle_count);
// A surface of any number of triangles, convex or not, closed or not: it has no inside.
SLEWRING_FCL_EXPORT std::size_t add_surface(Geometries& geometries, const double* vertices, std::size_t vertex_count,
                                            const std::uint32_t* triangles, std::size_t triangle_count);

// Contacts of shape a against shape b, at most `capacity` of them; `count` is their number. FCL allocates inside.
// failed: FCL gave up or found a value that is not finite; count is 0 then.
SLEWRING_FCL_EXPORT QueryResult collide(const Geometries& geometries, Scratch& scratch, std::size_t a, Placement of_a,
                                        std::size_t b, Placement of_b, RawContact* out, std::size_t capacity,
                                        std::size_t& count) noexcept;

// ---- groups ---------------------------------------------------------------------------------------------------

// Returns the index of a new group of shapes, each in a frame. Pairs of shapes in the same frame are not searched.
SLEWRING_FCL_EXPORT std::size_t add_group(Groups& groups, const std::size_t* shapes, const std::size_t* frames,
                                          std::size_t count);
// Places the group's member number k.
SLEWRING_FCL_EXPORT void place(Groups& groups, std::size_t group, std::size_t k, Placement placement) noexcept;

// The nearest points of two groups. Overlap: distance 0, both points are the place of one contact, and n_W its normal.
struct Nearest {
  double distance;  // m
  double p_a_W[3], p_b_W[3];
  double n_W[3];                   // unit, from b to a; 0 if none could be found
  std::size_t member_a, member_b;  // numbers in their groups
};

// The result depends on the places alone, not on earlier queries. failed: no pair of shapes could be searched, or a
// value is not finite.
SLEWRING_FCL_EXPORT QueryResult find_nearest(Groups& groups, std::size_t a, std::size_t b, Nearest& nearest) noexcept;
SLEWRING_FCL_EXPORT QueryResult find_overlap(Groups& groups, std::size_t a, std::size_t b, bool& overlaps) noexcept;

}  // namespace slew::sensors::fcl_border
