"""Renders scene.json with Mitsuba 3: mitsuba_render.py FOLDER SAMPLER, then lines `SPP SEED OUT.npy` on stdin.

Answers each with a line: the CPU seconds of that render. What is compiled is compiled by a render that does not count.
"""

import json
import resource
import sys
from pathlib import Path

import mitsuba
import numpy

folder, sampler = Path(sys.argv[1]), sys.argv[2]
mitsuba.set_variant("llvm_ad_rgb")
Transform = mitsuba.ScalarTransform4f
described = json.loads((folder / "scene.json").read_text())


def rgb(color):
    return {"type": "rgb", "value": list(color)}


def bsdf(material):
    """A lamp reflects nothing."""
    match material["kind"]:
        case "matte":
            return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": rgb(material["color"])}}
        case "metal" if material["roughness"] == 0:
            return {"type": "conductor", "specular_reflectance": rgb(material["color"])}
        case "metal":
            rough = {"type": "roughconductor", "distribution": "ggx", "alpha": material["roughness"] ** 2}
            return {"type": "twosided", "bsdf": rough | {"specular_reflectance": rgb(material["color"])}}
        case "glass":
            return {"type": "dielectric", "int_ior": material["ior"], "ext_ior": 1.0}
        case "checker":
            # One repetition of the texture is two squares wide.
            size = Transform().scale([material["squares"] / 2, material["squares"] / 2, 1])
            colors = {"color0": rgb(material["even"]), "color1": rgb(material["odd"]), "to_uv": size}
            return {"type": "diffuse", "reflectance": {"type": "checkerboard"} | colors}
        case "lamp":
            return {"type": "diffuse", "reflectance": rgb((0, 0, 0))}


def place(thing):
    """Mitsuba's rectangle and cube reach from -1 to 1."""
    if thing["kind"] == "box":
        turned = Transform().translate(thing["center"]).rotate([0, 1, 0], thing["turn"])
        return turned.scale(thing["half"])
    u, v = numpy.array(thing["u"]), numpy.array(thing["v"])
    w = numpy.cross(u, v)
    columns = [u, v, w / numpy.linalg.norm(w), thing["center"]]
    matrix = numpy.eye(4)
    matrix[:3, :4] = numpy.stack(columns, 1)
    return Transform(matrix)


def shape(thing):
    material = described["materials"][thing["material"]]
    fields = {"bsdf": bsdf(material)}
    if material["kind"] == "lamp":
        fields["emitter"] = {"type": "area", "radiance": rgb(material["radiance"])}
    match thing["kind"]:
        case "sphere":
            return fields | {"type": "sphere", "center": thing["center"], "radius": thing["radius"]}
        case "mesh":
            return fields | {"type": "ply", "filename": str(folder / thing["file"])}
        case "box":
            return fields | {"type": "cube", "to_world": place(thing)}
        case "rectangle":
            return fields | {"type": "rectangle", "to_world": place(thing)}


view, size = described["camera"], described["size"]
film = {"type": "hdrfilm", "width": size, "height": size, "pixel_format": "rgb", "component_format": "float32"}
to_world = Transform().look_at(origin=view["eye"], target=view["look_at"], up=[0, 1, 0])
scene = {
    "type": "scene",
    # Depth counts what scatters and the way to the light.
    "integrator": {"type": "path", "max_depth": described["depth"] + 1},
    "sensor": {
        "type": "perspective",
        "fov_axis": "y",
        "fov": view["fov"],
        "to_world": to_world,
        "film": film | {"rfilter": {"type": "box"}},
        "sampler": {"type": sampler},
    },
}
if any(described["sky"]):
    scene["sky"] = {"type": "constant", "radiance": rgb(described["sky"])}
for number, thing in enumerate(described["things"]):
    scene[f"thing{number}"] = shape(thing)
loaded = mitsuba.load_dict(scene)


def render(spp, seed):
    """The picture and its CPU seconds."""
    before = resource.getrusage(resource.RUSAGE_SELF)
    picture = numpy.array(mitsuba.render(loaded, spp=spp, seed=seed))
    after = resource.getrusage(resource.RUSAGE_SELF)
    return picture, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


render(4, 0)
for line in sys.stdin:
    spp, seed, output = line.split()
    picture, seconds = render(int(spp), int(seed))
    numpy.save(output, picture.astype(numpy.float32))
    print(seconds, flush=True)
