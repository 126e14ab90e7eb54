# SPDX-License-Identifier: GPL-3.0-or-later
"""Applies edits to meshes of PyMeshLab."""
from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy
import pymeshlab

from ._plugin import load

_FILTER = "apply_coord_laplacian_editing_replay"
_LIBRARY = load()


class EditRefused(ValueError):
    """An edit was refused. The text says what is wrong, where, and what to do. The mesh set is unchanged."""


def edit(mesh_set: pymeshlab.MeshSet, edit_dict: Mapping[str, Any], fraction: float = 1.0) -> dict[str, Any]:
    """Applies an edit to the current mesh of a mesh set and returns the report.

    The edit is computed on a copy. The mesh set is changed only if it succeeds.

    Args:
        mesh_set: its current mesh is edited.
        edit_dict: the keys of the JSON format of edits; "laplacian_edit" may be omitted. NumPy arrays are accepted for lists:
            vertex numbers in place of "12-40,77", points of shape (n, 3), a matrix of shape (4, 4).
        fraction: how far the handles go, from 0 (no change) to 1. Passed in single precision.

    Returns:
        A dict with "fraction", "mesh" (counts of "vertices" and "faces") and "steps": of each step the figures that the
        program laplacian-edit reports.

    Raises:
        EditRefused: the edit was refused.
        TypeError: edit_dict holds what JSON has no form for.
    """
    text = json.dumps(_plain({"laplacian_edit": 1, **edit_dict}), allow_nan=False)
    # The name of later releases, which deprecate the other one.
    count = mesh_set.mesh_number() if hasattr(mesh_set, "mesh_number") else mesh_set.number_meshes()
    if count == 0:
        raise EditRefused("There are 0 layers: open a triangle mesh first.")
    mesh = mesh_set.current_mesh()
    copy = pymeshlab.MeshSet()
    copy.add_mesh(pymeshlab.Mesh(vertex_matrix=mesh.vertex_matrix(), face_matrix=mesh.face_matrix()))
    try:
        copy.apply_filter(_FILTER, edit=text, fraction=float(fraction))
        # The plugin finds the result of the copy.
        mesh_set.apply_filter(_FILTER, edit=text, fraction=float(fraction))
        return json.loads(_LIBRARY.laplacian_edit_report().decode())
    except pymeshlab.PyMeshLabException as error:
        raise EditRefused(re.sub(r"^Failed to apply filter: .*?\nDetails: ", "", str(error), flags=re.DOTALL)) from None
    finally:
        _LIBRARY.laplacian_edit_forget()


def _plain(value: Any, key: str = "") -> Any:
    """Returns a value as json.dumps() takes it."""
    if isinstance(value, Mapping):
        return {name: _plain(each, name) for name, each in value.items()}
    if isinstance(value, numpy.generic):
        return value.item()
    if isinstance(value, numpy.ndarray):
        value = value.ravel().tolist() if key == "matrix" else value.tolist()
    if key == "vertices" and isinstance(value, Sequence) and not isinstance(value, str):
        return ",".join(str(_vertex(each)) for each in value)
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_plain(each) for each in value]
    return value


def _vertex(number: Any) -> int:
    if isinstance(number, (bool, numpy.bool_)) or not isinstance(number, (int, numpy.integer)):
        raise TypeError(f"The vertex number {number!r} is no integer: give integers, or text such as \"12-40,77\".")
    return int(number)
