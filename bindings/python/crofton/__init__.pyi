# SPDX-License-Identifier: MIT
import os
from typing import Any, Callable, Iterable, Optional, Sequence, Tuple, Union, overload

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]
Points = npt.ArrayLike  # numbers of shape (n, 3), or (n, 2) in the plane
Vector = npt.ArrayLike  # three numbers
Matrix = npt.ArrayLike  # of shape (4, 4) or (3, 4)
Vec3 = Tuple[float, float, float]
AnyCriterion = Union[str, "Criterion"]  # or "perimeter", "area", "volume"
View = Union["Camera", "Frustum"]
AnyBoxes = Union["Box", Array]  # an array of box_dtype
Objects = Union["ObjectHandle", Sequence["ObjectHandle"], Array]  # an array of handle_dtype
Nodes = Union["NodeHandle", Sequence["NodeHandle"], Array]
Progress = Optional[Callable[[float, float], Optional[bool]]]
AnyPath = Union[str, bytes, "os.PathLike[str]"]
Sphere = Tuple[Vector, float]
Capsule = Tuple[Vector, Vector, float]

__version__: str
OUTSIDE: int
STRADDLING: int
INSIDE: int
box_dtype: np.dtype[Any]
handle_dtype: np.dtype[Any]

class Error(ValueError):
    # 'invalid_argument', 'not_finite', 'out_of_range', 'degenerate', 'empty', 'unsupported', 'input/output', 'parse',
    # 'cancelled', 'budget_exceeded', 'unavailable', 'stale_handle' or 'internal'
    code: str
    item: Optional[int]

def set_threads(threads: int) -> None: ...
def boxes(center: npt.ArrayLike, half_extents: npt.ArrayLike, axes: Optional[npt.ArrayLike] = None) -> Array: ...

class Box:
    def __init__(self, center: Vector, half_extents: Vector, axes: Optional[npt.ArrayLike] = None) -> None: ...
    center: Array
    axes: Array
    half_extents: Array
    corners: Array
    volume: float
    surface_area: float
    edge_sum: float
    def contains(self, point: Vector) -> bool: ...

class Camera:
    def __init__(self, position: Vector = ..., forward: Vector = ..., up: Vector = ..., *, fov_y: float = ...,
                 height: Optional[float] = None, aspect: float = ..., near: float = ..., far: float = ...) -> None: ...
    position: Vec3
    forward: Vec3
    frustum: Frustum

class Frustum:
    @staticmethod
    def from_matrix(matrix: Matrix, depth: str = "reversed_zero_to_one", origin: Vector = ...) -> Frustum: ...
    origin: Vec3
    planes: Array
    def shadow_volume(self, toward_light: Vector) -> Frustum: ...

class IntrinsicVolumes:
    def __init__(self, volume: float = 0.0, area: float = 0.0, mean_curvature: float = 0.0) -> None: ...
    volume: float
    area: float
    mean_curvature: float
    @staticmethod
    def of_box(*box_or_edges: Union[Box, float]) -> IntrinsicVolumes: ...
    @staticmethod
    def of_sphere(radius: float) -> IntrinsicVolumes: ...
    @staticmethod
    def of_segment(length: float) -> IntrinsicVolumes: ...
    @staticmethod
    def of_hull(points: Points) -> IntrinsicVolumes: ...
    @staticmethod
    def of_frustum(camera: Camera) -> IntrinsicVolumes: ...

class Criterion:
    def __init__(self, volume: float = 0.0, area: float = 0.0, mean_curvature: float = 0.0) -> None: ...
    volume_weight: float
    area_weight: float
    mean_curvature_weight: float
    @staticmethod
    def for_rays(length: float) -> Criterion: ...
    @staticmethod
    def for_partner(body: IntrinsicVolumes) -> Criterion: ...
    @staticmethod
    def for_frustum(camera: Camera) -> Criterion: ...
    def __call__(self, body: Union[IntrinsicVolumes, Box]) -> float: ...

def kinematic_measure(b: IntrinsicVolumes, k: IntrinsicVolumes) -> float: ...
def improper_outside(query: IntrinsicVolumes, bound: IntrinsicVolumes, object: IntrinsicVolumes) -> float: ...
def triangles_met(body: IntrinsicVolumes, triangles: float, area: float, boundary: float, weight: float) -> float: ...

class ExactFit:
    box: Box
    value: float
    lower_bound: float
    gap: float
    complete: bool
    cells: int

def fit_obb(points: Points, criterion: AnyCriterion = "perimeter", quality: str = "tight") -> Box: ...
def fit_exact(points: Points, criterion: AnyCriterion = "perimeter", *, gap: float = 2e-7,
              seconds: Optional[float] = None, progress: Progress = None) -> ExactFit: ...
def fit_many(positions: Points, ends: npt.ArrayLike, indices: Optional[npt.ArrayLike] = None,
             criterion: AnyCriterion = "perimeter", quality: str = "fast") -> Array: ...
def minimal_rectangle(points: Points, criterion: str = "perimeter") \
    -> Tuple[Tuple[float, float], Tuple[float, float], Tuple[float, float]]: ...
def minimal_triangle(points: Points, criterion: str = "area") -> Array: ...
def minimal_disc(points: Points) -> Tuple[Tuple[float, float], float]: ...
def minimal_sphere(points: Points) -> Tuple[Vec3, float]: ...

class Triangulation:
    points: Array
    ring_ends: Array
    triangles: Array
    weight: float
    optimal: bool
    gap: float
    def to_svg(self, size: float = 400) -> str: ...

def triangulate(polygon: Union[Points, Sequence[Points]], method: str = "minimum_weight", *,
                seconds: Optional[float] = None, work: Optional[int] = None,
                progress: Progress = None) -> Triangulation: ...
def retriangulate_planar_patches(positions: Points, indices: npt.ArrayLike, *, tolerance: float = 0.0,
                                 progress: Progress = None) -> Tuple[Array, dict[str, float]]: ...

def classify(view: View, boxes: AnyBoxes, *, conservative: bool = False) -> Array: ...
def find_visible(view: View, boxes: AnyBoxes, *, layers: Optional[npt.ArrayLike] = None, layer_mask: int = ...,
                 conservative: bool = False) -> Array: ...

class BoxList:
    def __init__(self, boxes: AnyBoxes) -> None: ...
    def __len__(self) -> int: ...
    boxes: Array
    def find_visible(self, view: View, *, conservative: bool = False) -> Array: ...

class ClusteredMesh:
    def __init__(self, positions: Points, indices: npt.ArrayLike, max_triangles: int = 0) -> None: ...
    def __len__(self) -> int: ...
    triangle_order: Array
    clusters: Array  # records: first_triangle, triangle_count, center (3), half_edges (3, 3)

class DepthObject:
    def __init__(self, mesh: ClusteredMesh, to_clip: npt.ArrayLike, *, one_sided: bool = False, hides: bool = True,
                 position_error: float = 0.0) -> None: ...
    mesh: ClusteredMesh
    to_clip: Array
    one_sided: bool
    hides: bool
    position_error: float

class DepthCuller:
    def __init__(self) -> None: ...
    def find_visible(self, objects: Iterable[DepthObject], width: int, height: int, *,
                     depth: str = "reversed_zero_to_one") -> Tuple[Array, Array, Array]: ...
    statistics: dict[str, int]
    nearness: Array

def intersects(a: AnyBoxes, b: AnyBoxes) -> Array: ...
def distance(a: AnyBoxes, b: AnyBoxes) -> Array: ...
def penetration(a: Box, b: Box) -> Tuple[float, Vec3]: ...
def contact_manifold(a: Box, b: Box) -> dict[str, Any]: ...

class Broadphase:
    def __init__(self, *, exact_boxes: bool = True) -> None: ...
    def update(self, boxes: AnyBoxes, moved: Optional[npt.ArrayLike] = None) -> None: ...
    pairs: Array
    began: Array
    stayed: Array
    ended: Array

class ObjectHandle:
    def __init__(self, index: int, generation: int) -> None: ...
    index: int
    generation: int

class NodeHandle:
    def __init__(self, index: int, generation: int) -> None: ...
    index: int
    generation: int

class MeshHandle:
    def __init__(self, index: int, generation: int) -> None: ...
    index: int
    generation: int

class ObjectRef:
    object: ObjectHandle
    user: int

class Hit:
    object: ObjectHandle
    user: int
    t: float
    point: Vec3
    normal: Vec3
    started_inside: bool
    triangle: Optional[int]

class Closest:
    object: ObjectHandle
    user: int
    distance: float
    on_shape: Vec3
    on_object: Vec3

class Contact:
    first: ObjectRef
    second: ObjectRef
    phase: str
    normal: Vec3
    depth: float
    points: Array

class OcclusionOptions:
    def __init__(self, *, size: Tuple[int, int] = (480, 270), max_occluders: int = 256, least_cover: float = 2e-5,
                 list_occluded: bool = False) -> None: ...

class ViewMatrix:
    def __init__(self, to_clip: npt.ArrayLike, *, depth: str = "reversed_zero_to_one", origin: Vector = ...) -> None: ...

class PictureView:
    def __init__(self, width: int = 1280, height: int = 720, *, depth: str = "reversed_zero_to_one") -> None: ...

class DrawLimits:
    def __init__(self, eye: Vector, *, max_distance_in_radii: float = ..., least_radius: float = 0.0,
                 layer_distances: Optional[npt.ArrayLike] = None, item_distances: Optional[npt.ArrayLike] = None,
                 drawn_before: Optional[npt.ArrayLike] = None, hysteresis: float = 1.0) -> None: ...
    @staticmethod
    def of_camera(camera: Camera, picture_height: float, pixels: float) -> DrawLimits: ...

class ViewRequest:
    def __init__(self, camera: Optional[View] = None, *, matrix: Optional[Union[ViewMatrix, npt.ArrayLike]] = None,
                 volume: Optional[Frustum] = None, layers: Optional[int] = None,
                 occlusion: Optional[Union[OcclusionOptions, bool]] = None, picture: Optional[PictureView] = None,
                 limits: Optional[DrawLimits] = None, candidates: Optional[npt.ArrayLike] = None,
                 order: Optional[str] = None, conservative: Optional[bool] = None) -> None: ...

class ViewResult:
    ids: Array
    handles: Array
    users: Array
    verdicts: Array
    inside_count: int
    occluded_ids: Array
    depth: Optional[Array]
    triangles: Array  # records: object, cluster, triangles
    statistics: dict[str, int]
    def __len__(self) -> int: ...

class MultiViewResult:
    ids: Array
    handles: Array
    users: Array
    view_masks: Array
    view_count: int
    def depth(self, view: int) -> Optional[Array]: ...
    def triangles(self, view: int) -> Array: ...
    def occluded_ids(self, view: int) -> Array: ...
    def occluders_drawn(self, view: int) -> int: ...
    def __len__(self) -> int: ...

class World:
    def __init__(self, *, pairs: bool = True, contacts: bool = True, containment: bool = True, max_pairs: int = ...,
                 updates_to_rest: int = 16, tree: str = "aligned") -> None: ...
    def __len__(self) -> int: ...
    def __contains__(self, handle: Union[ObjectHandle, NodeHandle, MeshHandle]) -> bool: ...
    def add_mesh(self, positions: Points, indices: Optional[npt.ArrayLike] = None, *, triangles: bool = True,
                 occluders: bool = False, clusters: bool = False, one_sided: bool = False) -> MeshHandle: ...
    def clusters_of(self, mesh: MeshHandle) -> Optional[ClusteredMesh]: ...
    def set_vertices(self, mesh: MeshHandle, positions: Points) -> None: ...
    def add_node(self, parent: Optional[NodeHandle] = None, transform: Optional[Matrix] = None,
                 layers: int = ...) -> NodeHandle: ...
    def add(self, *, mesh: Optional[MeshHandle] = None, node: Optional[NodeHandle] = None,
            transform: Optional[Matrix] = None, box: Optional[Box] = None, sphere: Optional[Sphere] = None,
            aligned: Optional[Tuple[Vector, Vector]] = None, user: int = 0, layers: int = ...,
            collides_with: int = ..., occludes: bool = True) -> ObjectHandle: ...
    def add_boxes(self, boxes: AnyBoxes, *, users: Optional[npt.ArrayLike] = None, layers: int = ...,
                  collides_with: int = ...) -> Array: ...
    def add_instances(self, mesh: MeshHandle, transforms: npt.ArrayLike, *, users: Optional[npt.ArrayLike] = None,
                      layers: int = ..., collides_with: int = ...) -> Array: ...
    def remove(self, handle: Union[Objects, NodeHandle, MeshHandle]) -> None: ...
    def set_transform(self, handle: Union[ObjectHandle, NodeHandle], transform: Matrix) -> None: ...
    def set_transforms(self, objects: Objects, transforms: npt.ArrayLike) -> None: ...
    def set_node_transforms(self, nodes: Nodes, transforms: npt.ArrayLike) -> None: ...
    def set_boxes(self, objects: Objects, boxes: AnyBoxes) -> None: ...
    def set_hidden(self, objects: Objects, hidden: bool) -> None: ...
    def set_layers(self, objects: Objects, layers: int) -> None: ...
    def update(self) -> None: ...
    statistics: dict[str, int]
    @overload
    def view(self, camera: Optional[View] = None, *, matrix: Optional[Union[ViewMatrix, npt.ArrayLike]] = None,
             volume: Optional[Frustum] = None, layers: Optional[int] = None,
             occlusion: Optional[Union[OcclusionOptions, bool]] = None, picture: Optional[PictureView] = None,
             limits: Optional[DrawLimits] = None, candidates: Optional[npt.ArrayLike] = None,
             order: Optional[str] = None, conservative: Optional[bool] = None) -> ViewResult: ...
    @overload
    def view(self, camera: ViewRequest) -> ViewResult: ...
    @overload
    def view(self, camera: Sequence[Union[ViewRequest, View]]) -> MultiViewResult: ...
    def raycast(self, origin: Vector, direction: Vector, max_t: float = ..., layers: int = ...) -> Optional[Hit]: ...
    def raycast_many(self, origins: Points, directions: Points, max_t: float = ..., layers: int = ...) -> Array: ...
    def raycast_all(self, origin: Vector, direction: Vector, max_t: float = ..., layers: int = ...) -> list[Hit]: ...
    def overlap(self, *, box: Optional[Box] = None, sphere: Optional[Sphere] = None, capsule: Optional[Capsule] = None,
                layers: int = ...) -> Array: ...
    def closest(self, max_distance: float, *, box: Optional[Box] = None, sphere: Optional[Sphere] = None,
                capsule: Optional[Capsule] = None, layers: int = ...) -> Optional[Closest]: ...
    pairs: Array
    contacts: list[Contact]
    def box_of(self, object: ObjectHandle) -> Box: ...
    def transform_of(self, object: ObjectHandle) -> Array: ...
    def user_of(self, object: ObjectHandle) -> int: ...

HIDDEN: int
UNSEEN: int
SEEN: int

class Pvs:
    @staticmethod
    def bake(positions: Points, indices: npt.ArrayLike, object_of: Optional[npt.ArrayLike] = None, *,
             cells: npt.ArrayLike = (8, 8, 8), bounds: Optional[Points] = None, epsilon: float = 1e-4,
             confidence: float = 0.999, seed: int = 1, sides: str = "both", surface_steps: int = 0,
             near_radius: float = 0.5, seconds: Optional[float] = None, progress: Progress = None) -> Pvs: ...
    @staticmethod
    def open(path: AnyPath, most_pairs: int = 2**30) -> Pvs: ...
    @staticmethod
    def from_bytes(file: bytes, most_pairs: int = 2**30) -> Pvs: ...
    def to_bytes(self) -> bytes: ...
    def find_cell(self, eye: Vector) -> Optional[int]: ...
    def visible(self, eye: Union[Vector, int], mode: str = "conservative") -> Array: ...
    states: Array
    kinds: Array
    cell_boxes: Array
    counts: dict[str, int]
    cell_count: int
    object_count: int
    epsilon: float
    confidence: float
    def chart(self) -> Chart: ...

class Chart:
    def __init__(self, x: npt.ArrayLike, series: dict[str, npt.ArrayLike], x_label: str = "", y_label: str = "") -> None: ...
    def to_svg(self, size: float = 560) -> str: ...
