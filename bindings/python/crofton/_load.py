# SPDX-License-Identifier: MIT
"""Scenes' files and GeoJSON as meshes."""
import json
import os
import warnings

import numpy as np

from . import _crofton
from ._crofton import Error, Mesh

POLYGONS = ("Polygon", "MultiPolygon")


def load_all(source):
    """The meshes of a file, a list: one for each object, under its transform and with its name.

    `source`: a path of an OBJ, glTF (.gltf, .glb), WAD or .crofton file, or of GeoJSON (.json, .geojson); or GeoJSON as
    a dict, each polygon of which becomes a flat mesh in the plane z = 0. What is bad in a file is left out with a
    warning that names it. Raises crofton.Error for a file that cannot be read.
    """
    if isinstance(source, dict):
        return _tell_coarse(_of_geojson(source, "GeoJSON"), "GeoJSON")
    path = os.fsdecode(source)
    if os.path.splitext(path)[1].lower() in (".json", ".geojson"):
        return _tell_coarse(_of_geojson(_read_json(path), path), path)
    meshes, left_out = _crofton._load(path)
    for text in left_out:
        warnings.warn(f"{path}: {text}", stacklevel=2)
    if not meshes:
        raise _error("empty", f"{path}: there are no triangles")
    return _tell_coarse(meshes, path)


def load(source):
    """As load_all, all objects as one Mesh."""
    meshes = load_all(source)
    return meshes[0] if len(meshes) == 1 else merge(meshes)


def merge(meshes):
    """Several meshes as one, with colours where all have them."""
    meshes = list(meshes)
    if not all(isinstance(mesh, Mesh) for mesh in meshes):
        raise TypeError("meshes: a sequence of Mesh is expected")
    first, indices = 0, []
    for mesh in meshes:
        indices.append(mesh.indices + np.uint32(first))
        first += len(mesh.positions)
    colors = None
    if all(mesh.colors is not None for mesh in meshes):
        colors = np.concatenate([mesh.colors for mesh in meshes])
    return Mesh(np.concatenate([mesh.positions for mesh in meshes]), np.concatenate(indices), colors=colors)


def _tell_coarse(meshes, where):
    """The meshes; warns of the first so far out that rounding its vertices to float changes its shape."""
    for number, mesh in enumerate(meshes):
        low, high = mesh.positions.min(axis=0).astype("f8"), mesh.positions.max(axis=0).astype("f8")
        step = float(np.spacing(np.abs(mesh.positions).max()))
        if step > 1e-5 * (high - low).max():
            warnings.warn(f"{where}: mesh {number} ({mesh.name!r}) is so far from the origin that its vertices, which are "
                          f"floats, are rounded to {step:.1g}; move the file's coordinates towards 0", stacklevel=3)
            break
    return meshes


def _error(code, message, item=None):
    error = Error(message)
    error.code, error.item = code, item
    return error


def _read_json(path):
    try:
        with open(path, encoding="utf-8") as file:
            data = json.load(file)
    except (OSError, UnicodeDecodeError) as error:
        raise _error("input/output", f"{path}: {error}") from error
    except (ValueError, RecursionError) as error:
        raise _error("parse", f"{path}: no JSON: {error}") from error
    if not isinstance(data, dict):
        raise _error("parse", f"{path}: a GeoJSON object is expected")
    return data


def _of_geojson(data, where):
    meshes = []
    for item, (name, rings) in enumerate(_polygons(data, where)):
        try:
            cut = _crofton.triangulate([np.asarray(ring, dtype="f8")[:, :2] for ring in rings])
        except (TypeError, ValueError, IndexError) as error:
            code = getattr(error, "code", "parse")
            raise _error(code, f"{where}: polygon {item}: {error}", item) from error
        positions = np.zeros((len(cut.points), 3))
        positions[:, :2] = cut.points
        meshes.append(Mesh(positions, cut.triangles, name=name))
    if not meshes:
        raise _error("empty", f"{where}: there is no Polygon or MultiPolygon")
    return meshes


def _polygons(data, where):
    """(name, rings) of each polygon; a ring's last point, which repeats the first, is dropped."""
    waiting = [(data, "")]
    while waiting:
        thing, name = waiting.pop()
        kind = thing.get("type") if isinstance(thing, dict) else None
        if kind == "FeatureCollection":
            waiting += [(one, "") for one in reversed(_list_of(thing, "features", where))]
        elif kind == "Feature":
            properties = thing.get("properties")
            name = str(properties.get("name") or "") if isinstance(properties, dict) else ""
            if thing.get("geometry") is not None:
                waiting.append((thing["geometry"], name))
        elif kind == "GeometryCollection":
            waiting += [(one, name) for one in reversed(_list_of(thing, "geometries", where))]
        elif kind in POLYGONS:
            polygons = _list_of(thing, "coordinates", where)
            for rings in [polygons] if kind == "Polygon" else polygons:
                if not isinstance(rings, (list, tuple)) or not rings:
                    raise _error("parse", f"{where}: a {kind} has no rings")
                yield name, [_open_ring(ring, where) for ring in rings]
        elif kind not in ("Point", "MultiPoint", "LineString", "MultiLineString"):
            raise _error("parse", f"{where}: 'type' is {kind!r}, which GeoJSON does not have")


def _list_of(thing, key, where):
    value = thing.get(key)
    if not isinstance(value, (list, tuple)):
        raise _error("parse", f"{where}: a {thing['type']} has no list {key!r}")
    return list(value)


def _open_ring(ring, where):
    if not isinstance(ring, (list, tuple)) or len(ring) < 4:
        raise _error("parse", f"{where}: a ring has four positions or more, the last one equal to the first")
    if not all(isinstance(point, (list, tuple)) and len(point) >= 2 for point in ring):
        raise _error("parse", f"{where}: a ring has a position that is not two or three numbers")
    return [point[:2] for point in (ring[:-1] if list(ring[0]) == list(ring[-1]) else ring)]
