// What the comparison and the live view need of WebGL2: a program of one of the page's shaders over the whole target, textures, colours.

import { shaderText } from "report/data";

/** One triangle over the target. */
const VERTEX =
  "#version 300 es\nvoid main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }";

/** The program of the shader `name`: {program, uniform: locations by name}. Arrays are listed without `[0]`. */
export function makeProgram(gl, name) {
  const program = gl.createProgram();
  for (const [type, source] of [
    [gl.VERTEX_SHADER, VERTEX],
    [gl.FRAGMENT_SHADER, shaderText(name)],
  ]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost())
      throw new Error(`${name}: ${gl.getShaderInfoLog(shader)}`);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
    throw new Error(`${name}: ${gl.getProgramInfoLog(program)}`);
  const uniform = {};
  for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i++) {
    const { name: full } = gl.getActiveUniform(program, i);
    uniform[full.replace(/\[0\]$/, "")] = gl.getUniformLocation(program, full);
  }
  return { program, uniform };
}

/** A texture of one level whose texels are read one by one. It is left bound at `unit`. */
export function makeTexture(gl, unit, internal, width, height, format, type, data) {
  const texture = gl.createTexture();
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.texImage2D(gl.TEXTURE_2D, 0, internal, width, height, 0, format, type, data);
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
  for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
  return texture;
}

/** The colours of the project's error maps as a texture of two rows (magma, blue-red). */
export const makePalette = (gl, unit, { magma, blue_red }) => {
  const texels = Uint8Array.from([...magma, ...blue_red].flatMap((c) => [...c, 255]));
  return makeTexture(gl, unit, gl.RGBA8, 256, 2, gl.RGBA, gl.UNSIGNED_BYTE, texels);
};

/** A context that is lost and comes back: `restored` makes everything anew. */
export function keepContext(canvas, restored) {
  canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
  canvas.addEventListener("webglcontextrestored", restored);
}

/** The ranges of the project's error maps, and the colours of texels outside them. */
export function setErrorColors(gl, uniform, { relative, signed, nan, off_mask }) {
  gl.uniform2fv(uniform.relative_range, relative);
  gl.uniform2fv(uniform.signed_range, signed);
  gl.uniform3fv(
    uniform.nan_color,
    nan.map((c) => c / 255),
  );
  gl.uniform3fv(
    uniform.off_mask_color,
    off_mask.map((c) => c / 255),
  );
}

/** Draws a program over `framebuffer` (null: the canvas) of `size`, with textures by sampler name; `set` fills the other uniforms. */
export function drawOver(gl, { program, uniform }, framebuffer, [width, height], textures, set) {
  gl.useProgram(program);
  gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
  gl.viewport(0, 0, width, height);
  let unit = 0;
  for (const [sampler, texture] of Object.entries(textures)) {
    if (!uniform[sampler]) continue;
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.uniform1i(uniform[sampler], unit++);
  }
  set(uniform);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
}
