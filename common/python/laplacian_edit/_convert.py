# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts what users give to contiguous arrays and JSON text."""
from __future__ import annotations

import array as array_module
import json
import os
import pathlib
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence, Sized
from typing import Any, NamedTuple, Optional

import numpy

from ._errors import refused

_LARGEST = 2**31 - 1
_DEEPEST = 32  # a valid edit nests its lists and dicts 6 deep
_CHANCE_OF_TRIANGLES, _CHANCE_OF_QUADS = 1e-5, 1e-2  # largest ones at which a flat list is read as polygons
_VERTEX_KEYS = ("vertices", "held")
_POINT_KEYS = ("points", "targets")
_LIST_KEYS = ("translation", "axis", "center", "point", "normal", "weights", "depths", "matrix", "scan_faces")


class Mesh(NamedTuple):
    """A mesh as the module takes it, in arrays of its own."""

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
    is_object = faces is None
    if is_object:
        vertices, faces = _attributes(vertices, where)
    points = _array(vertices, where)
    if points.dtype.kind == "b" or (points.dtype.kind == "f" and points.dtype.itemsize not in (4, 8)):
        raise refused(where, f"the array holds {points.dtype}: give float32 or float64.")
    if points.ndim != 2 or points.shape[1] != 3:
        raise refused(where, f"the array has the shape {points.shape}: give one of shape (n, 3), a row for each vertex.")
    dtype = points.dtype if points.dtype.kind == "f" else numpy.dtype(float)
    triangles, polygon = _triangles(faces, prefix + "faces", is_object)
    return Mesh(numpy.array(points, numpy.float64, order="C"), triangles, dtype, polygon)


def scan_of(value: Any, where: str) -> tuple[numpy.ndarray, numpy.ndarray, numpy.ndarray]:
    """Returns vertices, faces and normals of a scan: a mesh, (vertices, faces), or a cloud (points, None, normals)."""
    given = value if isinstance(value, tuple) else (value, None)
    if isinstance(value, (tuple, list, numpy.ndarray)) and len(given) in (2, 3) and given[1] is None:
        if len(given) == 2 or given[2] is None:
            raise refused(where, "the points have neither faces nor normals: give (vertices, faces), or (points, None, normals).")
        points, normals = (mesh_of(given[k], (), f"{where}[{k}].").points for k in (0, 2))
        if len(points) != len(normals):
            raise refused(f"{where}[2]", f"there are {len(normals)} normals for {len(points)} points: give one for each.")
        return points, numpy.zeros((0, 3), numpy.int32), normals
    if len(given) != 2:
        raise refused(where, f"found {len(given)} values: give a mesh, (vertices, faces), or (points, None, normals).")
    mesh = mesh_of(*given, where + ".")
    return mesh.points, mesh.faces, numpy.zeros((0, 3))


def _attributes(mesh: Any, where: str) -> tuple[Any, Any]:
    for vertices, faces in (("vertices", "faces"), ("points", "faces"), ("vertices", "triangles")):
        if hasattr(mesh, vertices) and hasattr(mesh, faces):
            if getattr(mesh, "n_strips", 0):
                raise refused(where, f"{_kind(mesh)} has triangle strips, which are not among its faces: call mesh.triangulate() first.")
            return getattr(mesh, vertices), getattr(mesh, faces)
    if hasattr(mesh, "vertex") and hasattr(mesh, "triangle"):  # Open3D's tensors
        return mesh.vertex.positions.numpy(), mesh.triangle.indices.numpy()
    if hasattr(mesh, "vertices") and hasattr(mesh, "cells") and hasattr(mesh, "edges"):  # vedo's surfaces, whose volumes lack edges
        return mesh.vertices, mesh.cells
    advice = "give arrays of vertices and faces, or a mesh of trimesh, PyVista, Open3D or vedo"
    if hasattr(mesh, "extract_surface"):
        advice = "extract its surface first: mesh.extract_surface()"
    elif hasattr(mesh, "cells_dict"):  # meshio
        advice = 'give its arrays: mesh.points, mesh.cells_dict["triangle"]'
    raise refused(where, f"{_kind(mesh)} has no vertices and faces: {advice}.")


def _triangles(faces: Any, where: str, is_object: bool) -> tuple[numpy.ndarray, Optional[numpy.ndarray]]:
    """Returns triangles, and of each its polygon. Polygons become fans around their first corner.

    Args:
        is_object: the faces are those of a mesh, whose library says what they are.
    """
    if isinstance(faces, Iterator):
        faces = list(faces)
    is_ragged = isinstance(faces, (list, tuple)) and len({len(face) for face in faces if _has_length(face)}) > 1
    if is_ragged:
        rows = [_array(face, f"{where}[{k}]").ravel() for k, face in enumerate(faces)]
        for k, row in enumerate(rows):
            if row.size and row.dtype.kind not in "iu":
                raise refused(f"{where}[{k}]", f"the row holds {row.dtype}: give vertex numbers as integers.")
            _require_corners(row[None], [k], where)
        faces = numpy.concatenate([numpy.concatenate([[len(row)], row.astype(numpy.int64)]) for row in rows])
    array = _array(faces, where)
    if array.size == 0:
        return numpy.zeros((0, 3), numpy.int32), None
    if array.dtype.kind not in "iu":
        raise refused(where, f"the array holds {array.dtype}: give vertex numbers as integers.")
    largest, lowest = int(array.max()), int(array.min())
    if largest > _LARGEST or lowest < 0:
        raise refused(where, f"{largest if largest > _LARGEST else lowest} is no vertex number: vertices are counted from 0.",
                      "BadIndex")
    array = numpy.array(array, numpy.int32, order="C")
    if array.ndim == 1:
        return _polygons(array, where, is_object or is_ragged)
    if array.ndim != 2 or array.shape[1] < 3:
        raise refused(where, f"the array has the shape {array.shape}: give one of shape (m, 3), or polygons as PyVista has "
                      "them: the number of corners, then the corners, for one polygon after the other.")
    corners = array.shape[1]
    if not is_object and (array[:, 0] == corners - 1).all():
        raise refused(where, f"each row of {corners} begins with {corners - 1}, so that it is unclear whether this is the number of "
                      "corners, as PyVista has it, or a vertex: give rows of corners alone (faces[:, 1:]), or for polygons "
                      f"around vertex {corners - 1} rows that begin with another corner.")
    if corners == 3:
        return array, None
    _require_corners(array, numpy.arange(len(array)), where)
    return _fans(array, numpy.arange(len(array)))


def _require_corners(polygons: numpy.ndarray, numbers: Sequence[int], where: str) -> None:
    """Refuses polygons with equally many corners, fewer than three of which are different."""
    ordered = numpy.sort(polygons, axis=1)
    different = min(1, polygons.shape[1]) + (ordered[:, 1:] != ordered[:, :-1]).sum(axis=1)
    if len(different) and different.min() < 3:
        k = int(different.argmin())
        raise refused(where, f"polygon {numbers[k]} has {different[k]} different corners, {polygons[k].tolist()}: remove it, or give "
                      "it three or more.")


def _fans(polygons: numpy.ndarray, numbers: numpy.ndarray) -> tuple[numpy.ndarray, Optional[numpy.ndarray]]:
    """Returns the triangles of polygons with equally many corners."""
    count = polygons.shape[1] - 2
    triangles = numpy.stack([numpy.repeat(polygons[:, :1], count, axis=1), polygons[:, 1:-1], polygons[:, 2:]], axis=2)
    return numpy.ascontiguousarray(triangles.reshape(-1, 3)), None if count == 1 else numpy.repeat(numbers, count)


def _polygons(flat: numpy.ndarray, where: str, is_known: bool) -> tuple[numpy.ndarray, Optional[numpy.ndarray]]:
    """The same of VTK's list: the number of corners, then the corners, for one polygon after the other.

    Args:
        is_known: there is no doubt that it is such a list.
    """
    other = "give triangles as an array of shape (m, 3), or a list of polygons"
    listed, starts, at = flat.tolist(), [], 0
    while at < flat.size:
        starts.append(at)
        at += listed[at] + 1
    if at > flat.size:
        raise refused(where, f"polygon {len(starts) - 1} has {flat[starts[-1]]} corners, but the array ends after "
                      f"{flat.size - starts[-1] - 1} of them: {other}, or before the corners of each polygon their number.")
    first = numpy.array(starts)
    sizes = flat[first]
    if not is_known and (flat.size % 3 == 0 or flat.size % 4 == 0):
        # Corners of triangles or quads can look like such a list by chance: the probability for vertices in random order.
        chance = (len(set(sizes.tolist())) / len(set(listed))) ** len(sizes)
        if chance > _CHANCE_OF_TRIANGLES and (flat.size % 3 == 0 or chance > _CHANCE_OF_QUADS or any(
                len(set(listed[at + 1:at + 1 + listed[at]])) < listed[at] for at in starts)):
            raise refused(where, f"it is unclear whether the {flat.size} numbers are corners alone, or {len(sizes)} polygons with the "
                          f"number of corners before the corners: {other}.")
    triangles, polygon = [numpy.zeros((0, 3), numpy.int32)], [numpy.zeros(0, int)]
    for size in sorted(set(sizes.tolist())):
        numbers = numpy.flatnonzero(sizes == size)
        polygons = flat[first[numbers, None] + 1 + numpy.arange(size)]
        if size != 3 or not is_known:
            _require_corners(polygons, numbers, where)
        of_size, parts = _fans(polygons, numbers)
        triangles.append(of_size)
        polygon.append(numbers if parts is None else parts)
    parts = numpy.concatenate(polygon)
    order = numpy.argsort(parts, kind="stable")
    return numpy.concatenate(triangles)[order], None if (sizes == 3).all() else parts[order]


def _has_length(value: Any) -> bool:
    return isinstance(value, Sized) and getattr(value, "ndim", 1) > 0


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
        raise refused(where, f'"{path}" cannot be read as numbers ({error}): give a .npy file, or a text with numbers.'
                          ) from None


def _require_clear(value: Any, where: str, depth: int = 0) -> None:
    """Refuses masked entries, which NumPy would read through the mask, and lists that contain themselves."""
    if isinstance(value, numpy.ma.MaskedArray):
        if numpy.ma.is_masked(value):
            raise refused(where, f"{numpy.ma.count_masked(value)} of {value.size} entries are masked: give an array without masked "
                          "entries.")
    elif isinstance(value, (list, tuple)):
        if depth > _DEEPEST:
            raise refused(where, f"lists are nested more than {_DEEPEST} deep, or contain themselves: give a plain list.")
        for each in value:
            if isinstance(each, (list, tuple, numpy.ma.MaskedArray)):
                _require_clear(each, where, depth + 1)


def _listed(value: Iterable[Any]) -> list[Any]:
    try:
        return sorted(value) if isinstance(value, (set, frozenset)) else list(value)
    except TypeError:  # not all are numbers
        return list(value)


def _array(value: Any, where: str) -> numpy.ndarray:
    """Returns an array of numbers."""
    if isinstance(value, os.PathLike):
        value = _from_file(value, where)
    if isinstance(value, Iterable) and not isinstance(value, (list, tuple, str, bytes, memoryview, array_module.array)) and (
            not hasattr(value, "__array__")):
        value = _listed(value)
    _require_clear(value, where)
    try:
        array = numpy.asarray(value)
    except ValueError:
        raise refused(where, "the rows have different lengths: give rows of equal length.") from None
    except (TypeError, RuntimeError, OverflowError) as error:  # tensors of a graphics card, for example
        raise refused(where, f"{_kind(value)} cannot be converted to an array of NumPy ({error}): give an array.") from None
    if array.dtype.kind not in "biuf" and array.size > 0:
        raise refused(where, f"expected numbers, found {shown(value)}.")
    return array


def shown(value: Any) -> str:
    """Returns a value for messages."""
    try:
        text = repr(value)
    except (RecursionError, ValueError):  # too deep, or a number of thousands of digits
        return _kind(value)
    return text if len(text) < 60 else f"{text[:57]}... of the type {type(value).__name__}"


def points_of(value: Any, where: str) -> numpy.ndarray:
    """Returns points, (k, 3) in float64. A single point may be given alone."""
    array = _array(value, where)
    if array.ndim == 1 and array.size == 3:
        array = array[None]
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iuf":
        raise refused(where, f"found an array of shape {array.shape}: give points, an array of shape (k, 3).")
    array = numpy.ascontiguousarray(array, numpy.float64)
    wrong = numpy.argwhere(~numpy.isfinite(array))
    if len(wrong):
        row, column = wrong[0]
        raise refused(f"{where}[{row}][{column}]", f"{array[row, column]} is not finite: give a finite number.", "NotFinite")
    return array


def values_of(value: Any, count: int, where: str) -> numpy.ndarray:
    """Returns numbers for `count` vertices, (count,) or (count, m), in float64."""
    array = _array(value, where)
    if array.ndim not in (1, 2) or len(array) != count:
        raise refused(where, f"found an array of shape {array.shape}: give one number, or one row, for each of the {count} vertices.")
    return numpy.ascontiguousarray(array, numpy.float64)


def _leaves(value: Iterable[Any], where: str) -> Iterator[Any]:
    """Returns the numbers in nested lists."""
    _require_clear(value, where)
    for each in value:
        if isinstance(each, Iterable) and not isinstance(each, (str, bytes, Mapping)) and getattr(each, "ndim", 1) > 0:
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
        raise refused(where, f"{shown(value)} is no list of {what} numbers: give integers or a mask.")
    if isinstance(value, (int, numpy.integer)) or not (isinstance(value, (Iterable, os.PathLike)) or hasattr(value, "__array__")):
        value = [value]
    if isinstance(value, (set, frozenset)):
        value = _listed(value)
    if isinstance(value, (list, tuple)) and any(isinstance(each, Iterable) for each in value):
        value = list(_leaves(value, where))
    if isinstance(value, (list, tuple)) and any(isinstance(each, (bool, numpy.bool_)) for each in value) and len(value) != count:
        first = next(each for each in value if isinstance(each, (bool, numpy.bool_)))
        raise refused(where, f"{first} is no {what} number, and a mask would have {count} entries: give integers or a mask.")
    array = numpy.ravel(_array(value, where))
    if array.dtype.kind == "b":
        if array.size != count:
            raise refused(where, f"the mask has {array.size} entries: give one for each {what}, {count}.")
        array = numpy.flatnonzero(array)
    if array.size == 0:
        raise refused(where, f"there is no {what} in it: give at least one.", "NoHandle")
    if array.dtype.kind not in "iu":
        wrong = next((each for each in array.tolist() if each % 1 != 0), array[0])
        raise refused(where, f"{wrong} is no {what} number: give integers, counted from 0.")
    if int(array.min()) < 0 or int(array.max()) > _LARGEST:
        wrong = int(array.min()) if int(array.min()) < 0 else int(array.max())
        raise refused(where, f"{wrong} is no {what} number: give integers, counted from 0.", "BadIndex")
    return array.astype(numpy.int32, copy=False)


def _selection(value: Any, count: int, where: str, what: str) -> numpy.ndarray:
    """Returns the numbers of what is selected, which may be nothing."""
    if value is None:
        return numpy.zeros(0, numpy.int32)
    if isinstance(value, Iterator):
        value = list(value)
    empty = (_has_length(value) and len(value) == 0) or (isinstance(value, numpy.ndarray) and value.dtype == bool
                                                               and value.shape == (count,) and not value.any())
    numbers = numpy.zeros(0, numpy.int32) if empty else numpy.unique(numbers_of(value, count, where, what))
    if numbers.size and numbers[-1] >= count:
        raise refused(where, f"{what} {numbers[-1]} does not exist: there are {count}, counted from 0.", "BadIndex")
    return numpy.ascontiguousarray(numbers)


def selection_of(mesh: Mesh, vertices: Any, faces: Any) -> tuple[numpy.ndarray, numpy.ndarray]:
    """Returns the selected vertices, and the corners of the selected faces."""
    polygons = len(mesh.faces) if mesh.polygon is None else int(mesh.polygon[-1]) + 1
    chosen = _selection(faces, polygons, "selected_faces", "face")
    if mesh.polygon is not None:
        chosen = numpy.flatnonzero(numpy.isin(mesh.polygon, chosen))
    return _selection(vertices, len(mesh.points), "selected", "vertex"), numpy.unique(mesh.faces[chosen])


def plain(value: Any, vertices: int, where: str = "", key: str = "", depth: int = 0) -> Any:
    """Returns a value of an edit as JSON has it.

    Args:
        vertices: how many the mesh has.
        where: the path of the value, such as "steps[0].handles".
        key: its last key.
        depth: how many lists and dicts it is in.
    """
    if depth > _DEEPEST:
        raise refused("edit", f"lists and dicts are nested more than {_DEEPEST} deep, or contain themselves: a valid edit nests them 6 deep.")
    if isinstance(value, Mapping):
        for name in value:
            if not isinstance(name, str):
                raise refused(where or "edit", f"the key {shown(name)} is no text: give the JSON format's keys.")
        return {name: plain(each, vertices, f"{where}.{name}" if where else name, name, depth + 1) for name, each in value.items()}
    _require_clear(value, where)
    has_ranges = isinstance(value, (list, tuple)) and any(isinstance(each, str) for each in value)
    if key in _VERTEX_KEYS and where != "mesh.vertices" and not isinstance(value, str) and not has_ranges:
        return ",".join(map(str, numbers_of(value, vertices, where).tolist()))
    if key in _POINT_KEYS and not isinstance(value, str):
        return points_of(value, where).tolist()
    if key in _LIST_KEYS and not isinstance(value, str):
        array = _array(value, where)
        value = (array.ravel() if key == "matrix" else array).tolist()
    if isinstance(value, numpy.ndarray) and value.ndim == 0:
        return plain(value[()], vertices, where, key, depth + 1)
    for kind, convert in ((numpy.bool_, bool), (numpy.integer, int), (numpy.floating, float)):
        value = convert(value) if isinstance(value, kind) else value
    if isinstance(value, (str, bool)) or value is None:
        return value
    if isinstance(value, os.PathLike):
        return os.path.abspath(value) if key in ("from", "to") and pathlib.Path(value).exists() else os.fspath(value)
    if isinstance(value, (int, float)):
        if not -sys.float_info.max <= value <= sys.float_info.max:
            raise refused(where, f"{value if isinstance(value, float) else 'the number'} is not finite: give a finite number.", "NotFinite")
        return value
    if isinstance(value, Iterable) and not isinstance(value, (bytes, bytearray)):
        return [plain(each, vertices, f"{where}[{k}]", depth=depth + 1) for k, each in enumerate(value)]
    raise refused(where or "edit", f"{_kind(value)} has no form in JSON: give numbers, texts, lists or dicts.")


def path_of(value: Any, where: str) -> str:
    """Returns a path as text."""
    try:
        path = os.fsdecode(value)
    except TypeError:
        raise refused(where, f"{shown(value)} is no path: give a text or a pathlib.Path.") from None
    if "\0" in path:
        raise refused(where, f"{shown(path)} has a character 0, which no path has.")
    return path


def text_of(edit: Any, vertices: int, folder: Any, is_step: bool = False) -> tuple[bytes, str]:
    """Returns the JSON text of an edit, and the folder of its landmark files."""
    folder = None if folder is None else path_of(folder, "landmarks_folder")
    if isinstance(edit, (str, os.PathLike)):
        if isinstance(edit, str) and edit.lstrip(" \t\r\n\ufeff")[:1] in ("{", ""):
            return edit.encode("utf-8", "surrogatepass"), folder or ""
        path = path_of(edit, "edit")
        try:
            if os.path.exists(path) and not os.path.isfile(path):
                raise OSError(0, "it is no regular file")
            text = pathlib.Path(path).read_bytes()
        except OSError as error:
            raise refused("edit", f'"{path}" cannot be read ({error.strerror}): give a dict, JSON text, which begins with {{, or the path '
                          "of a file.", "BadScript") from None
        return text, folder if folder is not None else str(pathlib.Path(path).parent)
    if not isinstance(edit, Mapping):
        raise refused("edit", f"{_kind(edit)} is no edit: give a dict with the JSON format's keys, JSON text, or a path.",
                      "BadScript")
    if is_step and "steps" not in edit:
        edit = {"steps": [edit]}
    return json.dumps(plain({"laplacian_edit": 1, **edit}, vertices), allow_nan=False).encode(), folder or ""
