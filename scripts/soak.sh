#!/bin/sh
# A sweep of 5,000 small cells in one process under the validation layer: memory, open files, object leaks.
set -eu
cd "$(dirname "$0")/.."
exec cargo test --release --locked --test cli -- --ignored --exact --nocapture growth::a_sweep_of_thousands_of_cells_stays_flat
