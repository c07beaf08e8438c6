"""Renders scene.json with Cycles: cycles_render.py FOLDER, then lines `SPP SEED OUT.exr` on stdin.

Answers each with a line `CPU seconds`, which begins with `seconds` because Blender writes to standard output, too. Spheres are meshes: Cycles has no
others. Sampling is Cycles' default (tabulated Sobol) without adaptivity, clamping or a light threshold.
"""

import json
import math
import resource
import sys
from pathlib import Path

import bpy
from mathutils import Matrix, Vector

folder = Path(sys.argv[1])
described = json.loads((folder / "scene.json").read_text())
bpy.ops.wm.read_factory_settings(use_empty=True)
blender = bpy.context.scene


def nodes(owner):
    """The emptied node tree of a material or world, with its links."""
    owner.use_nodes = True
    owner.node_tree.nodes.clear()
    return owner.node_tree.nodes, owner.node_tree.links


def front_only(tree, links, emission, strength):
    """Lamps shine from their front, as the peers' do."""
    geometry, front = tree.new("ShaderNodeNewGeometry"), tree.new("ShaderNodeMath")
    front.operation, front.inputs[0].default_value = "SUBTRACT", strength
    scaled = tree.new("ShaderNodeMath")
    scaled.operation, scaled.inputs[1].default_value = "MULTIPLY", strength
    links.new(geometry.outputs["Backfacing"], scaled.inputs[0])
    links.new(scaled.outputs[0], front.inputs[1])
    links.new(front.outputs[0], emission.inputs["Strength"])


def make_material(name, fields):
    material = bpy.data.materials.new(name)
    tree, links = nodes(material)
    output = tree.new("ShaderNodeOutputMaterial")
    match fields["kind"]:
        case "matte":
            shader = tree.new("ShaderNodeBsdfDiffuse")
        case "metal":
            shader = tree.new("ShaderNodeBsdfAnisotropic")
            shader.distribution = "GGX"
            shader.inputs["Roughness"].default_value = fields["roughness"]
        case "glass":
            shader = tree.new("ShaderNodeBsdfGlass")
            shader.inputs["IOR"].default_value, shader.inputs["Roughness"].default_value = fields["ior"], 0
        case "lamp":
            shader = tree.new("ShaderNodeEmission")
            front_only(tree, links, shader, 1.0)
            material.cycles.emission_sampling = "FRONT"
    color = fields.get("color", fields.get("radiance", (1, 1, 1)))
    shader.inputs["Color"].default_value = (*color, 1)
    links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def add(vertices, faces, materials, smooth=False, choices=None):
    mesh = bpy.data.meshes.new("mesh")
    mesh.from_pydata(vertices, [], faces)
    for material in materials:
        mesh.materials.append(material)
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(faces))
    if choices:
        mesh.polygons.foreach_set("material_index", choices)
    mesh.update()
    blender.collection.objects.link(bpy.data.objects.new("thing", mesh))


def add_grid(thing, materials, squares):
    """A rectangle of squares whose colours alternate; one square is a rectangle."""
    center, u, v = (Vector(thing[key]) for key in ("center", "u", "v"))
    steps = [2 * i / squares - 1 for i in range(squares + 1)]
    vertices = [center + x * u + y * v for y in steps for x in steps]
    corner = [j * (squares + 1) + i for j in range(squares) for i in range(squares)]
    faces = [(a, a + 1, a + squares + 2, a + squares + 1) for a in corner]
    choices = [(i + j) % len(materials) for j in range(squares) for i in range(squares)]
    add([tuple(p) for p in vertices], faces, materials, choices=choices)


def add_box(thing, material):
    turn = Matrix.Translation(thing["center"]) @ Matrix.Rotation(math.radians(thing["turn"]), 4, "Y")
    signs = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    corners = [turn @ Vector([s * h for s, h in zip(sign, thing["half"])]) for sign in signs]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    add([tuple(corner) for corner in corners], faces, [material])


def add_sphere(thing, material, columns=192, rows=96):
    def point(i, j):
        around, down = math.tau * i / columns, math.pi * j / rows
        out = (math.sin(down) * math.cos(around), math.cos(down), math.sin(down) * math.sin(around))
        return tuple(c + thing["radius"] * o for c, o in zip(thing["center"], out))

    vertices = [point(0, 0)] + [point(i, j) for j in range(1, rows) for i in range(columns)] + [point(0, rows)]
    at = lambda i, j: 1 + (j - 1) * columns + i % columns
    faces = [(0, at(i + 1, 1), at(i, 1)) for i in range(columns)]
    faces += [(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)) for j in range(1, rows - 1) for i in range(columns)]
    faces += [(at(i, rows - 1), at(i + 1, rows - 1), len(vertices) - 1) for i in range(columns)]
    add(vertices, faces, [material], smooth=True)


def add_thing(thing):
    fields = described["materials"][thing["material"]]
    if fields["kind"] == "checker":
        colors = [make_material(side, {"kind": "matte", "color": fields[side]}) for side in ("even", "odd")]
        return add_grid(thing, colors, fields["squares"])
    material = materials.setdefault(thing["material"], None) or make_material(thing["material"], fields)
    materials[thing["material"]] = material
    match thing["kind"]:
        case "rectangle":
            add_grid(thing, [material], 1)
        case "box":
            add_box(thing, material)
        case "sphere":
            add_sphere(thing, material)
        case "mesh":
            bpy.ops.wm.ply_import(filepath=str(folder / thing["file"]), forward_axis="Y", up_axis="Z")
            mesh = bpy.context.selected_objects[0].data
            mesh.materials.clear()
            mesh.materials.append(material)
            mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))


def add_camera():
    view, data = described["camera"], bpy.data.cameras.new("camera")
    data.sensor_fit, data.angle_y = "VERTICAL", math.radians(view["fov"])
    blender.camera = bpy.data.objects.new("camera", data)
    blender.collection.objects.link(blender.camera)
    eye = Vector(view["eye"])
    z = (eye - Vector(view["look_at"])).normalized()
    x = Vector((0, 1, 0)).cross(z).normalized()
    matrix = Matrix((x, z.cross(x), z)).transposed().to_4x4()
    matrix.translation = eye
    blender.camera.matrix_world = matrix


def add_sky():
    blender.world = bpy.data.worlds.new("sky")
    tree, links = nodes(blender.world)
    background, output = tree.new("ShaderNodeBackground"), tree.new("ShaderNodeOutputWorld")
    background.inputs[0].default_value = (*described["sky"], 1)
    links.new(background.outputs[0], output.inputs[0])


def set_up():
    blender.render.engine = "CYCLES"
    cycles, render = blender.cycles, blender.render
    cycles.device = "CPU"
    # Bounces come after the first surface.
    bounces = described["depth"] - 1
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = bounces
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_indirect = cycles.sample_clamp_direct = cycles.light_sampling_threshold = cycles.blur_glossy = 0
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1
    render.resolution_x = render.resolution_y = described["size"]
    render.use_file_extension, render.use_persistent_data = False, True
    blender.view_settings.view_transform = "Raw"
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"


def render(spp, seed, output):
    """CPU seconds of a render, the file included."""
    blender.cycles.samples, blender.cycles.seed = spp, seed
    blender.render.filepath = output
    before = resource.getrusage(resource.RUSAGE_SELF)
    bpy.ops.render.render(write_still=True)
    after = resource.getrusage(resource.RUSAGE_SELF)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


materials = {}
for thing in described["things"]:
    add_thing(thing)
add_camera()
add_sky()
set_up()
render(1, 0, str(folder / "first.exr"))
for line in sys.stdin:
    spp, seed, output = line.split()
    print(f"\nseconds {render(int(spp), int(seed), output)}", flush=True)
