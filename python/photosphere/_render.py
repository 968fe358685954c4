"""Renders: they progress, stop, go on, and can be merged."""

from __future__ import annotations

import json
import os
import re
import threading
import time
import warnings
import weakref
from collections.abc import AsyncIterator, Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _core
from ._errors import Error
from ._picture import Picture, denoiser_package

if TYPE_CHECKING:
    from ._scene import Scene

__all__ = ["Part", "Render", "merge", "resume"]

#: Scenes of renders by the paths of their checkpoints: those of arrays are in no file.
_scenes: weakref.WeakValueDictionary[str, Scene] = weakref.WeakValueDictionary()

#: How long an interrupt waits for the samples that are being rendered, in seconds.
_PATIENCE = 0.25


class Render:
    """A render that runs on threads of its own.

    `Scene.start` and `resume` make one. In a notebook it shows a picture that gets better. A render
    that is no longer referenced stops.
    """

    def __init__(self, core: _core.Render, scene: Scene | None, options: dict[str, Any]) -> None:
        self._core, self._scene, self._options = core, scene, options
        self._has_warned = False
        #: The denoised picture, and the samples that it was made of.
        self._denoised: tuple[int, Picture] | None = None
        self._saved = False
        if options.get("preview") is not None:
            self._save_previews(options)

    @classmethod
    def _start(cls, scene: Scene, options: dict[str, Any]) -> Render:
        words, changes = scene._split(options)
        _check_output(options.get("output"))
        if options.get("denoise") is True:
            _core.check_denoiser(denoiser_package())
        if options.get("preview_every") is not None and options.get("preview") is None:
            raise TypeError("preview_every: there is no preview: preview=\"a.png\"")
        checkpoint = options.get("checkpoint")
        if checkpoint is not None:
            _scenes[os.path.abspath(checkpoint)] = scene
        core = _core.Render.start(scene._core, words, changes, _columns(scene))
        return cls(core, scene, options)

    def wait(self, timeout: float | None = None) -> Render:
        """Waits until the render ends, or for this many seconds.

        Raises:
            Error: The scene is wrong, or the render failed.
            KeyboardInterrupt: By Ctrl-C or an interrupt of the kernel. The render has stopped, and
                `picture` has the samples so far.
        """
        try:
            ended = self._core.wait(timeout)
        except KeyboardInterrupt:
            self._core.stop()
            self._core.wait(_PATIENCE)
            raise
        if ended:
            self._core.check()
            self._finish()
        return self

    def stop(self) -> Render:
        """Stops the render, and waits until it has stopped."""
        self._core.stop()
        self._core.wait(None)
        return self

    def extend_to(self, spp: int) -> Render:
        """Goes on until every pixel has this number of samples; waits for a run before it.

        Returns:
            The render, which runs: `wait` for it.
        """
        self.wait()
        self._core.extend_to(spp)
        self._saved = False
        return self

    @property
    def running(self) -> bool:
        """True until all samples are rendered, or the render has stopped."""
        return self._core.is_running()

    @property
    def picture(self) -> Picture:
        """The picture so far. With denoise=True it is denoised when the render has ended.

        Raises:
            Error: There are no samples yet, or the render failed.
        """
        while self._core.is_running() and not self.samples:
            self._core.wait(0.02)
        has_ended = not self._core.is_running()
        picture = Picture(self._core.picture(), self._scene, self._options)
        return self._denoise(picture) if has_ended and self._core.denoises() else picture

    @property
    def error(self) -> float | None:
        """The estimated error that 95 % of the values stay below, relative to the brightness."""
        progress = self._progress(True)
        return progress["error"] if progress else None

    @property
    def samples(self) -> int:
        """The samples so far, over all pixels."""
        progress = self._progress(False)
        return int(progress["samples"]) if progress else 0

    @property
    def spp(self) -> float:
        """The samples so far, per pixel."""
        progress = self._progress(False)
        return float(progress["spp"]) if progress else 0.0

    @property
    def left(self) -> float | None:
        """The time left in seconds, at most; None if unknown."""
        progress = self._progress(False)
        return progress["left"] if progress else None

    @property
    def reason(self) -> str | None:
        """Why the render ended: "finished", "time", "noise target missed", "stopped", "failed"."""
        return self._report()["reason"]

    @property
    def warnings(self) -> list[str]:
        """What is worth knowing of the scene and the picture."""
        return list(self._report()["warnings"])

    @property
    def part(self) -> Part:
        """The samples so far, to be merged or resumed."""
        return Part(self._core.checkpoint())

    def save(self, path: str | os.PathLike[str], **look: Any) -> Path:
        """Saves the picture so far; see `Picture.save`."""
        return self.picture.save(path, **look)

    def stream(self, every: float = 1.0) -> Iterator[Picture]:
        """The picture so far, again and again, and at the end."""
        while not self._core.wait(every):
            if self.samples:
                yield self.picture
        self.wait()
        yield self.picture

    async def __aiter__(self) -> AsyncIterator[Picture]:
        import asyncio

        while self._core.is_running():
            await asyncio.sleep(0.5)
            if self._core.is_running() and self.samples:
                yield self.picture
        self.wait()
        yield self.picture

    def __repr__(self) -> str:
        return f"<render: {self._line()}>"

    # Notebooks.

    def _ipython_display_(self) -> None:
        from IPython.display import display  # type: ignore[import-not-found,unused-ignore]

        handle = display(_Frame(self), display_id=True)
        if handle is None or not self.running:
            return

        _watch(self, 1.0, lambda render: handle.update(_Frame(render)))

    def _repr_png_(self) -> bytes | None:
        return self.picture._repr_png_() if self.samples else None

    # What follows is not for users.

    def _denoise(self, picture: Picture) -> Picture:
        samples = self.samples
        if self._denoised is None or self._denoised[0] != samples:
            try:
                self._denoised = samples, picture.denoise()
            except Error as error:
                # The samples are more than the library.
                warnings.warn(f"the picture is not denoised: {error}", stacklevel=3)
                return picture
        return self._denoised[1]

    def _progress(self, with_error: bool) -> dict[str, Any] | None:
        return json.loads(self._core.progress(with_error))

    def _report(self) -> dict[str, Any]:
        return json.loads(self._core.report())

    def _line(self) -> str:
        try:
            progress = self._progress(True)
        except RuntimeError:
            return "of another process"
        if progress is None:
            return "reading the scene" if self.running else "stopped before the first sample"
        parts = [f"{progress['spp']:.4g} samples per pixel"]
        if progress["error"] is not None:
            parts.append(f"error {100 * progress['error']:.3g} %")
        if not self.running:
            parts.append(self.reason or "")
        elif progress["left"] is not None:
            minutes, seconds = divmod(round(progress["left"]), 60)
            parts.append(f"{minutes}:{seconds:02} left")
        return ", ".join(part for part in parts if part)

    def _finish(self) -> None:
        if not self._has_warned and not self._options.get("quiet"):
            for text in self.warnings:
                warnings.warn(text, stacklevel=3)
        self._has_warned = True
        output = self._options.get("output")
        if output is not None and not self._saved:
            self._saved = True
            for path in _paths(output):
                target = self.part if path.lower().endswith(".part") else self
                target.save(path)

    def _save_previews(self, options: dict[str, Any]) -> None:
        def save(render: Render) -> None:
            if render.samples:
                try:
                    render.save(options["preview"])
                except Exception as error:
                    warnings.warn(f"the preview is not written: {error}", stacklevel=2)

        _watch(self, _seconds(options.get("preview_every", 2.0)), save)


def _watch(render: Render, every: float, show: Callable[[Render], object]) -> None:
    """Calls `show` every so many seconds, and once more when the render has ended.

    The thread ends when nobody else holds the render, and before the interpreter does: a thread
    that is in Rust then would crash the process.
    """
    watched = weakref.ref(render)
    main = threading.main_thread()

    def run() -> None:
        since = time.monotonic()
        while main.is_alive():
            one = watched()
            if one is None:
                return
            if not one._core.is_running():
                show(one)
                return
            if time.monotonic() - since >= every:
                show(one)
                since = time.monotonic()
            # Not held while it sleeps: the last reference ends a render.
            del one
            time.sleep(min(every, 0.1))

    threading.Thread(target=run, name="photosphere watch").start()


class _Frame:
    """A render as a notebook shows it at one time."""

    def __init__(self, render: Render) -> None:
        self._line = render._line()
        self._png = render._repr_png_()

    def _repr_mimebundle_(self, **_: Any) -> dict[str, str]:
        import html
        from base64 import b64encode

        line = html.escape(self._line)
        if self._png is None:
            return {"text/plain": self._line, "text/html": f"<em>{line}</em>"}
        data = b64encode(self._png).decode()
        picture = f'<img src="data:image/png;base64,{data}" style="max-width:100%">'
        return {
            "text/plain": self._line,
            "text/html": f"<figure>{picture}<figcaption>{line}</figcaption></figure>",
        }


class Part:
    """Samples of a render: the bytes of a `.part` file. It can be pickled and sent anywhere."""

    def __init__(self, data: bytes) -> None:
        self._data = data

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Part:
        """Reads a `.part` file or a checkpoint."""
        return cls(Path(path).read_bytes())

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Writes a file that `photosphere merge` and `merge` read."""
        path = Path(path)
        path.write_bytes(self._data)
        return path

    def __bytes__(self) -> bytes:
        return self._data

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Part) and self._data == other._data

    def __hash__(self) -> int:
        return hash(self._data)

    def __repr__(self) -> str:
        return f"<part of {len(self._data)} bytes>"


def merge(
    parts: Iterable[Part | str | os.PathLike[str]],
    *,
    layers: Sequence[str] | str | None = None,
    crop: tuple[int, int, int, int] | None = None,
    allow_gaps: bool = False,
) -> Picture:
    """The picture of parts of one render, whose pixels are those of a single render, bit for bit.

    Args:
        parts: Parts, or names of their files, in any order. No two have a sample in common.
        layers: The layers of the picture [default: those of the parts].
        crop: The window that parts with crops fill together.
        allow_gaps: Merge even if pixels or samples are missing.
    """
    import tempfile

    names = layers.split(",") if isinstance(layers, str) else layers
    if isinstance(parts, (Part, str, os.PathLike)):
        raise TypeError(f"parts: expected several, not {parts!r}")
    if crop is not None and len(crop) != 4:
        raise ValueError(f"crop: expected (x0, y0, x1, y1), not {crop!r}")
    with tempfile.TemporaryDirectory() as folder:
        paths, named = [], {}
        for at, part in enumerate(parts):
            if isinstance(part, Part):
                path = Path(folder) / f"{at}.part"
                part.save(path)
                named[os.fspath(path)] = f"parts[{at}]"
            elif isinstance(part, (str, os.PathLike)):
                path = Path(part)
            else:
                raise TypeError(f"parts: expected parts or their files, not {part!r}")
            paths.append(os.fspath(path))
        wanted = None if names is None else list(names)
        box = None if crop is None else list(crop)
        try:
            core, missed = _core.merge(paths, wanted, box, allow_gaps)
        except Error as error:
            raise error._renamed(named) from None
    for text in missed:
        warnings.warn(text, stacklevel=2)
    return Picture(core, None, {})


def resume(
    checkpoint: str | os.PathLike[str] | Part,
    *,
    scene: Scene | None = None,
    extend_to: int | None = None,
    threads: int = 0,
) -> Render:
    """Goes on with a render from its checkpoint.

    Args:
        checkpoint: The file that the render saved, which is saved further on; or a part.
        scene: The scene, if it was made of arrays or objects, unless this process started the
            render and still has it.
        extend_to: Render until every pixel has this number of samples.
        threads: The number of threads; 0 is one for each core.

    Raises:
        Error: The checkpoint is damaged, or the scene has changed.
    """
    data = bytes(checkpoint) if isinstance(checkpoint, Part) else None
    path = None if isinstance(checkpoint, Part) else os.fspath(checkpoint)
    if path is not None:
        os.stat(path)
        known = _scenes.get(os.path.abspath(path))
        if scene is None and known is not None and known._path is None:
            scene = known
    core_scene = None if scene is None else scene._core
    core = _core.Render.resume(path, data, core_scene, extend_to, threads, _columns(scene))
    return Render(core, scene, {})


def _columns(scene: Scene | None) -> list[tuple[str, Any]] | None:
    """The columns of numbers of arrays, and their rows, which may be layers."""
    particles = None if scene is None or scene._path is not None else scene._particles
    if particles is None:
        return None
    named = particles._columns.items()
    numbers = [(name, array) for name, array in named if array.dtype.kind in "fiub"]
    return [*numbers, ("row", particles._all_rows())]


def _seconds(given: Any) -> float:
    if isinstance(given, (int, float)):
        return float(given)
    match = re.fullmatch(r"([0-9.]+)(ms|s|m|h)?", str(given))
    if not match:
        raise ValueError(f"preview_every: expected a time such as 2s, not {given!r}")
    return float(match[1]) * {"ms": 1e-3, "s": 1.0, "m": 60.0, "h": 3600.0, None: 1.0}[match[2]]


#: The endings of files that a picture is written to.
_ENDINGS = (".png", ".exr", ".hdr", ".pfm", ".part")


def _paths(output: Any) -> list[str]:
    named = [output] if isinstance(output, (str, os.PathLike)) else output
    return [os.fspath(path) for path in named]


def _check_output(output: Any) -> None:
    """Refuses, before any sample is rendered, what could not be written after the last one."""
    if output is None:
        return
    try:
        paths = _paths(output)
    except TypeError:
        raise TypeError(f"output: expected a path, or several, not {output!r}") from None
    for path in paths:
        folder, ending = os.path.dirname(path) or ".", os.path.splitext(path)[1].lower()
        if ending not in _ENDINGS:
            expected = f"a name that ends in {', '.join(_ENDINGS)}"
            raise ValueError(f"output: expected {expected}, not {path!r}")
        if not os.path.isdir(folder):
            raise FileNotFoundError(f"output: there is no folder {folder!r} for {path!r}")
