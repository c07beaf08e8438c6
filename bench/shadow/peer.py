"""What the rasterisers have in common: the scene, the requests, the clock.

A peer answers requests, one JSON object a line, until its input ends:

    {"width", "height", "taps": 1 or 9, "cull": back faces in both passes, "frames", "picture": PNG to write or null}

with {"map", "eye", "frame", "cpu"}: milliseconds of each frame for the pass from the light, the pass from the eye, both
without waiting in between, and of the processors during the last, all threads together. One frame more is drawn
before, for the compiler of the shaders.
"""

import json
import sys
from pathlib import Path
from time import perf_counter, process_time

import numpy
from PIL import Image

SHADERS = Path(__file__).parent


class Scene:
    """The files of scene.py."""

    def __init__(self, path):
        path = Path(path)
        self.words = json.loads(path.with_suffix(".json").read_text())
        data = path.with_suffix(".ply").read_bytes()
        end = data.index(b"end_header\n") + len(b"end_header\n")
        counts = {line.split()[1]: int(line.split()[2]) for line in data[:end].splitlines() if line.startswith(b"element")}
        self.vertices = numpy.frombuffer(data, "<f4", 6 * counts[b"vertex"], end)
        face = numpy.dtype([("count", "u1"), ("corners", "<u4", 3)])
        faces = numpy.frombuffer(data, face, counts[b"face"], end + self.vertices.nbytes)
        self.indices = numpy.ascontiguousarray(faces["corners"])

    def table(self, name, text):
        """A row of the shading's tables as a constant of a shader: `text` with its length and numbers."""
        row = self.words["albedo"][name]
        return text.format(name=name.upper(), length=len(row), numbers=", ".join(map(repr, row)))

    @property
    def map_size(self):
        return self.words["maps"]["1"]["size"]

    def light_matrix(self, taps):
        """World to map; depth in [0, 1]. The view has room for the taps."""
        return numpy.array(self.words["maps"][str(taps)]["matrix"])

    def eye_matrix(self, aspect):
        """World to clip space of the camera; depth in [0, 1]."""
        camera = self.words["camera"]
        eye = numpy.array(camera["eye"])
        back = eye - camera["look_at"]
        back /= numpy.linalg.norm(back)
        right = numpy.cross(camera["up"], back)
        right /= numpy.linalg.norm(right)
        pose = numpy.eye(4)
        pose[:3, :3] = right, numpy.cross(back, right), back
        pose[:3, 3] = -pose[:3, :3] @ eye
        near, far, scale = camera["near"], camera["far"], 1 / numpy.tan(numpy.radians(camera["fov"]) / 2)
        projection = numpy.zeros((4, 4))
        projection[0, 0], projection[1, 1], projection[3, 2] = scale / aspect, scale, -1
        projection[2, 2:] = far / (near - far), far * near / (near - far)
        return projection @ pose

    def constants(self, taps):
        """What the shading asks for beside matrices, in the order of the shaders' uniform block, four floats each."""
        light, material, shadow_map = self.words["light"], self.words["material"], self.words["maps"][str(taps)]
        towards = -numpy.array(light["direction"])
        bias, texel = self.words["bias"], shadow_map["texel"] / shadow_map["depth"]
        f0 = ((material["ior"] - 1) / (material["ior"] + 1)) ** 2
        return {
            "eye": [*self.words["camera"]["eye"], 0],
            "wi": [*(towards / numpy.linalg.norm(towards)), 0],
            "illuminance": [*light["illuminance"], 0],
            "base_color": [*material["base_color"], 0],
            "sky": [*self.words["sky"], 0],
            # Roughness, reflectances at normal and at grazing incidence.
            "material": [material["roughness"], f0, min(50 * f0, 1), 0],
            # In units of the map's depth: for a tangent of 1, constant; the least cosine; texel in units of the map.
            "bias": [
                bias["slope"][str(taps)] * texel,
                bias["constant"] * texel,
                (1 + bias["greatest_tan"] ** 2) ** -0.5,
                1 / shadow_map["size"],
            ],
        }


def milliseconds(work):
    """Wall and CPU time of a function that ends when its work is done."""
    start = perf_counter(), process_time()
    work()
    return 1000 * (perf_counter() - start[0]), 1000 * (process_time() - start[1])


def measure(passes, frames):
    """Times a map pass, an eye pass and a function that waits for them."""
    draw_map, draw_eye, finish = passes
    works = {
        "map": lambda: (draw_map(), finish()),
        "eye": lambda: (draw_eye(), finish()),
        "frame": lambda: (draw_map(), draw_eye(), finish()),
    }
    works["frame"]()
    times = {name: [] for name in (*works, "cpu")}
    for _ in range(frames):
        for name, work in works.items():
            wall, cpu = milliseconds(work)
            times[name].append(wall)
        times["cpu"].append(cpu)
    return times


def serve(peer):
    """Answers requests; `peer.passes` gives the three functions, `peer.picture` the last picture's rows as RGBA."""
    scene = Scene(sys.argv[1])
    renderer = peer(scene)
    print(json.dumps({"name": renderer.name}), flush=True)
    for line in sys.stdin:
        request = json.loads(line)
        size = (request["width"], request["height"])
        times = measure(renderer.passes(size, request["taps"], request["cull"]), request["frames"])
        if request["picture"]:
            Image.frombytes("RGBA", size, renderer.picture(size)).convert("RGB").save(request["picture"])
        print(json.dumps(times), flush=True)
