#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the meshes of the truck crane:  make_meshes.py [FOLDER]   (this file's folder without one)

Every mesh is in the frame of its element in truck_crane.yaml, in metres, y up (the axes of a cylinder or piston are those
of its force: x from P2 to P1). ELEMENT.stl is for the eye, COLL_ELEMENT.stl a convex piece for contact. All are closed;
a mesh for the eye may be several closed pieces that overlap, so only those of one piece enclose a mass.

Coordinates are rounded to a micrometre, so that every C library gives the same bytes.
"""
import math
import pathlib
import struct
import sys

# ---- solids: lists of triangles of points, counter-clockwise seen from outside


def prism(outline, low, high, axis="z"):
    """A convex outline, counter-clockwise seen from the end of the axis, drawn out along that axis."""
    place = {"x": lambda a, b, c: (c, a, b), "y": lambda a, b, c: (b, c, a), "z": lambda a, b, c: (a, b, c)}[axis]
    bottom = [place(a, b, low) for a, b in outline]
    top = [place(a, b, high) for a, b in outline]
    triangles = []
    for i in range(len(outline)):
        k = (i + 1) % len(outline)
        triangles += [(bottom[i], bottom[k], top[k]), (bottom[i], top[k], top[i])]
    for i in range(1, len(outline) - 1):
        triangles += [(bottom[0], bottom[i + 1], bottom[i]), (top[0], top[i], top[i + 1])]
    return triangles


def box(low, high):
    return prism([(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])], low[2], high[2])


def circle(radius, sides, centre=(0, 0)):
    return [(centre[0] + radius * math.cos(2 * math.pi * i / sides), centre[1] + radius * math.sin(2 * math.pi * i / sides))
            for i in range(sides)]


def turned(profile, sides):
    """Points (x, radius) in the order of growing x, turned about the x axis; flat ends."""
    rings = [[(x, y, z) for y, z in circle(radius, sides)] for x, radius in profile]
    triangles = []
    for ring, after in zip(rings, rings[1:]):
        triangles += between(ring, after)
    first, last = rings[0], rings[-1]
    for i in range(1, sides - 1):
        triangles += [(first[0], first[i + 1], first[i]), (last[0], last[i], last[i + 1])]
    return triangles


def between(ring, after):
    """The skin between two rings of equally many points, counter-clockwise seen from behind the second one."""
    triangles = []
    for i in range(len(ring)):
        k = (i + 1) % len(ring)
        triangles += [(ring[i], ring[k], after[k]), (ring[i], after[k], after[i])]
    return triangles


def ball(centre, radius, levels):
    corners = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    triangles = [tuple(corners[i] for i in face) for face in faces]

    def half(a, b):
        middle = [(p + q) / 2 for p, q in zip(a, b)]
        size = math.sqrt(sum(c * c for c in middle))
        return tuple(c / size for c in middle)

    for _ in range(levels):
        finer = []
        for a, b, c in triangles:
            ab, bc, ca = half(a, b), half(b, c), half(c, a)
            finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = finer
    return [tuple(tuple(m + radius * c for m, c in zip(centre, p)) for p in t) for t in triangles]


def pin(x, y, radius, half_width, sides=16):
    return prism(circle(radius, sides, (x, y)), -half_width, half_width)


def plates(outline, inner, outer):
    """The same plate on either side of the plane z = 0."""
    return prism(outline, inner, outer) + prism(outline, -outer, -inner)


# ---- the crane

BEAM = {"length": 6.5, "side": 0.3, "wall": 0.002139, "y": 0.02904, "z": 0.1507}  # thesis 3.2; section chosen


def jib_boom():
    """The hollow beam itself: its solid times the density of the steel is its mass."""
    def ring(x, half):
        y, z = BEAM["y"], BEAM["z"]
        return [(x, y - half, z - half), (x, y + half, z - half), (x, y + half, z + half), (x, y - half, z + half)]

    outside, inside = BEAM["side"] / 2, BEAM["side"] / 2 - BEAM["wall"]
    tip, root = -BEAM["length"], 0.0
    return (between(ring(tip, outside), ring(root, outside)) + between(ring(root, outside), ring(root, inside)) +
            between(ring(root, inside), ring(tip, inside)) + between(ring(tip, inside), ring(tip, outside)))


def jib_boom_hull():
    half, y, z = BEAM["side"] / 2, BEAM["y"], BEAM["z"]
    return box((-BEAM["length"], y - half, z - half), (0, y + half, z + half))


def pillar():
    """Slewing ring, two side plates up to the boom's hinge, the lift cylinder's pin between them."""
    side = [(-0.36, 0.04), (0.40, 0.04), (0.44, 0.90), (0.62, 1.95), (0.58, 2.08), (0.42, 2.08), (0.16, 1.60), (-0.36, 0.40)]
    return (prism(circle(0.42, 32), -0.08, 0.06, "y") + plates(side, 0.17, 0.21) +
            box((0.15, 0.05, -0.18), (0.38, 0.90, 0.18)) + pin(0.50, 2.00, 0.06, 0.24) +
            pin(-0.221712, 0.22223, 0.05, 0.22))


def lift_boom():
    """Hinge plates with the lift cylinder's pin, then a box to the jib's hinge, a lug for the jib cylinder below."""
    root = [(-0.60, -0.13), (0.06, -0.07), (0.09, 0.0), (0.06, 0.07), (-0.16, 0.22), (-0.28, 0.22), (-0.60, 0.13)]
    beam = [(-2.68, -0.08), (-2.50, -0.11), (-0.52, -0.13), (-0.52, 0.13), (-2.50, 0.11), (-2.68, 0.08)]
    lug = [(-0.70, -0.31), (-0.64, -0.28), (-0.56, -0.10), (-0.84, -0.10), (-0.76, -0.28)]
    return (plates(root, 0.13, 0.16) + prism(beam, -0.12, 0.12) + plates(lug, 0.06, 0.09) +
            pin(-0.221712, 0.165, 0.045, 0.165) + pin(-0.70, -0.25, 0.035, 0.1) + pin(-2.60, 0.0, 0.05, 0.20))


def jib_attachment():
    """Plates on either side of the lift boom's end, down to the jib cylinder's pin."""
    plate = [(-0.10, -0.36), (0.0, -0.42), (0.10, -0.36), (0.30, -0.15), (0.30, 0.20), (-0.30, 0.20), (-0.30, -0.15)]
    return plates(plate, 0.14, 0.17) + pin(0.0, -0.35, 0.035, 0.18)


def hook():
    """A head at the jib's end, and a bent bar that ends in the bag's point."""
    sides, steps, radius, bend = 8, 14, 0.03, 0.09
    centre = (0.0, -0.21)
    rings = []
    for i in range(steps + 1):
        angle = math.pi * (0.5 - 1.55 * i / steps)  # from the top, clockwise, to the open side
        out = (math.cos(angle), math.sin(angle))
        thin = radius * (1 - 0.5 * i / steps)
        # seen along the way of the bar the ring must turn counter-clockwise
        rings.append([(centre[0] + (bend + thin * a) * out[0], centre[1] + (bend + thin * a) * out[1], thin * b)
                      for a, b in circle(1, sides)])
    bar = []
    for ring, after in zip(rings, rings[1:]):
        bar += between(ring, after)
    first, last = rings[0], rings[-1]
    for i in range(1, sides - 1):
        bar += [(first[0], first[i + 1], first[i]), (last[0], last[i], last[i + 1])]
    return bar + prism(circle(0.07, 12), -0.13, 0.03, "y") + pin(0.0, 0.0, 0.035, 0.1, 12)


def bag():
    """A sack with rounded corners that bulges, in the box 0.8 x 1.0 x 0.8 m about its centre, and four straps."""
    sides = 16
    rings = []
    for height, width in ((-1.10, 0.62), (-1.06, 0.74), (-0.85, 0.80), (-0.35, 0.80), (-0.14, 0.74), (-0.10, 0.60)):
        ring = []
        for i in range(sides):
            angle = 2 * math.pi * (i + 0.5) / sides
            c, s = math.cos(angle), math.sin(angle)
            size = width / 2 / (abs(c) ** 4 + abs(s) ** 4) ** 0.25  # a square with round corners
            # counter-clockwise seen from above is from z to x
            ring.append((size * s, height, size * c))
        rings.append(ring)
    sack = []
    for ring, after in zip(rings, rings[1:]):
        sack += between(ring, after)
    for i in range(1, sides - 1):
        sack += [(rings[0][0], rings[0][i + 1], rings[0][i]), (rings[-1][0], rings[-1][i], rings[-1][i + 1])]
    for x in (-1, 1):
        for z in (-1, 1):
            foot = [(0.24 * x + 0.02 * a, -0.12, 0.24 * z + 0.02 * b) for b, a in circle(1, 4)]
            head = [(0.012 * x + 0.01 * a, 0.0, 0.012 * z + 0.01 * b) for b, a in circle(1, 4)]
            sack += between(foot, head)
            sack += [(foot[0], foot[2], foot[1]), (foot[0], foot[3], foot[2]), (head[0], head[1], head[2]),
                     (head[0], head[2], head[3])]
    return sack


CAB = [(3.90, 0.75), (5.60, 0.75), (5.65, 1.60), (5.35, 2.75), (3.90, 2.75)]


def both_sides(low, high):
    """A box and its mirror image in the plane z = 0."""
    return box(low, high) + box((low[0], low[1], -high[2]), (high[0], high[1], -low[2]))


def truck_frame():
    """Frame, tanks, bumper, steps, outriggers on their feet, the cylinder that slews the crane."""
    foot = (2.84, 0.0, 1.36)
    return (box((-4.30, 0.55, -0.42), (5.40, 0.80, 0.42)) + box((2.75, 0.50, -0.70), (3.70, 0.79, 0.70)) +
            box((5.40, 0.50, -1.15), (5.68, 0.76, 1.15)) + both_sides((3.95, 0.42, 0.75), (4.15, 0.52, 1.22)) +
            box((2.90, 0.60, -1.42), (3.10, 0.74, 1.42)) +
            both_sides((2.92, 0.05, 1.42), (3.08, 0.78, 1.56)) + both_sides(foot, (3.16, 0.05, 1.62)) +
            both_sides((0.20, 0.42, 0.50), (1.60, 0.78, 1.05)) + prism(circle(0.11, 16, (2.98, 0.93)), -0.70, 0.70))


def truck_body():
    """Bed with its boards, the headboard behind the crane."""
    return (box((-4.35, 0.78, -1.25), (2.60, 1.10, 1.25)) + both_sides((-4.34, 1.08, 1.20), (2.59, 1.48, 1.24)) +
            box((-4.33, 1.09, -1.21), (-4.30, 1.47, 1.21)) + box((2.52, 1.07, -1.21), (2.58, 1.90, 1.21)) +
            both_sides((-1.00, 1.02, 1.235), (-0.92, 1.50, 1.275)) + both_sides((0.80, 1.02, 1.235), (0.88, 1.50, 1.275)))


def truck_cab():
    """Cab with a slanted front, mirrors, a raised roof; it covers the tops of the front wheels."""
    return (prism(CAB, -1.23, 1.23) + prism([(3.95, 2.74), (5.30, 2.74), (5.10, 2.86), (4.05, 2.95)], -1.05, 1.05) +
            both_sides((5.36, 1.80, 1.27), (5.46, 2.30, 1.45)) + both_sides((5.38, 2.02, 1.18), (5.42, 2.06, 1.28)))


def truck_glass():
    """Windscreen and side windows, 2 cm in front of the cab."""
    screen = [(5.62, 1.68), (5.655, 1.69), (5.40, 2.66), (5.365, 2.65)]
    side = [(4.35, 1.75), (5.45, 1.75), (5.27, 2.55), (4.35, 2.55)]
    return prism(screen, -1.08, 1.08) + plates(side, 1.20, 1.25)


def truck_lights():
    return (both_sides((5.55, 0.86, 0.72), (5.66, 1.02, 1.08)) + both_sides((5.62, 0.58, 0.80), (5.70, 0.68, 1.05)) +
            both_sides((5.20, 2.84, 0.55), (5.28, 2.90, 0.75)) + box((4.30, 2.90, -0.12), (4.54, 3.04, 0.12)))


def truck_wheels():
    wheels = []
    for x in (4.70, -1.90, -3.10):
        for z in (0.90, -1.20):
            wheels += prism(circle(0.50, 24, (x, 0.50)), z, z + 0.30)
    return wheels


def truck_rims():
    rims = []
    for x in (4.70, -1.90, -3.10):
        for z in (1.19, -1.215):
            rims += prism(circle(0.27, 12, (x, 0.50)), z, z + 0.025)
    return rims


def cylinder(bore, chamber, attachment):
    """The barrel: P1 at the origin, the chamber's bottom at the attachment's length, all towards -x."""
    outside = bore / 2 + 0.015
    end = -(attachment + chamber)
    barrel = [(end - 0.05, outside + 0.01), (end, outside + 0.01), (end + 0.002, outside), (-attachment, outside),
              (-attachment + 0.03, 0.5 * outside)]
    return turned(barrel, 24) + prism(circle(0.06, 16, (0, 0)), -0.05, 0.05) + box((-attachment, -0.03, -0.03), (-0.02, 0.03, 0.03))


def piston(bore, rod, rod_length, piston_length):
    """Rod and piston: P2 at the origin, the piston's face at the rod's length, towards +x."""
    shape = [(0.02, rod / 2), (rod_length - piston_length, rod / 2), (rod_length - piston_length + 0.001, bore / 2 - 0.001),
             (rod_length, bore / 2 - 0.001)]
    return turned(shape, 24) + prism(circle(0.055, 16, (0, 0)), -0.045, 0.045)


MESHES = {
    "Truck_Frame.stl": truck_frame,
    "Truck_Body.stl": truck_body,
    "Truck_Cab.stl": truck_cab,
    "Truck_Glass.stl": truck_glass,
    "Truck_Lights.stl": truck_lights,
    "Truck_Rims.stl": truck_rims,
    "Truck_Wheels.stl": truck_wheels,
    "Truck_Pillar.stl": pillar,
    "Truck_LiftBoom.stl": lift_boom,
    "Truck_JibBoomAttachment.stl": jib_attachment,
    "Truck_JibBoom.stl": jib_boom,
    "Truck_Hook.stl": hook,
    "Bag.obj": bag,
    "Dummy_PillarCylinder.stl": lambda: cylinder(0.200, 1.120, 0.100),
    "Dummy_PillarPiston.stl": lambda: piston(0.200, 0.105, 1.137, 0.050),
    "Dummy_LiftBoomCylinder.stl": lambda: cylinder(0.160, 1.020, 0.100),
    "Dummy_LiftBoomPiston.stl": lambda: piston(0.160, 0.090, 0.900, 0.050),
    "COLL_Truck_Ground.stl": lambda: box((-40, -1, -40), (40, 0, 40)),
    "COLL_Truck_Body.stl": lambda: box((-4.35, 0.20, -1.25), (3.15, 1.10, 1.25)),
    "COLL_Truck_Body_Cab.stl": lambda: prism(CAB, -1.2, 1.2),
    "COLL_Truck_Pillar.stl": lambda: box((-0.36, 0.0, -0.21), (0.44, 1.60, 0.21)),
    "COLL_Truck_LiftBoom.stl": lambda: box((-2.68, -0.13, -0.16), (0.09, 0.13, 0.16)),
    "COLL_Truck_JibBoom.stl": jib_boom_hull,
    "COLL_Truck_Hook.stl": lambda: ball((0.0, -0.15, 0.0), 0.15, 2),
    "COLL_Bag.stl": lambda: box((-0.4, -1.1, -0.4), (0.4, -0.1, 0.4)),
}

# ---- files


def rounded(triangles):
    # + 0.0 takes the sign from a zero
    return [tuple(tuple(round(c, 6) + 0.0 for c in p) for p in t) for t in triangles]


def normal(a, b, c):
    u, v = [q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]
    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    size = math.sqrt(sum(x * x for x in n))
    return [round(x / size, 6) + 0.0 for x in n]


def stl(name, triangles):
    data = f"{name}: metres, y up".encode().ljust(80) + struct.pack("<I", len(triangles))
    for a, b, c in triangles:
        data += struct.pack("<12fH", *normal(a, b, c), *a, *b, *c, 0)
    return data


def obj(name, triangles):
    points = {}
    for triangle in triangles:
        for point in triangle:
            points.setdefault(point, len(points) + 1)
    lines = [f"# {name}: metres, y up"]
    lines += ["v {:.6f} {:.6f} {:.6f}".format(*point) for point in points]
    lines += ["f {} {} {}".format(*(points[p] for p in triangle)) for triangle in triangles]
    return ("\n".join(lines) + "\n").encode()


def main():
    if len(sys.argv) > 2 or (len(sys.argv) == 2 and sys.argv[1].startswith("-")):
        print(__doc__.split("\n\n")[0])
        return 0 if sys.argv[1] in ("-h", "--help") else 2
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) == 2 else __file__)
    folder = folder if len(sys.argv) == 2 else folder.resolve().parent
    folder.mkdir(parents=True, exist_ok=True)
    for name, make in MESHES.items():
        triangles = rounded(make())
        write = obj if name.endswith(".obj") else stl
        (folder / name).write_bytes(write(name, triangles))
    return 0


if __name__ == "__main__":
    sys.exit(main())
