"""Every script of examples/ runs and draws its figure."""

import os
import subprocess
import sys

import matplotlib.image
import pytest
from conftest import ROOT

# A fit of its own takes more lines.
LINES_MAX = {"recovery_light": 110}
EXAMPLES = sorted((ROOT / "python" / "examples").glob("*.py"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example(path, tmp_path):
    if "splitsum.torch" in path.read_text():
        pytest.importorskip("torch")
    folder = os.environ.get("SPLITSUM_FIGURES", tmp_path)
    result = subprocess.run([sys.executable, path], cwd=folder, capture_output=True, check=False, text=True)
    assert result.returncode == 0 and result.stdout, result.stderr
    figure = matplotlib.image.imread(os.path.join(folder, path.stem + ".png"))
    # A blank figure would have one colour.
    assert figure.shape[0] > 300 and figure[..., :3].std() > 0.05
    assert len(path.read_text().splitlines()) <= LINES_MAX.get(path.stem, 60)
