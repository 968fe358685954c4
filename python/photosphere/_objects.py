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

from . import _core

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

#: A grey, red, green and blue, or a name such as "white" or "#102030".
Color = Union[float, Sequence[float], str]
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
                is_color = field.name in self._colors
                table[field.name] = _color(one, field.name) if is_color else _plain(one)
        return table


def _color(given: Any, name: str) -> list[float]:
    """Three numbers of one, three, or the name of a colour.

    Raises:
        ValueError: It is none of these; names the key.
    """
    numbers: list[float] | None = None
    if isinstance(given, str):
        numbers = _core.color(given)
    elif isinstance(given, (int, float)):
        numbers = [float(given)] * 3
    else:
        try:
            numbers = [float(one) for one in given]
        except (TypeError, ValueError):
            numbers = None
    if numbers is None or len(numbers) != 3:
        expected = 'a number, three numbers, or a colour such as "white" or "#102030"'
        raise ValueError(f"{name}: expected {expected}, not {given!r}")
    return numbers


def _plain(given: Any) -> Any:
    if hasattr(given, "tolist"):
        return given.tolist()
    return list(given) if isinstance(given, tuple) else given


@dataclass(frozen=True)
class Diffuse(_Table):
    """A matte surface.

    Args:
        albedo: The fraction of light that is scattered, 0 to 1 [default: 0.5].
        roughness: 0 is Lambertian, 1 looks as flat as chalk [default: 0].
        emission: Radiance in W/(sr m^2), from 0 [default: 0].
        opacity: The fraction of light that the surface meets, 0 to 1 [default: 1].
    """

    albedo: Color = 0.5
    roughness: float | None = None
    emission: Color | None = None
    opacity: float | None = None
    _type, _colors = "diffuse", ("albedo", "emission")


@dataclass(frozen=True)
class Mirror(_Table):
    """A perfect mirror.

    Args:
        reflectance: The fraction of light that is reflected, 0 to 1 [default: 0.9].
        emission: Radiance in W/(sr m^2), from 0 [default: 0].
        opacity: The fraction of light that the surface meets, 0 to 1 [default: 1].
    """

    reflectance: Color = 0.9
    emission: Color | None = None
    opacity: float | None = None
    _type, _colors = "mirror", ("reflectance", "emission")


@dataclass(frozen=True)
class Conductor(_Table):
    """A metal, by name or by its complex index of refraction.

    Args:
        metal: "gold", "silver", "copper", "aluminium", "iron", "chromium", "nickel", "titanium",
            "platinum", "tungsten" or "brass"; or else `ior` and `extinction`.
        ior: n, the real part, relative to vacuum, 0 to 100 [default: that of the metal].
        extinction: k, the imaginary part, 0 to 100 [default: that of the metal].
        roughness: 0 is polished, 0.3 brushed, 1 the most matte [default: 0].
        emission: Radiance in W/(sr m^2), from 0 [default: 0].
        opacity: The fraction of light that the surface meets, 0 to 1 [default: 1].
    """

    metal: str | None = None
    ior: Color | None = None
    extinction: Color | None = None
    roughness: float | None = None
    emission: Color | None = None
    opacity: float | None = None
    _type, _colors = "conductor", ("ior", "extinction", "emission")


@dataclass(frozen=True)
class Dielectric(_Table):
    """Glass, a crystal or a liquid. `Glass` is a shorter name.

    Args:
        ior: The index of refraction relative to vacuum, 0.1 to 10: water 1.33, glass 1.5, diamond
            2.42; or else `glass`.
        glass: A name: "water", "ice", "bk7", "f2", "sf11", "acrylic", "sapphire", "diamond", ...
        roughness: 0 is polished, 0.2 etched, 0.5 frosted, up to 1 [default: 0].
        priority: Where such spheres overlap, the one with the higher number fills the common part
            [default: 0].
        absorption: The coefficient a per unit of length, from 0: exp(-a d) of the light is left
            after a distance d [default: 0].
        emission: Radiance in W/(sr m^2), from 0 [default: 0].
        opacity: The fraction of light that the surface meets, 0 to 1 [default: 1].
    """

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
    """A diffuse base under a clear coat: plastics, lacquered wood, glazed clay.

    Args:
        albedo: Of the base, 0 to 1 [default: 0.5].
        ior: The index of refraction of the coat, 1 to 10 [default: 1.5].
        roughness: Of the coat: 0 is varnished, 0.5 satin, up to 1 [default: 0].
        emission: Radiance in W/(sr m^2), from 0 [default: 0].
        opacity: The fraction of light that the surface meets, 0 to 1 [default: 1].
    """

    albedo: Color = 0.5
    ior: float | None = None
    roughness: float | None = None
    emission: Color | None = None
    opacity: float | None = None
    _type, _colors = "plastic", ("albedo", "emission")


@dataclass(frozen=True)
class Principled(_Table):
    """The material with many knobs that modelling programs share. All are from 0 to 1.

    Args:
        base_color: Of the diffuse part, of metal at normal incidence, and of transmitted light
            [default: 0.5].
        metallic: The fraction that is metal [default: 0].
        roughness: Of metal, gloss and glass alike; 0 is polished [default: 0.5].
        specular: The strength of the gloss; 0.5 is as `ior` says [default: 0.5].
        ior: The index of refraction of gloss and glass, 1 to 10 [default: 1.5].
        coat: The strength of a clear coat [default: 0].
        coat_roughness: The roughness of the coat [default: 0].
        transmission: The fraction of the rest that is glass [default: 0].
        emission: Radiance in W/(sr m^2), from 0 [default: 0].
        opacity: The fraction of light that the surface meets [default: 1].
    """

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
    """Phong's model, for comparison with old pictures.

    Args:
        albedo: The diffuse albedo, 0 to 1 [default: 0.5].
        specular: The specular albedo, 0 to 1 [default: 0.3].
        exponent: Larger ones give narrower highlights, 0 to 100000 [default: 50].
        normalized: False is Phong's original form, which may create energy [default: True].
        emission: Radiance in W/(sr m^2), from 0 [default: 0].
        opacity: The fraction of light that the surface meets, 0 to 1 [default: 1].
    """

    albedo: Color = 0.5
    specular: Color = 0.3
    exponent: float = 50.0
    normalized: bool | None = None
    emission: Color | None = None
    opacity: float | None = None
    _type, _colors = "phong", ("albedo", "specular", "emission")


def Glass(glass: str | float = 1.5, **keys: Any) -> Dielectric:
    """Glass by name ("bk7", "water", "diamond") or by index of refraction.

    Args:
        glass: The name or the index, 0.1 to 10.
        keys: Those of `Dielectric`, such as roughness=0.2 or absorption=(0.1, 0.2, 0.3).
    """
    if isinstance(glass, str):
        return Dielectric(glass=glass, **keys)
    return Dielectric(ior=float(glass), **keys)


def Metal(metal: str = "silver", roughness: float | None = None, **keys: Any) -> Conductor:
    """A metal by name.

    Args:
        metal: "gold", "silver", "copper", "aluminium", "iron", ...
        roughness: 0 is polished, 0.3 brushed, 1 the most matte [default: 0].
        keys: Those of `Conductor`.
    """
    return Conductor(metal=metal, roughness=roughness, **keys)


def Light(emission: Color) -> Diffuse:
    """A surface that emits this radiance, in W/(sr m^2), and reflects nothing."""
    return Diffuse(albedo=0.0, emission=emission)


Material = Union[Diffuse, Mirror, Conductor, Dielectric, Plastic, Principled, Phong]


@dataclass(frozen=True)
class Camera(_Table):
    """A pinhole, or a thin lens if `aperture_radius` is given. Lengths are in units of the scene.

    Args:
        position: The centre of the lens.
        look_at: The point in the middle of the picture.
        up: The direction that points up in the picture [default: y; in scenes of particles z, or
            what their option `up` says].
        near: Rays ignore what is nearer than this along the view axis [default: 0].
        vertical_fov_degrees: The vertical field of view, above 0, below 180 [default: 36].
        aperture_radius: 0 is a pinhole, which keeps everything in focus [default: 0].
        focus_distance: From the lens to the plane in focus [default: that of `look_at`].
        focus_on: Instead of it, the name of a sphere, or "TABLE:ROW".
        focus_on_pixel: Instead of it, the column and the row of a pixel.
        blades: Corners of the aperture, 3 to 64; 0 is a disk [default: 0].
        rotation_degrees: Turns a polygonal aperture, -360 to 360 [default: 0].
        f_number: Instead of `aperture_radius`, that of a lens before a film 24 mm high.
        meters_per_unit: With `f_number`, the length of a unit of the scene [default: 1].
        fit: Places the camera so that it sees all that the scene shows; then without `position` and
            `look_at` [default: False].
        direction: With `fit`, from where: "iso", an axis such as "-y", "AZIMUTH,ELEVATION" in
            degrees, or three numbers [default: "iso"].
        margin: With `fit`, the share of the picture that stays free on each side, 0 to 0.49
            [default: 0.05].
        right_margin: With `fit`, that of the right side [default: `margin`, and room for the colour
            bar or the legend of particles].
    """

    position: Vector | None = None
    look_at: Vector | None = None
    up: Vector | None = None
    near: float | None = None
    vertical_fov_degrees: float | None = None
    aperture_radius: float | None = None
    focus_distance: float | None = None
    focus_on: str | None = None
    focus_on_pixel: Sequence[int] | None = None
    blades: int | None = None
    rotation_degrees: float | None = None
    f_number: float | None = None
    meters_per_unit: float | None = None
    fit: bool | None = None
    direction: str | Vector | None = None
    margin: float | None = None
    right_margin: float | None = None


def ThinLens(
    position: Vector, look_at: Vector, *, aperture_radius: float, **keys: Any
) -> Camera:
    """A camera with depth of field: `Camera` with an aperture.

    Args:
        position: The centre of the lens.
        look_at: The point in the middle of the picture, which is in focus unless `focus_distance` or
            `focus_on` says otherwise.
        aperture_radius: In units of the scene.
        keys: Those of `Camera`.
    """
    return Camera(position, look_at, aperture_radius=aperture_radius, **keys)


@dataclass(frozen=True)
class Orthographic(_Table):
    """A camera of parallel rays. Lengths are in units of the scene.

    Args:
        position: The middle of the plane from which the rays start.
        look_at: The point in the middle of the picture.
        height: The height of the visible area [default: what 36 degrees show at `look_at`].
        up: The direction that points up in the picture [default: as for `Camera`].
        near: Rays ignore what is nearer than this [default: 0].
        fit, direction, margin, right_margin: As for `Camera`.
    """

    position: Vector | None = None
    look_at: Vector | None = None
    height: float | None = None
    up: Vector | None = None
    near: float | None = None
    fit: bool | None = None
    direction: str | Vector | None = None
    margin: float | None = None
    right_margin: float | None = None
    _type = "orthographic"


@dataclass(frozen=True)
class Panoramic(_Table):
    """A camera that sees all around: columns are longitudes, rows are latitudes.

    Args:
        position: The point from which the rays start.
        look_at: A point in the middle of the picture.
        up: The direction that points up in the picture [default: as for `Camera`].
        near: Rays ignore what is nearer than this [default: 0].
        horizontal_extent_degrees: Above 0, at most 360 [default: 360].
        vertical_extent_degrees: Above 0, at most 180 [default: 180].
        fit, direction, margin, right_margin: As for `Camera`.
    """

    position: Vector | None = None
    look_at: Vector | None = None
    up: Vector | None = None
    near: float | None = None
    horizontal_extent_degrees: float | None = None
    vertical_extent_degrees: float | None = None
    fit: bool | None = None
    direction: str | Vector | None = None
    margin: float | None = None
    right_margin: float | None = None
    _type = "panoramic"


AnyCamera = Union[Camera, Orthographic, Panoramic]


@dataclass(frozen=True)
class Gradient(_Table):
    """A background that is linear in the sine of the elevation. Radiance in W/(sr m^2), from 0.

    Args:
        zenith: From straight above [default: 1].
        horizon: From the horizon [default: 1].
        nadir: From straight below [default: `horizon`].
    """

    zenith: Color = 1.0
    horizon: Color = 1.0
    nadir: Color | None = None
    _colors = ("zenith", "horizon", "nadir")


@dataclass(frozen=True)
class EnvironmentMap(_Table):
    """A picture of all directions, in latitude and longitude.

    Args:
        file: An .exr or .hdr picture, twice as wide as high, in linear Rec. 709.
        rotation_degrees: Turns it about `up`, counterclockwise from above, -360 to 360 [default: 0].
        scale: Multiplies its radiance, 0 to 1e6 [default: 1].
    """

    file: str
    rotation_degrees: float | None = None
    scale: float | None = None


@dataclass(frozen=True)
class Sky(_Table):
    """A clear sky (Preetham, Shirley and Smits 1999), for the sun beside it.

    `[Sky(), Sun(...)]` is a sky with its sun. Without one, the sun stands 45 degrees high, as bright
    as on a clear day.

    Args:
        turbidity: 2 is very clear air, 3 clear, 6 warm and moist, 10 hazy [default: 3].
        ground_albedo: Of the ground below the horizon, 0 to 1 [default: 0.2].
        scale: Multiplies the radiance, which is 20 to 50 W/(sr m^2) for 1: 0.01 suits a screen. The
            sun of a clear day has the irradiance 500 times this [default: 0.01].
    """

    turbidity: float | None = None
    ground_albedo: Color | None = None
    scale: float | None = 0.01
    _colors = ("ground_albedo",)


@dataclass(frozen=True)
class Sun(_Table):
    """A sun. Its direction is given, or by two angles.

    Args:
        direction: Towards the sun, of any length [default: by the angles].
        irradiance: W/m^2 on a surface that faces it, from 0: 500 on a clear day, 1 to 5 suits a
            screen [default: 2].
        elevation_degrees: Above the horizon, -90 to 90 [default: 0].
        azimuth_degrees: From -z to the right (+x) where y is up, -360 to 360 [default: 0].
        angular_diameter_degrees: How large it looks, 0.001 to 180 [default: 0.533].
    """

    direction: Vector | None = None
    irradiance: Color = 2.0
    elevation_degrees: float | None = None
    azimuth_degrees: float | None = None
    angular_diameter_degrees: float | None = None
    _colors = ("irradiance",)


@dataclass(frozen=True)
class Background(_Table):
    """What a ray sees when it hits nothing: at most one of radiance, gradient, image and sky.

    Args:
        radiance: From all directions, in W/(sr m^2), from 0 [default: 0].
        gradient: From the zenith to the nadir.
        image: A picture of all directions.
        sky: A clear sky; needs a sun.
        sun: A sun, which may stand beside each of the others.
        up: The direction of the zenith [default: y; in scenes of particles, what is up there].
        camera_visible: Whether the camera sees it; it lights the scene either way [default: True,
            unless transparent].
        transparent: Adds an alpha channel, 0 where the camera sees nothing [default: False].
        backdrop: What the camera sees behind everything; it lights nothing [default: the background].
    """

    radiance: Color | None = None
    gradient: Gradient | None = None
    image: EnvironmentMap | None = None
    sky: Sky | None = None
    sun: Sun | None = None
    up: Vector | None = None
    camera_visible: bool | None = None
    transparent: bool | None = None
    backdrop: Color | None = None
    _colors = ("radiance", "backdrop")

    def toml(self) -> dict[str, Any]:
        """The keys that are given, as the scene file has them."""
        table = super().toml()
        return {key: one.toml() if isinstance(one, _Table) else one for key, one in table.items()}


AnyBackground = Union[Background, Gradient, EnvironmentMap, Sky, Sun, Color]

#: What the sun sends on a clear day, in W/m^2 in every channel.
_CLEAR_SUN = 500.0

_PLACES = {Gradient: "gradient", EnvironmentMap: "image", Sky: "sky", Sun: "sun"}


def background_table(given: AnyBackground | Sequence[AnyBackground]) -> dict[str, Any]:
    """The table of a background: one object, several such as a sky and a sun, or a radiance."""
    if hasattr(given, "tolist"):
        given = given.tolist()
    if given == "none":
        return {"transparent": True}
    parts: list[Any] = [given] if not isinstance(given, (list, tuple)) else list(given)
    if isinstance(given, str) or all(isinstance(part, (int, float)) for part in parts):
        return {"radiance": _color(given, "background")}
    table: dict[str, Any] = {}
    for part in parts:
        if isinstance(part, Background):
            table.update(part.toml())
        elif type(part) in _PLACES:
            table[_PLACES[type(part)]] = part.toml()
        else:
            expected = "a radiance, a colour, or objects such as Sky() and Sun()"
            raise TypeError(f"background: expected {expected}, not {part!r}")
    if "sky" in table and "sun" not in table:
        table["sun"] = _sun_of_sky(table["sky"])
    return table


def _sun_of_sky(sky: dict[str, Any]) -> dict[str, Any]:
    """The sun of a sky that is given without: as bright as on a clear day."""
    irradiance = [_CLEAR_SUN * float(sky.get("scale", 1.0))] * 3
    return {"elevation_degrees": 45.0, "azimuth_degrees": 135.0, "irradiance": irradiance}


def camera_table(given: AnyCamera, up: list[int] | None = None) -> dict[str, Any]:
    """The table of a camera. If it says not what is up, `up` is, or another axis where the camera
    looks along that one."""
    if not isinstance(given, (Camera, Orthographic, Panoramic)):
        expected = "Camera, ThinLens, Orthographic or Panoramic"
        raise TypeError(f"camera: expected {expected}, not {given!r}")
    table = given.toml()
    if up is not None and "up" not in table:
        if not {"position", "look_at"} <= set(table):
            return {**table, "up": up}
        along = [b - a for a, b in zip(table["position"], table["look_at"])]
        sideways = [one for one, axis in zip(along, up) if axis == 0]
        table["up"] = up if any(sideways) else [up[2], up[0], up[1]]
    return table


@dataclass(frozen=True)
class Sphere(_Table):
    """A sphere of its own.

    Args:
        center: Three numbers within 1e15.
        radius: From 1e-15 to 1e15.
        material: A material, or the name of one [default: `Diffuse()`].
        name: For messages, Cryptomatte and `Pick`.
        shadow_catcher: Whether the camera sees only the shadow that others cast on it
            [default: False].
    """

    center: Vector
    radius: float
    material: Material | str = dataclasses.field(default_factory=Diffuse)
    name: str | None = None
    shadow_catcher: bool | None = None


@dataclass(frozen=True, eq=False)
class Spheres:
    """Many spheres of one material, from arrays.

    Args:
        center: (n, 3), any type of numbers, within 1e15.
        radius: One number, or (n,), positive.
        material: A material or the name of one [default: `Diffuse()`].
        color: (n, 3), linear Rec. 709, 0 to 1: replaces the colour of the material.
        emission: (n, 3), radiance in W/(sr m^2), from 0.
        ids: (n,) whole numbers from 0 to 4294967294 for the layer `sphere_id`, instead of rows of
            the scene.
        name: For Cryptomatte and messages.
        color_space: What the numbers of `color` are: "linear", or "srgb" for those of screens and
            colour maps [default: "linear"].
    """

    center: Any
    radius: Any
    material: Material | str = dataclasses.field(default_factory=Diffuse)
    color: Any = None
    emission: Any = None
    ids: Any = None
    name: str | None = None
    color_space: str | None = None
