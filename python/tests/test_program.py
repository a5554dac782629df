"""The same numbers as `splitsum`."""

import json
import threading
import time

import numpy as np
import pytest
import splitsum
from conftest import MAP, ROOT, table, vectors


@pytest.fixture(scope="module")
def bake(program, tmp_path_factory):
    """Bakes GGX of the golden map: a folder of `splitsum bake`."""
    folder = tmp_path_factory.mktemp("bake")
    program("bake", MAP, "--out", folder, "--set", "brdf=ggx", "--set", "prefilter_size=64x64", "--set", "dfg_size=32")
    return folder


def test_baked_tables(bake):
    for k, level in enumerate(splitsum.prefilter(MAP, levels=5, size=(64, 64))):
        np.testing.assert_array_equal(level, splitsum.read_exr(bake / f"prefiltered_ggx_{k}.exr")[0])
    # Blue is missing in the file.
    np.testing.assert_array_equal(splitsum.dfg_table(32), splitsum.read_exr(bake / "dfg_ggx.exr")[0][..., :2])
    for count, word in ((1, "one"), (2, "two"), (4, "four")):
        rgb, alpha = splitsum.read_exr(bake / f"taps_{word}_ggx.exr")
        np.testing.assert_array_equal(splitsum.taps(count), np.dstack([rgb, alpha]))
    np.testing.assert_allclose(splitsum.sh9(MAP), json.loads((bake / "sh9.json").read_text())["radiance"], rtol=1e-6)


@pytest.mark.parametrize("options", [{}, {"fail_on_wrong": True, "fail_between_above": 1e-9}])
def test_check_bake(program, bake, options):
    found = splitsum.check_bake(bake, MAP, **options)
    expected = json.loads(program("check-bake", bake, "--environment", MAP, "--json"))
    assert found["verdict"].startswith("good")
    if "fail_between_above" in options:
        # The program would exit with 1.
        assert not found["passes"] and len(found["failures"]) >= 4
        for key in ("limits", "passes", "failures"):
            expected[key] = found[key]
        for level, own in zip(expected["levels"], found["levels"]):
            level["passes"] = own["passes"]
    assert found == expected


def test_check_bake_of_a_wrong_bake(program, tmp_path):
    paths = [tmp_path / f"level{k}.exr" for k in range(3)]
    for path, level in zip(paths, splitsum.prefilter(MAP, [0, 0.5, 1], size=(32, 32))):
        splitsum.write_exr(path, level / np.float32(np.pi))
    own = {"alphas": [0, 0.5, 1], "masking": "separable"}
    found = splitsum.check_bake(paths, MAP, own)
    assert "times 1/pi" in found["verdict"] and found["preset"] == "own"
    flags = ["--preset", "splitsum", "--alphas", "0,0.5,1", "--json"]
    expected = json.loads(program("check-bake", *paths, "--environment", MAP, *flags))
    assert found == {**expected, "preset": "own"}


def test_integrate(program, tmp_path):
    n, v = [0, 0.6, 0.8], [[0, 0, 1], [0, 1, 0]]
    queries = "environment,brdf,alpha,f0,nx,ny,nz,vx,vy,vz,masking\n"
    for alpha in (0.1, 0.5):
        for view in ("0,0,1", "0,1,0"):
            queries += f"builtin:sky,beckmann,{alpha},0.1:0.2:0.3,0,0.6,0.8,{view},correlated\n"
    (tmp_path / "queries.csv").write_text(queries)
    for kind in ("shading", "ladder"):
        program("integrate", tmp_path / "queries.csv", "--kind", kind, "--out", tmp_path / "answers.csv")
        expected = table(tmp_path / "answers.csv")
        found = splitsum.integrate(
            "builtin:sky",
            kind=kind,
            n=[[n]],
            v=v,
            alpha=[[0.1], [0.5]],
            f0=[[[0.1, 0.2, 0.3]]],
            model="beckmann",
            masking="correlated",
        )
        for name, values in found.items():
            assert values.shape == (2, 2, 3)
            np.testing.assert_array_equal(values.reshape(4, 3), vectors(expected, name + "_", "rgb"))


def test_relmse(program, tmp_path):
    random = np.random.default_rng(1)
    test, reference = random.random((2, 20, 30, 3), np.float32)
    splitsum.write_exr(tmp_path / "test.exr", test)
    splitsum.write_exr(tmp_path / "reference.exr", reference)
    flags = ["--json", "--environment-mean", "0.5"]
    scores = json.loads(program("compare", tmp_path / "test.exr", tmp_path / "reference.exr", *flags))
    assert splitsum.relmse(test, reference, environment_mean=0.5) == scores["relmse"]
    # Any memory layout; a mask that leaves out half of the image.
    wide = np.repeat(test, 2, 1)[:, ::2]
    mask = np.arange(30) < 15
    half = splitsum.relmse(wide, reference, mask=np.broadcast_to(mask, (20, 30)))
    assert half == splitsum.relmse(np.ascontiguousarray(test[:, :15]), np.ascontiguousarray(reference[:, :15]))


@pytest.mark.parametrize("has_pandas", [True, False])
def test_read_run(program, tmp_path_factory, monkeypatch, has_pandas):
    folder = tmp_path_factory.getbasetemp() / "run"
    if not folder.exists():
        text = (ROOT / "experiments" / "quick.toml").read_text()
        settings = {"environment": "builtin:sky", "alpha": "0.5", "brdf": "ggx", "scene": "sphere", "size": "32x32"}
        flags = [flag for name, value in settings.items() for flag in ("--set", f"{name}={value}")]
        assert "sampled" in text
        program("run", ROOT / "experiments" / "quick.toml", *flags, "--out", folder)
    if not has_pandas:
        monkeypatch.setattr("splitsum.run.pandas", None)
    rows = splitsum.read_run(folder)
    rows = [row for _, row in rows.iterrows()] if has_pandas else rows
    assert len(rows) > 2
    mean = table(folder / "environments.csv")["mean_luminance"][0]
    for row in rows:
        image, reference, mask = row.image(), row.reference(), row.mask()
        assert image.dtype == np.float32 and image.shape == reference.shape == (32, 32, 3) == (*mask.shape, 3)
        assert splitsum.relmse(image, reference, mask=mask, environment_mean=mean) == pytest.approx(row["relmse"], 1e-6)
        assert (row.standard_error()[mask] > 0).any() and row["run"] == str(folder)
    published = splitsum.read_run(ROOT / "results" / "quick")
    first = published.iloc[0] if has_pandas else published[0]
    assert first["cell"] == "b37be85392ad2e33" and first["alpha"] == 0.1
    with pytest.raises(FileNotFoundError, match="published runs have only tables"):
        first.image()


def test_the_gil_is_free():
    ticks = []
    # A table that is not in the program.
    worker = threading.Thread(target=splitsum.taps, args=(4,), kwargs={"levels": 7})
    worker.start()
    while worker.is_alive():
        ticks.append(time.monotonic())
        time.sleep(0.001)
    # A held GIL would leave one gap of the whole time.
    assert len(ticks) > 100 and max(np.diff(ticks)) < 0.5 * (ticks[-1] - ticks[0])
