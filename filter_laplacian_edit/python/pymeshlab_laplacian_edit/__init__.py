# SPDX-License-Identifier: GPL-3.0-or-later
"""Detail-preserving mesh deformation for PyMeshLab.

Importing this package loads the plugin that fits the installed PyMeshLab, and raises ImportError if there is none.
"""
import importlib.metadata

from ._edit import EditRefused, edit
from ._plugin import SUPPORTED

__all__ = ["EditRefused", "SUPPORTED", "edit"]
__version__ = importlib.metadata.version("meshlab-laplacian-edit")
