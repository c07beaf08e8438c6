// Umbriel's shading of a rough dielectric under one directional light and a uniform sky: Plain::eval, eval_ggx, fresnel_schlick, Albedo and
// ambient_reflection of crates/render, with the same names. After the version stand TAPS, and the rows TOTAL and GRAZING of Albedo's tables.
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

// Albedo::new, of the rows of both tables for this roughness.
vec2 albedo(float cos_o) {
    float c = clamp(cos_o, 1e-6, 1.0), alpha = material.x * material.x;
    float x = c * (1.0 + alpha) / (c + alpha) * float(TOTAL.length() - 1), y = sqrt(c) * float(GRAZING.length() - 1);
    int i = min(int(x), TOTAL.length() - 2), j = min(int(y), GRAZING.length() - 2);
    float total = TOTAL[i] + (TOTAL[i + 1] - TOTAL[i]) * (x - float(i));
    return vec2(total, total * (GRAZING[j] + (GRAZING[j + 1] - GRAZING[j]) * (y - float(j))));
}

// Albedo::compensation and Albedo::reflected.
float compensation(vec2 e) { return 1.0 + material.y * ((1.0 - e.x) / e.x); }
float reflected(vec2 e) { return (material.y * (e.x - e.y) + material.z * e.y) * compensation(e); }

vec3 eval(vec3 n, vec3 wo, vec2 e) {
    float cos_i = dot(n, wi.xyz), cos_o = dot(n, wo);
    if (cos_i <= 0.0) return vec3(0.0);
    vec3 h = normalize(wo + wi.xyz);
    float f = mix(material.y, material.z, fresnel_schlick(dot(wo, h), 0.0)), alpha = material.x * material.x;
    float specular = cos_o > 0.0 ? f * compensation(e) * eval_ggx(alpha, cos_o, cos_i, dot(n, h)) : 0.0;
    return (base_color.rgb * ((1.0 - reflected(e)) / PI) + specular) * cos_i;
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
    vec2 e = albedo(min(cos_o, 1.0));
    vec3 ambient = (base_color.rgb * (1.0 - reflected(e)) + reflected(e)) * sky.rgb;
    color = vec4(ambient + eval(n, wo, e) * illuminance.rgb * visibility(ng), 1.0);
}
