"""What a scene is made of: materials, cameras, backgrounds and spheres, as plain values.

Each class has the keys of its table in a scene file. A key that is None has the default of the
format. Colours are linear Rec. 709; a single number stands for grey. Names and limits are checked
when a scene is made.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Union

__all__ = [
    "Background",
    "Camera",
    "Conductor",
    "Dielectric",
    "Diffuse",
    "EnvironmentMap",
    "Glass",
    "Gradient",
    "Light",
    "Metal",
    "Mirror",
    "Orthographic",
    "Panoramic",
    "Phong",
    "Plastic",
    "Principled",
    "Sky",
    "Sphere",
    "Spheres",
    "Sun",
    "ThinLens",
]

Color = Union[float, Sequence[float]]
Vector = Sequence[float]


class _Table:
    """A table of a scene file."""

    _type: ClassVar[str | None] = None
    _colors: ClassVar[tuple[str, ...]] = ()

    def toml(self) -> dict[str, Any]:
        """The keys that are given, as the scene file has them."""
        table: dict[str, Any] = {} if self._type is None else {"type": self._type}
        for field in dataclasses.fields(self):  # type: ignore[arg-type]
            one = getattr(self, field.name)
            if one is not None:
                table[field.name] = _color(one) if field.name in self._colors else _plain(one)
        return table


def _color(given: Any) -> list[float]:
    if isinstance(given, (int, float)):
        return [float(given)] * 3
    return [float(one) for one in given]


def _plain(given: Any) -> Any:
    if hasattr(given, "tolist"):
        return given.tolist()
    return list(given) if isinstance(given, tuple) else given


@dataclass(frozen=True)
class Diffuse(_Table):
    """A matte surface. `roughness` 0 is Lambertian, 1 looks as flat as chalk."""

    albedo: Color = 0.5
    roughness: float | None = None
    emission: Color | None = None
    opacity: float | None = None
    _type, _colors = "diffuse", ("albedo", "emission")


@dataclass(frozen=True)
class Mirror(_Table):
    """A perfect mirror."""

    reflectance: Color = 0.9
    emission: Color | None = None
    opacity: float | None = None
    _type, _colors = "mirror", ("reflectance", "emission")


@dataclass(frozen=True)
class Conductor(_Table):
    """A metal, by name ("gold") or by its complex index of refraction."""

    metal: str | None = None
    ior: Color | None = None
    extinction: Color | None = None
    roughness: float | None = None
    emission: Color | None = None
    opacity: float | None = None
    _type, _colors = "conductor", ("ior", "extinction", "emission")


@dataclass(frozen=True)
class Dielectric(_Table):
    """Glass, a crystal or a liquid, by index of refraction or by name ("bk7")."""

    ior: float | None = None
    glass: str | None = None
    roughness: float | None = None
    priority: int | None = None
    absorption: Color | None = None
    emission: Color | None = None
    opacity: float | None = None
    _type, _colors = "dielectric", ("absorption", "emission")


@dataclass(frozen=True)
class Plastic(_Table):
    """A diffuse base under a clear coat."""

    albedo: Color = 0.5
    ior: float | None = None
    roughness: float | None = None
    emission: Color | None = None
    opacity: float | None = None
    _type, _colors = "plastic", ("albedo", "emission")


@dataclass(frozen=True)
class Principled(_Table):
    """The material with many knobs that modelling programs share."""

    base_color: Color = 0.5
    metallic: float | None = None
    roughness: float | None = None
    specular: float | None = None
    ior: float | None = None
    coat: float | None = None
    coat_roughness: float | None = None
    transmission: float | None = None
    emission: Color | None = None
    opacity: float | None = None
    _type, _colors = "principled", ("base_color", "emission")


@dataclass(frozen=True)
class Phong(_Table):
    """Phong's model, for comparison with old pictures."""

    albedo: Color = 0.5
    specular: Color = 0.3
    exponent: float = 50.0
    normalized: bool | None = None
    emission: Color | None = None
    opacity: float | None = None
    _type, _colors = "phong", ("albedo", "specular", "emission")


def Glass(glass: str | float = 1.5, **keys: Any) -> Dielectric:
    """Glass by name ("bk7", "water", "diamond") or by index of refraction."""
    if isinstance(glass, str):
        return Dielectric(glass=glass, **keys)
    return Dielectric(ior=float(glass), **keys)


def Metal(metal: str = "silver", roughness: float | None = None, **keys: Any) -> Conductor:
    """A metal by name: "gold", "silver", "copper", "aluminium", "iron", ..."""
    return Conductor(metal=metal, roughness=roughness, **keys)


def Light(emission: Color) -> Diffuse:
    """A surface that emits this radiance, in W/(sr m^2), and reflects nothing."""
    return Diffuse(albedo=0.0, emission=emission)


Material = Union[Diffuse, Mirror, Conductor, Dielectric, Plastic, Principled, Phong]


@dataclass(frozen=True)
class Camera(_Table):
    """A pinhole, or a thin lens if `aperture_radius` is given."""

    position: Vector
    look_at: Vector
    up: Vector | None = None
    near: float | None = None
    vertical_fov_degrees: float | None = None
    aperture_radius: float | None = None
    focus_distance: float | None = None
    focus_on: str | None = None
    blades: int | None = None
    rotation_degrees: float | None = None


def ThinLens(
    position: Vector, look_at: Vector, *, aperture_radius: float, **keys: Any
) -> Camera:
    """A camera with depth of field."""
    return Camera(position, look_at, aperture_radius=aperture_radius, **keys)


@dataclass(frozen=True)
class Orthographic(_Table):
    """Parallel rays; `height` is that of the visible area."""

    position: Vector
    look_at: Vector
    height: float
    up: Vector | None = None
    near: float | None = None
    _type = "orthographic"


@dataclass(frozen=True)
class Panoramic(_Table):
    """Columns are longitudes, rows are latitudes."""

    position: Vector
    look_at: Vector
    up: Vector | None = None
    near: float | None = None
    horizontal_extent_degrees: float | None = None
    vertical_extent_degrees: float | None = None
    _type = "panoramic"


AnyCamera = Union[Camera, Orthographic, Panoramic]


@dataclass(frozen=True)
class Gradient(_Table):
    """Radiance from the zenith through the horizon to the nadir."""

    zenith: Color = 1.0
    horizon: Color = 1.0
    nadir: Color | None = None
    _colors = ("zenith", "horizon", "nadir")


@dataclass(frozen=True)
class EnvironmentMap(_Table):
    """An .exr or .hdr picture in latitude and longitude."""

    file: str
    rotation_degrees: float | None = None
    scale: float | None = None


@dataclass(frozen=True)
class Sky(_Table):
    """A clear sky, for the sun beside it."""

    turbidity: float | None = None
    ground_albedo: Color | None = None
    scale: float | None = None
    _colors = ("ground_albedo",)


@dataclass(frozen=True)
class Sun(_Table):
    """A sun: where it stands, how large it looks, and the W/m^2 on a surface that faces it."""

    direction: Vector | None = None
    irradiance: Color = 2.0
    elevation_degrees: float | None = None
    azimuth_degrees: float | None = None
    angular_diameter_degrees: float | None = None
    _colors = ("irradiance",)


@dataclass(frozen=True)
class Background(_Table):
    """What a ray sees when it hits nothing. At most one of radiance, gradient, image and sky."""

    radiance: Color | None = None
    gradient: Gradient | None = None
    image: EnvironmentMap | None = None
    sky: Sky | None = None
    sun: Sun | None = None
    up: Vector | None = None
    camera_visible: bool | None = None
    transparent: bool | None = None
    _colors = ("radiance",)

    def toml(self) -> dict[str, Any]:
        """The keys that are given, as the scene file has them."""
        table = super().toml()
        return {key: one.toml() if isinstance(one, _Table) else one for key, one in table.items()}


AnyBackground = Union[Background, Gradient, EnvironmentMap, Sky, Sun, Color]

_PLACES = {Gradient: "gradient", EnvironmentMap: "image", Sky: "sky", Sun: "sun"}


def background_table(given: AnyBackground | Sequence[AnyBackground]) -> dict[str, Any]:
    """The table of a background: one object, several such as a sky and a sun, or a radiance."""
    if isinstance(given, Background):
        return given.toml()
    parts: list[Any] = [given] if not isinstance(given, (list, tuple)) else list(given)
    if all(isinstance(part, (int, float)) for part in parts):
        return {"radiance": _color(given)}
    table: dict[str, Any] = {}
    for part in parts:
        if isinstance(part, Background):
            table.update(part.toml())
        elif type(part) in _PLACES:
            table[_PLACES[type(part)]] = part.toml()
        else:
            raise TypeError(f"background: expected a background, not {part!r}")
    return table


@dataclass(frozen=True)
class Sphere(_Table):
    """A sphere of its own, of a material or the name of one."""

    center: Vector
    radius: float
    material: Material | str = dataclasses.field(default_factory=Diffuse)
    name: str | None = None


@dataclass(frozen=True, eq=False)
class Spheres:
    """Many spheres of one material, from arrays.

    Args:
        center: (n, 3), any type of numbers.
        radius: One number, or (n,).
        material: A material or the name of one.
        color: (n, 3), linear, 0 to 1: replaces the colour of the material.
        emission: (n, 3), radiance in W/(sr m^2).
        ids: (n,) unsigned integers for the layer `sphere_id`, instead of rows.
        name: For Cryptomatte and messages.
    """

    center: Any
    radius: Any
    material: Material | str = dataclasses.field(default_factory=Diffuse)
    color: Any = None
    emission: Any = None
    ids: Any = None
    name: str | None = None
