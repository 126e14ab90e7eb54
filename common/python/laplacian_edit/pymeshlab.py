# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of meshes of PyMeshLab, whose own filters write the coordinates, so that no plugin is needed."""
from __future__ import annotations

import types
from typing import Any, Dict, Mapping, Optional

import numpy
import pymeshlab as _pymeshlab  # type: ignore

from . import _edit
from ._errors import refused

_FILTER = "compute_coord_linear_morphing"
#: The filter adds the difference of two meshes, which is rounded. Where the target cannot allow for that, since a coordinate
#: is far smaller than it was, another pass adds what is left.
_MOST_PASSES = 6


def _target(before: numpy.ndarray, after: numpy.ndarray) -> numpy.ndarray:
    """Returns the coordinates with which the filter's sum, before + (target - before), is the wanted one where possible."""
    target = after.copy()
    for _ in range(3):
        left = after - (before + (target - before))
        if not left.any():
            break
        target += left
    return target


def edit(mesh_set: _pymeshlab.MeshSet, edit: _edit.Edit, fraction: float = 1.0, *, scans: Optional[Mapping[str, Any]] = None,
         landmarks_folder: Any = None, space: Optional[str] = None, progress: Optional[_edit.Progress] = None) -> Dict[str, Any]:
    """Applies an edit to the current mesh of a mesh set and returns the report.

    Coordinates change; PyMeshLab recomputes the normals; all other attributes, the selection and the mesh's number stay.
    {"selected": True} stands for what is selected in the mesh.

    Args:
        mesh_set: its current mesh is edited, in double precision as everywhere in PyMeshLab.
        edit, fraction, scans, landmarks_folder, space, progress: as for laplacian_edit.edit().

    Returns:
        The report, a dict with "mesh", "fraction" and "steps".

    Raises:
        EditRefused: the mesh set is then unchanged.
    """
    if not isinstance(mesh_set, _pymeshlab.MeshSet):
        raise refused("mesh_set", f"an object of the type {type(mesh_set).__name__} is no MeshSet: call "
                          "laplacian_edit.edit() for arrays and for meshes of other libraries.")
    # The name of later releases, which deprecate the other one.
    count = mesh_set.mesh_number() if hasattr(mesh_set, "mesh_number") else mesh_set.number_meshes()
    if count == 0:
        raise refused("mesh_set", "there are 0 layers: open a triangle mesh first.", "EmptyMesh")
    mesh = mesh_set.current_mesh()
    if not mesh.is_compact():
        mesh.compact()
    vertices, faces = mesh.vertex_matrix(), mesh.face_matrix()
    result = _edit.edit(types.SimpleNamespace(vertices=vertices, faces=faces), edit, selected=mesh.vertex_selection_array(),
                        selected_faces=mesh.face_selection_array(), scans=scans, landmarks_folder=landmarks_folder,
                        space=space, fraction=fraction, progress=progress)
    if not numpy.isfinite(vertices).all():
        raise refused("mesh_set", "the current mesh has vertices that are not finite, which PyMeshLab cannot write: remove "
                          "them, or call laplacian_edit.edit() for its arrays.", "NotFinite")
    current = mesh_set.current_mesh_id()
    for _ in range(_MOST_PASSES):
        mesh_set.add_mesh(_pymeshlab.Mesh(_target(vertices, result.vertices)), "", True)
        other = mesh_set.current_mesh_id()
        try:
            mesh_set.set_current_mesh(current)
            mesh_set.apply_filter(_FILTER, targetmesh=other, percentmorph=100.0)
        finally:
            mesh_set.set_current_mesh(other)
            mesh_set.delete_current_mesh()
            mesh_set.set_current_mesh(current)
        vertices = mesh_set.current_mesh().vertex_matrix()
        if numpy.array_equal(vertices, result.vertices):
            break
    return result.report
