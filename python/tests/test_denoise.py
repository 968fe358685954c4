"""Denoised pictures: by an option and of finished pictures, with the library and without."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import REPOSITORY, command

import photosphere as ps
from photosphere import _core, _picture


@pytest.fixture
def no_library(in_folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which the library is not, though it is looked for there and nowhere else."""
    monkeypatch.setenv("OIDN_DIR", str(in_folder))
    return in_folder


@pytest.fixture
def library() -> None:
    """Skips a test where the library is not installed."""
    try:
        _core.check_denoiser(_picture.denoiser_package())
    except ps.Error as error:
        pytest.skip(str(error))


def room(**options: Any) -> ps.Render:
    scene = ps.scene(REPOSITORY / "scenes" / "cornell-spheres.toml")
    return scene.start(96, 72, threads=2, **options).wait()


def test_without_the_library_nothing_is_rendered(no_library: Path, scene: ps.Scene) -> None:
    with pytest.raises(ps.Error, match="Open Image Denoise is not in OIDN_DIR") as caught:
        scene.render(8, 6, spp=1, denoise=True, output="a.png")
    assert "pip install pyoidn" in str(caught.value.help)
    assert not any(no_library.iterdir())
    with pytest.raises(ps.Error, match="pip install pyoidn"):
        scene.render(8, 6, spp=1).denoise()


def test_a_render_whose_library_is_gone_keeps_its_samples(
    no_library: Path, scene: ps.Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(_core, "check_denoiser", lambda _: None)
    with pytest.warns(UserWarning, match="the picture is not denoised: .*OIDN_DIR"):
        picture = scene.render(8, 6, spp=2, denoise=True)
    assert picture.spp == 2 and "denoised" not in picture


def test_the_option_is_a_flag(scene: ps.Scene) -> None:
    with pytest.raises(TypeError, match="denoise: expected True or False"):
        scene.render(8, 6, spp=1, denoise="yes")


@pytest.mark.usefixtures("library")
def test_the_screen_shows_the_denoised_picture_and_beauty_stays(in_folder: Path) -> None:
    plain = room(spp=16).picture
    picture = room(spp=16, denoise=True, output=["a.png", "a.exr"]).picture
    assert np.array_equal(picture["beauty"], plain["beauty"])
    assert np.array_equal(np.asarray(picture), plain["beauty"])
    denoised = picture["denoised"]
    assert denoised.shape == (72, 96, 3) and denoised.dtype == np.float32
    truth = room(spp=1024).picture["beauty"]

    def error(values: np.ndarray) -> float:
        return float(np.mean((values - truth) ** 2 / (truth**2 + 0.01)))

    assert error(denoised) < 0.3 * error(plain["beauty"])
    shown, noisy = picture.rgb8().astype(int), plain.rgb8().astype(int)
    assert np.abs(shown - noisy).mean() > 1
    assert picture._repr_png_() != plain._repr_png_()
    assert "denoised" in picture.metadata["biased"]
    # A copy shows the same, and is denoised.
    copy = pickle.loads(pickle.dumps(picture))
    assert np.array_equal(copy.rgb8(), picture.rgb8()) and "denoised" in copy


@pytest.mark.usefixtures("library")
def test_files_are_those_of_the_command_line(in_folder: Path) -> None:
    room(spp=4, denoise=True, no_run_figures=True, output=["a.png", "a.exr", "a.pfm"])
    path = REPOSITORY / "scenes" / "cornell-spheres.toml"
    words = ["render", path, "--size=96x72", "--spp=4", "--denoise", "--threads=2", "--quiet"]
    words += ["--no-run-figures", "-o", "b.png", "-o", "b.exr", "-o", "b.pfm"]
    done = command(*words, folder=in_folder)
    assert done.returncode == 0, done.stderr
    for ending in ("png", "exr", "pfm"):
        ours, theirs = (in_folder / f"{name}.{ending}" for name in "ab")
        assert ours.read_bytes() == theirs.read_bytes(), ending


@pytest.mark.usefixtures("library")
def test_a_finished_picture_is_denoised_with_the_layers_it_has(in_folder: Path) -> None:
    guides = ["denoising_albedo", "denoising_normal"]
    render = room(spp=4, layers=guides)
    by_option = room(spp=4, denoise=True).picture
    once = render.picture.denoise()
    assert np.array_equal(once["denoised"], by_option["denoised"])
    twice = once.denoise()
    assert twice.layers == once.layers
    # What is merged and extended are samples, which are never denoised.
    parts = [room(spp=32, denoise=True, samples=one).part for one in ((0, 16), (16, 32))]
    merged, whole = ps.merge(parts), room(spp=32, denoise=True).picture
    assert "denoised" not in merged and np.array_equal(merged["beauty"], whole["beauty"])
    assert np.array_equal(merged.denoise()["denoised"], whole["denoised"])
    longer = room(spp=2, denoise=True).extend_to(4).wait()
    assert np.array_equal(longer.picture["denoised"], once["denoised"])
