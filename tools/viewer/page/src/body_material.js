// SPDX-License-Identifier: GPL-3.0-or-later
// How surfaces look: bone, muscle with its grain, cloth; heat maps on top; a cut through the rest shape.
import {
    Color, DoubleSide, MeshBasicMaterial, MeshStandardMaterial, NotEqualStencilFunc, ReplaceStencilOp, ShaderMaterial, Vector4,
} from "three";

const roughness = { bone: 0.62, tissue: 0.46, cloth: 0.9, plain: 0.6 }, roughnessOf = { fat: 0.55, skin: 0.62, cartilage: 0.35, organ: 0.32 };

/** Shared by all tissues: the plane n·rest < w keeps. Off: w is beyond everything. */
export const cutPlane = { value: new Vector4(0, 0, 0, 1) };

const vertexHead = `
attribute vec3 rest;
attribute vec3 mapColour;
varying vec3 vRest;
varying vec3 vMap;
`;
const fragmentHead = `
varying vec3 vRest;
varying vec3 vMap;
uniform vec4 uCut;
uniform float uCutOn;
uniform float uMap;
uniform float uStripes;
uniform vec3 uSelect;
uniform mat4 uGrain;
float grainNoise(vec2 p) {
    vec2 i = floor(p), f = fract(p);
    f = f * f * (3.0 - 2.0 * f);
    vec4 h = fract(sin(vec4(dot(i, vec2(127.1, 311.7)), dot(i + vec2(1, 0), vec2(127.1, 311.7)),
                            dot(i + vec2(0, 1), vec2(127.1, 311.7)), dot(i + vec2(1, 1), vec2(127.1, 311.7)))) * 43758.5453);
    return mix(mix(h.x, h.y, f.x), mix(h.z, h.w, f.x), f.y);
}
`;
const fragmentColour = `
if (uCutOn > 0.5 && dot(vRest, uCut.xyz) > uCut.w) discard;
if (uStripes > 0.0) {
    vec3 g = (uGrain * vec4(vRest, 1.0)).xyz;
    float fine = grainNoise(vec2(atan(g.z, g.y) * 14.0, g.x * 1.6 + 9.0));
    float wide = grainNoise(vec2(atan(g.z, g.y) * 5.0 + 40.0, g.x * 0.9));
    diffuseColor.rgb *= 1.0 + uStripes * (0.30 * (fine - 0.5) + 0.22 * (wide - 0.5));
}
diffuseColor.rgb = mix(diffuseColor.rgb, vMap, uMap);
`;

export function bodyMaterial(body, grain) {
    const material = new MeshStandardMaterial({
        color: new Color(body.colour),
        roughness: roughnessOf[body.matter] ?? roughness[body.kind] ?? 0.6,
        metalness: 0,
        polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, // edges lie on top
        side: DoubleSide,
    });
    const own = {
        uCut: cutPlane,
        uCutOn: { value: 0 },
        uMap: { value: 0 },
        uStripes: { value: body.stripes },
        uSelect: { value: new Color(0, 0, 0) },
        uGrain: { value: grain },
    };
    material.userData.own = own;
    material.onBeforeCompile = (shader) => {
        Object.assign(shader.uniforms, own);
        shader.vertexShader = vertexHead + shader.vertexShader.replace(
            "#include <begin_vertex>", "#include <begin_vertex>\nvRest = rest;\nvMap = mapColour;");
        shader.fragmentShader = fragmentHead + shader.fragmentShader
            .replace("#include <color_fragment>", "#include <color_fragment>\n" + fragmentColour)
            .replace("#include <emissivemap_fragment>", "#include <emissivemap_fragment>\ntotalEmissiveRadiance += uSelect;");
    };
    material.customProgramCacheKey = () => "body";
    return material;
}

/** Marks where a selected body is, so that its rim is drawn around it and not over it. */
export function outlineMask() {
    return new MeshBasicMaterial({
        colorWrite: false, depthWrite: false, depthTest: false, side: DoubleSide,
        stencilWrite: true, stencilRef: 1, stencilZPass: ReplaceStencilOp,
    });
}

/** The rim: the surface once more, a few pixels larger, where the mask is not. */
export function outlineMaterial() {
    return new ShaderMaterial({
        side: DoubleSide, depthTest: false, depthWrite: false, transparent: true,
        stencilWrite: true, stencilRef: 1, stencilFunc: NotEqualStencilFunc,
        uniforms: { colour: { value: new Color(0x2f81f7) }, width: { value: 0.005 } },
        vertexShader: `
uniform float width;
void main() {
    vec4 p = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    vec2 d = (projectionMatrix * vec4(normalize(normalMatrix * normal), 0.0)).xy;
    p.xy += normalize(d + vec2(1e-9)) * width * p.w;
    gl_Position = p;
}`,
        fragmentShader: `
uniform vec3 colour;
void main() {
    gl_FragColor = vec4(colour, 1.0);
    #include <colorspace_fragment>
}`,
    });
}
