"""Makes the scene of `bench/run shadow`: scene.py FOLDER TRIANGLES. Prints the path of the scene file.

25 smooth tori over a ground of 10x10 squares, one mesh, all outward sides counter-clockwise; a sun, a uniform sky. Three
files: NAME.toml for Umbriel, NAME.ply for everybody, NAME.json for the peers, which adds what a scene file has no words
for: the view of the light, the bias.

The view of the light is Umbriel's own, which fits it to what the camera sees; `bench/shadow.py` writes it into the JSON file, by the number of taps:

    (x, y, z) = matrix (p, 1)

x and y in [-1, 1] are the map, y up; z is 0 on the side of the light and 1 on the other. A texel is `texel` metres wide.
"""

import json
import math
import sys
from pathlib import Path

import numpy

# Segments around the ring and around the tube: 25 * 2 * u * v triangles, and 200 of the ground.
SEGMENTS = {10_000: (20, 10), 100_000: (64, 31), 1_000_000: (200, 100)}
RING, TUBE, SPACING = 1.0, 0.42, 3.6
GROUND, SQUARES = 12.0, 10
CAMERA = {"eye": [0.0, 9.0, 15.0], "look_at": [0.0, 0.5, 0.0], "up": [0.0, 1.0, 0.0], "fov": 50.0}
# Only rasterisers have these planes, and here nothing reaches them.
PLANES = {"near": 0.5, "far": 60.0}
LIGHT = {"direction": [-8.0, -14.0, -6.0], "illuminance": [2.6, 2.5, 2.3]}
MATERIAL = {"base_color": [0.75, 0.6, 0.45], "roughness": 0.5, "ior": 1.5}
SKY = [0.14, 0.18, 0.25]
# In texels, by the number of taps, as BIAS in umbriel/src/main.rs.
BIAS = {"slope": {"1": 1.0, "9": 2.5}, "constant": 0.0, "greatest_tan": 10.0}


def grid(u, v):
    """Corners (i, j) of u x v squares, each cut into two triangles."""
    i, j = (axis.ravel() for axis in numpy.meshgrid(numpy.arange(u), numpy.arange(v), indexing="ij"))
    return (i, j), (i + 1, j), (i + 1, j + 1), (i, j), (i + 1, j + 1), (i, j + 1)


def torus(u, v):
    """Positions, normals and triangles around the z axis."""
    a, b = numpy.meshgrid(numpy.arange(u) * (math.tau / u), numpy.arange(v) * (math.tau / v), indexing="ij")
    normals = numpy.stack([numpy.cos(a) * numpy.cos(b), numpy.sin(a) * numpy.cos(b), numpy.sin(b)], -1).reshape(-1, 3)
    axis = numpy.stack([numpy.cos(a), numpy.sin(a), 0 * a], -1).reshape(-1, 3)
    triangles = numpy.stack([(i % u) * v + j % v for i, j in grid(u, v)], -1).reshape(-1, 3)
    return RING * axis + TUBE * normals, normals, triangles


def ground():
    """Positions, normals and triangles of the plane y = 0, seen from above."""
    line = numpy.linspace(-GROUND, GROUND, SQUARES + 1)
    z, x = numpy.meshgrid(line, line, indexing="ij")
    positions = numpy.stack([x, 0 * x, z], -1).reshape(-1, 3)
    triangles = numpy.stack([i * (SQUARES + 1) + j for i, j in grid(SQUARES, SQUARES)], -1).reshape(-1, 3)
    return positions, numpy.tile([0.0, 1.0, 0.0], (len(positions), 1)), triangles


def mesh(size):
    """All in one: vertices (position, normal) in f32 and triangles."""
    p, n, t = torus(*SEGMENTS[size])
    parts = []
    for k in range(25):
        c, s = math.cos(0.7 * k), math.sin(0.7 * k)
        turn = numpy.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
        place = [(k % 5 - 2) * SPACING, 1.45 + 0.5 * (k % 3), (k // 5 - 2) * SPACING]
        parts.append((p @ turn.T + place, n @ turn.T, t))
    parts.append(ground())
    starts = numpy.cumsum([0] + [len(part[0]) for part in parts])
    vertices = numpy.concatenate([numpy.hstack(part[:2]) for part in parts]).astype("<f4")
    return vertices, numpy.concatenate([part[2] + start for part, start in zip(parts, starts)]).astype("<u4")


def write_ply(path, vertices, triangles):
    """Binary, with normals."""
    properties = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n{properties}"
    header += f"element face {len(triangles)}\nproperty list uchar uint vertex_indices\nend_header\n"
    faces = numpy.empty(len(triangles), [("count", "u1"), ("corners", "<u4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    path.write_bytes(header.encode() + vertices.tobytes() + faces.tobytes())


def write_toml(path):
    """The scene file; the picture's size comes by the command line."""
    table = lambda values: "\n".join(f"{key} = {json.dumps(value)}" for key, value in values.items())
    path.write_text(f"""# Made by bench/shadow/scene.py.

[render]
method = "ray-cast"
tonemap = "linear"
spp = 1

[environment]
color = {SKY}

[[camera]]
{table(CAMERA)}

[[directional_light]]
{table(LIGHT)}

[[material]]
name = "clay"
{table(MATERIAL)}

[[mesh]]
file = "{path.stem}.ply"
material = "clay"
""")


def main():
    folder, size = Path(sys.argv[1]), int(sys.argv[2])
    vertices, triangles = mesh(size)
    path = folder / f"tori_{size}.toml"
    write_ply(path.with_suffix(".ply"), vertices, triangles)
    write_toml(path)
    words = {"triangles": len(triangles), "camera": CAMERA | PLANES, "light": LIGHT, "bias": BIAS}
    words |= {"material": MATERIAL, "sky": SKY}
    path.with_suffix(".json").write_text(json.dumps(words, indent=1) + "\n")
    print(path)


if __name__ == "__main__":
    main()
