// Umbriel's shading of a rough dielectric under one directional light and a uniform sky: Bsdf::eval, eval_ggx,
// fresnel_schlick, ambient_reflection and albedo_ggx of crates/render, with the same names.
#version 330
uniform sampler2DShadow shadow_map;
uniform vec4 eye, wi, illuminance, base_color, sky, material, bias;
in vec3 position, normal, in_map;
out vec4 color;

const float PI = 3.14159265358979;

float fresnel_schlick(float c, float f0) {
    float m = clamp(1.0 - c, 0.0, 1.0), m2 = m * m;
    return f0 + (1.0 - f0) * (m2 * m2 * m);
}

float eval_ggx(float alpha, float cos_o, float cos_i, float cos_h) {
    float a2 = alpha * alpha, d = cos_h * cos_h * (a2 - 1.0) + 1.0;
    float masking_o = sqrt(cos_o * cos_o * (1.0 - a2) + a2), masking_i = sqrt(cos_i * cos_i * (1.0 - a2) + a2);
    return a2 / (PI * d * d) * 0.5 / (cos_i * masking_o + cos_o * masking_i);
}

float albedo_ggx(float cos_o, float roughness, float f0) {
    float x = 1.0 - roughness, y = 0.0425 - 0.0275 * roughness;
    float z = 1.04 - 0.572 * roughness, w = -0.04 + 0.022 * roughness;
    float a = min(x * x, exp2(-9.28 * cos_o)) * x + y;
    return max(f0 * (-1.04 * a + z) + (1.04 * a + w), 0.0);
}

vec3 eval(vec3 n, vec3 wo) {
    float cos_i = dot(n, wi.xyz), cos_o = dot(n, wo);
    if (cos_i <= 0.0) return vec3(0.0);
    vec3 h = normalize(wo + wi.xyz);
    float f = fresnel_schlick(dot(wo, h), material.y), alpha = material.x * material.x;
    float specular = cos_o > 0.0 ? f * eval_ggx(alpha, cos_o, cos_i, dot(n, h)) : 0.0;
    return (base_color.rgb * ((1.0 - f) / PI) + specular) * cos_i;
}

// The fraction of texels that are not nearer to the light; the bias is slope-scaled by the triangle's own plane.
float visibility(vec3 ng) {
    float c = clamp(dot(ng, wi.xyz), bias.z, 1.0);
    float z = in_map.z - (bias.x * sqrt(1.0 - c * c) / c + bias.y);
#if TAPS == 1
    return texture(shadow_map, vec3(in_map.xy, z));
#else
    float sum = 0.0;
    for (int y = -1; y <= 1; y++)
        for (int x = -1; x <= 1; x++) sum += texture(shadow_map, vec3(in_map.xy + vec2(x, y) * bias.w, z));
    return sum * (1.0 / 9.0);
#endif
}

void main() {
    vec3 wo = normalize(eye.xyz - position);
    vec3 ng = normalize(cross(dFdx(position), dFdy(position)));
    vec3 n = normalize(gl_FrontFacing ? normal : -normal);
    float cos_o = dot(n, wo);
    // The shading normal never points away from the viewer.
    if (cos_o < 0.0) { n = normalize(n - wo * cos_o); cos_o = 0.0; }
    float coat = albedo_ggx(min(cos_o, 1.0), material.x, material.y);
    vec3 ambient = (base_color.rgb * (1.0 - coat) + coat) * sky.rgb;
    color = vec4(ambient + eval(n, wo) * illuminance.rgb * visibility(ng), 1.0);
}
