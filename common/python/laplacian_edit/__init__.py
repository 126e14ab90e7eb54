# SPDX-License-Identifier: GPL-3.0-or-later
"""Detail-preserving mesh deformation (Lipman et al. 2004): arrays in, arrays out.

Some vertices move, the surface around them follows smoothly, details keep their shape and rotate with it, and nothing
outside the region changes. edit() applies an edit, Editor prepares a step once for many poses, nearest() finds vertices,
fit_landmarks() makes an edit of landmark files, transfer() takes colours from a scan to what was fitted to it, and
laplacian_edit.pymeshlab edits meshes of PyMeshLab.
"""
import importlib.metadata

from ._edit import Editor, Region, Result, edit, fit_landmarks, nearest, transfer
from ._errors import EditRefused

__all__ = ["EditRefused", "Editor", "Region", "Result", "edit", "fit_landmarks", "nearest", "transfer"]
__version__ = importlib.metadata.version("laplacian-edit")
