// The only way to FCL: a shared library of its own with plain numbers at its border.
//
// FCL as Debian builds it is for baseline x86-64, where Eigen's types are aligned to 16 bytes; with our instruction set
// they are aligned to 32, and an object made on one side would be read wrongly on the other. So the code behind this
// header is built with FCL's own flags, hides all its symbols but these, and no type of FCL or Eigen crosses.
//
// Our searches are compared with it; no program uses it (docs/decisions/own-contact-search.md).
//
// Vectors are x, y, z [m]; a rotation is three columns of three. Queries on one Geometries object may run in several
// threads at once as long as each has a Scratch of its own.
#pragma once

#include <cstddef>
#include <cstdint>

#if defined(__GNUC__)
#define SLEWRING_FCL_EXPORT __attribute__((visibility("default")))
#endif

namespace slew::contact::fcl_border {

struct Geometries;  // immutable once all shapes are added
struct Scratch;     // memory of queries

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

// Each returns the index of the new shape; at build only.
SLEWRING_FCL_EXPORT std::size_t add_sphere(Geometries& geometries, double radius);
SLEWRING_FCL_EXPORT std::size_t add_box(Geometries& geometries, double x, double y, double z);       // edges
SLEWRING_FCL_EXPORT std::size_t add_cylinder(Geometries& geometries, double radius, double length);  // along z
SLEWRING_FCL_EXPORT std::size_t add_capsule(Geometries& geometries, double radius, double length);   // along z
SLEWRING_FCL_EXPORT std::size_t add_plane(Geometries& geometries);                                   // solid z <= 0
SLEWRING_FCL_EXPORT std::size_t add_convex(Geometries& geometries, const double* vertices, std::size_t vertex_count,
                                           const std::uint32_t* triangles, std::size_t triangle_count);

// Contacts of shape a against shape b, at most `capacity` of them; `count` is their number. FCL allocates inside.
// failed: FCL gave up or found a value that is not finite; count is 0 then.
SLEWRING_FCL_EXPORT QueryResult collide(const Geometries& geometries, Scratch& scratch, std::size_t a, Placement of_a,
                                        std::size_t b, Placement of_b, RawContact* out, std::size_t capacity,
                                        std::size_t& count) noexcept;

}  // namespace slew::contact::fcl_border
