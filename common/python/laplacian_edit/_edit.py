# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of arrays."""
from __future__ import annotations

import json
import os
from numbers import Real
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Union

import numpy

from . import _convert, _core
from ._errors import EditRefused, refused

#: Called with the fraction done, 0 to 1, and the name of the stage. An exception cancels the edit and is passed on.
Progress = Callable[[float, str], object]
#: A dict with the keys of the JSON format, JSON text, or the path of a file.
Edit = Union[Mapping[str, Any], str, "os.PathLike[str]"]


class Result(NamedTuple):
    """An edited mesh.

    Attributes:
        vertices: a new array, (n, 3), with the dtype of the given one; float64 if that held integers.
        report: a dict with "mesh", "fraction" and "steps": of each step the figures that the program reports.
    """

    vertices: numpy.ndarray
    report: Dict[str, Any]


class Region(NamedTuple):
    """Vertex numbers of a region of interest, ascending arrays.

    Attributes:
        vertices: all, the three others together.
        free: those that follow the handles.
        anchors: stationary anchors, which hold the region.
        handles: the vertices of the handle groups.
    """

    vertices: numpy.ndarray
    free: numpy.ndarray
    anchors: numpy.ndarray
    handles: numpy.ndarray


def _given(mesh: _convert.Mesh, text: bytes, folder: str, space: str, selected: Any, selected_faces: Any) -> _core.Given:
    chosen = _convert.selection_of(mesh, selected, selected_faces)
    return _core.Given(mesh.points, mesh.faces, text, os.fsencode(folder), space, *chosen, mesh.dtype.itemsize == 4,
                       mesh.polygon is not None)


def _space(value: Any) -> str:
    space = "" if value is None else value.upper() if isinstance(value, str) else None
    if space not in ("", "RAS", "LPS"):
        raise refused("space", f"{_convert.shown(value)} is no coordinate system: give \"RAS\" or \"LPS\".")
    return space


def _progress(value: Any) -> Optional[Progress]:
    if value is not None and not callable(value):
        raise refused("progress", f"{_convert.shown(value)} cannot be called: give a function of a fraction and a text.")
    return value  # type: ignore[no-any-return]


def _scans(value: Any) -> Mapping[str, Any]:
    if value is not None and not (isinstance(value, Mapping) and all(isinstance(name, str) for name in value)):
        raise refused("scans", f"{type(value).__name__} is no dict of scans by their names: give scans={{\"head\": mesh}}.")
    return value or {}


def edit(vertices: Any, faces: Any = None, edit: Optional[Edit] = None, *, selected: Any = None, selected_faces: Any = None,
         scans: Optional[Mapping[str, Any]] = None, landmarks_folder: Any = None, space: Optional[str] = None, fraction: float = 1.0,
         progress: Optional[Progress] = None) -> Result:
    """Applies an edit to a mesh and returns its new vertices with a report. The given arrays are not changed.

    edit(vertices, faces, edit) takes arrays, edit(mesh, edit) a mesh of trimesh, PyVista, Open3D or vedo. The same mesh and edit
    give the same bits as the program laplacian-edit of the same build: float32 vertices as a file of single precision.

    Args:
        vertices: (n, 3), model units, float32, float64 or integers, in any memory layout; or a mesh.
        faces: (m, 3) vertex numbers counted from 0; (m, k) polygons; or polygons as PyVista has them: the number of corners,
            then the corners, for one polygon after the other.
        edit: a dict with the keys of the JSON format ("laplacian_edit" may be left out), JSON text, or a path. Where a key
            lists vertices: an integer, an array or any iterable of integers, a mask of n booleans, text such as "12-40,77",
            or the path of a file. Where it lists points: anything of shape (k, 3), or a single point.
        selected: the vertices that {"selected": True} stands for: numbers or a mask.
        selected_faces: the same for faces, whose corners count.
        scans: of each name in "to" of a fit the scan: a mesh, (vertices, faces), or a cloud (points, None, normals).
        landmarks_folder: of relative names of landmark files; by default that of the edit's file, or the current one.
        space: coordinate system of the mesh, "RAS" or "LPS", that landmarks are converted to.
        fraction: how far the handles go on their paths, from 0 (no change) to 1.
        progress: called with the fraction done, 0 to 1, and the name of the stage, some times a second.

    Returns:
        Result(vertices, report)

    Raises:
        EditRefused: with what is wrong, where, and what to do.
        KeyboardInterrupt: Ctrl+C cancels.

    Example:
        >>> step = {"region": {"radius": 15}, "handles": [{"vertices": 840, "translation": [0, 0, 6]}]}
        >>> new_vertices, report = laplacian_edit.edit(vertices, faces, {"steps": [step]})  # doctest: +SKIP
    """
    if edit is None:
        edit, faces = faces, None
    mesh = _convert.mesh_of(vertices, faces)
    text, folder = _convert.text_of(edit, len(mesh.points), landmarks_folder)
    given = _given(mesh, text, folder, _space(space), selected, selected_faces)
    for name, scan in _scans(scans).items():
        given.add_scan(name, *_convert.scan_of(scan, f'scans["{name}"]'))
    numbers, positions, report = _core.edit(given, _fraction(fraction), _progress(progress))
    return Result(mesh.result(numbers, positions), json.loads(report))


def _fraction(value: Any) -> float:
    if not isinstance(value, (Real, numpy.floating)) or not 0 <= value <= 1:
        raise refused("fraction", f"{_convert.shown(value)} is outside its range: give a number from 0 (no change) to 1 (the whole edit).")
    return float(value)


class Editor:
    """A step that is prepared once and posed many times.

    Editor(vertices, faces, step) takes arrays, Editor(mesh, step) a mesh of trimesh, PyVista, Open3D or vedo. Preparing finds the
    region and factors the equations; a pose then takes a fraction of that time. Several threads may use one Editor, one
    after the other; it cannot be pickled.

    Args:
        step: one step of an edit, {"region": ..., "handles": [...]}, or an edit with one step; as edit() takes it. No fit.

    All others are those of edit().

    Raises:
        EditRefused: as edit().

    Example:
        >>> editor = laplacian_edit.Editor(vertices, faces, step)  # doctest: +SKIP
        >>> frames = [editor.pose(k / 59) for k in range(60)]  # doctest: +SKIP
    """

    def __init__(self, vertices: Any, faces: Any = None, step: Optional[Edit] = None, *, selected: Any = None,
                 selected_faces: Any = None, landmarks_folder: Any = None, space: Optional[str] = None,
                 progress: Optional[Progress] = None) -> None:
        if step is None:
            step, faces = faces, None
        self._mesh = _convert.mesh_of(vertices, faces)
        text, folder = _convert.text_of(step, len(self._mesh.points), landmarks_folder, is_step=True)
        self._folder = folder and os.path.abspath(folder)
        self._space = _space(space)
        given = _given(self._mesh, text, self._folder, self._space, selected, selected_faces)
        self._core = _core.Editor(given, _progress(progress))
        whole = json.loads(text)
        self._described = {"mesh": whole["mesh"]} if "mesh" in whole else {}
        self._groups = [self._vertices(group) for group in whole["steps"][0].get("handles", [])]

    def _vertices(self, group: Mapping[str, Any]) -> Dict[str, Any]:
        """Returns the keys of a handle group that say which vertices it has. Landmark files are read now."""
        if "landmarks" in group:
            files = group["landmarks"]
            group = {**group, "points": self.landmarks(files["from"], files["to"])["points"].tolist()}
        return {key: group[key] for key in _VERTEX_KEYS + ("weights",) if key in group}

    def pose(self, pose: Union[float, Mapping[str, Any], Sequence[Mapping[str, Any]]] = 1.0, *, fraction: float = 1.0,
             progress: Optional[Progress] = None) -> numpy.ndarray:
        """Computes a pose of the whole mesh. The same pose has the same bits, whatever was posed before.

        Args:
            pose: a number from 0 (no change) to 1: the fraction of the step's own paths. Or handles: a list with a dict for
                each handle group of the step, in its order, with translation, rotation, scale, matrix or targets, as in the
                step; a dict alone for a step with one group. A group without these holds its position. Its vertices need
                not be repeated.
            fraction: how far of that the handles go on their paths.
            progress: as for edit().

        Returns:
            New vertices, (n, 3), with the dtype of the given ones.

        Raises:
            EditRefused: as edit(), and for handles of other vertices than the step's.
        """
        if isinstance(pose, (Mapping, Sequence)) and not isinstance(pose, str):
            handles = [pose] if isinstance(pose, Mapping) else list(pose)
            if len(handles) != len(self._groups):
                raise refused("handles", f"there are {len(handles)}, but the step has {len(self._groups)} groups: give a dict for "
                                  "each, in the step's order.")
            text = self._moved(handles)
        else:
            fraction, text = _fraction(pose) * _fraction(fraction), b""
        return self._mesh.result(*self._core.pose(_fraction(fraction), text, _progress(progress)))

    def _moved(self, handles: List[Mapping[str, Any]]) -> bytes:
        """Returns the text of an edit with the groups of the step and the motions of handles."""
        groups = []
        for k, (own, given) in enumerate(zip(self._groups, handles)):
            if not isinstance(given, Mapping):
                raise refused(f"handles[{k}]", f"{type(given).__name__} is no handle group: give a dict, such as "
                              '{"translation": [0, 0, 1]}.')
            motion = _convert.plain(given, len(self._mesh.points), f"handles[{k}]")
            is_named = any(key in motion for key in (*_VERTEX_KEYS, "landmarks"))
            groups.append(motion if is_named else {**own, **motion})
        steps = [{"region": {"component": True}, "handles": groups}]
        return json.dumps({"laplacian_edit": 1, **self._described, "steps": steps}).encode()

    @property
    def region(self) -> Region:
        """The region of interest."""
        numbers, classes = self._core.region()
        return Region(numbers, numbers[classes == 2], numbers[classes == 1], numbers[classes == 3])

    @property
    def report(self) -> Dict[str, Any]:
        """The report of the last pose, as that of edit()."""
        report: Dict[str, Any] = json.loads(self._core.report())
        return report

    def nearest(self, points: Any) -> numpy.ndarray:
        """Returns the number of the vertex nearest to each point, on the mesh as it was given.

        Args:
            points: (k, 3), model units, or a single point.
        """
        return _core.nearest(self._mesh.points, self._mesh.faces, _convert.points_of(points, "points"))[0]

    def landmarks(self, from_file: Any, to_file: Any) -> Dict[str, numpy.ndarray]:
        """Reads two landmark files and pairs them by their names.

        Args:
            from_file: landmarks on this mesh, .pp, .csv, .tsv, .fcsv or .mrk.json; to_file: where they go.

        Returns:
            A handle group for a step or a pose: {"points": (k, 3), "targets": (k, 3)}, in the mesh's coordinate system.
        """
        points, targets = _landmarks(from_file, to_file, self._space, self._folder)[1:]
        return {"points": points, "targets": targets}


_VERTEX_KEYS = ("vertices", "points", "within", "selected")


def _landmarks(from_file: Any, to_file: Any, space: str, folder: str = "") -> tuple[List[str], numpy.ndarray, numpy.ndarray]:
    files = _convert.path_of(from_file, "from_file"), _convert.path_of(to_file, "to_file")
    return _core.landmarks(*(os.fsencode(os.path.join(folder, file)) for file in files), space)


def nearest(vertices: Any, faces: Any = None, points: Any = None) -> numpy.ndarray:
    """Returns the number of the vertex nearest to each point. Only vertices of faces count.

    nearest(vertices, faces, points) takes arrays, nearest(mesh, points) a mesh, both as edit() does.

    Args:
        points: (k, 3), model units, or a single point.

    Returns:
        (k,) vertex numbers.
    """
    if points is None:
        points, faces = faces, None
    mesh = _convert.mesh_of(vertices, faces)
    return _core.nearest(mesh.points, mesh.faces, _convert.points_of(points, "points"))[0]


def transfer(points: Any, scan: Any, values: Any, within: Optional[float] = None) -> numpy.ndarray:
    """Returns the values of a scan, such as colours, quality or texture coordinates, at its points nearest to others.

    Args:
        points: (k, 3), model units: the vertices of a template that edit() fitted to the scan.
        scan: a mesh, (vertices, faces), or a cloud (points, None, normals).
        values: (n,) or (n, m), one number or row for each vertex of the scan; between vertices they are linear.
        within: up to which distance; by default 2 % of the scan's size.

    Returns:
        (k,) or (k, m), float64, NaN where the scan is farther away.

    Raises:
        EditRefused: for values that do not belong to the scan.

    Example:
        >>> fitted, report = laplacian_edit.edit(  # doctest: +SKIP
        ...     template, {"steps": [{"region": {"component": True}, "fit": {"to": "scan"}}]}, scans={"scan": scan})
        >>> colours = laplacian_edit.transfer(fitted, scan, scan.visual.vertex_colors)  # doctest: +SKIP
    """
    vertices, faces, _ = _convert.scan_of(scan, "scan")
    rows = _convert.values_of(values, len(vertices), "values")
    if within is not None and not (isinstance(within, (Real, numpy.floating)) and within >= 0):
        raise refused("within", f"{_convert.shown(within)} is no distance: give a length of 0 or more, model units.")
    carried = _core.carried(_convert.points_of(points, "points"), vertices, faces, rows.reshape(len(vertices), -1),
                            None if within is None else float(within))
    return carried[:, 0] if rows.ndim == 1 else carried


def fit_landmarks(from_file: Any, to_file: Any) -> Dict[str, Any]:
    """Returns an edit that fits whole surfaces to landmarks, by settings that suit landmarks all over them.

    Args:
        from_file: landmarks on the mesh, .pp, .csv, .tsv, .fcsv or .mrk.json; to_file: where they go. They are paired by
            their names.

    Returns:
        An edit for edit(), whose report lists the distance of each landmark to its target.

    Raises:
        EditRefused: for a file that is no landmark file, and for names that are in one file only.
    """
    _landmarks(from_file, to_file, "")
    settings = json.loads(_core.landmark_settings())["steps"][0]
    settings["handles"] = [{"landmarks": {"from": os.path.abspath(_convert.path_of(from_file, "from_file")),
                                             "to": os.path.abspath(_convert.path_of(to_file, "to_file"))}}]
    return {"laplacian_edit": 1, "steps": [settings]}
