"""hmesh: an image as a triangle mesh with one colour a vertex.

    import hmesh
    mesh = hmesh.mesh_image(array, vertices=5000)    # (h, w) or (h, w, c): uint8, uint16 or float32
    mesh.positions, mesh.colors, mesh.faces          # numpy arrays
    mesh.write("picture.glb")

The mesh is that of the C++ library and of the command, byte for byte, for any number of threads. Errors are ValueErrors and
TypeErrors whose sentences name the value and its bound.
"""

from __future__ import annotations

import io
import math
import os
import secrets
from collections.abc import Callable, Sequence
from typing import Any, BinaryIO, Literal, NamedTuple, Optional, Union

import numpy as np

from . import _core

__all__ = ["CompactImage", "Mesh", "Progress", "Report", "compact_image", "mesh_image", "mesh_terrain", "psnr", "read"]
__version__: str = _core.version

max_channels: int = _core.max_channels
"""The most channels that an image may have: 16, or fewer where the module was built so."""

Effort = Literal["draft", "fast", "normal", "fine", "best"]
TerrainEffort = Literal["draft", "fast", "normal", "best"]
Axes = Literal["none", "x", "y", "xy"]
SampleGrid = Literal["squares", "points"]

_EFFORTS = ("draft", "fast", "normal", "fine", "best")
_TERRAIN_EFFORTS = ("draft", "fast", "normal", "best")
_AXES = ("none", "x", "y", "xy")
_GRIDS = ("squares", "points")
_COLORS = ("optimal", "sampled")
_SVG_KINDS = ("gradient", "exact", "flat")
_HMC_COLORS = (8, 16, 32)


def _number_of(name: str, words: Sequence[str], word: object) -> int:
    """The place of a word among those that are known."""
    if isinstance(word, str) and word in words:
        return words.index(word)
    raise ValueError(f"{name} must be one of {', '.join(words)}, and is {word!r}")


class Report(NamedTuple):
    """What mesh_image() says of its mesh. With weights a pixel, and a channel, counts with its weight / the largest one."""

    vertices: int
    """Number of vertices; of a periodic mesh each counts once."""
    faces: int
    """Number of faces."""
    energy: float
    """Sum of squared differences over pixels and channels, in squares of stored values."""
    psnr: float
    """dB: 10 log10(peak^2 / MSE), with the MSE the mean over pixels and channels, of the mesh drawn at its own size."""
    max_error: float
    """Largest difference to a sample, in stored values; samples of weight 0 do not count."""
    stages: list[dict[str, Any]]
    """Name, vertices, energy and psnr after each stage of the method."""
    message: str
    """Why the mesh is not what was asked for, such as a PSNR out of reach; empty where it is."""


class Progress(NamedTuple):
    """How far the work is, as the callback of mesh_image() is told."""

    stage: str
    """The name of the stage."""
    fraction: float
    """How much of the stage is done, 0 to 1."""
    vertices: int
    """Number of vertices so far."""
    energy: float
    """Squared error so far; 0 before there is a mesh."""
    total: float
    """An estimate of how much of the whole call is done, 0 to 1."""
    mesh: Optional[Callable[[], "Mesh"]]
    """Makes the mesh so far, during this call of the callback alone; None where the work offers none."""


class Mesh:
    """A triangle mesh with one colour a vertex.

    positions: (n, 2) float32, x and y of each vertex in px of the image, y down
    colors:    (n, channels) float32, in the image's stored values; `peak` is full intensity
    faces:     (m, 3) uint32, the vertices of each face, clockwise on the screen

    Meshes of mesh_image() have a report, others None. The arrays may be changed in place.
    """

    __slots__ = ("positions", "colors", "faces", "width", "height", "peak", "premultiplied", "periodic", "samples", "report")

    positions: np.ndarray
    colors: np.ndarray
    faces: np.ndarray
    width: int
    height: int
    peak: float
    premultiplied: bool
    periodic: str
    samples: str
    report: Optional[Report]

    def __init__(
        self,
        positions: Any,
        colors: Any,
        faces: Any,
        *,
        width: int,
        height: int,
        peak: float = 255,
        premultiplied: bool = False,
        periodic: Axes = "none",
        samples: SampleGrid = "squares",
    ) -> None:
        self.positions = _packed(_unmasked("positions", positions), np.float32)
        self.colors = _packed(_unmasked("colors", colors), np.float32)
        self.faces = _indices(_unmasked("faces", faces))
        self.width = _whole("width", width, -(2**63), 2**63 - 1)
        self.height = _whole("height", height, -(2**63), 2**63 - 1)
        self.peak = _real("peak", peak)
        self.premultiplied = bool(premultiplied)
        self.periodic = _AXES[_number_of("periodic", _AXES, periodic)]
        self.samples = _GRIDS[_number_of("samples", _GRIDS, samples)]
        self.report = None
        self._check()

    @classmethod
    def _of(cls, core: dict[str, Any]) -> "Mesh":
        mesh = cls.__new__(cls)
        mesh.positions, mesh.colors, mesh.faces = core["positions"], core["colors"], core["faces"]
        mesh.width, mesh.height, mesh.peak = core["width"], core["height"], core["peak"]
        mesh.premultiplied = core["premultiplied"]
        mesh.periodic, mesh.samples = _AXES[core["periodic"]], _GRIDS[core["samples"]]
        mesh.report = Report(**core["report"]) if "report" in core else None
        return mesh

    def _check(self) -> None:
        for name, array, width in (("positions", self.positions, 2), ("faces", self.faces, 3)):
            if array.ndim != 2 or array.shape[1] != width:
                raise ValueError(f"{name} must be of shape (n, {width}), and are of {array.shape}")
        if self.colors.ndim != 2 or not 1 <= self.colors.shape[1] <= 16:
            raise ValueError(f"colors must be of shape (n, 1) to (n, 16), and are of {self.colors.shape}")
        if len(self.colors) != len(self.positions):
            raise ValueError(f"there must be as many colors as positions, and there are {len(self.colors)} and "
                             f"{len(self.positions)}")

    def _core(self) -> dict[str, Any]:
        self._check()
        return {
            "positions": _packed(_unmasked("positions", self.positions), np.float32),
            "colors": _packed(_unmasked("colors", self.colors), np.float32),
            "faces": _indices(_unmasked("faces", self.faces)),
            "width": self.width,
            "height": self.height,
            "peak": self.peak,
            "premultiplied": self.premultiplied,
            "periodic": _number_of("periodic", _AXES, self.periodic),
            "samples": _number_of("samples", _GRIDS, self.samples),
        }

    def __getstate__(self) -> tuple[Any, ...]:
        return tuple(getattr(self, name) for name in self.__slots__)

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        for name, value in zip(self.__slots__, state):
            setattr(self, name, value)

    def __repr__(self) -> str:
        return (f"<hmesh.Mesh of {self.width} x {self.height} px: {len(self.positions)} vertices, {len(self.faces)} faces, "
                f"{self.channels} channels>")

    @property
    def channels(self) -> int:
        """Samples of a colour; of 2 or 4 the last is alpha."""
        return int(self.colors.shape[1])

    def render(
        self,
        width: Optional[int] = None,
        height: Optional[int] = None,
        *,
        linear: bool = False,
        dtype: Any = np.float32,
        threads: int = 0,
    ) -> np.ndarray:
        """The mesh drawn, (height, width, channels), as a GPU draws it.

        width, height: px of the picture, 1 to 65536 and at most 2^28 in all; by default those of the mesh
        linear: interpolates linear light between sRGB colours rather than the stored values
        dtype: float32 for stored values as they are; uint8 or uint16 for them scaled from `peak` to the type's largest, rounded
            and held to its range
        """
        sides = [None if side is None else _whole(name, side, 1, 65536) for name, side in (("width", width), ("height", height))]
        picture = _core.render(self._core(), *sides, bool(linear), _threads(threads))
        dtype = np.dtype(dtype)
        if dtype == np.float32:
            return picture
        if dtype not in (np.uint8, np.uint16):
            raise TypeError(f"dtype must be float32, uint8 or uint16, and is {dtype}")
        scale = np.iinfo(dtype).max / self.peak
        stored = picture.astype(np.float64)  # NumPy 1 would count by float32, which rounds some otherwise
        return np.clip(np.floor(stored * scale + 0.5), 0, np.iinfo(dtype).max).astype(dtype)

    def tobytes(self, format: str, **options: Any) -> bytes:
        """The bytes of a file of the mesh: write() says which formats and options there are."""
        _number_of("format", tuple(_OPTIONS), format)
        given = dict(_OPTIONS[format])
        for name, value in options.items():
            if name not in given:
                known = ", ".join(given) if given else "none"
                raise TypeError(f"format {format} has no option {name!r}; it has {known}")
            given[name] = value
        if format == "svg":
            given["kind"] = _number_of("kind", _SVG_KINDS, given["kind"])
        if format == "hmc":
            if given["color_bits"] not in _HMC_COLORS:
                raise ValueError(f"color_bits must be 8, 16 or 32, and is {given['color_bits']!r}")
            given["colors"] = _HMC_COLORS.index(given["color_bits"])
        return _core.write(self._core(), format, given)

    def write(self, target: Union[str, os.PathLike[str], BinaryIO], format: Optional[str] = None, **options: Any) -> None:
        """Writes the mesh to a file, whole or not at all, or to an object with write().

        format: by default as the path ends
            ply         ascii=False, float_colors=False
            obj
            glb         longer_side=1 (0: a pixel is a unit), quantized_positions=False, colors_are_linear=False, color_bits=16
            svg         kind="gradient" ("exact", "flat"), wireframe=False
            html        title="Triangle mesh"
            pdf, eps
            hmc         color_bits=8 (16, or 32 for the very floats): the compact file
            stl, height_ply, height_obj, height_glb
                        one channel as heights: channel=0, z_scale=1, z_offset=0, x_step=1, y_step=1; stl has base=None,
                        a height for a closed model
        """
        if format is None:
            name = os.fspath(target) if isinstance(target, (str, os.PathLike)) else ""
            format = os.path.splitext(name)[1][1:].lower()
            if not format:
                raise ValueError("format must be named where no file's ending tells it: one of " + ", ".join(_OPTIONS))
        data = self.tobytes(format, **options)
        if isinstance(target, (str, os.PathLike)):
            _write_whole(os.fspath(target), data)
        elif isinstance(getattr(target, "file", target), io.RawIOBase):  # as it is, or in what tempfile wraps it in
            rest = memoryview(data)
            while rest:
                taken = target.write(rest)  # no more at once than it likes
                if not taken:
                    raise BlockingIOError(f"the file took {len(data) - len(rest)} of {len(data)} bytes")
                rest = rest[taken:]
        elif hasattr(target, "write"):
            target.write(data)
        else:
            raise TypeError(f"target must be a path or an object with write(), and is of type {type(target).__name__}")

    def to_trimesh(self, **options: Any) -> Any:
        """The mesh as a trimesh.Trimesh in the plane z = 0, y up, with vertex colours; needs trimesh."""
        import trimesh

        if self.channels > 4:
            raise ValueError(f"trimesh's colours have 1 to 4 channels, and the mesh has {self.channels}")
        vertices = np.zeros((len(self.positions), 3))
        vertices[:, 0] = self.positions[:, 0]
        vertices[:, 1] = self.height - (self.samples == "points") - self.positions[:, 1]
        shares = self.colors.astype(np.float64) / self.peak
        if self.premultiplied and self.channels in (2, 4):
            np.divide(shares[:, :-1], shares[:, -1:], out=shares[:, :-1], where=shares[:, -1:] > 0)
        colors = np.clip(np.floor(shares * 255 + 0.5), 0, 255).astype(np.uint8)
        if self.channels < 3:
            colors = np.concatenate([np.repeat(colors[:, :1], 3, axis=1), colors[:, 1:]], axis=1)
        return trimesh.Trimesh(vertices, self.faces[:, ::-1], vertex_colors=colors[:, :4], process=False, **options)


_HEIGHTS: dict[str, Any] = {"channel": 0, "z_scale": 1.0, "z_offset": 0.0, "x_step": 1.0, "y_step": 1.0}
_OPTIONS: dict[str, dict[str, Any]] = {
    "ply": {"ascii": False, "float_colors": False},
    "obj": {},
    "glb": {"longer_side": 1.0, "quantized_positions": False, "colors_are_linear": False, "color_bits": 16},
    "svg": {"kind": "gradient", "wireframe": False},
    "html": {"title": "Triangle mesh"},
    "pdf": {},
    "eps": {},
    "hmc": {"color_bits": 8},
    "stl": {**_HEIGHTS, "base": None},
    "height_ply": _HEIGHTS,
    "height_obj": _HEIGHTS,
    "height_glb": _HEIGHTS,
}


def _write_whole(path: str, data: bytes) -> None:
    """Writes a file under another name, and gives it its own when it is whole. A symbolic link stays one, and what is no file,
    such as a pipe, is written to."""
    if os.path.exists(path) and not os.path.isfile(path):
        with open(path, "wb") as file:
            file.write(data)
        return
    path = os.path.realpath(path)
    part = os.path.join(os.path.dirname(path), f".hmesh-{secrets.token_hex(8)}.part")
    file = open(part, "xb")
    try:
        with file:
            try:
                os.chmod(part, os.stat(path).st_mode & 0o777)
            except FileNotFoundError:
                pass  # it has the mode of a new file already: umask() is the whole process's, and asking it sets it
            file.write(data)
        os.replace(part, path)
    except BaseException:
        os.unlink(part)
        raise


def _threads(threads: int) -> int:
    if isinstance(threads, bool) or not isinstance(threads, (int, np.integer)) or not 0 <= threads <= 1024:
        raise ValueError(f"threads must be 0, for all cores, or 1 to 1024, and is {threads!r}")
    return int(threads)


def _unmasked(name: str, values: Any) -> Any:
    """The values, which np.asarray() would take as they are behind a mask."""
    if np.ma.is_masked(values):
        raise TypeError(f"{name} must be numbers, and some are masked")
    return values


def _packed(array: Any, dtype: Any = None) -> np.ndarray:
    """An array whose numbers are one after another and aligned, which np.ascontiguousarray() does not see to."""
    return np.require(array, dtype, ("C_CONTIGUOUS", "ALIGNED", "ENSUREARRAY"))


def _indices(faces: Any) -> np.ndarray:
    """Faces as the core takes them; numbers that uint32 does not hold would become other vertices."""
    array = np.asarray(faces)
    if array.dtype.kind not in "uif":
        raise TypeError(f"faces must be numbers, and are of {array.dtype}")
    with np.errstate(invalid="ignore"):
        indices = _packed(array, np.uint32)
    if not np.array_equal(indices, array):
        raise ValueError("faces must be whole numbers from 0 to 4294967295")
    return indices


def _plain(array: np.ndarray) -> np.ndarray:
    """The array with bytes in this machine's order and pixels beside each other in rows that go forward; a copy only where it
    must be."""
    array = array.astype(array.dtype.newbyteorder("="), copy=False)
    inner = array.strides[1:]
    packed = (array.itemsize * array.shape[2], array.itemsize) if array.ndim == 3 else (array.itemsize,)
    row = array.itemsize * int(np.prod(array.shape[1:]))
    is_plain = inner == packed and array.strides[0] >= row and array.strides[0] % array.itemsize == 0 and array.flags.aligned
    return array if is_plain else _packed(array)


def _image(image: Any, most: int) -> np.ndarray:
    """An image as the core takes it: (h, w, c)."""
    if np.ma.is_masked(image):
        raise TypeError("an image has no masked samples, and this one has: weights say how much a pixel counts, and a mask which "
                        "heights there are")
    array = np.asarray(image)
    if array.dtype.kind not in "uf" or array.dtype.itemsize != {"u": min(array.dtype.itemsize, 2), "f": 4}[array.dtype.kind]:
        raise TypeError(f"an image is an array of uint8, uint16 or float32, and this one is of {array.dtype}")
    if array.ndim == 2:
        array = array[:, :, np.newaxis]
    if array.ndim != 3:
        raise ValueError(f"an image is of shape (height, width) or (height, width, channels), and this one is of {array.shape}")
    if not 1 <= array.shape[2] <= most:
        raise ValueError(f"an image has 1 to {most} channels, and this one has {array.shape[2]}")
    if array.shape[0] == 0 or array.shape[1] == 0:
        raise ValueError(f"an image has at least one pixel, and this one is of shape {array.shape[:2]}")
    return _plain(array)


def _map(name: str, values: Any, dtype: Any, shape: tuple[int, ...]) -> Optional[np.ndarray]:
    """One number for each pixel, or None."""
    if values is None:
        return None
    array = np.asarray(_unmasked(name, values))
    if array.dtype.kind not in "buif":
        raise TypeError(f"{name} must be numbers, and are of {array.dtype}")
    if array.shape != shape[:2]:
        raise ValueError(f"{name} must be of the image's shape {shape[:2]}, and are of {array.shape}")
    return _packed(array, dtype)


def _listener(progress: Optional[Callable[[Progress], Any]]) -> Optional[Callable[..., Any]]:
    if progress is None:
        return None

    def tell(stage: str, fraction: float, vertices: int, energy: float, total: float, mesh: Any) -> Any:
        so_far = None if mesh is None else lambda: Mesh._of(mesh())
        return progress(Progress(stage, fraction, vertices, energy, total, so_far))

    return tell


def _plain_options() -> dict[str, Any]:
    """The core's options as the library has them by default."""
    return {
        "target": "percent", "value": 1.0, "max_vertices": None, "good_enough": None, "weights": None, "mask": None,
        "channel_weights": (), "colors": None, "round_colors": True, "premultiplied": False, "periodic": 0,
        "straight_border": False, "samples": 0, "nan_is_no_data": False, "position_step": 1 / 256, "progress": None, "threads": 0,
    }


def mesh_image(
    image: Any,
    *,
    vertices: Optional[int] = None,
    percent: Optional[float] = None,
    psnr: Optional[float] = None,
    max_vertices: Optional[int] = None,
    good_enough: Optional[float] = None,
    effort: Effort = "normal",
    seed: int = 1,
    tile: int = 0,
    weights: Any = None,
    channel_weights: Sequence[float] = (),
    colors: Optional[Literal["optimal", "sampled"]] = None,
    round_colors: bool = True,
    premultiplied: bool = False,
    periodic: Axes = "none",
    straight_border: bool = False,
    samples: SampleGrid = "squares",
    border_tolerance: Optional[float] = None,
    position_step: float = 1 / 256,
    start: Optional[Mesh] = None,
    progress: Optional[Callable[[Progress], Any]] = None,
    threads: int = 0,
) -> Mesh:
    """Turns an image into a mesh.

    image: (height, width) or (height, width, channels), 1 to 16 channels of uint8, uint16 or float32. Rows may be apart; arrays
        of other strides are copied.
    vertices, percent, psnr: the target, one of them: exactly so many vertices; vertices for 100 pixels (the default, 1); or the
        fewest vertices found that reach so many dB
    max_vertices: with psnr, the most vertices that the mesh may have
    good_enough: with vertices or percent, the PSNR in dB above which fewer vertices will do
    effort: "draft", "fast", "normal", "fine" or "best"
    weights: (height, width), how much each pixel counts, >= 0
    channel_weights: how much each channel counts, >= 0
    periodic: "x", "y" or "xy" for images that repeat
    samples: "points" where samples are points, as heights are, and not squares
    start: a mesh of the image to go on from
    progress: is called with a Progress, and ends the work by returning False or by raising, from any thread. So does Ctrl-C.
        Returning False gives the mesh so far.
    threads: 0 for all cores; the mesh is the same for any number
    Other options are those of the C++ library's Options and Annealed.

    A PSNR out of reach gives the nearest mesh, and a sentence in mesh.report.message. Raises ValueError or TypeError with a
    sentence where an argument is refused, MemoryError, and what `progress` raises.
    """
    array = _image(image, max_channels)
    pixel_weights = _map("weights", weights, np.float32, array.shape)
    if pixel_weights is not None and not pixel_weights.any():
        raise ValueError("weights must not all be 0: no pixel would count")
    given = [(name, value) for name, value in (("vertices", vertices), ("percent", percent), ("psnr", psnr)) if value is not None]
    if len(given) > 1:
        raise ValueError(f"{given[0][0]} and {given[1][0]} are both targets, and there can be one")
    options = _plain_options()
    if given:
        options["target"], options["value"] = given[0][0], _real(*given[0])
        if given[0][0] == "vertices" and not options["value"].is_integer():
            raise ValueError(f"vertices must be a whole number, and is {vertices!r}")
    if start is not None and not isinstance(start, Mesh):
        raise TypeError(f"start must be a Mesh, and is of type {type(start).__name__}")
    options.update(
        max_vertices=None if max_vertices is None else _whole("max_vertices", max_vertices, -(2**63), 2**63 - 1),
        good_enough=good_enough,
        effort=_number_of("effort", _EFFORTS, effort),
        seed=_whole("seed", seed, 0, 2**64 - 1),
        tile=_whole("tile", tile, 0, 2**31 - 1),
        weights=pixel_weights,
        channel_weights=_reals("channel_weights", channel_weights),
        colors=None if colors is None else _number_of("colors", _COLORS, colors),
        round_colors=bool(round_colors),
        premultiplied=bool(premultiplied),
        periodic=_number_of("periodic", _AXES, periodic),
        straight_border=bool(straight_border),
        samples=_number_of("samples", _GRIDS, samples),
        border_tolerance=border_tolerance,
        position_step=_real("position_step", position_step),
        start=None if start is None else start._core(),
        progress=_listener(progress),
        threads=_threads(threads),
    )
    return Mesh._of(_core.mesh_image(array, options))


class CompactImage(NamedTuple):
    """What compact_image() makes."""

    data: bytes
    """The compact file (.hmc), which read() and the command read."""
    mesh: Mesh
    """The mesh that it holds."""
    psnr: float
    """dB: 10 log10(255^2 / MSE) of the mesh drawn at the image's size and rounded to 8 bits, the MSE over pixels and channels."""


def compact_image(
    image: Any,
    bytes: int,
    *,
    effort: Effort = "normal",
    seed: int = 1,
    table: bool = True,
    premultiplied: bool = False,
    progress: Optional[Callable[[Progress], Any]] = None,
    threads: int = 0,
) -> CompactImage:
    """Turns an image into a compact file of at most so many bytes, of which all but 2 % are used.

    image: as mesh_image() takes it, of 1 to 4 channels, of which 8 bits are kept
    bytes: the most that the file may have. Vertices, their places and colours are as coarse as that takes.
    table: whether the file begins with what photographs have taught, which is worth 8 to 12 % of the bytes; the page and the
        package for JavaScript read files without it alone
    Other options are those of mesh_image(); work that is stopped gives no file and raises ValueError.

    Takes some four times as long as a mesh of as many vertices. Raises as mesh_image() does, and ValueError where a file of
    4 vertices has more bytes.
    """
    array = _image(image, _core.max_compact_channels)
    core = _core.compact_image(array, {
        "bytes": _whole("bytes", bytes, 1, 2**31),
        "effort": _number_of("effort", _EFFORTS, effort),
        "seed": _whole("seed", seed, 0, 2**64 - 1),
        "table": bool(table),
        "premultiplied": bool(premultiplied),
        "progress": _listener(progress),
        "threads": _threads(threads),
    })
    return CompactImage(core["data"], Mesh._of(core), core["psnr"])


def mesh_terrain(
    heights: Any,
    *,
    max_error: float,
    effort: TerrainEffort = "normal",
    free_borders: bool = False,
    mask: Any = None,
    nan_is_no_data: bool = False,
    samples: SampleGrid = "points",
    progress: Optional[Callable[[Progress], Any]] = None,
    threads: int = 0,
) -> Mesh:
    """The mesh of few triangles that differs from no height by more than max_error.

    heights: (height, width) of uint8, uint16 or float32
    max_error: in the heights' values, >= 0
    mask: (height, width), 0 where there is no height
    nan_is_no_data: whether NaN and infinity are no heights; by default they are refused
    free_borders: whether sides may depend on what is inside; by default tiles that share a row share its vertices

    Raises as mesh_image() does, and ValueError where `progress` ends the work before there is a mesh within the bound.
    """
    array = _image(heights, 1)
    options = _plain_options()
    options.update(
        max_error=_real("max_error", max_error),
        effort=_number_of("effort", _TERRAIN_EFFORTS, effort),
        free_borders=bool(free_borders),
        mask=None if mask is None else _map("mask", np.ma.asarray(mask) != 0, np.uint8, array.shape),
        nan_is_no_data=bool(nan_is_no_data),
        samples=_number_of("samples", _GRIDS, samples),
        progress=_listener(progress),
        threads=_threads(threads),
    )
    return Mesh._of(_core.mesh_terrain(array, options))


def _real(name: str, value: Any) -> float:
    """A number as a float, which text is not, though float() reads it."""
    try:
        if not isinstance(value, (str, bytes, bytearray)):
            return float(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise TypeError(f"{name} must be a number that a float holds, and is {_words(value)}")


def _reals(name: str, values: Any) -> tuple[float, ...]:
    """One float after another."""
    try:
        each = iter(values)
    except TypeError:
        raise TypeError(f"{name} must be numbers, one after another, and are {_words(values)}") from None
    return tuple(_real(name, value) for value in each)


def _words(value: Any) -> str:
    """What a sentence says of a value: how it is written, or its type where that fails, as of integers of thousands of digits."""
    try:
        return repr(value)
    except Exception:
        return f"of type {type(value).__name__}"


def _whole(name: str, value: Any, low: int, high: int) -> int:
    """A whole number within bounds; a float may be one, as 1e6 is."""
    is_whole = isinstance(value, (int, np.integer)) or (isinstance(value, (float, np.floating)) and float(value).is_integer())
    if isinstance(value, bool) or not is_whole or not low <= int(value) <= high:
        raise ValueError(f"{name} must be a whole number from {low} to {high}, and is {_words(value)}")
    return int(value)


def read(source: Union[str, os.PathLike[str], BinaryIO, bytes], *, max_vertices: int = 1 << 20, max_pixels: int = 1 << 32) -> Mesh:
    """Reads a compact file (.hmc): a path, an object with read(), or its bytes. What has more than max_vertices, 4 to 2^24, or
    max_pixels is refused with a ValueError, and so is what is damaged."""
    if isinstance(source, (str, os.PathLike)):
        with open(source, "rb") as file:
            data = file.read()
    else:
        data = source.read() if hasattr(source, "read") else source
        if not isinstance(data, (bytes, bytearray, memoryview)):
            given = "source" if data is source else "source.read()"
            raise TypeError(f"source must be a path, a binary file or bytes, and {given} is of type {type(data).__name__}")
        data = bytes(data)
    most = [_whole(name, value, -(2**63), 2**63 - 1) for name, value in (("max_vertices", max_vertices), ("max_pixels", max_pixels))]
    return Mesh._of(_core.read_compact(data, *most))


def psnr(mesh: Mesh, image: Any) -> float:
    """dB: 10 log10(peak^2 / MSE) of the mesh drawn at its own size, neither rounded nor clamped, against the image's stored
    values, the MSE being the mean over pixels and channels; infinity for no error. Where the mesh is premultiplied, so is the
    image first. Samples that are not finite raise ValueError."""
    if not isinstance(mesh, Mesh):
        raise TypeError(f"mesh must be a Mesh, and is of type {type(mesh).__name__}")
    array = _image(image, 16)
    if array.shape != (mesh.height, mesh.width, mesh.channels):
        raise ValueError(f"the image is of shape {array.shape}, and the mesh is of one of "
                         f"{(mesh.height, mesh.width, mesh.channels)}")
    wanted = array.astype(np.float64)
    if not np.isfinite(wanted).all():
        raise ValueError("the image has samples that are not finite")
    if mesh.premultiplied and mesh.channels in (2, 4):
        wanted[:, :, -1] = np.clip(wanted[:, :, -1], 0, mesh.peak)
        wanted[:, :, :-1] *= wanted[:, :, -1:] / mesh.peak
        if array.dtype.kind == "u":
            wanted = np.floor(wanted + 0.5)
    error = float(np.mean((mesh.render().astype(np.float64) - wanted) ** 2))
    return math.inf if error == 0 else 10 * math.log10(mesh.peak**2 / error)
