# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds and loads the plugin for the installed PyMeshLab."""
from __future__ import annotations

import ctypes
import importlib.metadata
import pathlib
import re

_PLUGINS = pathlib.Path(__file__).parent / "plugins"
_FILTER = "apply_coord_laplacian_editing_replay"

#: The PyMeshLab releases that this package has a plugin for.
SUPPORTED: tuple[str, ...] = tuple(sorted(folder.name for folder in _PLUGINS.iterdir() if folder.is_dir()))


def plugin_path(version: str) -> pathlib.Path:
    """Returns the plugin for a version of PyMeshLab, such as "2025.7.post1".

    Raises ImportError if there is none.
    """
    found = re.match(r"\d+\.\d+", version)
    if found is None or found[0] not in SUPPORTED:
        raise ImportError(f"PyMeshLab {version} is installed, but this package has plugins for PyMeshLab "
                          f"{', '.join(SUPPORTED)} only: pip install 'pymeshlab=={SUPPORTED[-1]}.*'.")
    return _PLUGINS / found[0] / "laplacian_edit_pymeshlab.so"


def require_numpy(pymeshlab_version: str, numpy_version: str) -> None:
    """Raises ImportError for a PyMeshLab that was built before NumPy 2 and crashes with it."""
    if pymeshlab_version.startswith("2022.") and int(numpy_version.split(".")[0]) >= 2:
        raise ImportError(f"PyMeshLab {pymeshlab_version} crashes with NumPy {numpy_version}: pip install 'numpy<2'.")


def load() -> ctypes.CDLL:
    """Loads the plugin into PyMeshLab, unless it is loaded already. Returns its library."""
    version = importlib.metadata.version("pymeshlab")
    path = plugin_path(version)
    require_numpy(version, importlib.metadata.version("numpy"))
    import pymeshlab  # pylint: disable=import-outside-toplevel
    if _FILTER not in pymeshlab.filter_list():
        pymeshlab.load_plugin(str(path))
    # The library is in the process already: this is another handle of it.
    library = ctypes.CDLL(str(path))
    library.laplacian_edit_report.restype = ctypes.c_char_p
    library.laplacian_edit_report.argtypes = ()
    library.laplacian_edit_forget.restype = None
    library.laplacian_edit_forget.argtypes = ()
    return library
