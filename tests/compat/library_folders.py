# SPDX-License-Identifier: GPL-3.0-or-later
"""Where binaries look for libraries: nowhere but in folders with a whole path, or beside themselves. An empty folder or
a relative one would be the current folder, from which anybody's library would be run."""
import os
import pathlib
import re
import subprocess


def binaries(folder):
    for path in pathlib.Path(folder).rglob("*"):
        if path.is_file() and not path.is_symlink() and os.access(path, os.R_OK):
            with open(path, "rb") as file:
                if file.read(4) == b"\x7fELF":
                    yield path


def complaints(binary):
    text = subprocess.run(["readelf", "-dW", binary], stdout=subprocess.PIPE, check=True).stdout.decode()
    for kind, folders in re.findall(r"\((RPATH|RUNPATH)\)[^\[]*\[(.*)\]", text):
        for folder in folders.split(":"):
            if not re.match(r"/|\$ORIGIN(/|$)|\$\{ORIGIN\}(/|$)", folder):
                yield f"{binary}: {kind} is {folders!r}, of which {folder!r} is found from the current folder"
