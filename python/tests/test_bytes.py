"""The files of the package equal those of the command line, byte for byte."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import REPOSITORY, command

import photosphere as ps

SCENES = [
    "scenes/cornell-spheres.toml",
    "scenes/many-lights.toml",
    "scenes/materials.toml",
    "scenes/phong.toml",
    "scenes/sky.toml",
    "scenes/smallpt.toml",
    "scenes/furnace.toml",
    "scenes/bench/mixed-balls.toml",
    "scenes/paper/fig2.toml",
    "scenes/paper/fig5.toml",
    "scenes/verify/panorama.toml",
    "scenes/verify/orthographic.toml",
    "scenes/verify/glass-in-a-field.toml",
]

PARTICLES = [
    ("a.xyz", {}),
    ("a.xyz", {"color": "e", "colormap": "vik", "view": (30, 20)}),
    ("a.xyz", {"style": "paper", "scale_bar": True, "unit": "Å", "cell": True}),
    ("a.xyz", {"select": "e < 9", "material": "gold", "background": "none"}),
    ("a.xyz", {"style": "glow", "ortho": True, "axes": True, "tone": "agx", "exposure": 1}),
    ("b.csv", {"radius": "r", "color": "x", "range": (0, "p90"), "title": "x", "dpi": 200}),
    ("b.csv", {"replicate": None, "style": "dark", "zoom": 1.2, "up": "y", "slice": "x > 4"}),
]


def words(options: dict[str, object]) -> list[str]:
    """Options as a user would type them."""
    line = []
    for name, given in options.items():
        option = "--" + name.replace("_", "-")
        if given is True:
            line.append(option)
        elif given is not None:
            text = ",".join(map(str, given)) if isinstance(given, tuple) else str(given)
            line += [option, text]
    return line


@pytest.mark.parametrize("name", SCENES)
def test_a_scene(name: str, in_folder: Path) -> None:
    path = REPOSITORY / name
    options = {"spp": 4, "layers": "direct,indirect,albedo,depth", "no_run_figures": True}
    done = command("render", path, "--size", "40x30", *words(options), "-o", "cli.exr")
    assert done.returncode == 0, done.stderr
    ps.scene(path).render(40, 30, **options, quiet=True).save("python.exr")
    assert Path("python.exr").read_bytes() == Path("cli.exr").read_bytes()


@pytest.mark.parametrize("name, options", PARTICLES)
def test_a_particle_file(name: str, options: dict[str, object], in_folder: Path) -> None:
    from conftest import write_xyz

    write_xyz(Path("a.xyz"))
    rows = "\n".join(f"{at % 7},{at % 5},{at % 3},{0.3 + at % 4 / 10}" for at in range(70))
    Path("b.csv").write_text("x,y,z,r\n" + rows + "\n")
    options = {**options, "spp": 4, "no_run_figures": True}
    size = ["--size", "64x48"]
    done = command("render", name, *size, *words(options), "-o", "cli.png", "-o", "cli.exr")
    assert done.returncode == 0, done.stderr
    picture = ps.read(name).render(64, 48, **options, quiet=True)
    for ending in ("png", "exr"):
        picture.save(f"python.{ending}")
        same = Path(f"python.{ending}").read_bytes() == Path(f"cli.{ending}").read_bytes()
        assert same, ending


def test_particles_are_rendered_until_they_are_good(in_folder: Path) -> None:
    from conftest import write_xyz

    write_xyz(Path("a.xyz"))
    done = command("render", "a.xyz", "--size", "64x48", "--no-run-figures", "-o", "cli.png")
    assert "--quality good" in done.stderr, done.stderr
    render = ps.read("a.xyz").start(64, 48, no_run_figures=True, quiet=True)
    render.wait().save("python.png")
    assert Path("python.png").read_bytes() == Path("cli.png").read_bytes()
    assert render.error is not None and render.error < 0.06


def test_scenes_are_twenty() -> None:
    assert len(SCENES) + len(PARTICLES) == 20


def test_arrays_render_like_a_file(in_folder: Path) -> None:
    import numpy as np

    from conftest import write_xyz

    write_xyz(Path("a.xyz"))
    file = ps.read("a.xyz")
    names = {name: file[name] for name in file.columns}
    arrays = ps.Particles(file.positions, cell=file.cell, **names)
    pictures = [p.render(64, 48, spp=4, quiet=True) for p in (file, arrays)]
    assert np.array_equal(*map(np.asarray, pictures))
