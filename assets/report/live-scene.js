// The run's tables, models and camera for the live view, and its error.

import { decode, texelError } from "report/data";
import { makeTexture } from "report/program";

/** The run's camera over a model, turned by degrees about its middle; at a distance of 1 it frames the same. */
export function cameraOf({ camera, low, high }, { yaw, pitch, distance }, width, height) {
  const [a, b] = [camera.yaw + (yaw * Math.PI) / 180, camera.pitch + (pitch * Math.PI) / 180];
  const [sa, ca, sb, cb] = [Math.sin(a), Math.cos(a), Math.sin(b), Math.cos(b)];
  const [right, up, back] = [[ca, 0, -sa], [-sa * sb, cb, -ca * sb], [sa * cb, sb, ca * cb]]; // prettier-ignore
  const [x, y, z] = camera.offset;
  const eye = low.map((side, i) => (side + high[i]) / 2 + x * right[i] + y * up[i] + z * back[i]);
  // A tall image fits the width, as the renderer's automatic camera does.
  const half = distance * Math.max(camera.extent[1], (camera.extent[0] * height) / width);
  // The ball around the scene lies between the planes.
  const radius = 0.51 * Math.hypot(...low.map((side, i) => high[i] - side));
  const [near, far] = [camera.is_perspective ? Math.max(z - radius, 0.01 * radius) : z - radius, z + radius];
  const scale = (camera.is_perspective ? far : 1) / (far - near);
  const depth = [scale, -near * scale];
  return { right, up, back, forward: back.map((side) => -side), eye, extent: [(half * width) / height, half], depth };
}

/**
 * Packed levels as one trilinear texture by a map layout. The faces of a cube are below each other; u of a lat-long
 * map repeats.
 */
export async function loadChain(gl, levels, layout = "") {
  const images = await Promise.all(levels.map(({ size, base64 }) => decode(base64, size[0], size[1])));
  const isCube = layout === "cube";
  const target = isCube ? gl.TEXTURE_CUBE_MAP : gl.TEXTURE_2D;
  const faces = isCube ? [0, 1, 2, 3, 4, 5].map((face) => gl.TEXTURE_CUBE_MAP_POSITIVE_X + face) : [target];
  const texture = gl.createTexture();
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(target, texture);
  gl.texStorage2D(target, images.length, gl.RGBA16F, images[0].width, images[0].height / faces.length);
  images.forEach(({ width, height, rgba }, level) => {
    const [rows, size] = [height / faces.length, rgba.length / faces.length];
    faces.forEach((face, i) => {
      const texels = rgba.subarray(i * size, (i + 1) * size);
      gl.texSubImage2D(face, level, 0, 0, width, rows, gl.RGBA, gl.HALF_FLOAT, texels);
    });
  });
  const minified = images.length > 1 ? gl.LINEAR_MIPMAP_LINEAR : gl.LINEAR;
  gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, minified);
  gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
  gl.texParameteri(target, gl.TEXTURE_WRAP_S, layout === "equirect" ? gl.REPEAT : gl.CLAMP_TO_EDGE);
  gl.texParameteri(target, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  return Object.assign(texture, { target });
}

/** The triangles of a part of a model: {vertices, count}. */
export async function loadPart(gl, part) {
  const { positions, normals, tangents, triangles, vertex_count: count, triangle_count: size } = part;
  const texts = [positions, normals, tangents || normals].map((text) => decode(text, count, 1));
  const loaded = await Promise.all([...texts, decode(triangles, size, 1)]);
  const [fractions, octahedra, turned, corners] = loaded.map(({ rgba }) => rgba);
  const vertices = gl.createVertexArray();
  gl.bindVertexArray(vertices);
  // A texel has four words; the last one is unused.
  const attribute = (location, data, components, type) => {
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, components, type, true, 8, 0);
  };
  attribute(0, fractions, 3, gl.UNSIGNED_SHORT);
  attribute(1, octahedra, 2, gl.SHORT);
  // Without tangents the third number, the handedness, is 0.
  attribute(2, turned, 3, gl.SHORT);
  const indices = corners.filter((_, i) => i % 4 < 3);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
  gl.bindVertexArray(null);
  return { vertices, count: 3 * size };
}

/** The renderer's Hammersley set, in an order whose every prefix covers the whole lobe. */
export function makePoints(gl, count) {
  const divisor = (a, b) => (b ? divisor(b, a % b) : a);
  let step = Math.max(1, Math.round(count * 0.618));
  while (divisor(step, count) !== 1) step++;
  const point = (_, place) => {
    const i = (place * step) % count;
    let turns = 0;
    for (let bits = i, half = 0.5; bits; bits >>= 1, half /= 2) turns += bits & 1 ? half : 0;
    const u = (i + 0.5) / count;
    return [u, Math.cos(2 * Math.PI * turns), Math.sin(2 * Math.PI * turns), -Math.log1p(-u)];
  };
  const table = Float32Array.from(Array.from({ length: count }, point).flat());
  return makeTexture(gl, 0, gl.RGBA32F, count, 1, gl.RGBA, gl.FLOAT, table);
}

/** relMSE over the surface, under light of a mean luminance. Texels are RGB and 1 on the surface. */
export function relativeError(test, truth, mean) {
  let [sum, count] = [0, 0];
  for (let i = 0; i < test.length; i += 4) {
    if (!test[i + 3]) continue;
    sum += texelError(test.subarray(i, i + 3), truth.subarray(i, i + 3), mean).relative ** 2;
    count++;
  }
  return count ? sum / count : 0;
}
