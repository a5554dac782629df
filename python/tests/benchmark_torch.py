"""Prints time and memory a pixel of `splitsum.torch.shade`, forward and backward: benchmark_torch.py [PIXELS].

Each method runs in a process of its own, whose peak memory is counted from before the first call on the pixels.
"""

import resource
import subprocess
import sys
import time

METHODS = ["split-sum", "split-sum-one", "split-sum-two", "split-sum-four"]
REPEATS = 5


def measure(method, pixels):
    """Returns microseconds and bytes a pixel."""
    import splitsum.torch as st
    import torch

    torch.manual_seed(1)
    torch.set_num_threads(1)
    levels = [torch.rand(6, 128 >> k, 128 >> k, 3, requires_grad=True) for k in range(5)]
    inputs = [torch.randn(pixels, 3), torch.randn(pixels, 3), torch.rand(pixels, 1), torch.rand(pixels, 3)]
    inputs = [values.requires_grad_() for values in inputs]

    def run(count):
        st.shade(levels, *(values[:count] for values in inputs), method).sum().backward()

    run(16)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    start = time.process_time()
    for _ in range(REPEATS):
        run(pixels)
    seconds = (time.process_time() - start) / REPEATS
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    return 1e6 * seconds / pixels, 1024 * peak / pixels


if len(sys.argv) == 3:
    print(*measure(sys.argv[1], int(sys.argv[2])))
else:
    pixels = sys.argv[1] if len(sys.argv) > 1 else "300000"
    for method in METHODS:
        found = subprocess.run([sys.executable, __file__, method, pixels], check=True, capture_output=True, text=True)
        microseconds, memory = map(float, found.stdout.split())
        print(f"{method}: {microseconds:.2f} µs and {memory:.0f} bytes a pixel")
