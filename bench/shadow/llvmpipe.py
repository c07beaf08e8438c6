"""Mesa's llvmpipe through OpenGL 3.3 and EGL, without a window: llvmpipe.py SCENE. See peer.py for what it answers."""

import moderngl
import numpy
from peer import SHADERS, serve

MAP_VERTEX = """#version 330
uniform mat4 light; in vec3 p;
void main() { gl_Position = light * vec4(p, 1.0); }
"""
EYE_VERTEX = """#version 330
uniform mat4 camera, light; in vec3 p, n; out vec3 position, normal, in_map;
void main() {
    position = p; normal = n;
    in_map = (light * vec4(p, 1.0)).xyz * 0.5 + 0.5;
    gl_Position = camera * vec4(p, 1.0);
}
"""
GL_SRGB8_ALPHA8, GL_FRAMEBUFFER_SRGB = 0x8C43, 0x8DB9
# OpenGL's clip space has depths in [-1, 1].
DEPTHS = numpy.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 2, -1], [0, 0, 0, 1]])


def matrix(rows):
    return rows.T.astype("f4").tobytes()




class Llvmpipe:
    """A depth map and, by size, pictures."""

    def __init__(self, scene):
        self.scene, self.targets, self.programs = scene, {}, {}
        self.gl = moderngl.create_context(standalone=True, backend="egl", require=330)
        self.name = f"{self.gl.info['GL_RENDERER']}, {self.gl.info['GL_VERSION']}"
        self.buffers = self.gl.buffer(scene.vertices.tobytes()), self.gl.buffer(scene.indices.tobytes())
        self.map = self.gl.depth_texture((scene.map_size, scene.map_size))
        self.map.compare_func, self.map.filter = "<=", (moderngl.NEAREST, moderngl.NEAREST)
        self.map.repeat_x = self.map.repeat_y = False
        self.map_target = self.gl.framebuffer(depth_attachment=self.map)
        self.map.use(0)
        program = self.gl.program(vertex_shader=MAP_VERTEX, fragment_shader="#version 330\nvoid main() {}")
        self.map_program = program
        self.map_mesh = self.mesh(program, "3f 12x", "p")
        self.gl.enable(moderngl.DEPTH_TEST)
        self.gl.enable_direct(GL_FRAMEBUFFER_SRGB)

    def mesh(self, program, form, *names):
        vertices, indices = self.buffers
        return self.gl.vertex_array(program, [(vertices, form, *names)], indices)

    def target(self, size):
        if size not in self.targets:
            color = self.gl.texture(size, 4, internal_format=GL_SRGB8_ALPHA8)
            self.targets[size] = self.gl.framebuffer([color], self.gl.depth_renderbuffer(size))
        return self.targets[size]

    def shading(self, taps):
        """The program and mesh of the eye pass."""
        if taps not in self.programs:
            text = (SHADERS / "shade.glsl").read_text()
            constant = "const float {name}[{length}] = float[{length}]({numbers});\n"
            tables = [self.scene.table(name, constant) for name in ("total", "grazing")]
            text = text.replace("#version 330", f"#version 330\n#define TAPS {taps}\n" + "".join(tables))
            program = self.gl.program(vertex_shader=EYE_VERTEX, fragment_shader=text[text.index("#version") :])
            program["light"].write(matrix(DEPTHS @ self.scene.light_matrix(taps)))
            for name, value in self.scene.constants(taps).items():
                program[name].value = tuple(value)
            self.programs[taps] = program, self.mesh(program, "3f 3f", "p", "n")
        return self.programs[taps]

    def passes(self, size, taps, cull):
        target, (program, mesh) = self.target(size), self.shading(taps)
        self.map_program["light"].write(matrix(DEPTHS @ self.scene.light_matrix(taps)))
        program["camera"].write(matrix(DEPTHS @ self.scene.eye_matrix(size[0] / size[1])))
        (self.gl.enable if cull else self.gl.disable)(moderngl.CULL_FACE)
        sky = tuple(self.scene.words["sky"])

        def draw_map():
            self.map_target.use()
            self.map_target.clear()
            self.map_mesh.render()

        def draw_eye():
            target.use()
            target.clear(*sky, 1.0)
            mesh.render()

        return draw_map, draw_eye, self.gl.finish

    def picture(self, size):
        rows = numpy.frombuffer(self.target(size).read(components=4), "u1").reshape(size[1], -1)
        return rows[::-1].tobytes()


serve(Llvmpipe)
