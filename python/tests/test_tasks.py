"""The ten tasks that the package is made for, as they are written in its documentation."""

from __future__ import annotations

import asyncio
import pickle
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from conftest import REPOSITORY, command, write_xyz

import photosphere as ps

SMALL = {"spp": 4, "quiet": True}


def test_1_three_lines(xyz: np.ndarray) -> None:
    scene = ps.spheres(xyz, radius=0.4)
    picture = scene.render(80, 60, spp=4)
    assert repr(picture).startswith("<picture of 80 x 60 pixels, 4 samples per pixel")
    assert picture._repr_png_().startswith(b"\x89PNG")
    assert 0.05 < np.asarray(picture).mean() < 2


def test_2_colour_by_an_array_with_a_bar(xyz: np.ndarray, in_folder: Path) -> None:
    v = np.linalg.norm(xyz, axis=1)
    color = ps.by(v, "batlow", range=(0, 8), title="distance", unit="nm")
    scene = ps.spheres(xyz, radius=0.4, color=color, material="diffuse", style="studio")
    picture = scene.render(96, 72, noise="50%", max_spp=64, quiet=True)
    picture.save("fig3.png", dpi=300)
    assert picture.legend is not None
    assert picture.legend.title == "distance (nm)"
    picture.legend.save("bar.svg")
    drawing = Path("bar.svg").read_text()
    assert "distance (nm)" in drawing and drawing.count("<stop") == 256
    plain = picture.rgb8(overlay=False)
    assert (plain != picture.rgb8()).any(), "the bar is drawn over the picture"


def test_4_a_file_with_conditions(in_folder: Path) -> None:
    write_xyz(Path("a.xyz"))
    p = ps.read("a.xyz", frame=-1, columns=["e"])
    assert (p.n, p.columns, p.frames) == (60, ["e"], 1)
    assert p.cell is not None and np.allclose(p.cell.vectors, 8 * np.eye(3))
    assert p["e"].shape == (60,) and p.positions.shape == (60, 3)
    part = p.where("e < 8 && z > 2").where("e > 1")
    scene = part.scene(color=ps.by("e", "vik"))
    kept = (p["e"] < 8) & (p.positions[:, 2] > 2) & (p["e"] > 1)
    assert scene._describe()["particles"] == kept.sum()
    assert scene.render(64, 48, **SMALL).width == 64


def test_4_a_file_never_becomes_python_objects(in_folder: Path) -> None:
    write_xyz(Path("a.xyz"))
    code = (
        "import sys, photosphere as ps\n"
        "p = ps.read('a.xyz', columns=['e']).where('e < 12')\n"
        "p.scene(color=ps.by('e', 'vik')).render(64, 48, spp=4, quiet=True).save('a.png')\n"
        "print('numpy' in sys.modules)"
    )
    line = [sys.executable, "-c", code]
    done = subprocess.run(line, capture_output=True, text=True, check=True)
    assert done.stdout == "False\n" and Path("a.png").exists()


def test_5_a_render_that_progresses(scene: ps.Scene) -> None:
    r = scene.start(64, 48, noise="20%", max_spp=64, quiet=True)
    assert r.wait(timeout=0.01) is r and r.picture.width == 64
    r.wait()
    assert r.error is not None and 0 < r.error < 1
    assert r.reason in ("finished", "noise target missed")
    pictures = list(scene.start(64, 48, spp=64).stream(every=0.05))
    assert pictures[-1].spp == 64

    async def last() -> ps.Picture:
        pictures = [picture async for picture in scene.start(64, 48, spp=16)]
        return pictures[-1]

    assert np.array_equal(np.asarray(asyncio.run(last())), scene.render(64, 48, spp=16)["beauty"])


def test_6_layers_as_arrays(scene: ps.Scene) -> None:
    names = ["direct", "indirect", "albedo", "normal", "depth", "sphere_id", "variance"]
    picture = scene.render(64, 48, spp=32, layers=names)
    assert set(names) <= set(picture.layers)
    assert picture["depth"].shape == (48, 64) and picture["depth"].dtype == np.float32
    assert picture["normal"].shape == (48, 64, 3)
    assert picture["sphere_id"].dtype == np.uint32
    both = picture["direct"] + picture["indirect"]
    assert np.array_equal(both, np.asarray(picture)) and both.dtype == np.float32
    assert picture.rgb8().shape == (48, 64, 3) and picture.rgb8().dtype == np.uint8
    assert not picture["depth"].flags.writeable
    first, again = picture["depth"], picture["depth"]
    assert first.__array_interface__["data"] == again.__array_interface__["data"], "no copy"
    with pytest.raises(KeyError, match="albedo"):
        picture["position"]
    kept = picture["depth"]
    del picture, again, first
    assert np.isfinite(kept).any(), "the array keeps the picture alive"


def test_6_columns_are_layers(xyz: np.ndarray, in_folder: Path) -> None:
    charge = np.arange(1000.0)
    scene = ps.spheres(xyz, radius=0.4, values={"charge": charge}, select="charge < 900")
    picture = scene.render(64, 48, layers=["depth", "charge"], **SMALL)
    layer = picture["charge"]
    assert layer.dtype == np.float32 and np.nanmax(layer) < 900
    y, x = np.argwhere(np.isfinite(layer))[100]
    pick = picture.pick(int(x), int(y))
    assert pick is not None and pick.row == layer[y, x] == pick.values["charge"]
    with pytest.raises(ps.Error, match="there is no layer `nothing`"):
        scene.render(64, 48, layers=["nothing"], **SMALL)
    write_xyz(Path("a.xyz"))
    ps.read("a.xyz").render(64, 48, layers=["e"], no_run_figures=True, **SMALL).save("a.exr")
    words = ["--size", "64x48", "--spp", 4, "--layers", "e", "--no-run-figures", "-o", "b.exr"]
    done = command("render", "a.xyz", *words)
    assert done.returncode == 0, done.stderr
    assert Path("a.exr").read_bytes() == Path("b.exr").read_bytes()


def test_7_stop_go_on_and_extend(scene: ps.Scene, in_folder: Path) -> None:
    r = scene.start(64, 48, spp=192, checkpoint="a.state")
    assert r.picture.width == 64, "there are samples"
    r.stop()
    assert not r.running
    ps.resume("a.state").extend_to(256).wait().save("a.exr", no_run_figures=True)
    scene.render(64, 48, spp=256).save("b.exr", no_run_figures=True)
    assert Path("a.exr").read_bytes() == Path("b.exr").read_bytes()


def test_7_a_file_is_resumed_by_its_checkpoint_alone(in_folder: Path) -> None:
    write_xyz(Path("a.xyz"))
    r = ps.read("a.xyz").start(64, 48, spp=256, checkpoint="a.state", quiet=True)
    assert r.picture.width == 64, "there are samples"
    r.stop()
    r = ps.resume("a.state").extend_to(320).wait()
    assert np.array_equal(
        np.asarray(r.picture), np.asarray(ps.read("a.xyz").render(64, 48, spp=320, quiet=True))
    )


def test_8_a_scene_file_changed_by_keys_and_back(in_folder: Path) -> None:
    path = REPOSITORY / "scenes/cornell-spheres.toml"
    keys = {"render.samples_per_pixel": 4, "image.width": 64, "image.height": 48}
    s = ps.scene(path, {**keys, "materials.red.albedo": [0.7, 0.1, 0.1]})
    camera = ps.Camera(position=(0, 1, 6), look_at=(0, 1, 0), aperture_radius=0.05)
    changed = s.replace(camera=camera)
    changed.save("mine.toml")
    again = ps.scene("mine.toml")
    assert again.content_hash == changed.content_hash != s.content_hash
    pictures = [one.render(quiet=True) for one in (changed, again)]
    assert np.array_equal(*map(np.asarray, pictures))


def test_9_which_particle_is_it(xyz: np.ndarray) -> None:
    ids = np.arange(1000) + 7000
    scene = ps.spheres(xyz, radius=0.4, values={"id": ids})
    picture = scene.render(96, 72, layers=["sphere_id", "depth"], **SMALL)
    seen = np.unique(picture["sphere_id"])
    assert len(seen[seen != ps.NONE]) > 100
    y, x = np.argwhere(picture["depth"] < np.inf)[len(xyz) // 2]
    pick = next(p for p in (picture.pick(x, y) for x in range(30, 60)) if p and p.values)
    assert pick.values["id"] == 7000 + pick.row
    assert np.allclose(pick.position, xyz[pick.row]) and pick.radius == pytest.approx(0.4)


def test_9_a_row_of_a_file(in_folder: Path) -> None:
    write_xyz(Path("a.xyz"))
    p = ps.read("a.xyz")
    picture = p.where("z > 1").render(64, 48, **SMALL)
    picks = [picture.pick(x, 24) for x in range(64)]
    pick = next(pick for pick in picks if pick and pick.values)
    assert np.allclose(pick.position, p.positions[pick.row], atol=1e-5)
    assert pick.values["e"] == pytest.approx(p["e"][pick.row])


def test_10_many_machines_exact_sums(scene: ps.Scene, in_folder: Path) -> None:
    with ThreadPoolExecutor(2) as executor:
        part = lambda a: scene.part(samples=(a, a + 32), size=(64, 48))  # noqa: E731
        parts = list(executor.map(part, range(0, 128, 32)))
    parts = pickle.loads(pickle.dumps(parts))
    ps.merge(parts).save("a.exr", no_run_figures=True)
    scene.render(64, 48, spp=128).save("b.exr", no_run_figures=True)
    assert Path("a.exr").read_bytes() == Path("b.exr").read_bytes()


def test_10_a_plan_for_a_queue(in_folder: Path) -> None:
    path = REPOSITORY / "scenes/cornell-spheres.toml"
    plan = ps.scene(path).plan(shards=4, format="slurm", spp=256)
    plan.save("job.sh")
    assert "SLURM_ARRAY_TASK_ID" in Path("job.sh").read_text()
