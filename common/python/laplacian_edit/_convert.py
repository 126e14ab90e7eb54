# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts what users give to contiguous arrays and JSON text."""
from __future__ import annotations

import array as array_module
import json
import math
import os
import pathlib
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple, Optional

import numpy

from ._errors import EditRefused

_LARGEST = 2**31 - 1
_VERTEX_KEYS = ("vertices", "held")
_POINT_KEYS = ("points", "targets")
_LIST_KEYS = ("translation", "axis", "center", "point", "normal", "weights", "depths", "matrix")


class Mesh(NamedTuple):
    """A mesh as the module takes it."""

    points: numpy.ndarray  # (n, 3), float64
    faces: numpy.ndarray  # (m, 3), int32
    dtype: numpy.dtype  # of the vertices that were given
    polygon: Optional[numpy.ndarray]  # of each triangle the polygon that it is a part of; None: there are triangles only

    def result(self, numbers: numpy.ndarray, positions: numpy.ndarray) -> numpy.ndarray:
        """Returns new vertices."""
        vertices = self.points.astype(self.dtype)
        vertices[numbers] = positions
        return vertices


def mesh_of(vertices: Any, faces: Any, prefix: str = "") -> Mesh:
    """Returns the mesh of two arrays, or of one object of trimesh, PyVista, Open3D or vedo.

    Args:
        prefix: of the names of vertices and faces in refusals.
    """
    where = prefix + "vertices"
    if faces is None:
        vertices, faces = _attributes(vertices, where)
    points = _finite_type(_array(vertices, where), where)
    if points.ndim != 2 or points.shape[1] != 3:
        raise EditRefused(f"{where}: the array has the shape {points.shape}: give one of shape (n, 3), a row for each vertex.")
    dtype = points.dtype if points.dtype.kind == "f" else numpy.dtype(float)
    triangles, polygon = _triangles(faces, prefix + "faces")
    return Mesh(numpy.ascontiguousarray(points, numpy.float64), triangles, dtype, polygon)


def scan_of(value: Any, where: str) -> tuple[numpy.ndarray, numpy.ndarray, numpy.ndarray]:
    """Returns vertices, faces and normals of a scan: a mesh, (vertices, faces), or a cloud (points, None, normals)."""
    given = value if isinstance(value, tuple) else (value, None)
    if len(given) == 3 and given[1] is None:
        points, normals = (mesh_of(given[k], (), f"{where}[{k}].").points for k in (0, 2))
        if len(points) != len(normals):
            raise EditRefused(f"{where}[2]: there are {len(normals)} normals for {len(points)} points: give one for each.")
        return points, numpy.zeros((0, 3), numpy.int32), normals
    if len(given) != 2:
        raise EditRefused(f"{where}: found {len(given)} values: give a mesh, (vertices, faces), or (points, None, normals).")
    mesh = mesh_of(*given, where + ".")
    return mesh.points, mesh.faces, numpy.zeros((0, 3))


def _attributes(mesh: Any, where: str) -> tuple[Any, Any]:
    for vertices, faces in (("vertices", "faces"), ("points", "faces"), ("vertices", "triangles")):
        if hasattr(mesh, vertices) and hasattr(mesh, faces):
            return getattr(mesh, vertices), getattr(mesh, faces)
    if hasattr(mesh, "vertex") and hasattr(mesh, "triangle"):  # Open3D's tensors
        return mesh.vertex.positions.numpy(), mesh.triangle.indices.numpy()
    if hasattr(mesh, "vertices") and hasattr(mesh, "cells") and hasattr(mesh, "edges"):  # vedo's surfaces, whose volumes lack edges
        return mesh.vertices, mesh.cells
    advice = "extract its surface first: mesh.extract_surface()" if hasattr(mesh, "cells") else (
        "give arrays of vertices and faces, or a mesh of trimesh, PyVista, Open3D or vedo")
    raise EditRefused(f"{where}: {_kind(mesh)} has no vertices and faces: {advice}.")


def _triangles(faces: Any, where: str) -> tuple[numpy.ndarray, Optional[numpy.ndarray]]:
    """Returns triangles, and of each its polygon. Polygons become fans around their first corner."""
    if isinstance(faces, Iterator):
        faces = list(faces)
    if isinstance(faces, (list, tuple)) and len({len(face) for face in faces if hasattr(face, "__len__")}) > 1:
        faces = numpy.concatenate([numpy.concatenate([[len(face)], face]) for face in faces])
    array = _array(faces, where)
    if array.size == 0:
        return numpy.zeros((0, 3), numpy.int32), None
    if array.dtype.kind not in "iu":
        raise EditRefused(f"{where}: the array holds {array.dtype}: give vertex numbers as integers.")
    largest, lowest = int(array.max()), int(array.min())
    if largest > _LARGEST or lowest < 0:
        raise EditRefused(f"{where}: {largest if largest > _LARGEST else lowest} is no vertex number: vertices are counted from 0.",
                          "BadIndex")
    array = array.astype(numpy.int32, copy=False)
    if array.ndim == 2 and array.shape[1] == 3:
        return numpy.ascontiguousarray(array), None
    if array.ndim == 2 and array.shape[1] > 3:
        return _fans(array, numpy.arange(len(array)))
    if array.ndim != 1:
        raise EditRefused(f"{where}: the array has the shape {array.shape}: give one of shape (m, 3), or polygons as PyVista has "
                          "them: the number of corners, then the corners, for one polygon after the other.")
    return _polygons(array, where)


def _fans(polygons: numpy.ndarray, numbers: numpy.ndarray) -> tuple[numpy.ndarray, Optional[numpy.ndarray]]:
    """Returns the triangles of polygons with equally many corners."""
    count = polygons.shape[1] - 2
    triangles = numpy.stack([numpy.repeat(polygons[:, :1], count, axis=1), polygons[:, 1:-1], polygons[:, 2:]], axis=2)
    return numpy.ascontiguousarray(triangles.reshape(-1, 3)), None if count == 1 else numpy.repeat(numbers, count)


def _polygons(flat: numpy.ndarray, where: str) -> tuple[numpy.ndarray, Optional[numpy.ndarray]]:
    """The same of VTK's list: the number of corners, then the corners, for one polygon after the other."""
    corners = int(flat[0])
    if corners >= 3 and flat.size % (corners + 1) == 0 and (flat[::corners + 1] == corners).all():
        return _fans(flat.reshape(-1, corners + 1)[:, 1:], numpy.arange(flat.size // (corners + 1)))
    triangles, polygon, at, number = [], [], 0, 0
    while at < flat.size:
        corners = int(flat[at])
        if at + corners >= flat.size:
            raise EditRefused(f"{where}: polygon {number} has {corners} corners, but the array ends after {flat.size - at - 1} of "
                              "them: give the number of corners, then the corners, or an array of shape (m, 3).")
        if corners >= 3:
            triangles.append(_fans(flat[None, at + 1:at + 1 + corners], numpy.zeros(1))[0])
            polygon.extend([number] * (corners - 2))
        at += corners + 1
        number += 1
    if not triangles:
        return numpy.zeros((0, 3), numpy.int32), None
    return numpy.concatenate(triangles), numpy.array(polygon)


def _kind(value: Any) -> str:
    return f"an object of the type {type(value).__name__}"


def _from_file(path: os.PathLike[str], where: str) -> numpy.ndarray:
    """Reads an array from a file of NumPy, or numbers from a text, separated by blanks or commas."""
    try:
        if str(path).endswith(".npy"):
            return numpy.asarray(numpy.load(path, allow_pickle=False))
        with open(path, encoding="utf-8") as file:
            rows = [[float(number) if "." in number or "e" in number.lower() else int(number)
                     for number in line.replace(",", " ").split()] for line in file]
        return numpy.array([row for row in rows if row])
    except (OSError, ValueError) as error:
        raise EditRefused(f'{where}: "{path}" cannot be read as numbers ({error}): give a .npy file, or a text with numbers.'
                          ) from None


def _array(value: Any, where: str) -> numpy.ndarray:
    """Returns an array of numbers."""
    if isinstance(value, os.PathLike):
        value = _from_file(value, where)
    if isinstance(value, (set, frozenset)):
        value = sorted(value)
    if isinstance(value, Iterable) and not isinstance(value, (list, tuple, str, bytes, memoryview, array_module.array)) and (
            not hasattr(value, "__array__")):
        value = list(value)
    try:
        array = numpy.asarray(value)
    except ValueError:
        raise EditRefused(f"{where}: the rows have different lengths: give rows of equal length.") from None
    if array.dtype.kind not in "biuf" and array.size > 0:
        raise EditRefused(f"{where}: expected numbers, found {_shown(value)}.")
    return array


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) < 60 else f"{text[:57]}... of the type {type(value).__name__}"


def _finite_type(array: numpy.ndarray, where: str) -> numpy.ndarray:
    if array.dtype.kind == "f" and array.dtype.itemsize not in (4, 8):
        raise EditRefused(f"{where}: the array holds {array.dtype}: give float32 or float64.")
    return array


def points_of(value: Any, where: str) -> numpy.ndarray:
    """Returns points, (k, 3) in float64. A single point may be given alone."""
    array = _array(value, where)
    if array.ndim == 1 and array.size == 3:
        array = array[None]
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iuf":
        raise EditRefused(f"{where}: found an array of shape {array.shape}: give points, an array of shape (k, 3).")
    array = numpy.ascontiguousarray(array, numpy.float64)
    wrong = numpy.argwhere(~numpy.isfinite(array))
    if len(wrong):
        row, column = wrong[0]
        raise EditRefused(f"{where}[{row}][{column}]: {array[row, column]} is not finite: give a finite number.", "NotFinite")
    return array


def _leaves(value: Iterable[Any], where: str) -> Iterator[Any]:
    """Returns the numbers in nested lists."""
    for each in value:
        if isinstance(each, Iterable) and not isinstance(each, (str, bytes, Mapping)):
            yield from _leaves(each, where)
        else:
            yield each


def numbers_of(value: Any, count: int, where: str, what: str = "vertex") -> numpy.ndarray:
    """Returns numbers of vertices or faces, in their order.

    Args:
        value: a number, any nesting of iterables of numbers, an array, a mask, or the path of a file with one.
        count: how many there are, for masks.
    """
    if isinstance(value, (str, bytes, Mapping)) or value is None:
        raise EditRefused(f"{where}: {_shown(value)} is no list of {what} numbers: give integers or a mask.")
    if isinstance(value, (int, numpy.integer)) or not (isinstance(value, (Iterable, os.PathLike)) or hasattr(value, "__array__")):
        value = [value]
    if isinstance(value, (list, tuple)) and any(isinstance(each, Iterable) for each in value):
        value = list(_leaves(value, where))
    if isinstance(value, (list, tuple)) and any(isinstance(each, (bool, numpy.bool_)) for each in value) and len(value) != count:
        first = next(each for each in value if isinstance(each, (bool, numpy.bool_)))
        raise EditRefused(f"{where}: {first} is no {what} number, and a mask would have {count} entries: give integers or a mask.")
    array = numpy.ravel(_array(value, where))
    if array.dtype.kind == "b":
        if array.size != count:
            raise EditRefused(f"{where}: the mask has {array.size} entries: give one for each {what}, {count}.")
        array = numpy.flatnonzero(array)
    if array.size == 0:
        raise EditRefused(f"{where}: there is no {what} in it: give at least one.", "NoHandle")
    if array.dtype.kind not in "iu":
        wrong = next((each for each in array.tolist() if each % 1 != 0), array[0])
        raise EditRefused(f"{where}: {wrong} is no {what} number: give integers, counted from 0.")
    if int(array.min()) < 0 or int(array.max()) > _LARGEST:
        wrong = int(array.min()) if int(array.min()) < 0 else int(array.max())
        raise EditRefused(f"{where}: {wrong} is no {what} number: give integers, counted from 0.", "BadIndex")
    return array.astype(numpy.int32, copy=False)


def _selection(value: Any, count: int, where: str, what: str) -> numpy.ndarray:
    """Returns the numbers of what is selected, which may be nothing."""
    if value is None:
        return numpy.zeros(0, numpy.int32)
    if isinstance(value, Iterator):
        value = list(value)
    empty = (hasattr(value, "__len__") and len(value) == 0) or (isinstance(value, numpy.ndarray) and value.dtype == bool
                                                               and value.shape == (count,) and not value.any())
    numbers = numpy.zeros(0, numpy.int32) if empty else numpy.unique(numbers_of(value, count, where, what))
    if numbers.size and numbers[-1] >= count:
        raise EditRefused(f"{where}: {what} {numbers[-1]} does not exist: there are {count}, counted from 0.", "BadIndex")
    return numpy.ascontiguousarray(numbers)


def selection_of(mesh: Mesh, vertices: Any, faces: Any) -> tuple[numpy.ndarray, numpy.ndarray]:
    """Returns the selected vertices, and the corners of the selected faces."""
    polygons = len(mesh.faces) if mesh.polygon is None else int(mesh.polygon[-1]) + 1
    chosen = _selection(faces, polygons, "selected_faces", "face")
    if mesh.polygon is not None:
        chosen = numpy.flatnonzero(numpy.isin(mesh.polygon, chosen))
    return _selection(vertices, len(mesh.points), "selected", "vertex"), numpy.unique(mesh.faces[chosen])


def plain(value: Any, vertices: int, where: str = "", key: str = "") -> Any:
    """Returns a value of an edit as JSON has it.

    Args:
        vertices: how many the mesh has.
        where: the path of the value, such as "steps[0].handles".
        key: its last key.
    """
    if isinstance(value, Mapping):
        return {str(name): plain(each, vertices, f"{where}.{name}" if where else str(name), str(name))
                for name, each in value.items()}
    has_ranges = isinstance(value, (list, tuple)) and any(isinstance(each, str) for each in value)
    if key in _VERTEX_KEYS and where != "mesh.vertices" and not isinstance(value, str) and not has_ranges:
        return ",".join(map(str, numbers_of(value, vertices, where).tolist()))
    if key in _POINT_KEYS and not isinstance(value, str):
        return points_of(value, where).tolist()
    if key in _LIST_KEYS and not isinstance(value, str):
        array = _array(value, where)
        value = (array.ravel() if key == "matrix" else array).tolist()
    if isinstance(value, (str, bool, int)) or value is None:
        return value
    if isinstance(value, os.PathLike):
        return os.path.abspath(value) if key in ("from", "to") and pathlib.Path(value).exists() else os.fspath(value)
    if isinstance(value, numpy.generic):
        return plain(value.item(), vertices, where, key)
    if isinstance(value, float):
        if not math.isfinite(value):
            raise EditRefused(f"{where}: {value} is not finite: give a finite number.", "NotFinite")
        return value
    if isinstance(value, numpy.ndarray) and value.ndim == 0:
        return plain(value.item(), vertices, where, key)
    if isinstance(value, Iterable):
        return [plain(each, vertices, f"{where}[{k}]") for k, each in enumerate(value)]
    raise EditRefused(f"{where or 'edit'}: {_kind(value)} has no form in JSON: give numbers, texts, lists or dicts.")


def text_of(edit: Any, vertices: int, folder: Any, is_step: bool = False) -> tuple[str, str]:
    """Returns the JSON text of an edit, and the folder of its landmark files."""
    folder = None if folder is None else os.fspath(folder)
    if isinstance(edit, (str, os.PathLike)):
        path = os.fspath(edit)
        if isinstance(edit, str) and edit.lstrip(" \t\r\n\ufeff")[:1] in ("{", ""):
            return edit, folder or ""
        try:
            text = pathlib.Path(path).read_bytes().decode("utf-8")
        except (OSError, ValueError) as error:
            why = error.strerror if isinstance(error, OSError) and error.strerror else "it is not in UTF-8"
            raise EditRefused(f'edit: "{path}" cannot be read ({why}): give a dict, JSON text, which begins with {{, or the path '
                              "of a file.", "BadScript") from None
        return text, folder if folder is not None else str(pathlib.Path(path).parent)
    if not isinstance(edit, Mapping):
        raise EditRefused(f"edit: {_kind(edit)} is no edit: give a dict with the JSON format's keys, JSON text, or a path.",
                          "BadScript")
    if is_step and "steps" not in edit:
        edit = {"steps": [edit]}
    return json.dumps(plain({"laplacian_edit": 1, **edit}, vertices), allow_nan=False), folder or ""
