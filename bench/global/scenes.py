"""The scenes of `bench/run global`: one description of each, as our scene file and as JSON for the peers.

All are 256x256 pixels, y up, lengths in metres, linear colours. Rectangles have a centre and two half edges; lamps shine from their front, the
side of `u x v`. Light is scattered by at most `depth` surfaces.
"""

import json
import math
import random
import struct
from array import array

SIZE = 256


def camera(eye, look_at, fov):
    """A camera; `fov` in degrees, from top to bottom."""
    return {"eye": eye, "look_at": look_at, "fov": fov}


def rectangle(material, center, u, v):
    return {"kind": "rectangle", "material": material, "center": center, "u": u, "v": v}


def box(material, center, half, turn=0):
    """A box turned by `turn` degrees about its upright axis."""
    return {"kind": "box", "material": material, "center": center, "half": half, "turn": turn}


def sphere(material, center, radius):
    return {"kind": "sphere", "material": material, "center": center, "radius": radius}


def matte(*color):
    return {"kind": "matte", "color": color}


def metal(roughness, *color):
    """GGX with alpha = roughness squared; 0 is a mirror."""
    return {"kind": "metal", "roughness": roughness, "color": color}


def lamp(*radiance):
    """Shines and reflects nothing."""
    return {"kind": "lamp", "radiance": radiance}


def scene(view, materials, things, sky=(0, 0, 0), depth=7):
    return {"size": SIZE, "camera": view, "materials": materials, "things": things, "sky": sky, "depth": depth}


def cornell():
    """A box of 2 m with a lamp, two blocks and coloured walls."""
    materials = {
        "white": matte(0.73, 0.72, 0.68),
        "red": matte(0.57, 0.04, 0.04),
        "green": matte(0.10, 0.38, 0.08),
        "lamp": lamp(18, 14, 7),
    }
    things = [
        rectangle("white", [0, -1, 0], [0, 0, 1], [1, 0, 0]),
        rectangle("white", [0, 1, 0], [1, 0, 0], [0, 0, 1]),
        rectangle("white", [0, 0, -1], [1, 0, 0], [0, 1, 0]),
        rectangle("red", [-1, 0, 0], [0, 1, 0], [0, 0, 1]),
        rectangle("green", [1, 0, 0], [0, 0, 1], [0, 1, 0]),
        rectangle("lamp", [0, 0.9999, 0], [0.24, 0, 0], [0, 0, 0.2]),
        box("white", [0.34, -0.7, 0.35], [0.3, 0.3, 0.3], -17),
        box("white", [-0.33, -0.4, -0.3], [0.3, 0.6, 0.3], 17),
    ]
    return scene(camera([0, 0, 3.9], [0, 0, 0], 39), materials, things)


def glossy():
    """Metal balls of five roughnesses under a small and a large lamp, on a rough metal floor."""
    things = [rectangle("floor", [0, 0, 0], [0, 0, 6], [6, 0, 0])]
    materials = {"floor": metal(0.5, 0.5, 0.5, 0.5), "small": lamp(60, 55, 45), "large": lamp(3, 3.5, 4)}
    for i, roughness in enumerate([0.15, 0.25, 0.35, 0.5, 0.7]):
        materials[f"metal{i}"] = metal(roughness, 0.95 - 0.1 * i, 0.75, 0.4 + 0.1 * i)
        things.append(sphere(f"metal{i}", [1.1 * (i - 2), 0.5, 0], 0.5))
    things.append(rectangle("small", [-1.5, 3, 1], [0.2, 0, 0], [0, 0, 0.2]))
    things.append(rectangle("large", [1.5, 3, 0], [0.9, 0, 0], [0, 0, 0.9]))
    return scene(camera([0, 2, 7.5], [0, 0.5, 0], 40), materials, things, (0.1, 0.1, 0.1))


def many_lights():
    """A thousand small lamps of various strengths above a floor with blocks."""
    chance = random.Random(6)
    materials = {"floor": matte(0.6, 0.6, 0.6), "block": matte(0.7, 0.5, 0.3)}
    things = [rectangle("floor", [0, 0, 0], [0, 0, 12], [12, 0, 0])]
    for i in range(8):
        strength = 40 * 4 ** (i / 4)
        materials[f"lamp{i}"] = lamp(*(strength * chance.uniform(0.3, 1) for _ in range(3)))
    for _ in range(1000):
        center = [chance.uniform(-10, 10), chance.uniform(2.5, 4), chance.uniform(-10, 10)]
        things.append(rectangle(f"lamp{chance.randrange(8)}", center, [0.03, 0, 0], [0, 0, 0.03]))
    for _ in range(40):
        half = [chance.uniform(0.2, 0.6), chance.uniform(0.2, 0.9), chance.uniform(0.2, 0.6)]
        center = [chance.uniform(-6, 6), half[1], chance.uniform(-6, 6)]
        things.append(box("block", center, half, chance.uniform(0, 90)))
    return scene(camera([0, 2.3, 10], [0, 0.6, 0], 40), materials, things)


def whitted():
    """Glass and mirror above a chequered floor, the picture of 1980, under a lamp with an area and a sky that shines."""
    materials = {
        "glass": {"kind": "glass", "ior": 1.5},
        "mirror": metal(0, 0.8, 0.8, 0.8),
        "floor": {"kind": "checker", "even": (0.8, 0.12, 0.05), "odd": (0.9, 0.75, 0.06), "squares": 32},
        "lamp": lamp(60, 60, 60),
    }
    things = [
        rectangle("floor", [0, 0, -4], [16, 0, 0], [0, 0, -16]),
        sphere("glass", [4, 2.3, -4], 1),
        sphere("mirror", [2, 1.5, -2.5], 1),
        rectangle("lamp", [8, 14, -8], [1.5, 0, 0], [0, 0, 1.5]),
    ]
    return scene(camera([8, 2, -4], [4, 2.3, -4], 60), materials, things, (0.34, 0.55, 0.85))


def mesh():
    """A torus with bumps, 131,072 triangles with smooth normals, on a floor under a lamp and a sky."""
    materials = {"floor": matte(0.6, 0.6, 0.6), "mesh": matte(0.8, 0.55, 0.2), "lamp": lamp(25, 24, 22)}
    things = [
        rectangle("floor", [0, 0, 0], [0, 0, 8], [8, 0, 0]),
        {"kind": "mesh", "material": "mesh", "file": "bumps.ply"},
        rectangle("lamp", [2, 5, 2], [0.75, 0, 0], [0, 0, 0.75]),
    ]
    return scene(camera([0, 2.6, 4.2], [0, 0.55, 0], 38), materials, things, (0.3, 0.36, 0.48))


SCENES = {"Cornell box": cornell, "glossy": glossy, "1000 lights": many_lights, "Whitted": whitted, "mesh 131k": mesh}


def bump_torus(u, v):
    """A point of the torus; both angles in radians."""
    small = 0.42 * (1 + 0.08 * math.sin(17 * u + 3 * v) * math.sin(11 * v))
    ring = 1.1 + small * math.cos(v)
    return (ring * math.cos(u), 0.55 + small * math.sin(v), ring * math.sin(u))


def normal(u, v, step=1e-4):
    """The unit normal at a point of the torus, outwards, by central differences."""
    along = [b - a for a, b in zip(bump_torus(u - step, v), bump_torus(u + step, v))]
    across = [b - a for a, b in zip(bump_torus(u, v - step), bump_torus(u, v + step))]
    n = [across[(i + 1) % 3] * along[(i + 2) % 3] - across[(i + 2) % 3] * along[(i + 1) % 3] for i in range(3)]
    length = math.sqrt(sum(x * x for x in n))
    return [x / length for x in n]


def write_mesh(path, columns=512, rows=128):
    """Writes the torus as a binary PLY file: 2 * columns * rows triangles."""
    corners, faces = array("f"), bytearray()
    for i in range(columns):
        for j in range(rows):
            u, v = math.tau * i / columns, math.tau * j / rows
            corners.extend([*bump_torus(u, v), *normal(u, v)])
            right, up = (i + 1) % columns * rows, (j + 1) % rows
            a, b, c, d = i * rows + j, right + j, right + up, i * rows + up
            faces += struct.pack("<B3iB3i", 3, a, c, b, 3, a, d, c)
    names = [f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz")]
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {columns * rows}", *names]
    head += [f"element face {2 * columns * rows}", "property list uchar int vertex_indices", "end_header"]
    path.write_bytes(("\n".join(head) + "\n").encode() + corners.tobytes() + bytes(faces))


def toml_material(name, material):
    """Our materials; an index of refraction of 1 makes them matte."""
    lines = ["[[material]]", f'name = "{name}"']
    match material["kind"]:
        case "matte":
            lines += [f"base_color = {list(material['color'])}", "ior = 1.0"]
        case "metal":
            lines += [f"base_color = {list(material['color'])}", "metallic = 1.0", f"roughness = {material['roughness']}"]
        case "glass":
            lines += ["transmission = 1.0", "roughness = 0.0", f"ior = {material['ior']}"]
        case "lamp":
            lines += ["base_color = [0.0, 0.0, 0.0]", "ior = 1.0", f"emission = {list(material['radiance'])}"]
        case "checker":
            lines += [f'base_color_texture = {{ texture = "squares", scale = [{material["squares"]}.0, {material["squares"]}.0] }}']
            lines += ["ior = 1.0", "[[checker]]", 'name = "squares"']
            lines += [f"even = {list(material['even'])}", f"odd = {list(material['odd'])}"]
    return lines


def toml_thing(thing):
    kind, lines = thing["kind"], [f"[[{thing['kind']}]]", f'material = "{thing["material"]}"']
    if kind == "box":
        low, high = [-half for half in thing["half"]], thing["half"]
        turn = f"{{ rotate = [0, {thing['turn']}, 0], translate = {thing['center']} }}"
        return lines + [f"min = {low}", f"max = {high}", f"transform = {turn}"]
    keys = {"rectangle": ("center", "u", "v"), "sphere": ("center", "radius"), "mesh": ("file",)}[kind]
    return lines + [f"{key} = {json.dumps(thing[key])}" for key in keys]


def write_scene(name, folder):
    """Writes `scene.toml` and `scene.json`, and the mesh if there is one."""
    described = SCENES[name]()
    view, size = described["camera"], described["size"]
    lines = ["[render]", 'method = "path"', f"resolution = [{size}, {size}]", f"depth = {described['depth']}"]
    lines += ["[environment]", f"color = {list(described['sky'])}", "[[camera]]"]
    lines += [f"eye = {view['eye']}", f"look_at = {view['look_at']}", f"fov = {view['fov']}"]
    for material, fields in described["materials"].items():
        lines += toml_material(material, fields)
    for thing in described["things"]:
        lines += toml_thing(thing)
        if thing["kind"] == "mesh":
            write_mesh(folder / thing["file"])
    # A light without intensity keeps daylight from being added.
    lines += ["[[point_light]]", "position = [0, 100, 0]", "intensity = 0"]
    (folder / "scene.toml").write_text("\n".join(lines) + "\n")
    (folder / "scene.json").write_text(json.dumps(described))
