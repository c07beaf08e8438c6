"""Mesa's lavapipe through wgpu and Vulkan, without a window: lavapipe.py SCENE. See peer.py for what it answers."""

import numpy
import wgpu
from peer import SHADERS, serve

FLOATS = [{"format": "float32x3", "offset": 12 * k, "shader_location": k} for k in range(2)]
DEPTH = {"format": "depth32float", "depth_write_enabled": True, "depth_compare": "less"}
VERTEX, FRAGMENT = wgpu.ShaderStage.VERTEX, wgpu.ShaderStage.FRAGMENT
UNIFORM = {"binding": 0, "visibility": VERTEX | FRAGMENT, "buffer": {"type": "uniform"}}
TEXTURE = {"binding": 1, "visibility": FRAGMENT, "texture": {"sample_type": "depth"}}
SAMPLER = {"binding": 2, "visibility": FRAGMENT, "sampler": {"type": "comparison"}}


class Lavapipe:
    """A depth map and, by size, pictures."""

    def __init__(self, scene):
        adapter = wgpu.gpu.request_adapter_sync(force_fallback_adapter=True)
        self.scene, self.device, self.targets = scene, adapter.request_device_sync(), {}
        self.name = f"{adapter.info['device']}, {adapter.info['description']}"
        use, device = wgpu.BufferUsage, self.device
        self.vertices = device.create_buffer_with_data(data=scene.vertices.tobytes(), usage=use.VERTEX)
        self.indices = device.create_buffer_with_data(data=scene.indices.tobytes(), usage=use.INDEX)
        self.constants = device.create_buffer(size=16 * 15, usage=use.UNIFORM | use.COPY_DST)
        self.fence = device.create_buffer(size=16, usage=use.COPY_SRC | use.COPY_DST)
        side = scene.map_size
        self.map = self.texture((side, side), "depth32float", wgpu.TextureUsage.TEXTURE_BINDING).create_view()
        nearest = device.create_sampler(compare="less-equal")
        uniform = {"binding": 0, "resource": {"buffer": self.constants}}
        self.map_layout, self.map_group = self.group([UNIFORM], [uniform])
        bound = [uniform, {"binding": 1, "resource": self.map}, {"binding": 2, "resource": nearest}]
        self.eye_layout, self.eye_group = self.group([UNIFORM, TEXTURE, SAMPLER], bound)
        self.pipelines = {}

    def group(self, layout, entries):
        layout = self.device.create_bind_group_layout(entries=layout)
        return layout, self.device.create_bind_group(layout=layout, entries=entries)

    def texture(self, size, form, usage=0):
        return self.device.create_texture(size=(*size, 1), format=form, usage=usage | wgpu.TextureUsage.RENDER_ATTACHMENT)

    def target(self, size):
        if size not in self.targets:
            color = self.texture(size, "rgba8unorm-srgb", wgpu.TextureUsage.COPY_SRC)
            self.targets[size] = color, color.create_view(), self.texture(size, "depth32float").create_view()
        return self.targets[size]

    def pipeline(self, layout, module, entry, attributes, cull, **fragment):
        return self.device.create_render_pipeline(
            layout=self.device.create_pipeline_layout(bind_group_layouts=[layout]),
            vertex={"module": module, "entry_point": entry, "buffers": [{"array_stride": 24, "attributes": attributes}]},
            primitive={"topology": "triangle-list", "cull_mode": "back" if cull else "none"},
            depth_stencil=DEPTH,
            **fragment,
        )

    def two_pipelines(self, taps, cull):
        """For the pass from the light and the pass from the eye."""
        if (taps, cull) not in self.pipelines:
            constant = "const {name}S = {length};\nvar<private> {name}: array<f32, {length}> = array<f32, {length}>({numbers});\n"
            tables = [self.scene.table(name, constant) for name in ("total", "grazing")]
            code = f"const TAPS = {taps};\n" + "".join(tables) + (SHADERS / "shade.wgsl").read_text()
            module = self.device.create_shader_module(code=code)
            shade = {"module": module, "entry_point": "shade", "targets": [{"format": "rgba8unorm-srgb"}]}
            self.pipelines[taps, cull] = (
                self.pipeline(self.map_layout, module, "map_vertex", FLOATS[:1], cull),
                self.pipeline(self.eye_layout, module, "eye_vertex", FLOATS, cull, fragment=shade),
            )
        return self.pipelines[taps, cull]

    def draw(self, pipeline, group, depth, colors):
        """One pass, handed in at once."""
        encoder = self.device.create_command_encoder()
        depth = {"view": depth, "depth_clear_value": 1.0, "depth_load_op": "clear", "depth_store_op": "store"}
        render = encoder.begin_render_pass(color_attachments=colors, depth_stencil_attachment=depth)
        render.set_pipeline(pipeline)
        render.set_bind_group(0, group)
        render.set_vertex_buffer(0, self.vertices)
        render.set_index_buffer(self.indices, "uint32")
        render.draw_indexed(self.scene.indices.size)
        render.end()
        self.device.queue.submit([encoder.finish()])

    def passes(self, size, taps, cull):
        matrices = [self.scene.light_matrix(taps).T, self.scene.eye_matrix(size[0] / size[1]).T]
        numbers = [*matrices, *self.scene.constants(taps).values()]
        data = numpy.concatenate([numpy.ravel(part) for part in numbers]).astype("f4")
        self.device.queue.write_buffer(self.constants, 0, data.tobytes())
        from_light, from_eye = self.two_pipelines(taps, cull)
        _, color, depth = self.target(size)
        sky = {"clear_value": (*self.scene.words["sky"], 1), "load_op": "clear", "store_op": "store"}
        return (
            lambda: self.draw(from_light, self.map_group, self.map, []),
            lambda: self.draw(from_eye, self.eye_group, depth, [{"view": color} | sky]),
            # The wait: queue.on_submitted_work_done_sync of wgpu 0.32.0 raises TypeError.
            lambda: self.device.queue.read_buffer(self.fence),
        )

    def picture(self, size):
        layout = {"bytes_per_row": 4 * size[0]}
        return bytes(self.device.queue.read_texture({"texture": self.target(size)[0]}, layout, (*size, 1)))


serve(Lavapipe)
