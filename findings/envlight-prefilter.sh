#!/bin/sh
# envlight 0.1.0 (PyPI): the prefilter of nvdiffrec (render/light.py, renderutils), its CUDA kernels compiled as C++ and
# run on the CPU.
# Guess: `cutoff=0.99` of build_mips keeps 99 % of the weight of each level, and the diffuse map of a white
#   world is white.
# Seen: the levels of roughness 0.08 to 0.5 keep 74 to 97 % of their kernel. The cutoff sums D over the
#   angle of the half vector without its sine, so it counts the peak too often, and the kernel compares
#   that angle with the light's, which is twice as large. The diffuse map of a white world is 1.05 to 1.12, not 1:
#   pixel_area multiplies two angles, which is no solid angle off the middle of a face, and takes the
#   texels left of the middle one texel too far outside. Its value depends on the direction.
# Hurt: levels are sharper than their roughness says, so a fit of roughness to photos ends too rough;
#   fitted albedos are 4 to 10 % too dark.
# Avoid: pass cutoff=1 to build_mips and divide the diffuse map by that of a white world.
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
python3 -m pip -q --disable-pip-version-check install --root-user-action ignore \
    --target "$t/p" --no-deps envlight==0.1.0 || exit 77
python3 -m pip -q --disable-pip-version-check install --root-user-action ignore \
    --target "$t/n" numpy==1.26.4 || exit 77
kernels="$t/p/envlight/renderutils/c_src"
# CUDA's words for one thread on a processor.
cat >"$t/cuda.h" <<'C'
#include <algorithm>
#include <cmath>
using std::max;
using std::min;
#define __device__
#define __host__
#define __global__
struct float3 { float x, y, z; };
struct float4 { float x, y, z, w; };
struct dim3 { unsigned x, y, z; dim3(unsigned a = 1, unsigned b = 1, unsigned c = 1) : x(a), y(b), z(c) {} };
static dim3 blockIdx, blockDim, threadIdx(0, 0, 0);
static inline int min(int a, unsigned b) { return min(a, int(b)); }
static inline void atomicAdd(float *place, float value) { *place += value; }
C
cat >"$t/main.cpp" <<'C'
#define __CUDACC__
#include "cubemap.cu"
#include <cstdio>
#include <cstdlib>
#include <vector>

struct Values {
    std::vector<float> data;
    Tensor tensor;
    Values(int n, int h, int w, int c, float value) : data(size_t(n) * h * w * c, value) {
        const int dims[4] = {n, h, w, c}, strides[4] = {h * w * c, w * c, c, 1};
        for (int i = 0; i < 4; ++i) {
            tensor.dims[i] = tensor._dims[i] = dims[i];
            tensor.strides[i] = strides[i];
        }
        tensor.val = tensor.d_val = data.data();
        tensor.fp16 = false;
    }
};

// The weight of the kernel at a texel of a face, over its whole hemisphere and over its cutoff.
static double weight(int side, float roughness, float cutoff) {
    Values cube(6, side, side, 3, 1.0f), bounds(6, side, side, 24, 0.0f), out(6, side, side, 4, 0.0f);
    for (size_t i = 0; i < bounds.data.size(); ++i)
        bounds.data[i] = i % 2 ? float(side - 1) : 0.0f;
    SpecularCubemapKernelParams p = {cube.tensor, bounds.tensor, out.tensor, dim3(side, side, 6), cutoff, roughness};
    blockIdx = dim3(side / 2, side / 2, 0);
    SpecularCubemapFwdKernel(p);
    return out.data[(size_t(side / 2) * side + side / 2) * 4 + 3];
}

int main(int count, char **texts) {
    for (int i = 1; i + 2 < count; i += 3) {
        const int side = atoi(texts[i]);
        const float roughness = atof(texts[i + 1]), cutoff = atof(texts[i + 2]);
        printf("kept %.3f %.4f\n", roughness, weight(side, roughness, cutoff) / weight(side, roughness, 0.0f));
    }
    const int side = 16;
    Values cube(6, side, side, 3, 1.0f), out(6, side, side, 3, 0.0f);
    DiffuseCubemapKernelParams p = {cube.tensor, out.tensor, dim3(side, side, 6)};
    for (int z = 0; z < 6; ++z)
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                blockIdx = dim3(x, y, z);
                DiffuseCubemapFwdKernel(p);
            }
    const auto ends = std::minmax_element(out.data.begin(), out.data.end());
    printf("diffuse %.4f %.4f\n", *ends.first, *ends.second);
}
C
c++ -O2 -w -I "$t" -I "$kernels" -o "$t/prefilter" "$t/main.cpp"
PYTHONPATH="$t/n" python3 - "$t" <<'P'
import ast, subprocess, sys
from pathlib import Path
import numpy as np

root = Path(sys.argv[1])
# The package's own cutoff, up to the call of its plugin.
source = (root / "p/envlight/renderutils/ops.py").read_text()
bounds = next(node for node in ast.parse(source).body
              if isinstance(node, ast.FunctionDef) and node.name == "__ndfBounds")
bounds.body = [node for node in bounds.body if "_get_plugin" not in ast.unparse(node)]
bounds.body[-1] = ast.parse("return costheta[idx]").body[0]
names = {"np": np}
exec(compile(ast.fix_missing_locations(ast.Module([bounds], [])), "ops.py", "exec"), names)

sides = [512, 256, 128, 64, 32, 16]
roughness = [0.08 + 0.42 * i / 4 for i in range(5)] + [1.0]
words = []
for side, r in zip(sides, roughness):
    words += [str(side), f"{r:.6f}", f"{names['__ndfBounds'](side, r, 0.99):.9f}"]
lines = subprocess.run([root / "prefilter", *words], check=True, capture_output=True, text=True).stdout.split("\n")
kept = {line.split()[1]: float(line.split()[2]) for line in lines if line.startswith("kept")}
least, most = map(float, next(line for line in lines if line.startswith("diffuse")).split()[1:])
print("envlight 0.1.0, kept part of the kernel by roughness:", kept, "(expected 0.99)")
print(f"diffuse map of a white world: {least:.3f} to {most:.3f} (expected 1)")
if min(kept.values()) > 0.95 or most < 1.02:
    sys.exit("CHANGED: levels keep their kernel, or a white world is white")
print(f"still so: a level keeps {min(kept.values()):.2f} of its kernel, a white world is {most:.2f}")
P
