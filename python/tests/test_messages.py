"""What is wrong with a value is said with the name of its argument, and with what is expected."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import REPOSITORY

import photosphere as ps

THREE = np.arange(9.0).reshape(3, 3)
CAMERA = ps.Camera((0, 1, 6), (0, 1, 0))


def table(**keys: Any) -> ps.Scene:
    return ps.Scene([ps.Spheres(THREE, 1.0, **keys)], camera=CAMERA)


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda s: s.render((80, 60)), r"width: expected a number of pixels, not \(80, 60\)"),
        (lambda s: s.render("80", 60), "width: expected a number of pixels, not '80'"),
        (lambda s: s.render(80, 60.5), "height: expected a number of pixels, not 60.5"),
        (lambda s: s.render(samples=range(64)), r"samples: expected 2 values .*\(0, 64\)"),
        (lambda s: s.part(range(64)), r"samples: expected the first and the end, such as \(0, 256"),
        (lambda s: s.render(size=80), None),
        (lambda s: s.render(size=(80, 60, 3)), r"size: expected 2 values such as \(640, 480\)"),
        (lambda s: s.render(crop=(0, 0, 3)), "crop: expected 4 values such as"),
        (lambda s: s.render(color=ps.by("x")), "color: it is part of a scene of particles"),
        (lambda s: s.render(radius=np.ones(3)), "radius: it is part of a scene of particles"),
        (lambda s: s.render(spp={}), "spp: expected a whole number, not {}"),
        (lambda s: s.render(set=["a"]), "set: expected keys with their values"),
        (lambda s: s.replace(camera=(0, 0, 5)), "camera: expected Camera, ThinLens, Orthographic"),
        (lambda s: s.replace(background=object), "background: expected a radiance, a colour"),
        (lambda s: s.replace(background="whte"), "whte.*background.*colour"),
        (lambda s: s.replace(material=3.5), "material: expected a material or its name, not 3.5"),
        (lambda s: ps.merge(s.part((0, 16), size=(8, 6))), "parts: expected several, not <part"),
        (lambda s: ps.merge([3]), "parts: expected parts or their files, not 3"),
        (lambda s: ps.Particles(THREE, cell=(10, 10, 10)), r"cell: .*\[a, b, c\]"),
        (lambda s: ps.spheres(THREE, cell=(10, 10, 10)), r"cell: .*three edges .*\(10, 10, 10\)"),
        (lambda s: ps.Particles(THREE, cell=ps.Cell(np.eye(3), (0, 0))), "cell: .*`origin`"),
        (lambda s: ps.spheres(THREE, radius={}), r"radius: expected a number, an array \(3,\)"),
        (lambda s: ps.spheres(THREE, radius=1e300), r"radius: .* at most 1e\+15, not 1e\+300"),
        (lambda s: ps.spheres(THREE, radius=[1, 1e16, 1]), "radius: row 1 is 1e.16: .* at most"),
        (lambda s: ps.spheres(THREE * 1e299), r"positions: row 0 is .*within ±1e15"),
        (lambda s: table(ids=[0, -1, 2]), "ids: row 1 is -1: expected a whole number from 0"),
        (lambda s: table(ids=[0, 1, 1.5]), "ids: row 2 is 1.5: expected a whole number"),
        (lambda s: table(ids=[2**33, 1, 2]), "ids: row 0 is 8589934592: .* to 4294967294"),
        (lambda s: table(ids=[np.nan, 1, 2]), "ids: row 0 is nan"),
        (lambda s: table(color=THREE), r"color: row 0 is \[0.0, 1.0, 2.0\]: .* from 0 to 1"),
        (lambda s: table(color=-THREE), "color: row 0 is .*: expected numbers from 0 to 1"),
        (lambda s: table(emission=-THREE), "emission: row 0 is .*: expected numbers from 0"),
        (lambda s: table(color=THREE * np.nan), "color: row 0 is"),
        (lambda s: ps.Scene([ps.Sphere((0, 0, 0), 1, ps.Diffuse("whit"))]), "albedo: .*'whit'"),
        (lambda s: ps.Scene([ps.Sphere((0, 0, 0), 1, ps.Diffuse((1, 0)))]), "albedo: expected"),
        (lambda s: ps.Scene([], background="whit"), "background: expected .*'whit'"),
        (lambda s: ps.Scene([], camera=(0, 0, 1)), "camera: expected Camera"),
    ],
)
def test_arguments(scene: ps.Scene, call: Any, message: str | None) -> None:
    with pytest.raises((TypeError, ValueError, ps.Error), match=message) as caught:
        call(scene)
    assert "--" not in str(caught.value)


@pytest.mark.parametrize(
    "look, message",
    [
        ({"dpi": 300.5}, "dpi: expected a whole number of pixels per inch .* not 300.5"),
        ({"dpi": "300"}, "dpi: expected a whole number of pixels per inch .* not '300'"),
        ({"dpi": 0}, "dpi: "),
        ({"exposure": "1"}, "exposure: expected a number, not '1'"),
        ({"font_size": -1}, "font_size: expected a positive number, not -1"),
        ({"tone": 3}, "tone: expected a name, not 3"),
        ({"tone": "filmik"}, "tone: expected one of srgb, filmic, agx"),
        ({"dither": 1}, "dither: expected True or False, not 1"),
    ],
)
def test_looks(scene: ps.Scene, in_folder: Path, look: dict[str, Any], message: str) -> None:
    picture = scene.render(32, 24, spp=1, quiet=True)
    with pytest.raises((TypeError, ValueError), match=message):
        picture.save("a.png", **look)
    assert not Path("a.png").exists()


def test_a_whole_number_may_be_a_float(scene: ps.Scene, in_folder: Path) -> None:
    picture = scene.render(32, 24, spp=1, quiet=True)
    picture.save("a.png", dpi=300.0, no_run_figures=True)
    picture.save("b.png", dpi=np.int64(300), no_run_figures=True)
    assert Path("a.png").read_bytes() == Path("b.png").read_bytes()


def test_merge_names_parts_by_their_place(scene: ps.Scene, tmp_path: Path) -> None:
    parts = [scene.part((0, 16), size=(8, 6)), scene.part((0, 16), size=(8, 6))]
    with pytest.raises(ps.Error) as caught:
        ps.merge(parts)
    assert "parts[0]" in str(caught.value) or "parts[1]" in str(caught.value)
    assert ".part" not in str(caught.value) and "tmp" not in str(caught.value)
    file = parts[0].save(tmp_path / "mine.part")
    with pytest.raises(ps.Error, match="mine.part"):
        ps.merge([file, parts[1]])


def test_help_names_keywords(scene: ps.Scene) -> None:
    parts = [scene.part((first, first + 16), size=(8, 6)) for first in (0, 32)]
    with pytest.raises(ps.Error) as caught:
        ps.merge(parts)
    assert "allow_gaps=True" in (caught.value.help or "")
    assert ps.merge(parts, allow_gaps=True).width == 8


def test_a_wrong_key_is_named_with_its_table() -> None:
    with pytest.raises(ps.Error, match=r"^`materials.diffuse-1.albedo` must") as caught:
        ps.Scene([ps.Sphere((0, 0, 0), 1, ps.Diffuse(2.0))])
    assert caught.value.file is None and "the scene" not in str(caught.value)
    with pytest.raises(ps.Error, match=r"^`spheres.0.radius` must"):
        ps.Scene([ps.Sphere((0, 0, 0), -1)])


@pytest.mark.parametrize("given", [{"format": "slurmy"}, {"spp": "many"}, {"samples": (0, 16)}])
def test_plans_speak_of_keywords(given: dict[str, Any]) -> None:
    scene = ps.scene(REPOSITORY / "scenes/smallpt.toml")
    with pytest.raises((ps.Error, TypeError)) as caught:
        scene.plan(shards=4, **given)
    text = str(caught.value)
    assert next(iter(given)) in text
    assert "try" not in text and "--" not in text and "Usage" not in text


def test_a_layer_that_is_not_there(scene: ps.Scene) -> None:
    picture = scene.render(32, 24, spp=1, quiet=True)
    with pytest.raises(KeyError, match=r"depth: the picture has the layers .*layers=\[...\]"):
        picture["depth"]


def test_arrays_of_pictures_without_a_copy(scene: ps.Scene) -> None:
    picture = scene.render(32, 24, spp=1, layers=["depth"], quiet=True)
    for one in (picture, picture["depth"]):
        first = np.asarray(one)
        if np.lib.NumpyVersion(np.__version__) >= "2.0.0":
            again = np.asarray(one, copy=False)
            assert np.shares_memory(first, again)
            with pytest.raises(ValueError):
                np.asarray(one, dtype="f8", copy=False)
        assert not np.shares_memory(first, np.array(one, copy=True))
        assert np.asarray(one, dtype="f8").dtype == np.float64
