"""Made by python/stubs.py from the module itself."""
from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Path = Union[str, PathLike[str]]
__version__: str

class Error(Exception):
    file: str | None
    exit_code: int

class BadInput(Error, ValueError): ...

class BadUsage(Error, ValueError): ...

class NoDevice(Error, RuntimeError): ...

class Calibration:
    def __repr__(self) -> str: ...
    @property
    def cameras(self) -> list[dict[str, Any]]: ...
    @property
    def frames(self) -> int: ...
    def json(self) -> str: ...
    def write_rig(self, file: Any) -> None: ...

class Contacts:
    def __len__(self) -> int: ...
    def __repr__(self) -> str: ...
    @property
    def depths(self) -> NDArray[np.float64]: ...
    @property
    def indices(self) -> NDArray[np.int64]: ...
    @property
    def positions(self) -> NDArray[np.float64]: ...
    @property
    def solids(self) -> NDArray[np.int64]: ...

class Drive:
    def __array__(self, *args: Any, **kwargs: Any) -> NDArray[Any]: ...
    def __len__(self) -> int: ...
    def __repr__(self) -> str: ...
    @property
    def aimed(self) -> NDArray[np.float64] | None: ...
    @property
    def beyond_linear(self) -> bool: ...
    def csv(self) -> str: ...
    @property
    def evenness(self) -> float: ...
    @property
    def foci(self) -> NDArray[np.float64]: ...
    @property
    def gains(self) -> NDArray[np.float64]: ...
    def json(self) -> str: ...
    @property
    def over_free_field(self) -> NDArray[np.float64] | None: ...
    @property
    def pressures(self) -> NDArray[np.float64]: ...
    @property
    def spread(self) -> dict[str, Any] | None: ...
    @property
    def unresolved(self) -> list[tuple[int, int]]: ...
    @property
    def vector(self) -> NDArray[np.complex128]: ...

class Event:
    def __repr__(self) -> str: ...
    @property
    def centroid(self) -> NDArray[np.float64]: ...
    @property
    def depth(self) -> float: ...
    @property
    def finger(self) -> int: ...
    @property
    def kind(self) -> str: ...
    @property
    def solid(self) -> str: ...
    @property
    def time(self) -> float: ...

class Export:
    def __repr__(self) -> str: ...
    @property
    def foci(self) -> dict[str, Any]: ...
    @property
    def frames(self) -> int: ...
    def json(self) -> str: ...
    @property
    def slot(self) -> float: ...

class Field:
    def __array__(self, *args: Any, **kwargs: Any) -> NDArray[Any]: ...
    def __repr__(self) -> str: ...
    @property
    def absorption(self) -> float: ...
    @property
    def beyond_linear(self) -> bool: ...
    @property
    def density(self) -> float: ...
    @property
    def faces(self) -> NDArray[np.uint32]: ...
    def json(self) -> str: ...
    @property
    def peak(self) -> float: ...
    @property
    def peak_at(self) -> NDArray[np.float64]: ...
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def pressure(self) -> NDArray[np.complex128]: ...
    @property
    def sound_speed(self) -> float: ...
    @property
    def spread(self) -> dict[str, Any] | None: ...

class Figure6:
    def __getitem__(self, index: int) -> tuple[str, Simulation]: ...
    def __len__(self) -> int: ...
    def __repr__(self) -> str: ...
    def json(self) -> str: ...

class Finger:
    def __repr__(self) -> str: ...
    @property
    def axes(self) -> NDArray[np.float64]: ...
    @property
    def centroid(self) -> NDArray[np.float64]: ...
    @property
    def contacts(self) -> NDArray[np.int64]: ...
    @property
    def depth(self) -> float: ...
    @property
    def dwell(self) -> float: ...
    @property
    def eigenvalues(self) -> NDArray[np.float64]: ...
    @property
    def foci(self) -> NDArray[np.float64]: ...
    @property
    def focus_points(self) -> NDArray[np.int64]: ...
    @property
    def gain(self) -> float: ...
    @property
    def id(self) -> int: ...
    @property
    def modulation_frequency(self) -> float: ...
    @property
    def order(self) -> NDArray[np.uint32]: ...
    @property
    def perimeter(self) -> float: ...
    @property
    def played_foci(self) -> NDArray[np.float64]: ...
    @property
    def pressures(self) -> NDArray[np.float64] | None: ...
    @property
    def solid(self) -> str: ...
    @property
    def spectrum(self) -> dict[str, Any] | None: ...
    @property
    def together(self) -> bool: ...
    @property
    def tuned(self) -> dict[str, Any] | None: ...

class FingerBody:
    def __init__(
        self,
        finger: tuple[ArrayLike, ArrayLike] | _Path | Mesh,
        *,
        force: bool = ...,
        **options: Any,
    ) -> None: ...
    def __repr__(self) -> str: ...

class FingerSound:
    def __init__(
        self,
        layout: Layout,
        finger: tuple[ArrayLike, ArrayLike] | _Path | Mesh,
        *,
        force: bool = ...,
        **options: Any,
    ) -> None: ...
    def __repr__(self) -> str: ...

class Layout:
    def __init__(self, source: _Path | str) -> None: ...
    def __len__(self) -> int: ...
    def __repr__(self) -> str: ...
    @property
    def axes(self) -> NDArray[np.float64]: ...
    @property
    def boards(self) -> list[dict[str, Any]]: ...
    @property
    def default_pose(self) -> NDArray[np.float64]: ...
    def drive(
        self,
        foci: ArrayLike,
        gains: ArrayLike = ...,
        *,
        finger: tuple[ArrayLike, ArrayLike] | _Path | Mesh | FingerSound = ...,
        force: bool = ...,
        amplitude: Literal["distance", "uniform"] | None = ...,
        solver: Literal["naive", "gs-pat", "greedy", "loudest", "adjoint"] | None = ...,
        transfer: Literal["free", "finger"] | None = ...,
        constraint: Literal["normalise", "uniform", "clamp"] | None = ...,
        pressure: float | str | None = ...,
        directivity: Literal["omni", "piston", "t4010a1"] | None = ...,
        temperature: float | str | None = ...,
        sound_speed: float | str | None = ...,
        frequency: float | str | None = ...,
        spread: Any | None = ...,
        draws: int | str | None = ...,
        gpu: Any | None = ...,
        backend: Literal["gpu", "cpu"] | None = ...,
        seed: int | str | None = ...,
        validation: Literal["off", "core", "sync", "gpu-assisted"] | None = ...,
    ) -> NDArray[np.complex128]: ...
    def field(
        self,
        drive: ArrayLike | Drive,
        where: ArrayLike | tuple[ArrayLike, ArrayLike] | Places | Mesh,
        *,
        directivity: Literal["omni", "piston", "t4010a1"] | None = ...,
        temperature: float | str | None = ...,
        sound_speed: float | str | None = ...,
        frequency: float | str | None = ...,
        humidity: float | str | None = ...,
        air_pressure: float | str | None = ...,
        no_absorption: bool | None = ...,
        spread: Any | None = ...,
        draws: int | str | None = ...,
        gpu: Any | None = ...,
        backend: Literal["gpu", "cpu"] | None = ...,
        seed: int | str | None = ...,
        validation: Literal["off", "core", "sync", "gpu-assisted"] | None = ...,
    ) -> Field: ...
    @property
    def frequency(self) -> float: ...
    def moved(self, pose: ArrayLike) -> Layout: ...
    @property
    def name(self) -> str: ...
    @staticmethod
    def names() -> list[str]: ...
    @property
    def positions(self) -> NDArray[np.float64]: ...
    def read_drive(self, file: Any) -> NDArray[np.complex128]: ...
    def solve(
        self,
        foci: ArrayLike,
        gains: ArrayLike = ...,
        *,
        finger: tuple[ArrayLike, ArrayLike] | _Path | Mesh | FingerSound = ...,
        force: bool = ...,
        amplitude: Literal["distance", "uniform"] | None = ...,
        solver: Literal["naive", "gs-pat", "greedy", "loudest", "adjoint"] | None = ...,
        transfer: Literal["free", "finger"] | None = ...,
        constraint: Literal["normalise", "uniform", "clamp"] | None = ...,
        pressure: float | str | None = ...,
        directivity: Literal["omni", "piston", "t4010a1"] | None = ...,
        temperature: float | str | None = ...,
        sound_speed: float | str | None = ...,
        frequency: float | str | None = ...,
        spread: Any | None = ...,
        draws: int | str | None = ...,
        gpu: Any | None = ...,
        backend: Literal["gpu", "cpu"] | None = ...,
        seed: int | str | None = ...,
        validation: Literal["off", "core", "sync", "gpu-assisted"] | None = ...,
    ) -> Drive: ...
    def solve_touch(
        self,
        touch: _Path,
        *,
        slot: int = ...,
        amplitude: Literal["distance", "uniform"] | None = ...,
        solver: Literal["naive", "gs-pat", "greedy", "loudest", "adjoint"] | None = ...,
        transfer: Literal["free", "finger"] | None = ...,
        constraint: Literal["normalise", "uniform", "clamp"] | None = ...,
        pressure: float | str | None = ...,
        directivity: Literal["omni", "piston", "t4010a1"] | None = ...,
        temperature: float | str | None = ...,
        sound_speed: float | str | None = ...,
        frequency: float | str | None = ...,
        spread: Any | None = ...,
        draws: int | str | None = ...,
        gpu: Any | None = ...,
        backend: Literal["gpu", "cpu"] | None = ...,
        seed: int | str | None = ...,
        validation: Literal["off", "core", "sync", "gpu-assisted"] | None = ...,
    ) -> Drive: ...
    @property
    def source(self) -> str: ...
    @property
    def source_level(self) -> float: ...
    @property
    def transducer_radius(self) -> float: ...
    def transfer(
        self,
        points: ArrayLike,
        *,
        directivity: Literal["omni", "piston", "t4010a1"] | None = ...,
        temperature: float | str | None = ...,
        sound_speed: float | str | None = ...,
        frequency: float | str | None = ...,
    ) -> NDArray[np.complex128]: ...
    def write_drive(self, file: _Path, drive: ArrayLike | Drive) -> Any: ...

class Mesh:
    def __init__(self, source: tuple[ArrayLike, ArrayLike] | _Path) -> None: ...
    def __repr__(self) -> str: ...
    @property
    def area(self) -> float: ...
    @property
    def faces(self) -> NDArray[np.uint32]: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def volume(self) -> float: ...

class Parts:
    def __repr__(self) -> str: ...
    def json(self, file: Any) -> str: ...
    @property
    def solids(self) -> list[dict[str, Any]]: ...
    def write(self, file: Any) -> None: ...

class Places:
    def __len__(self) -> int: ...
    def __repr__(self) -> str: ...
    @property
    def extent(self) -> tuple[float, ...] | None: ...
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def shape(self) -> tuple[int, ...]: ...

class Recording:
    def __init__(self, folder: _Path) -> None: ...
    def __len__(self) -> int: ...
    def __repr__(self) -> str: ...
    @property
    def cameras(self) -> list[str]: ...
    def images(self, frame: int) -> list[Any]: ...
    @property
    def source(self) -> str: ...
    @property
    def times(self) -> NDArray[np.float64]: ...

class RunStats:
    def __repr__(self) -> str: ...
    @property
    def drives(self) -> int: ...
    @property
    def frames(self) -> int: ...
    def json(self) -> str: ...
    @property
    def replaced(self) -> int: ...
    @property
    def silent_drives(self) -> int: ...
    @property
    def touching(self) -> int: ...

class Scattering:
    def __repr__(self) -> str: ...
    @property
    def areas(self) -> NDArray[np.float64]: ...
    @property
    def around(self) -> NDArray[np.complex128]: ...
    @property
    def beyond_linear(self) -> bool: ...
    @property
    def centroids(self) -> NDArray[np.float64]: ...
    @property
    def density(self) -> float: ...
    @property
    def faces(self) -> NDArray[np.uint32]: ...
    @property
    def far_force(self) -> NDArray[np.float64] | None: ...
    @property
    def force(self) -> NDArray[np.float64]: ...
    def json(self) -> str: ...
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def pressure(self) -> NDArray[np.complex128]: ...
    @property
    def timing(self) -> dict[str, float]: ...
    @property
    def torque(self) -> NDArray[np.float64]: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...

class Scene:
    def __getitem__(self, key: str | int) -> Solid: ...
    def __init__(
        self,
        file: _Path,
        *,
        gltf_scene: int | str | None = ...,
        surface: Literal["mesh", "parts"] | None = ...,
        parts: int | str | None = ...,
        internal_faces: Literal["drop", "keep"] | None = ...,
        allow_outside: bool | None = ...,
    ) -> None: ...
    def __len__(self) -> int: ...
    def __repr__(self) -> str: ...
    @property
    def solids(self) -> list[Solid]: ...
    @property
    def source(self) -> str: ...
    def touch(
        self,
        skin: ArrayLike | _Path = ...,
        *,
        depth: Sequence[Any] | NDArray[Any] | _Path = ...,
        camera: Sequence[Any] | _Path = ...,
        rig: _Path = ...,
        penetration: float = ...,
        delta: float | str | None = ...,
        finger_gap: float | str | None = ...,
        min_points: int | str | None = ...,
        finger_width: float | str | None = ...,
        cluster: Literal["contacts", "inside"] | None = ...,
        foci: int | str | None = ...,
        spacing: Literal["angle", "arc"] | None = ...,
        stride: int | str | None = ...,
        dwell: float | str | None = ...,
        method: Literal["cross-section", "single-focus", "ellipse", "multi-focus"] | None = ...,
        modulation: Literal["pressure-sine", "amplitude-sine"] | None = ...,
        modulation_frequency: float | str | None = ...,
        tune: bool | None = ...,
        spot: float | str | None = ...,
        spectrum: bool | None = ...,
        tune_shortest: float | str | None = ...,
        tune_longest: float | str | None = ...,
        layout: Any | None = ...,
        amplitude: Literal["distance", "uniform"] | None = ...,
        solver: Literal["naive", "gs-pat", "greedy", "loudest", "adjoint"] | None = ...,
        constraint: Literal["normalise", "uniform", "clamp"] | None = ...,
        pressure: float | str | None = ...,
        directivity: Literal["omni", "piston", "t4010a1"] | None = ...,
        temperature: float | str | None = ...,
        sound_speed: float | str | None = ...,
        frequency: float | str | None = ...,
        gpu: Any | None = ...,
        backend: Literal["gpu", "cpu"] | None = ...,
        seed: int | str | None = ...,
        validation: Literal["off", "core", "sync", "gpu-assisted"] | None = ...,
    ) -> Touch: ...

class Session:
    def __enter__(self) -> Session: ...
    def __exit__(self, *args: Any) -> None: ...
    def __init__(
        self,
        scene: Scene,
        *,
        camera: Sequence[Any] | _Path = ...,
        depth: bool = ...,
        source: Any | None = ...,
        allow_outside: bool | None = ...,
        hold: Any | None = ...,
        ceiling: int | str | None = ...,
        ramp: float | str | None = ...,
        noise_free: bool | None = ...,
        events: Any | None = ...,
        event_move: float | str | None = ...,
        link: Any | None = ...,
        board_files: Any | None = ...,
        every_frame: bool | None = ...,
        record: Any | None = ...,
        overwrite: bool | None = ...,
        rig: Any | None = ...,
        layout: Any | None = ...,
        delta: float | str | None = ...,
        finger_gap: float | str | None = ...,
        min_points: int | str | None = ...,
        finger_width: float | str | None = ...,
        cluster: Literal["contacts", "inside"] | None = ...,
        foci: int | str | None = ...,
        spacing: Literal["angle", "arc"] | None = ...,
        stride: int | str | None = ...,
        dwell: float | str | None = ...,
        method: Literal["cross-section", "single-focus", "ellipse", "multi-focus"] | None = ...,
        modulation: Literal["pressure-sine", "amplitude-sine"] | None = ...,
        modulation_frequency: float | str | None = ...,
        tune: bool | None = ...,
        spot: float | str | None = ...,
        amplitude: Literal["distance", "uniform"] | None = ...,
        solver: Literal["naive", "gs-pat", "greedy", "loudest", "adjoint"] | None = ...,
        constraint: Literal["normalise", "uniform", "clamp"] | None = ...,
        pressure: float | str | None = ...,
        directivity: Literal["omni", "piston", "t4010a1"] | None = ...,
        temperature: float | str | None = ...,
        sound_speed: float | str | None = ...,
        frequency: float | str | None = ...,
        axes: Literal["steady", "covariance"] | None = ...,
        smoothing: Literal["one-euro", "none"] | None = ...,
        gpu: Any | None = ...,
        backend: Literal["gpu", "cpu"] | None = ...,
        seed: int | str | None = ...,
        validation: Literal["off", "core", "sync", "gpu-assisted"] | None = ...,
    ) -> None: ...
    def __repr__(self) -> str: ...
    @property
    def drives(self) -> NDArray[np.complex128] | None: ...
    def end(self) -> list[Event]: ...
    @property
    def events(self) -> list[Event]: ...
    def run(
        self,
        frames: int = ...,
        *,
        on_frame: Callable[..., Any] = ...,
        on_event: Callable[..., Any] = ...,
    ) -> RunStats: ...
    @property
    def running(self) -> bool: ...
    def set_aim(self, offset: ArrayLike) -> None: ...
    def set_gain(self, gain: float) -> None: ...
    def set_pose(self, solid: int | str, pose: ArrayLike) -> None: ...
    def start(
        self,
        frames: int = ...,
        *,
        on_frame: Callable[..., Any] = ...,
        on_event: Callable[..., Any] = ...,
    ) -> None: ...
    def stop(self) -> None: ...
    def touch(self, skin: ArrayLike = ..., time: float = ..., *, depth: NDArray[Any] = ...) -> Touch: ...
    def wait(self) -> RunStats: ...

class Simulation:
    def __repr__(self) -> str: ...
    @property
    def areas(self) -> NDArray[np.float64]: ...
    @property
    def bare_elongation(self) -> float | None: ...
    @property
    def beyond_linear(self) -> bool: ...
    @property
    def centroids(self) -> NDArray[np.float64]: ...
    def csv(self) -> str: ...
    @property
    def faces(self) -> NDArray[np.uint32]: ...
    @property
    def far_force(self) -> NDArray[np.float64] | None: ...
    @property
    def foci(self) -> NDArray[np.float64]: ...
    @property
    def force(self) -> NDArray[np.float64]: ...
    def json(self) -> str: ...
    @property
    def langevin(self) -> NDArray[np.float64]: ...
    @property
    def langevin_spot(self) -> dict[str, Any]: ...
    @property
    def penetration(self) -> float: ...
    @property
    def squared(self) -> NDArray[np.float64]: ...
    @property
    def squared_spot(self) -> dict[str, Any]: ...
    @property
    def timing(self) -> dict[str, float]: ...
    @property
    def tip(self) -> NDArray[np.float64]: ...
    @property
    def torque(self) -> NDArray[np.float64]: ...
    @property
    def unreached(self) -> str | None: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    def write_vtu(self, file: Any) -> None: ...

class Solid:
    def __repr__(self) -> str: ...
    @property
    def bounds(self) -> NDArray[np.float64]: ...
    def depth(self, points: ArrayLike) -> NDArray[np.float64]: ...
    @property
    def faces(self) -> NDArray[np.uint32]: ...
    @property
    def haptics(self) -> dict[str, Any]: ...
    @property
    def name(self) -> str: ...
    @property
    def parts(self) -> int: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...

class Touch:
    def __repr__(self) -> str: ...
    @property
    def contacts(self) -> Contacts: ...
    def csv(self) -> str: ...
    @property
    def dwell(self) -> float: ...
    @property
    def fingers(self) -> list[Finger]: ...
    def json(self) -> str: ...
    @property
    def order(self) -> NDArray[np.uint32]: ...
    @property
    def points(self) -> int: ...
    @property
    def slot(self) -> float: ...
    @property
    def time(self) -> float: ...
    @property
    def timing(self) -> dict[str, float]: ...
    @property
    def unreached(self) -> str | None: ...

def calibrate(
    *,
    source: Any | None = ...,
    frames: int | str | None = ...,
    noise_free: bool | None = ...,
    at: Any | None = ...,
    turn: Any | None = ...,
    seed: int | str | None = ...,
    allow_outside: bool | None = ...,
    rig: Any | None = ...,
    layout: Any | None = ...,
) -> Calibration: ...
def decompose(
    scene: _Path | Scene,
    *,
    gltf_scene: int | str | None = ...,
    allow_outside: bool | None = ...,
    parts: int | str | None = ...,
    resolution: int | str | None = ...,
    error: float | str | None = ...,
    seed: int | str | None = ...,
) -> Parts: ...
def export(
    scene: _Path | Scene,
    source: _Path | str | Recording,
    *,
    gltf_scene: int | str | None = ...,
    frames: int | str | None = ...,
    allow_outside: bool | None = ...,
    hold: Any | None = ...,
    ceiling: int | str | None = ...,
    ramp: float | str | None = ...,
    noise_free: bool | None = ...,
    events: Any | None = ...,
    event_move: float | str | None = ...,
    foci: Any | None = ...,
    drives: Any | None = ...,
    surface: Literal["mesh", "parts"] | None = ...,
    parts: int | str | None = ...,
    internal_faces: Literal["drop", "keep"] | None = ...,
    rig: Any | None = ...,
    layout: Any | None = ...,
    delta: float | str | None = ...,
    finger_gap: float | str | None = ...,
    min_points: int | str | None = ...,
    finger_width: float | str | None = ...,
    cluster: Literal["contacts", "inside"] | None = ...,
    foci_count: int | str | None = ...,
    spacing: Literal["angle", "arc"] | None = ...,
    stride: int | str | None = ...,
    dwell: float | str | None = ...,
    method: Literal["cross-section", "single-focus", "ellipse", "multi-focus"] | None = ...,
    modulation: Literal["pressure-sine", "amplitude-sine"] | None = ...,
    modulation_frequency: float | str | None = ...,
    tune: bool | None = ...,
    spot: float | str | None = ...,
    amplitude: Literal["distance", "uniform"] | None = ...,
    solver: Literal["naive", "gs-pat", "greedy", "loudest", "adjoint"] | None = ...,
    constraint: Literal["normalise", "uniform", "clamp"] | None = ...,
    pressure: float | str | None = ...,
    directivity: Literal["omni", "piston", "t4010a1"] | None = ...,
    temperature: float | str | None = ...,
    sound_speed: float | str | None = ...,
    frequency: float | str | None = ...,
    axes: Literal["steady", "covariance"] | None = ...,
    smoothing: Literal["one-euro", "none"] | None = ...,
    gpu: Any | None = ...,
    backend: Literal["gpu", "cpu"] | None = ...,
    seed: int | str | None = ...,
    validation: Literal["off", "core", "sync", "gpu-assisted"] | None = ...,
) -> Export: ...
def figure6(
    finger: tuple[ArrayLike, ArrayLike] | _Path | FingerBody | Mesh,
    *,
    penetration: float = ...,
    skin: Literal["vertices", "cameras"] = ...,
    noise_free: bool = ...,
    force: bool = ...,
    delta: float | str | None = ...,
    finger_gap: float | str | None = ...,
    min_points: int | str | None = ...,
    finger_width: float | str | None = ...,
    cluster: Literal["contacts", "inside"] | None = ...,
    foci: int | str | None = ...,
    spacing: Literal["angle", "arc"] | None = ...,
    stride: int | str | None = ...,
    dwell: float | str | None = ...,
    modulation: Literal["pressure-sine", "amplitude-sine"] | None = ...,
    modulation_frequency: float | str | None = ...,
    tune: bool | None = ...,
    spot: float | str | None = ...,
    spectrum: bool | None = ...,
    tune_shortest: float | str | None = ...,
    tune_longest: float | str | None = ...,
    rig: Any | None = ...,
    layout: Any | None = ...,
    amplitude: Literal["distance", "uniform"] | None = ...,
    solver: Literal["naive", "gs-pat", "greedy", "loudest", "adjoint"] | None = ...,
    transfer: Literal["free", "finger"] | None = ...,
    constraint: Literal["normalise", "uniform", "clamp"] | None = ...,
    pressure: float | str | None = ...,
    directivity: Literal["omni", "piston", "t4010a1"] | None = ...,
    temperature: float | str | None = ...,
    sound_speed: float | str | None = ...,
    frequency: float | str | None = ...,
    humidity: float | str | None = ...,
    air_pressure: float | str | None = ...,
    no_absorption: bool | None = ...,
    gpu: Any | None = ...,
    backend: Literal["gpu", "cpu"] | None = ...,
    seed: int | str | None = ...,
    validation: Literal["off", "core", "sync", "gpu-assisted"] | None = ...,
) -> Figure6: ...
def line(start: ArrayLike, end: ArrayLike, *, samples: int = ...) -> Places: ...
def messages() -> list[tuple[str, str]]: ...
def plane(
    plane: Literal["xy", "xz", "yz"],
    *,
    centre: ArrayLike = ...,
    size: tuple[float, float],
    pixels: tuple[int, int] = ...,
) -> Places: ...
def read_ply(file: _Path) -> NDArray[np.float64]: ...
def scatter(
    mesh: tuple[ArrayLike, ArrayLike] | _Path | Mesh,
    *,
    plane_wave: ArrayLike = ...,
    point_source: ArrayLike = ...,
    layout: _Path | str | Layout = ...,
    drive: ArrayLike | Drive = ...,
    where: ArrayLike | Places | Mesh = ...,
    force: bool = ...,
    directivity: Literal["omni", "piston", "t4010a1"] | None = ...,
    temperature: float | str | None = ...,
    sound_speed: float | str | None = ...,
    frequency: float | str | None = ...,
    humidity: float | str | None = ...,
    air_pressure: float | str | None = ...,
    absorption: bool | None = ...,
) -> Scattering: ...
def set_log_level(level: Literal["quiet", "error", "warning", "info", "debug"]) -> None: ...
def simulate(
    scene: Scene,
    finger: tuple[ArrayLike, ArrayLike] | _Path | FingerBody | Mesh,
    *,
    penetration: float = ...,
    skin: Literal["vertices", "cameras"] = ...,
    noise_free: bool = ...,
    bare_elongation: bool = ...,
    force: bool = ...,
    delta: float | str | None = ...,
    finger_gap: float | str | None = ...,
    min_points: int | str | None = ...,
    finger_width: float | str | None = ...,
    cluster: Literal["contacts", "inside"] | None = ...,
    foci: int | str | None = ...,
    spacing: Literal["angle", "arc"] | None = ...,
    stride: int | str | None = ...,
    dwell: float | str | None = ...,
    method: Literal["cross-section", "single-focus", "ellipse", "multi-focus"] | None = ...,
    modulation: Literal["pressure-sine", "amplitude-sine"] | None = ...,
    modulation_frequency: float | str | None = ...,
    tune: bool | None = ...,
    spot: float | str | None = ...,
    spectrum: bool | None = ...,
    tune_shortest: float | str | None = ...,
    tune_longest: float | str | None = ...,
    rig: Any | None = ...,
    layout: Any | None = ...,
    amplitude: Literal["distance", "uniform"] | None = ...,
    solver: Literal["naive", "gs-pat", "greedy", "loudest", "adjoint"] | None = ...,
    transfer: Literal["free", "finger"] | None = ...,
    constraint: Literal["normalise", "uniform", "clamp"] | None = ...,
    pressure: float | str | None = ...,
    directivity: Literal["omni", "piston", "t4010a1"] | None = ...,
    temperature: float | str | None = ...,
    sound_speed: float | str | None = ...,
    frequency: float | str | None = ...,
    humidity: float | str | None = ...,
    air_pressure: float | str | None = ...,
    no_absorption: bool | None = ...,
    gpu: Any | None = ...,
    backend: Literal["gpu", "cpu"] | None = ...,
    seed: int | str | None = ...,
    validation: Literal["off", "core", "sync", "gpu-assisted"] | None = ...,
) -> Simulation: ...
def write_ply(file: _Path, points: ArrayLike, faces: ArrayLike = ...) -> None: ...
