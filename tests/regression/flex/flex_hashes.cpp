// SPDX-License-Identifier: Apache-2.0
// Prints hashes of reduced bodies, dense and by Lanczos steps, clamped and free. Two builds of one compiler print the
// same:
//   diff <(build/release/bin/flex_hashes) <(build/dev/bin/flex_hashes)
#include <cinttypes>
#include <cstdio>
#include <exception>

#include "core/state_hash.h"
#include "tests/support/flex_beams.h"

namespace {

using namespace slew;
using math::Mat3;
using math::Vec3;

void add(StateHash& hash, Vec3 v) {
  const auto values = v.array();
  hash.add(values);
}

void add(StateHash& hash, const Mat3& a) {
  for (const Vec3& column : a.c) add(hash, column);
}

std::uint64_t hash_of(const flex::ReducedBody& body) {
  StateHash hash;
  hash.add(body.omega);
  add(hash, body.s0);
  add(hash, body.W0);
  for (const Vec3& C : body.C) add(hash, C);
  for (const Mat3& Z : body.Z) add(hash, Z);
  for (const Mat3& Y : body.Y) add(hash, Y);
  for (const Mat3& H : body.H) add(hash, H);
  for (const flex::ReducedNode& node : body.nodes) {
    for (const Vec3& phi : node.phi) add(hash, phi);
    for (const Vec3& psi : node.psi) add(hash, psi);
    for (const Vec3& g : node.g) add(hash, g);
  }
  return hash.digest();
}

}  // namespace

int main() {
  try {
    for (const int nodes : {3, 20, 120}) {
      for (const auto attachment : {flex::Attachment::clamped, flex::Attachment::free}) {
        flex::ReductionDef def = flex::testing::with_modes(6, attachment);
        def.stiffening = flex::GeometricStiffening::straight_beam;
        const flex::Reduction reduction = flex::reduce(flex::build_beam(flex::testing::jib_boom(nodes)), def);
        std::printf("%3d %s %016" PRIx64 "\n", nodes, attachment == flex::Attachment::free ? "free" : "clamped",
                    hash_of(reduction.body));
      }
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "flex_hashes: %s\n", error.what());
    return 1;
  }
}
