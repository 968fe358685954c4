"""Every option of the command line is a keyword: of the types, of the functions, in the README."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import photosphere as ps
from photosphere import _core, _options

README = Path(__file__).parents[1] / "README.md"


def options_table() -> str:
    """The options as a table of the README."""
    lines = ["| keyword | value | meaning |", "|---|---|---|"]
    for name, value, text, default, _ in _core.keywords():
        if name in _options.NOT_HERE:
            continue
        value = "True" if value is None else f"`{value}`"
        text = " ".join(text.split()).replace("|", "\\|")
        default = "" if default is None else f" [default: {default}]"
        lines.append(f"| `{name.replace('-', '_')}` | {value} | {text}{default} |")
    return "\n".join(lines)


def test_types_and_command_line_agree() -> None:
    ours = set(_options.Options.__annotations__) | set(_options.LookOptions.__annotations__)
    theirs = {name.replace("-", "_") for name, *_ in _core.keywords()}
    assert theirs - _options.NOT_HERE == ours - {"camera"}
    assert _options.NOT_HERE < theirs


def test_the_readme_lists_them() -> None:
    text = README.read_text()
    begin, end = text.index("<!-- options -->"), text.index("<!-- end of options -->")
    shown = text[begin:end].removeprefix("<!-- options -->").strip()
    if shown != options_table() and "PHOTOSPHERE_UPDATE" in __import__("os").environ:
        README.write_text(
            f"{text[:begin]}<!-- options -->\n\n{options_table()}\n\n{text[end:]}"
        )
    assert shown == options_table(), "set PHOTOSPHERE_UPDATE to write the table anew"


def test_the_command_line_lists_the_same() -> None:
    line = [sys.executable, "-m", "photosphere", "render", "--help"]
    text = subprocess.run(line, capture_output=True, text=True, check=True).stdout
    for name, *_ in _core.keywords():
        assert f"--{name}" in text


@pytest.mark.parametrize(
    "options, words",
    [
        ({"spp": 4, "noise": None}, ["--spp=4"]),
        ({"noise": "1%"}, ["--noise=1%"]),
        ({"time": 30, "checkpoint_every": "5m"}, ["--time=30s", "--checkpoint-every=5m"]),
        ({"size": (4, 3), "samples": (0, 16)}, ["--size=4x3", "--samples=0..16"]),
        ({"range": (0, "p90"), "replicate": (1, 2, 3)}, ["--range=0,p90", "--replicate=1,2,3"]),
        ({"ortho": True, "axes": False}, ["--ortho"]),
        ({"ground": False}, ["--ground=false"]),
        ({"layers": ["depth", "albedo"]}, ["--layers=depth,albedo"]),
        ({"set": {"render.seed": 7}}, ["--set=render.seed=7"]),
        ({"material": "diffuse"}, ["--material=lambert"]),
    ],
)
def test_values_become_words(options: dict[str, Any], words: list[str]) -> None:
    assert _options.split(options) == (words, [])


def test_a_wrong_name_is_refused_and_the_right_one_named(scene: ps.Scene) -> None:
    with pytest.raises(TypeError, match="no option `sppp`; did you mean `spp`"):
        scene.render(sppp=4)
    with pytest.raises(TypeError, match="ortho: expected True or False"):
        scene.render(ortho="yes")


def test_a_wrong_value_is_an_error_with_the_keyword(scene: ps.Scene) -> None:
    with pytest.raises(ps.Error, match="'5x' for 'noise"):
        scene.render(noise="5x")
    with pytest.raises(ps.Error, match="render.samples_per_pixel|spp") as caught:
        scene.render(spp=0)
    assert "--" not in str(caught.value)
    with pytest.raises(ps.Error, match="colour map|colormap"):
        ps.read(__file__, input_format="csv").scene(colormap="viridisx").render()


def test_a_time_between_previews_needs_a_preview(scene: ps.Scene) -> None:
    with pytest.raises(TypeError, match="preview_every: there is no preview"):
        scene.render(8, 6, spp=1, preview_every=1)
