"""The scene of whitted.pov for Mitsuba 3: whitted_mitsuba.py VARIANT HOLLOW OUT.png

A path tracer has no point light through glass and takes the sky as a light: same geometry, different physics.
"""

import sys

import mitsuba

variant, hollow, output = sys.argv[1], sys.argv[2] == "1", sys.argv[3]
mitsuba.set_variant(variant)
Transform = mitsuba.ScalarTransform4f


def rgb(*color):
    return {"type": "rgb", "value": list(color)}


def glass(radius, outside, inside):
    bsdf = {"type": "dielectric", "ext_ior": outside, "int_ior": inside}
    return {"type": "sphere", "center": [4, 2.3, -4], "radius": radius, "bsdf": bsdf}


floor = {
    "type": "checkerboard",
    "color0": rgb(0.80, 0.12, 0.05),
    "color1": rgb(0.90, 0.75, 0.06),
    "to_uv": Transform().scale([16, 16, 1]),
}
scene = {
    "type": "scene",
    "integrator": {"type": "path", "max_depth": 10, "rr_depth": 50},
    "sensor": {
        "type": "perspective",
        "fov_axis": "y",
        "fov": 60,
        "to_world": Transform().look_at(origin=[8, 2, -4], target=[4, 2.3, -4], up=[0, 1, 0]),
        "film": {"type": "hdrfilm", "width": 640, "height": 480, "pixel_format": "rgb", "rfilter": {"type": "box"}},
        "sampler": {"type": "independent", "sample_count": 1},
    },
    "light": {"type": "point", "position": [14, 16, -14], "intensity": rgb(1200, 1200, 1200)},
    "sky": {"type": "constant", "radiance": rgb(0.34, 0.55, 0.85)},
    "floor": {
        "type": "rectangle",
        "to_world": Transform().translate([0, 0, -4]).rotate([1, 0, 0], -90).scale([16, 16, 1]),
        "bsdf": {"type": "diffuse", "reflectance": floor},
    },
    "glass": glass(1.0, 1.0, 1.5),
    "mirror": {
        "type": "sphere",
        "center": [2, 1.5, -2.5],
        "radius": 1,
        "bsdf": {"type": "conductor", "specular_reflectance": rgb(0.8, 0.8, 0.8)},
    },
}
if hollow:
    scene["hollow"] = glass(0.96, 1.5, 1.0)
mitsuba.util.write_bitmap(output, mitsuba.render(mitsuba.load_dict(scene), spp=1), write_async=False)
