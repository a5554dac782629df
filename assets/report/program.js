// WebGL2 helpers of the comparison and the live view: programs of the page's shaders, textures, colours.

import { model, shaderText } from "report/data";

/** One triangle over the target. */
const VERTEX =
  "#version 300 es\nvoid main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }";
/** Setters of uniforms by type; samplers are set by the texture. */
const SETTERS = { FLOAT: "1f", INT: "1i", BOOL: "1i", UNSIGNED_INT: "1ui" };
const VECTORS = { FLOAT_VEC2: "2fv", FLOAT_VEC3: "3fv", FLOAT_VEC4: "4fv" };

/** The program of the shader `name`: {program, set: setters of uniforms by name}. Arrays are listed without `[0]`. */
export function makeProgram(gl, name, vertex = VERTEX) {
  const program = gl.createProgram();
  const check = (isDone, log) => {
    if (!isDone && !gl.isContextLost()) throw new Error(`${name}: ${log}`);
  };
  for (const [type, source] of Object.entries({ VERTEX_SHADER: vertex, FRAGMENT_SHADER: shaderText(name) })) {
    const shader = gl.createShader(gl[type]);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    check(gl.getShaderParameter(shader, gl.COMPILE_STATUS), gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  check(gl.getProgramParameter(program, gl.LINK_STATUS), gl.getProgramInfoLog(program));
  const set = {};
  const kinds = Object.entries({ ...SETTERS, ...VECTORS });
  for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i++) {
    const { name: full, size, type } = gl.getActiveUniform(program, i);
    const place = gl.getUniformLocation(program, full);
    const [, setter] = kinds.find(([kind]) => gl[kind] === type) ?? ["", "1i"];
    const array = size > 1 && !setter.endsWith("v") ? "v" : "";
    set[full.replace(/\[0\]$/, "")] = (value) => gl[`uniform${setter}${array}`](place, value);
  }
  return { program, set };
}

/** A texture of one level whose texels are read one by one. It is left bound at `unit`. */
export function makeTexture(gl, unit, internal, width, height, format, type, data) {
  const texture = gl.createTexture();
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.texImage2D(gl.TEXTURE_2D, 0, internal, width, height, 0, format, type, data);
  for (const name of ["MIN_FILTER", "MAG_FILTER"]) gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}`], gl.NEAREST);
  for (const name of ["WRAP_S", "WRAP_T"]) gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}`], gl.CLAMP_TO_EDGE);
  return texture;
}

/** The colours of the project's error maps as a texture of two rows (magma, blue-red). */
export function makePalette(gl, unit) {
  const texels = [...model.colors.magma, ...model.colors.blue_red].flatMap((color) => [...color, 255]);
  return makeTexture(gl, unit, gl.RGBA8, 256, 2, gl.RGBA, gl.UNSIGNED_BYTE, Uint8Array.from(texels));
}

/** The ranges of the project's error maps, the colours of texels outside them, and the mean luminance of the light. */
export function errorColors(light_mean) {
  const { relative, signed, nan, off_mask } = model.colors;
  const [nan_color, off_mask_color] = [nan, off_mask].map((color) => color.map((code) => code / 255));
  return { relative_range: relative, signed_range: signed, nan_color, off_mask_color, light_mean };
}

/** Handles a lost context that comes back: `restored` makes everything again. */
export function keepContext(canvas, restored) {
  canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
  canvas.addEventListener("webglcontextrestored", restored);
}

/** Makes a program current over `target`, a canvas or {framebuffer, width, height}. Missing uniforms are skipped. */
export function useProgram(gl, { program, set }, target, textures, values) {
  gl.useProgram(program);
  gl.bindFramebuffer(gl.FRAMEBUFFER, target.framebuffer ?? null);
  gl.viewport(0, 0, target.width, target.height);
  Object.entries(textures).forEach(([sampler, texture], unit) => {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(texture.target ?? gl.TEXTURE_2D, texture);
    set[sampler]?.(unit);
  });
  for (const [name, value] of Object.entries(values)) set[name]?.(value);
}

/** Draws a program over the whole of its target. */
export function drawOver(gl, made, target, textures, values) {
  useProgram(gl, made, target, textures, values);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
}
