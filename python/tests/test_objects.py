"""Scenes of objects: every table and key of the scene file, as the schema has them."""

from __future__ import annotations

import dataclasses
import json
import pickle
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import REPOSITORY

import photosphere as ps
from photosphere import _core, _toml

CAMERA = ps.Camera((0, 1, 6), (0, 1, 0))


def keys_of(kind: type) -> set[str]:
    """The keys of a class."""
    return {field.name for field in dataclasses.fields(kind)}


def schema() -> dict[str, Any]:
    """The JSON schema of scene files."""
    return json.loads(_core.schema())


def keys_in(table: dict[str, Any]) -> set[str]:
    """All keys of a table, whatever its type."""
    found: set[str] = set(table.get("properties", {}))
    for word in ("oneOf", "anyOf", "allOf"):
        for one in table.get(word, []):
            found |= keys_in(one)
    for word in ("then", "else"):
        found |= keys_in(table[word]) if word in table else set()
    return found


def test_classes_have_the_keys_of_the_schema() -> None:
    tables = schema()["properties"]
    materials = [ps.Diffuse, ps.Mirror, ps.Conductor, ps.Dielectric, ps.Plastic, ps.Principled,
                 ps.Phong]
    theirs = keys_in(tables["materials"]["additionalProperties"])
    assert theirs == set().union(*map(keys_of, materials)) | {"type"}
    cameras = [ps.Camera, ps.Orthographic, ps.Panoramic]
    assert keys_in(tables["camera"]) == set().union(*map(keys_of, cameras)) | {"type"}
    background = tables["background"]["properties"]
    assert set(background) == keys_of(ps.Background)
    for name, kind in (("gradient", ps.Gradient), ("image", ps.EnvironmentMap), ("sky", ps.Sky),
                       ("sun", ps.Sun)):
        assert set(background[name]["properties"]) == keys_of(kind), name
    assert set(tables["spheres"]["items"]["properties"]) == keys_of(ps.Sphere)


def test_fitted_cameras_light_by_name_and_shadow_catchers() -> None:
    spheres = [ps.Sphere((0, 1, 0), 1), ps.Sphere((0, -100, 0), 100, shadow_catcher=True)]
    for camera in (ps.Camera(fit=True), ps.Orthographic(fit=True, direction=(0, 1, 3)),
                   ps.Panoramic(fit=True, margin=0.1)):
        background = ps.Background(backdrop="white")
        scene = ps.Scene(spheres, camera=camera, light="softbox", background=background)
        picture = np.asarray(scene.render(32, 24, spp=16, quiet=True))
        assert 0.05 < picture[12, 16].mean() < 0.95, "the ball is in the middle"
        assert (picture[0, 0] == 1).all(), "white paper around it"
    with pytest.raises(ps.Error, match="finds it"):
        ps.Scene(spheres, camera=ps.Camera((0, 0, 9), (0, 0, 0), fit=True))
    colors = np.full((2, 3), 0.5)
    tables = [ps.Spheres(np.eye(3)[:2], 0.4, color=colors, color_space=space)
              for space in ("linear", "srgb")]
    hashes = {ps.Scene([table], camera=CAMERA).content_hash for table in tables}
    assert len(hashes) == 2


MATERIALS = [
    ps.Diffuse(0.7, roughness=0.5),
    ps.Mirror(),
    ps.Metal("gold", 0.2),
    ps.Conductor(ior=(0.2, 0.9, 1.1), extinction=(3.9, 2.4, 2.2)),
    ps.Glass("bk7"),
    ps.Glass(1.33, absorption=(0.1, 0.2, 0.3)),
    ps.Plastic((0.6, 0.1, 0.1), roughness=0.2),
    ps.Principled((0.8, 0.5, 0.2), metallic=1, coat=0.5),
    ps.Phong(),
    ps.Light((5, 4, 3)),
]


@pytest.mark.parametrize("material", MATERIALS, ids=str)
def test_every_material(material: Any) -> None:
    spheres = [ps.Sphere((0, 1, 0), 1, material), ps.Sphere((0, -50, 0), 50)]
    scene = ps.Scene(spheres, camera=CAMERA, background=1.0)
    assert np.asarray(scene.render(32, 24, spp=4, quiet=True)).mean() > 0


@pytest.mark.parametrize(
    "background",
    [
        0.5,
        (0.1, 0.2, 0.3),
        ps.Gradient(1.0, (0.5, 0.5, 0.6)),
        [ps.Sky(scale=0.01), ps.Sun(elevation_degrees=30, irradiance=3)],
        ps.Background(radiance=0.2, sun=ps.Sun((1, 1, 1))),
    ],
    ids=str,
)
def test_every_background(background: Any) -> None:
    scene = ps.Scene([ps.Sphere((0, 1, 0), 1)], camera=CAMERA, background=background)
    assert np.asarray(scene.render(32, 24, spp=4, quiet=True)).mean() > 0
    xyz = np.random.default_rng(0).uniform(-1, 1, (20, 3))
    lit = ps.spheres(xyz, radius=0.3, background=background)
    assert np.asarray(lit.render(32, 24, spp=4, quiet=True)).mean() > 0


def test_backgrounds_by_name() -> None:
    spheres = [ps.Sphere((0, 1, 0), 1, ps.Diffuse("gold"))]
    white = ps.Scene(spheres, camera=CAMERA, background="white")
    assert white.content_hash == ps.Scene(spheres, camera=CAMERA, background=1.0).content_hash
    assert white.replace(background="white").content_hash == white.content_hash
    assert white.replace(background=0.5).toml.count("up") == 0, "z is up for particles alone"
    clear = ps.Scene(spheres, camera=CAMERA, background="none")
    assert "alpha" in clear.render(32, 24, spp=1, quiet=True).layers


def test_a_sky_has_a_sun_and_suits_a_screen() -> None:
    spheres = [ps.Sphere((0, 1, 0), 1), ps.Sphere((0, -100, 0), 100)]
    for background in (ps.Sky(), [ps.Sky(turbidity=5)], [ps.Sky(), ps.Sun(elevation_degrees=30)]):
        scene = ps.Scene(spheres, camera=CAMERA, background=background)
        assert 0.1 < np.median(np.asarray(scene.render(32, 24, spp=16, quiet=True))) < 1
    assert np.asarray(ps.spheres(np.eye(3), background=ps.Sky()).render(32, 24, spp=4)).mean() > 0


@pytest.mark.parametrize("up, axis", [(None, 2), ("z", 2), ("y", 1), ("-x", 0)])
def test_what_is_up_for_cameras_of_particles(up: str | None, axis: int) -> None:
    xyz = np.zeros((2, 3))
    xyz[1, axis] = -3 if up == "-x" else 3
    position = np.full(3, 0.0)
    position[axis], position[(axis + 1) % 3] = xyz[1, axis] / 2, 12
    camera = ps.Camera(position, xyz.mean(axis=0))
    options: dict[str, Any] = {"style": "flat", "up": up, "size": (48, 64), "spp": 1}
    made = [
        ps.spheres(xyz, radius=1.0, camera=camera, **{k: options[k] for k in ("style", "up")}),
        ps.spheres(xyz, radius=1.0, style="flat", up=up).replace(camera=camera),
    ]
    for scene in made:
        picture = scene.render(48, 64, spp=1, layers=["row"], quiet=True)
        rows = [set(half[half != ps.NONE]) for half in np.split(picture["row"], 2)]
        assert rows == [{1}, {0}], "the second one is above the first"
    own = ps.spheres(xyz, radius=1.0, camera=ps.Camera((0, 12, 1), (0, 0, 1), up=(1, 0, 0)))
    assert "[1, 0, 0]" in own.toml


def test_a_camera_that_looks_along_the_axis_that_is_up() -> None:
    scene = ps.spheres(np.eye(3), radius=0.3, camera=ps.Camera((0, 0, 9), (0, 0, 0)))
    assert np.isfinite(scene.render(32, 24, spp=1, layers=["depth"], quiet=True)["depth"]).any()


def test_every_camera() -> None:
    cameras = [
        ps.ThinLens((0, 1, 6), (0, 1, 0), aperture_radius=0.2, blades=5),
        ps.Orthographic((0, 1, 6), (0, 1, 0), 4),
        ps.Panoramic((0, 1, 6), (0, 1, 0)),
    ]
    sphere = ps.Sphere((0, 1, 0), 1)
    hashes = {ps.Scene([sphere], camera=c, background=1.0).content_hash for c in cameras}
    assert len(hashes) == 3


def test_particles_of_glass_under_a_lens() -> None:
    xyz = np.random.default_rng(0).uniform(-1, 1, (20, 3))
    scene = ps.spheres(xyz, radius=0.3, material=ps.Glass("water"))
    assert "dielectric" in scene.toml
    camera = ps.ThinLens((0, -8, 2), (0, 0, 0), up=(0, 0, 1), aperture_radius=0.1)
    other = scene.replace(camera=camera)
    assert other.content_hash != scene.content_hash


def test_a_scene_of_objects_is_saved_with_its_arrays(in_folder: Path) -> None:
    xyz = np.random.default_rng(0).uniform(-1, 1, (50, 3))
    table = ps.Spheres(xyz, np.full(50, 0.2), ps.Diffuse(), color=np.abs(xyz))
    scene = ps.Scene([table, ps.Sphere((0, -50, 0), 49)], camera=CAMERA, background=1.0)
    scene.save("mine.toml")
    again = ps.scene("mine.toml")
    same = [np.asarray(one.render(32, 24, spp=4, quiet=True)) for one in (scene, again)]
    assert np.array_equal(*same)


def test_a_scene_of_particles_is_saved_with_its_arrays(in_folder: Path, scene: ps.Scene) -> None:
    scene.save("mine.toml")
    again = ps.scene("mine.toml", {"image.width": 32, "image.height": 24})
    assert Path("mine.npz").exists()
    assert np.asarray(again.render(spp=4, quiet=True)).mean() > 0


@pytest.mark.parametrize("name", ["cornell-spheres", "materials", "sky", "many-lights"])
def test_toml_is_written_as_it_is_read(name: str) -> None:
    document = tomllib.loads((REPOSITORY / f"scenes/{name}.toml").read_text())
    assert tomllib.loads(_toml.document(document)) == document


def test_scenes_and_pictures_can_be_pickled(scene: ps.Scene) -> None:
    table = ps.Spheres(np.eye(3), 0.3, ps.Mirror())
    objects = ps.Scene([table], camera=CAMERA, background=1.0)
    file = ps.scene(REPOSITORY / "scenes/smallpt.toml")
    for one in (scene, objects, file):
        assert pickle.loads(pickle.dumps(one)).content_hash == one.content_hash
    layers = ["depth", "sphere_id", "normal"]
    picture = scene.render(64, 48, spp=4, layers=layers, quiet=True)
    again = pickle.loads(pickle.dumps(picture))
    for name in picture:
        assert np.array_equal(picture[name], again[name]), name
    assert np.array_equal(picture.rgb8(), again.rgb8())
