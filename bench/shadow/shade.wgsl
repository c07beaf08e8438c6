// The shading of shade.glsl in WGSL, and the vertex stages. Before this text stand `const TAPS = 1;` or 9, and both tables' rows with their lengths.
struct Constants {
    light: mat4x4f, camera: mat4x4f,
    eye: vec4f, wi: vec4f, illuminance: vec4f, base_color: vec4f, sky: vec4f, material: vec4f, bias: vec4f,
}
struct Vertex {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f, @location(1) normal: vec3f, @location(2) in_map: vec3f,
}
@group(0) @binding(0) var<uniform> c: Constants;
@group(0) @binding(1) var shadow_map: texture_depth_2d;
@group(0) @binding(2) var nearest: sampler_comparison;

const PI = 3.14159265358979;

@vertex fn map_vertex(@location(0) p: vec3f) -> @builtin(position) vec4f { return c.light * vec4f(p, 1.0); }

@vertex fn eye_vertex(@location(0) p: vec3f, @location(1) n: vec3f) -> Vertex {
    let m = c.light * vec4f(p, 1.0);
    return Vertex(c.camera * vec4f(p, 1.0), p, n, vec3f(m.xy * vec2f(0.5, -0.5) + 0.5, m.z));
}

fn fresnel_schlick(cosine: f32, f0: f32) -> f32 {
    let m = clamp(1.0 - cosine, 0.0, 1.0);
    let m2 = m * m;
    return f0 + (1.0 - f0) * (m2 * m2 * m);
}

fn eval_ggx(alpha: f32, cos_o: f32, cos_i: f32, cos_h: f32) -> f32 {
    let a2 = alpha * alpha;
    let d = cos_h * cos_h * (a2 - 1.0) + 1.0;
    let masking_o = sqrt(cos_o * cos_o * (1.0 - a2) + a2);
    let masking_i = sqrt(cos_i * cos_i * (1.0 - a2) + a2);
    return a2 / (PI * d * d) * 0.5 / (cos_i * masking_o + cos_o * masking_i);
}

fn albedo(cos_o: f32) -> vec2f {
    let cosine = clamp(cos_o, 1e-6, 1.0);
    let alpha = c.material.x * c.material.x;
    let x = cosine * (1.0 + alpha) / (cosine + alpha) * f32(TOTALS - 1);
    let y = sqrt(cosine) * f32(GRAZINGS - 1);
    let i = min(i32(x), TOTALS - 2);
    let j = min(i32(y), GRAZINGS - 2);
    let total = TOTAL[i] + (TOTAL[i + 1] - TOTAL[i]) * (x - f32(i));
    return vec2f(total, total * (GRAZING[j] + (GRAZING[j + 1] - GRAZING[j]) * (y - f32(j))));
}

fn compensation(e: vec2f) -> f32 { return 1.0 + c.material.y * ((1.0 - e.x) / e.x); }
fn reflected(e: vec2f) -> f32 { return (c.material.y * (e.x - e.y) + c.material.z * e.y) * compensation(e); }

fn eval(n: vec3f, wo: vec3f, e: vec2f) -> vec3f {
    let cos_i = dot(n, c.wi.xyz);
    let cos_o = dot(n, wo);
    if cos_i <= 0.0 { return vec3f(); }
    let h = normalize(wo + c.wi.xyz);
    let f = mix(c.material.y, c.material.z, fresnel_schlick(dot(wo, h), 0.0));
    let alpha = c.material.x * c.material.x;
    var specular = 0.0;
    if cos_o > 0.0 { specular = f * compensation(e) * eval_ggx(alpha, cos_o, cos_i, dot(n, h)); }
    return (c.base_color.rgb * ((1.0 - reflected(e)) / PI) + specular) * cos_i;
}

fn visibility(ng: vec3f, in_map: vec3f) -> f32 {
    let cosine = clamp(dot(ng, c.wi.xyz), c.bias.z, 1.0);
    let z = in_map.z - (c.bias.x * sqrt(1.0 - cosine * cosine) / cosine + c.bias.y);
    if TAPS == 1 { return textureSampleCompareLevel(shadow_map, nearest, in_map.xy, z); }
    var sum = 0.0;
    for (var y = -1; y <= 1; y++) {
        for (var x = -1; x <= 1; x++) {
            sum += textureSampleCompareLevel(shadow_map, nearest, in_map.xy + vec2f(vec2(x, y)) * c.bias.w, z);
        }
    }
    return sum * (1.0 / 9.0);
}

@fragment fn shade(v: Vertex, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let wo = normalize(c.eye.xyz - v.position);
    // Rows grow downwards here: the other way round than in OpenGL.
    let ng = normalize(cross(dpdy(v.position), dpdx(v.position)));
    var n = normalize(select(-v.normal, v.normal, front));
    var cos_o = dot(n, wo);
    if cos_o < 0.0 { n = normalize(n - wo * cos_o); cos_o = 0.0; }
    let e = albedo(min(cos_o, 1.0));
    let ambient = (c.base_color.rgb * (1.0 - reflected(e)) + reflected(e)) * c.sky.rgb;
    return vec4f(ambient + eval(n, wo, e) * c.illuminance.rgb * visibility(ng, v.in_map), 1.0);
}
