#!/bin/sh
# A sweep of 5,040 small cells in one process under the validation layer: memory, open files, object leaks, equal results.
set -eu
cd "$(dirname "$0")/.."
exec cargo test --release --locked --test cli -- --ignored --exact --nocapture soak::a_sweep_of_thousands_of_cells_stays_flat
