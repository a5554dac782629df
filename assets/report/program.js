// A WebGL2 program of one of the page's shaders over the whole target.

import { shaderText } from "report/data";

/** One triangle over the target. */
const VERTEX = "#version 300 es\nvoid main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }";

/** The program of the shader `name`: {program, uniform: locations by name}. Arrays are listed without `[0]`. */
export function makeProgram(gl, name) {
  const program = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, shaderText(name)]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(`${name}: ${gl.getShaderInfoLog(shader)}`);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(`${name}: ${gl.getProgramInfoLog(program)}`);
  const uniform = {};
  for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i++) {
    const { name: full } = gl.getActiveUniform(program, i);
    uniform[full.replace(/\[0\]$/, "")] = gl.getUniformLocation(program, full);
  }
  return { program, uniform };
}

/** The colours of the project's error maps as a texture of two rows (magma, blue-red), and their ranges as uniforms. */
export function setErrorColors(gl, uniform, { relative, signed, nan, off_mask }) {
  gl.uniform2fv(uniform.relative_range, relative);
  gl.uniform2fv(uniform.signed_range, signed);
  gl.uniform3fv(uniform.nan_color, nan.map((c) => c / 255));
  gl.uniform3fv(uniform.off_mask_color, off_mask.map((c) => c / 255));
}

/** The texels of that texture. */
export const paletteTexels = ({ magma, blue_red }) => Uint8Array.from([...magma, ...blue_red].flatMap((c) => [...c, 255]));
