# SPDX-License-Identifier: GPL-3.0-or-later
"""A private X server for tests, and the environment of programs that use it."""
import ctypes
import os
import signal
import subprocess


def end_with_parent():
    """Called in a new process: even a test that is killed for taking too long leaves no X server behind."""
    pr_set_pdeathsig = 1
    ctypes.CDLL(None).prctl(pr_set_pdeathsig, signal.SIGTERM)


def start_x_server(add_cleanup, size):
    """add_cleanup: of a test case or class. @return the display, such as ":7" """
    readable, writable = os.pipe()
    # The server chooses a free display itself: tests can run side by side.
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(writable), "-screen", "0", size + "x24", "+extension", "GLX", "-nolisten", "tcp"],
        pass_fds=[writable], preexec_fn=end_with_parent, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    add_cleanup(server.wait)
    add_cleanup(server.terminate)
    os.close(writable)
    with os.fdopen(readable) as pipe:
        display = pipe.readline().strip()
    assert display, "Xvfb did not start"
    return ":" + display


def host_environment(display, home):
    """For a staged MeshLab with a home of its own."""
    environment = dict(os.environ, DISPLAY=display, HOME=str(home), XDG_RUNTIME_DIR=str(home),
                       XDG_CONFIG_HOME=str(home), LIBGL_ALWAYS_SOFTWARE="1")
    if os.environ.get("LAPEDIT_PRELOAD"):
        environment["LD_PRELOAD"] = os.environ["LAPEDIT_PRELOAD"]
    return environment
